//! The simulated teacher: looks at the true rewards, and errs as its configuration says.

use rand::RngExt;

use super::{Says, Teacher, TeacherConfig};
use crate::dataset::Dataset;
use crate::preferences::{Answer, LogEntry, PreferenceError, Query, Question, Said};
use crate::rng::Seed;

/// Answers as its configuration says. Whatever is random about an answer is a function of the seed, the question and its number:
/// nobody can tell how often a run was started again.
#[derive(Clone, Debug, PartialEq)]
pub struct ScriptedTeacher {
    config: TeacherConfig,
    seed: Seed,
    name: String,
}

impl ScriptedTeacher {
    /// A teacher of this kind.
    #[must_use]
    pub fn new(config: TeacherConfig, seed: Seed) -> Self {
        Self {
            name: config.name(),
            config,
            seed,
        }
    }

    /// One that knows the true rewards and never errs.
    #[must_use]
    pub fn truthful() -> Self {
        // Nothing is drawn from the seed that shows in an answer.
        Self::new(TeacherConfig::default(), Seed::root(0))
    }

    /// Whether it can say anything about a dataset.
    ///
    /// # Errors
    /// When it looks at rewards, and they are all the same.
    pub fn check(&self, dataset: &Dataset) -> Result<(), PreferenceError> {
        match dataset.only_reward() {
            Some(reward) if self.config.says.looks_at_rewards() => {
                let id = dataset.id().to_owned();
                Err(PreferenceError::NobodyToAsk { id, reward })
            }
            _ => Ok(()),
        }
    }

    /// What it says to the question of this number, counted from 1; none when it cannot tell.
    fn say(&self, dataset: &Dataset, number: usize, query: &Query) -> Option<Answer> {
        let [first, second] = query
            .segments
            .map(|it| format!("{}/{}/{}", it.episode(), it.start(), it.len()));
        let stream = self.seed.child(&format!("{number}/{first}/{second}"));
        let mut rng = stream.rng();
        // Always the same draws, so that a teacher who errs more often errs where the other one does too.
        let [told, slipped]: [f64; 2] = [rng.random(), rng.random()];
        let coin = if rng.random() {
            Answer::First
        } else {
            Answer::Second
        };
        if told < self.config.cannot_tell {
            return None;
        }
        let answer = match self.config.says {
            Says::TrueReturn => self.truth(dataset, query),
            Says::Reversed => self.truth(dataset, query).turned(),
            Says::Random => coin,
            Says::First => Answer::First,
            Says::Equal => Answer::Equal,
        };
        let errs = slipped < self.config.errs;
        Some(if errs { answer.turned() } else { answer })
    }

    /// The order of the true returns.
    fn truth(&self, dataset: &Dataset, query: &Query) -> Answer {
        let [first, second] = query.segments.map(|segment| segment.return_true(dataset));
        let [steps, others] = query.segments.map(|segment| f64::from(segment.len()));
        let tolerance = self.config.tolerance * spread(dataset) * (steps + others) / 2.0;
        if (first - second).abs() <= tolerance {
            Answer::Equal
        } else if first > second {
            Answer::First
        } else {
            Answer::Second
        }
    }
}

/// Standard deviation, over episodes, of the mean true reward of a step.
fn spread(dataset: &Dataset) -> f64 {
    let episodes = dataset.episodes();
    let rewards = episodes
        .iter()
        .map(|episode| episode.return_true / episode.len as f64);
    let count = episodes.len() as f64;
    let mean = rewards.clone().sum::<f64>() / count;
    (rewards.map(|it| (it - mean) * (it - mean)).sum::<f64>() / count).sqrt()
}

impl Teacher for ScriptedTeacher {
    fn answer(
        &mut self,
        dataset: &Dataset,
        asked: &[LogEntry],
        question: &Question,
    ) -> Result<Said, PreferenceError> {
        Ok(Said {
            answer: self.say(dataset, asked.len() + 1, &question.query),
            later: false,
            by: self.name.clone(),
            at: None,
        })
    }
}

#[cfg(test)]
#[path = "scripted_tests.rs"]
mod tests;
