//! The artefact against the state of the run that it was made from: weights, rewards, discount classes.

use ted_core::{DiscountClass, Mlp, Normaliser, RewardEnsemble, Scratch, ShapeError, TedDiscount};
use ted_policy::Artifact;

use crate::dataset::Dataset;
use crate::train::FinishedRun;

use super::{CrosscheckError, Distance};

/// Episodes whose rewards are computed again, spread evenly over the dataset.
const LABELLED_EPISODES: usize = 16;

/// Every number of the policy and of the reward ensemble.
pub(super) fn weights(
    artifact: &Artifact<'_>,
    run: &FinishedRun,
) -> Result<Distance, CrosscheckError> {
    let mut flown = Vec::new();
    let mut learned = Vec::new();
    let policy = artifact.policy();
    push_network(&mut flown, policy.normaliser(), [policy.mlp()]);
    let normaliser = Normaliser::new(run.shift(), run.scale())?;
    push_network(&mut learned, &normaliser, [&run.actor().view()?]);
    if let Some(reward) = artifact.reward() {
        push_ensemble(&mut flown, &reward);
    }
    if let Some((ensemble, range)) = run.reward() {
        push_ensemble(&mut learned, &ensemble.view(range)?);
    }
    let mut distance = Distance::between(&flown, &learned);
    // A part that only one of the two has is different in every number.
    distance.unequal += flown.len().abs_diff(learned.len()) as u64;
    Ok(distance)
}

fn push_ensemble(out: &mut Vec<f32>, ensemble: &RewardEnsemble<'_>) {
    push_network(out, ensemble.normaliser(), ensemble.members());
    out.extend([ensemble.range().low, ensemble.range().high]);
}

fn push_network<'a, 'b: 'a>(
    out: &mut Vec<f32>,
    normaliser: &Normaliser<'_>,
    members: impl IntoIterator<Item = &'a Mlp<'b>>,
) {
    out.extend(normaliser.shift().iter().chain(normaliser.scale()));
    for layer in members.into_iter().flat_map(Mlp::layers) {
        out.extend(layer.weights().iter().chain(layer.bias()));
    }
}

/// The rewards of some episodes, by the artefact's ensemble, against those that the learner was given.
pub(super) fn labels(
    ensemble: &RewardEnsemble<'_>,
    run: &FinishedRun,
    dataset: &Dataset,
) -> Result<Distance, ShapeError> {
    let episodes = dataset.episodes();
    let count = LABELLED_EPISODES.min(episodes.len());
    let mut scratch = Scratch::new();
    let mut all = Distance::default();
    for episode in (0..count).map(|i| episodes[i * episodes.len() / count]) {
        let steps = episode.first_step..episode.first_step + episode.len;
        let computed = steps
            .clone()
            .map(|step| {
                let (observation, action) = (dataset.observation(step), dataset.action(step));
                ensemble.reward_hat(observation, action, &mut scratch)
            })
            .collect::<Result<Vec<_>, _>>()?;
        all = all.and(Distance::between(&computed, &run.labels().rewards[steps]));
    }
    Ok(all)
}

/// Episodes compared, and those that the artefact's threshold puts on another side than a ranking by predicted return.
pub(super) fn classes(ted: &TedDiscount, returns_hat: &[f32], k: f64) -> (u64, u64) {
    let keep = (returns_hat.len() as f64 * k / 100.0).round() as usize;
    let wrong = (0..returns_hat.len())
        .filter(|&episode| {
            let better = |&other: &usize| {
                returns_hat[other] > returns_hat[episode]
                    || (returns_hat[other] == returns_hat[episode] && other < episode)
            };
            let rank = (0..returns_hat.len()).filter(better).count();
            let number = u32::try_from(episode).unwrap_or(ted_core::NEW_EPISODE);
            let in_top = ted.class(returns_hat[episode], number) == DiscountClass::TopK;
            in_top != (rank < keep)
        })
        .count();
    (returns_hat.len() as u64, wrong as u64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ted::DiscountConfig;

    #[test]
    fn the_threshold_and_the_ranking_agree_and_another_threshold_does_not() {
        let returns_hat = [3.0, 1.0, 2.0, 2.0, 2.0, 0.0];
        let lookup = |k| {
            let config = DiscountConfig::Ted {
                gamma: 0.99,
                k,
                sigma: 0.7,
            };
            config.lookup(&returns_hat).unwrap().unwrap()
        };
        assert_eq!(classes(&lookup(50.0), &returns_hat, 50.0), (6, 0));
        assert_eq!(classes(&lookup(70.0), &returns_hat, 50.0), (6, 1));
    }
}
