//! The model of episodes as a run sees it.

use crate::dataset::{Clip, Dataset, SegmentSampler};
use crate::preferences::{Interview, LabelledPair};
use crate::reward::{LearnError, Learned, Material, Questions, RewardLearner, Save};

use super::EpisodesConfig;
use super::interrogation::Interrogation;
use super::learn::learn;

impl RewardLearner for EpisodesConfig {
    fn check(&self, dataset: &Dataset) -> Result<(), LearnError> {
        SegmentSampler::new(dataset, Clip::Episode)?;
        match dataset.episodes().len() {
            0 | 1 => Err(LearnError::TooFewEpisodes),
            _ => Ok(()),
        }
    }

    fn queries(&self) -> usize {
        self.queries
    }

    /// Each question depends on the answers before it: nothing is asked beforehand.
    fn ask(
        &self,
        on: Material<'_>,
        _: &mut Interview<'_>,
    ) -> Result<Vec<LabelledPair>, LearnError> {
        self.check(on.dataset)?;
        Ok(Vec::new())
    }

    /// The look at the logs is taken once.
    fn questions<'a>(&'a self, on: Material<'a>) -> Result<Box<dyn Questions + 'a>, LearnError> {
        self.check(on.dataset)?;
        Ok(Box::new(Interrogation::begin(self, on)?))
    }

    /// It takes a minute: nothing but the answers is saved.
    fn learn(
        &self,
        _: &[LabelledPair],
        on: Material<'_>,
        interview: &mut Interview<'_>,
        _: Save<'_>,
    ) -> Result<Learned, LearnError> {
        learn(self, on, interview)
    }
}
