//! Choices of the OPRL reward ensemble.

use serde::{Deserialize, Serialize};

use crate::dataset::Clip;
use crate::nn::{Activation, Adam, Initialiser};
use crate::reward::{InputScaling, RewardInputs};

/// The ensemble, its queries and its training.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct OprlConfig {
    /// Networks in the ensemble; each gets one random query of its own first.
    pub members: usize,
    /// Rounds after that; each asks one query that all members share.
    pub rounds: u32,
    /// What a segment is: steps, H, or whole episodes where all have the same length.
    pub segment: Clip,
    /// Random pairs of segments among which a round looks for the largest disagreement.
    pub pool: usize,
    /// What the networks see.
    pub inputs: RewardInputs,
    /// How that is scaled.
    pub scaling: InputScaling,
    /// Hidden widths.
    pub hidden: Vec<usize>,
    /// Activation of a network's output.
    pub output: Activation,
    /// How weights are drawn.
    pub initialiser: Initialiser,
    /// Full-batch gradient steps after the first queries and after each round.
    pub epochs: u32,
    /// Adam's step size; the optimiser starts anew in each round, the weights go on.
    pub learning_rate: f64,
    /// The optimiser's constants.
    pub adam: Adam,
    /// Pairs held out to measure the ensemble's agreement with true returns.
    pub held_out: usize,
}

impl Default for OprlConfig {
    fn default() -> Self {
        Self {
            members: 7,
            rounds: 3,
            segment: Clip::Steps(50),
            pool: 1000,
            inputs: RewardInputs::ObservationAction,
            scaling: InputScaling::Standard { floor: 0.05 },
            hidden: vec![64, 64],
            output: Activation::Tanh,
            initialiser: Initialiser::UniformFanIn,
            epochs: 200,
            learning_rate: 3e-4,
            adam: Adam::default(),
            held_out: 1000,
        }
    }
}

impl OprlConfig {
    /// Answers a person has to give: one for each member and one for each round.
    #[must_use]
    pub fn queries(&self) -> usize {
        self.members + self.rounds as usize
    }

    /// The same with so many answers, by more or fewer rounds; each member has its own question in any case.
    #[must_use]
    pub fn asking(&self, answers: usize) -> Self {
        let rounds = answers.saturating_sub(self.members);
        Self {
            rounds: u32::try_from(rounds).unwrap_or(u32::MAX),
            ..self.clone()
        }
    }
}
