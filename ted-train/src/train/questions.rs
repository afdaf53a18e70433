//! What a run asks, by itself: somebody may answer before anything is trained.

use firmware_sim::progress::Audience;

use crate::config::Config;
use crate::dataset::Dataset;
use crate::preferences::Interview;
use crate::reward::{LearnError, Material, Questions};
use crate::rng::Seed;
use crate::run::RunFolder;

use super::{answers, model};

/// Everything that a run of this configuration asks about the dataset, ready to be asked, and asked again after an answer was
/// taken back or more are wanted. What is asked is what the run itself would ask with the same log.
///
/// # Errors
/// When the dataset does not have what is asked about, or what is computed before the first question cannot be.
pub fn questions<'a>(
    dataset: &'a Dataset,
    config: &'a Config,
    audience: Audience,
) -> Result<Box<dyn Questions + 'a>, LearnError> {
    let seed = Seed::root(config.seed).child("reward");
    if let Some(learner) = config.reward.learner() {
        return learner.questions(Material {
            dataset,
            seed,
            backend: config.backend,
            audience,
        });
    }
    Ok(match config.algorithm.questions() {
        Some(questions) => Box::new(questions.asked_of(dataset, seed)),
        None => Box::new(|_: &mut Interview<'_>, _| Ok(())),
    })
}

/// Whether something was learned in this folder from the answers in it: from then on they are part of the run.
#[must_use]
pub fn has_learned(folder: &RunFolder) -> bool {
    [model::STATE, answers::STATE]
        .iter()
        .any(|state| folder.file(state).exists())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::{Overrides, Preset};
    use crate::dataset::fixtures::{SHAPE, records};
    use crate::preferences::{PreferenceLog, ScriptedTeacher};

    /// Networks that learn in a moment.
    fn small(preset: Preset) -> Config {
        let sets: &[&str] = match preset {
            Preset::Steer => &[
                "reward.clone.steps=20",
                "reward.clone.hidden=[8]",
                "reward.pool=60",
            ],
            Preset::OprlITed => &["reward.epochs=5", "reward.hidden=[8]", "reward.segment=10"],
            Preset::Oppo => &["algorithm.segment=10"],
            _ => &["reward.segment=10"],
        };
        let overrides = sets
            .iter()
            .try_fold(Overrides::default(), |all, set| all.set(set));
        overrides.unwrap().resolve(Some(preset), None).unwrap()
    }

    #[test]
    fn more_answers_leave_the_questions_before_them_as_they_were_whatever_asks() {
        let dataset = Dataset::from_records("ted/x-v0", SHAPE, &records(&[30; 12])).unwrap();
        let folder = tempfile::tempdir().unwrap();
        for preset in [Preset::Steer, Preset::OprlITed, Preset::Pt, Preset::Oppo] {
            let config = small(preset);
            assert_eq!(config.answers(), 10);
            assert_eq!(config.asking(10), config, "{preset:?}");
            let log = |name: &str, config: &Config, answers: usize| {
                let path = folder.path().join(format!("{preset:?}-{name}"));
                let mut teacher = ScriptedTeacher::truthful();
                let log = PreferenceLog::open(&path, &dataset).unwrap();
                let mut interview = Interview::new(&dataset, &mut teacher, log);
                let questions = questions(&dataset, config, Audience::Nobody).unwrap();
                questions.ask(&mut interview, answers).unwrap();
                std::fs::read_to_string(path).unwrap()
            };
            let ten = log("ten", &config, 10);
            let more = log("more", &config, 15);
            assert_eq!((ten.lines().count(), more.lines().count()), (10, 15));
            assert!(more.starts_with(&ten), "{preset:?}");
            // A run that wants as many from its beginning asks the same.
            let wanting = config.asking(15);
            assert_eq!(wanting.answers(), 15);
            assert_eq!(log("wanting", &wanting, 15), more, "{preset:?}");
        }
        let deaf = Preset::Bc.config();
        assert_eq!(deaf.asking(15), deaf);
    }
}
