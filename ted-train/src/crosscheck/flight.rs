//! The run's evaluation, flown again: the returns must have the same bits.

use firmware_sim::progress::Audience;

use crate::evaluate::{Evaluation, evaluate};
use crate::run::{RunError, RunFolder};

use super::CrosscheckError;

const EVALUATION: &str = "evaluation.json";

/// Episodes compared, and those whose return differs; none when the run has not been evaluated.
pub(super) fn fly_again(
    folder: &RunFolder,
    episodes: u32,
    workers: usize,
    audience: Audience,
) -> Result<Option<(u64, u64)>, CrosscheckError> {
    let path = folder.file(EVALUATION);
    if episodes == 0 || !path.exists() {
        return Ok(None);
    }
    let held: Evaluation = folder.read_json(EVALUATION)?;
    let unreadable = |message: &str| RunError::Unreadable {
        path: path.clone(),
        message: message.to_owned(),
    };
    let text = std::fs::read_to_string(&path).map_err(|error| unreadable(&error.to_string()))?;
    let expected = returns(&text).ok_or_else(|| unreadable("it holds no list of returns"))?;
    let episodes = episodes.min(u32::try_from(expected.len()).unwrap_or(episodes));
    let flown = evaluate(
        &folder.artefact_path(),
        Some(&held.task),
        episodes,
        held.seed,
        workers,
        audience,
    )?;
    let different = flown
        .returns
        .iter()
        .zip(&expected)
        .filter(|(flown, expected)| flown.to_bits() != expected.to_bits())
        .count();
    Ok(Some((u64::from(episodes), different as u64)))
}

/// The returns in the text of an evaluation, to the bit. The JSON parser is fast instead of exact in the last place, which is
/// the place that is compared here.
fn returns(json: &str) -> Option<Vec<f64>> {
    let (_, rest) = json.split_once("\"returns\":")?;
    let (list, _) = rest.split_once('[')?.1.split_once(']')?;
    list.split(',')
        .map(|number| number.trim().parse().ok())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn returns_are_read_back_to_the_bit() {
        let written = vec![1.0, 0.1 + 0.2, 3690.412345678901, 0.1_f64.sqrt(), 1e300];
        let json = serde_json::json!({ "seed": 0, "returns": written, "success": 1.0 });
        let pretty = serde_json::to_string_pretty(&json).unwrap();
        assert_eq!(returns(&pretty), Some(written));
        assert_eq!(returns("{}"), None);
    }
}
