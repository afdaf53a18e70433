//! Where the rewards of a run come from, and what they are worth.
//!
//! Every source ends in the same thing, [`Labels`]: one reward in [0, 1] for each transition. Bradley-Terry does not fix
//! a reward's offset, and lowering a discount lowers a value only where values are positive, so rewards of every source
//! are mapped to [0, 1] over the dataset before TED sees them.

mod config;
mod error;
mod fit;
mod labels;
mod loss;
pub mod oprl;
pub mod quality;
mod random_queries;
mod scaling;
#[cfg(test)]
mod tests;
pub mod transformer;
pub mod transport;

pub use config::RewardConfig;
pub use error::LearnError;
pub use fit::{Fit, HeldOut};
pub use labels::{
    Labels, dataset_labels, ensemble_labels, negative_labels, random_labels, zero_labels,
};
pub(crate) use random_queries::ask_random_pairs;
pub use scaling::InputScaling;
