//! Where the rewards of a run come from, and what they are worth.
//!
//! Every source ends in the same thing, [`Labels`]: one reward in [0, 1] for each transition. Bradley-Terry does not fix
//! a reward's offset, and lowering a discount lowers a value only where values are positive, so rewards of every source
//! are mapped to [0, 1] over the dataset before TED sees them.
//!
//! A source is [`Computed`] from the dataset, or it is learned from answers: [`RewardLearner`] is what a run does with it then,
//! and [`RewardModel`] what it leaves.

mod computed;
mod config;
pub mod episodes;
mod error;
mod exported;
mod fit;
mod inputs;
mod labels;
mod learner;
mod loss;
mod model;
pub mod oprl;
pub mod quality;
mod random_queries;
mod scaling;
mod standing;
#[cfg(test)]
mod tests;
pub mod transformer;
pub mod transport;

pub use computed::Computed;
pub use config::{RewardConfig, Source};
pub use error::LearnError;
pub use exported::ExportedEnsemble;
pub use fit::{Fit, HeldOut};
pub use inputs::{InputMap, RewardInputs};
pub use labels::{Labels, ensemble_labels};
pub use learner::{Learned, Material, Questions, RewardLearner, Save, Saved};
pub use model::RewardModel;
pub use random_queries::RandomQueries;
pub use scaling::InputScaling;
pub use standing::{Ranked, Standing};
