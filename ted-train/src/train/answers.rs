//! Answers that are asked for all at once, before anything is learned.

use firmware_sim::progress::Audience;

use super::TrainError;
use super::model::Facts;
use crate::algorithm::oppo::OppoConfig;
use crate::dataset::{Dataset, SegmentSampler};
use crate::preferences::{LabelledPair, PreferenceLog, Teacher};
use crate::reward::{LearnError, ask_random_pairs};
use crate::rng::Seed;
use crate::run::{PREFERENCES, RunError, RunFolder};

/// Answers about random pairs of clips.
pub(super) struct Answers {
    pub(super) pairs: Vec<LabelledPair>,
    /// Digest of the log that they are in.
    pub(super) digest: String,
}

/// The log of a run.
pub(super) fn log(
    folder: &RunFolder,
    dataset: &Dataset,
    audience: Audience,
) -> Result<PreferenceLog, TrainError> {
    let log = PreferenceLog::open(folder.file(PREFERENCES), dataset).map_err(LearnError::from)?;
    if let Some(recovered) = log.recovered() {
        audience.note(&format!(
            "the preference log had a torn last line; {} answers are kept",
            recovered.kept
        ));
    }
    Ok(log)
}

impl Answers {
    /// Asks about so many pairs of clips what the log does not answer yet. With the same root, whoever asks about clips as
    /// long asks the same.
    pub(super) fn ask(
        queries: usize,
        segment: u32,
        dataset: &Dataset,
        teacher: &mut dyn Teacher,
        log: &mut PreferenceLog,
        root: Seed,
    ) -> Result<Self, TrainError> {
        let sampler = SegmentSampler::new(dataset, segment).map_err(LearnError::from)?;
        let seed = root.child("reward");
        let pairs = ask_random_pairs(queries, dataset, &sampler, teacher, log, seed)
            .map_err(LearnError::from)?;
        let digest = log.digest().map_err(LearnError::from)?;
        Ok(Self { pairs, digest })
    }

    /// Those that a policy is learned from without a reward in between.
    pub(super) fn of_a_policy(
        config: &OppoConfig,
        dataset: &Dataset,
        folder: &RunFolder,
        teacher: &mut dyn Teacher,
        root: Seed,
        audience: Audience,
    ) -> Result<(Vec<LabelledPair>, Facts), TrainError> {
        let mut log = log(folder, dataset, audience)?;
        let OppoConfig {
            queries, segment, ..
        } = *config;
        let answers = Self::ask(queries, segment, dataset, teacher, &mut log, root)?;
        same_answers(folder, &answers.digest)?;
        let facts = Facts {
            queries: log.entries().len(),
            preferences_digest: Some(answers.digest),
            ..Facts::default()
        };
        Ok((answers.pairs, facts))
    }
}

/// Refuses to go on with a policy that was learned from other answers than those of this digest.
fn same_answers(folder: &RunFolder, digest: &str) -> Result<(), TrainError> {
    /// Holds the digest of the answers that the checkpoints are of.
    const STATE: &str = "answers.state";
    let held = match folder.file(STATE).exists() {
        true => Some(folder.read_state::<String>(STATE).map_err(RunError::from)?),
        false => None,
    };
    let difference = match held {
        Some(held) if held == digest => return Ok(()),
        Some(_) => format!("its policy is learned from other answers than {PREFERENCES} has now"),
        None if folder.has_checkpoints() => {
            format!("{STATE} is gone, which says what answers its policy is learned from")
        }
        None => return Ok(folder.write_state(STATE, &digest)?),
    };
    Err(folder.other(difference).into())
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::dataset::fixtures::{SHAPE, records};
    use crate::preferences::{Context, ReplayTeacher, ScriptedTeacher};

    #[test]
    fn as_many_pairs_are_asked_about_as_wanted_and_the_log_alone_answers_the_same() {
        let dataset = Dataset::from_records("ted/x-v0", SHAPE, &records(&[9, 9, 9])).unwrap();
        let folders = [(); 2].map(|()| tempfile::tempdir().unwrap());
        let [first, second] = folders.each_ref().map(|it| it.path().join("log.jsonl"));
        let ask = |path: &Path, teacher: &mut dyn Teacher| {
            let mut log = PreferenceLog::open(path, &dataset).unwrap();
            let root = Seed::root(3);
            let answers = Answers::ask(10, 4, &dataset, teacher, &mut log, root).unwrap();
            (answers, log.entries().to_vec())
        };
        let (answers, asked) = ask(&first, &mut ScriptedTeacher::new(0.0).unwrap());
        assert_eq!((answers.pairs.len(), asked.len()), (10, 10));
        let shared = Context {
            round: 0,
            member: None,
        };
        assert!(asked.iter().all(|entry| entry.context == shared));
        let mut teacher = ReplayTeacher::open(&first, &dataset).unwrap();
        let (replayed, entries) = ask(&second, &mut teacher);
        assert_eq!(entries, asked);
        assert_eq!(replayed.pairs, answers.pairs);
        assert_eq!(replayed.digest, answers.digest);
    }
}
