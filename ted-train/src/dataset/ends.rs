//! Where the end of an episode may stand: at its last step, and nowhere before.
//!
//! A flag inside of an episode is two recordings in one, or rows that a writer put down in another order than that of time. In
//! both cases a transition joins two moments that did not follow each other, and nobody would notice in training.

use super::DatasetError;

/// Refuses an end inside of an episode. A last step without a flag is the end of the recording all the same.
pub(super) fn check_ends(
    place: &str,
    terminations: &[bool],
    truncations: &[bool],
) -> Result<(), DatasetError> {
    let inside = |flags: &[bool]| {
        let before = flags.len().saturating_sub(1);
        flags[..before].iter().position(|&end| end)
    };
    let first = [
        ("a termination", terminations),
        ("a truncation", truncations),
    ]
    .into_iter()
    .filter_map(|(flag, flags)| Some((inside(flags)?, flag)))
    .min();
    let Some((step, flag)) = first else {
        return Ok(());
    };
    let last = |flags: &[bool]| flags.last() == Some(&true);
    Err(DatasetError::EndInside {
        place: place.into(),
        flag,
        step,
        steps: terminations.len(),
        ends: last(terminations) || last(truncations),
    })
}
