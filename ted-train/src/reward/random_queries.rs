//! Questions about random pairs, all asked before anything is learned.

use crate::dataset::{Clip, Dataset, SegmentSampler};
use crate::preferences::{Context, Interview, LabelledPair, RandomPair};
use crate::rng::Seed;

use super::{LearnError, Questions};

/// How many random pairs somebody is asked about, and what they see of each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RandomQueries {
    /// Questions.
    pub queries: usize,
    /// What is shown of an episode.
    pub clip: Clip,
}

impl RandomQueries {
    /// Whether the dataset has such segments.
    ///
    /// # Errors
    /// When every episode is too short for one.
    pub fn check(self, dataset: &Dataset) -> Result<(), LearnError> {
        SegmentSampler::new(dataset, self.clip)?;
        Ok(())
    }

    /// Asks, each question being from the stream `seed/query/<number>`: with the same seed, whoever asks about the same clips
    /// asks the same.
    ///
    /// # Errors
    /// When [`Self::check`] does, or an answer cannot be had or kept.
    pub fn ask(
        self,
        dataset: &Dataset,
        interview: &mut Interview<'_>,
        seed: Seed,
    ) -> Result<Vec<LabelledPair>, LearnError> {
        let sampler = SegmentSampler::new(dataset, self.clip)?;
        let context = Context {
            round: 0,
            member: None,
        };
        let ask = |query| {
            let mut rng = seed.child(&format!("query/{query}")).rng();
            Ok(interview.ask(context, &RandomPair, &sampler, &mut rng)?)
        };
        (0..self.queries).map(ask).collect()
    }

    /// The same as something that can be asked again and again, with as many questions as are wanted then.
    pub fn asked_of(self, dataset: &Dataset, seed: Seed) -> impl Questions {
        move |interview: &mut Interview<'_>, queries: usize| {
            let all = Self { queries, ..self };
            all.ask(dataset, interview, seed).map(drop)
        }
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::dataset::fixtures::{SHAPE, records};
    use crate::preferences::{PreferenceLog, ReplayTeacher, ScriptedTeacher, Teacher};

    #[test]
    fn as_many_pairs_are_asked_about_as_wanted_and_the_log_alone_answers_the_same() {
        let dataset = Dataset::from_records("ted/x-v0", SHAPE, &records(&[9, 9, 9])).unwrap();
        let folders = [(); 2].map(|()| tempfile::tempdir().unwrap());
        let [first, second] = folders.each_ref().map(|it| it.path().join("log.jsonl"));
        let ask = |path: &Path, teacher: &mut dyn Teacher| {
            let log = PreferenceLog::open(path, &dataset).unwrap();
            let mut interview = Interview::new(&dataset, teacher, log);
            let questions = RandomQueries {
                queries: 10,
                clip: Clip::Steps(4),
            };
            let pairs = questions.ask(&dataset, &mut interview, Seed::root(3));
            let digest = interview.digest().unwrap();
            (pairs.unwrap(), interview.entries().to_vec(), digest)
        };
        let asked = ask(&first, &mut ScriptedTeacher::truthful());
        let (pairs, entries, _) = &asked;
        assert_eq!((pairs.len(), entries.len()), (10, 10));
        let shared = Context {
            round: 0,
            member: None,
        };
        assert!(entries.iter().all(|entry| entry.question.context == shared));
        let mut teacher = ReplayTeacher::open(&first, &dataset).unwrap();
        assert_eq!(ask(&second, &mut teacher), asked);
    }
}
