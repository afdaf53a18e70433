//! What a run asks, by itself: somebody may answer before anything is trained.

use firmware_sim::progress::Audience;

use crate::config::Config;
use crate::dataset::Dataset;
use crate::reward::{LearnError, Material, Questions};
use crate::rng::Seed;
use crate::run::RunFolder;

use super::{answers, model};

/// Everything that a run of this configuration asks about the dataset, ready to be asked, and asked again after an answer was
/// taken back. What is asked is what the run itself would ask with the same log.
///
/// # Errors
/// When the dataset does not have what is asked about, or what is computed before the first question cannot be.
pub fn questions<'a>(
    dataset: &'a Dataset,
    config: &'a Config,
    audience: Audience,
) -> Result<Questions<'a>, LearnError> {
    let seed = Seed::root(config.seed).child("reward");
    if let Some(learner) = config.reward.learner() {
        return learner.questions(Material {
            dataset,
            seed,
            backend: config.backend,
            audience,
        });
    }
    let of_policy = config.algorithm.questions();
    Ok(Box::new(move |interview| match of_policy {
        Some(questions) => questions.ask(dataset, interview, seed).map(drop),
        None => Ok(()),
    }))
}

/// Whether something was learned in this folder from the answers in it: from then on they are part of the run.
#[must_use]
pub fn has_learned(folder: &RunFolder) -> bool {
    [model::STATE, answers::STATE]
        .iter()
        .any(|state| folder.file(state).exists())
}
