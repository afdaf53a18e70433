//! What a person who waits is told: what the logs say by themselves, and what the answers changed of it.

use nalgebra::DVector;

use super::descriptors::Descriptors;
use super::posterior::Prior;

/// How far the two halves of an episode agree on each descriptor.
pub(super) fn look(reliability: &[f64]) -> String {
    let each = reliability.iter().enumerate();
    let each = each.map(|(j, rho)| format!("{} {rho:.2}", Descriptors::name(j)));
    format!(
        "what the logs say by themselves: two halves of an episode agree (1 is fully) on {}",
        each.collect::<Vec<_>>().join(", ")
    )
}

/// How far the answers moved what was believed, of the descriptors that they moved most; none where they moved nothing.
pub(super) fn moved(prior: &Prior, weights: &DVector<f64>) -> Option<String> {
    /// Descriptors that are named.
    const NAMED: usize = 3;
    /// Less than this does not show in two digits.
    const VISIBLE: f64 = 0.005;
    let mut moves: Vec<(usize, f64)> = (weights - &prior.mean)
        .iter()
        .map(|by| by.abs())
        .enumerate()
        .filter(|&(_, by)| by >= VISIBLE)
        .collect();
    moves.sort_by(|(_, one), (_, other)| other.total_cmp(one));
    let named = moves.iter().take(NAMED).map(|&(j, _)| {
        let (before, now) = (prior.mean[j], weights[j]);
        format!("{} {now:+.2} (before {before:+.2})", Descriptors::name(j))
    });
    let named: Vec<_> = named.collect();
    (!named.is_empty()).then(|| format!("by the answers a good episode has: {}", named.join(", ")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_moved_most_is_named_first_and_what_stood_still_is_not() {
        let prior = Prior {
            mean: DVector::from_vec(vec![1.5, 0.0, 0.0]),
            std: DVector::from_vec(vec![1.0, 0.5, 0.5]),
        };
        assert_eq!(moved(&prior, &prior.mean), None);
        let weights = DVector::from_vec(vec![1.25, -0.5, 0.004]);
        assert_eq!(
            moved(&prior, &weights).unwrap(),
            "by the answers a good episode has: whereabouts 1 -0.50 (before +0.00), competence +1.25 (before +1.50)"
        );
        assert!(look(&[0.9, 0.0]).ends_with("on competence 0.90, whereabouts 1 0.00"));
    }
}
