//! The Preference Transformer as a run sees it.

use crate::dataset::{Clip, Dataset};
use crate::preferences::{Interview, LabelledPair};
use crate::reward::{
    LearnError, Learned, Material, Questions, RandomQueries, RewardLearner, RewardModel, Save,
    Saved,
};

use super::config::PtConfig;
use super::labels::transformer_labels;
use super::learn::{LOOK_EVERY, held_out_agreement, train};

impl RewardLearner for PtConfig {
    fn check(&self, dataset: &Dataset) -> Result<(), LearnError> {
        self.random().check(dataset)
    }

    fn queries(&self) -> usize {
        self.queries
    }

    fn ask(
        &self,
        on: Material<'_>,
        interview: &mut Interview<'_>,
    ) -> Result<Vec<LabelledPair>, LearnError> {
        self.random().ask(on.dataset, interview, on.seed)
    }

    fn learn(
        &self,
        answers: &[LabelledPair],
        on: Material<'_>,
        _: &mut Interview<'_>,
        save: Save<'_>,
    ) -> Result<Learned, LearnError> {
        self.go_on(None, answers, on, save)
    }

    /// All of it is asked before anything is learned.
    fn questions<'a>(&'a self, on: Material<'a>) -> Result<Box<dyn Questions + 'a>, LearnError> {
        Ok(Box::new(self.random().asked_of(on.dataset, on.seed)))
    }

    fn resume(
        &self,
        saved: Saved,
        answers: &[LabelledPair],
        on: Material<'_>,
        _: &mut Interview<'_>,
        save: Save<'_>,
    ) -> Result<Learned, LearnError> {
        self.go_on(Some(saved), answers, on, save)
    }

    fn takes_long(&self) -> bool {
        true
    }

    fn looked_at(&self, index: u64) -> u64 {
        self.steps.min((index + 1) * LOOK_EVERY)
    }
}

impl PtConfig {
    fn random(&self) -> RandomQueries {
        RandomQueries {
            queries: self.queries,
            clip: Clip::Steps(self.segment),
        }
    }

    fn go_on(
        &self,
        saved: Option<Saved>,
        answers: &[LabelledPair],
        on: Material<'_>,
        save: Save<'_>,
    ) -> Result<Learned, LearnError> {
        let trained = train(self, answers, on, saved, save)?;
        let held_out = held_out_agreement(self, &trained.transformer, on.dataset, on.seed)?;
        let labels = transformer_labels(on.dataset, &trained.transformer, on.audience)?;
        Ok(Learned {
            model: RewardModel::Labels(labels),
            fits: trained.fits,
            held_out,
        })
    }
}
