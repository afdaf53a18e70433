//! OPRL as a run sees it.

use crate::dataset::{Dataset, SegmentSampler};
use crate::preferences::{Interview, LabelledPair};
use crate::reward::{LearnError, Learned, Material, Questions, RewardLearner, RewardModel, Save};

use super::config::OprlConfig;
use super::learn::{ask, held_out_agreement, train};

impl RewardLearner for OprlConfig {
    fn check(&self, dataset: &Dataset) -> Result<(), LearnError> {
        SegmentSampler::of_one_length(dataset, self.segment)?;
        Ok(())
    }

    fn queries(&self) -> usize {
        Self::queries(self)
    }

    fn ask(
        &self,
        on: Material<'_>,
        interview: &mut Interview<'_>,
    ) -> Result<Vec<LabelledPair>, LearnError> {
        ask(self, on, interview)
    }

    /// What a round asks depends on what was learned before it.
    fn questions<'a>(&'a self, on: Material<'a>) -> Result<Box<dyn Questions + 'a>, LearnError> {
        Ok(Box::new(
            move |interview: &mut Interview<'_>, answers: usize| {
                let config = self.asking(answers);
                let own = ask(&config, on, interview)?;
                train(&config, &own, on, interview).map(drop)
            },
        ))
    }

    /// It takes seconds: nothing is saved.
    fn learn(
        &self,
        answers: &[LabelledPair],
        on: Material<'_>,
        interview: &mut Interview<'_>,
        _: Save<'_>,
    ) -> Result<Learned, LearnError> {
        let trained = train(self, answers, on, interview)?;
        let held_out = held_out_agreement(self, &trained.ensemble, on.dataset, on.seed)?;
        Ok(Learned {
            model: RewardModel::Ensemble(trained.ensemble.exported()),
            fits: trained.fits,
            held_out,
        })
    }
}
