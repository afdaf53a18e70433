//! Behaviour cloning: the policy that recorded the data, as far as a network can repeat it.
//!
//! ```text
//! L(phi) = mean over batch and action coordinates of (pi(s) - a)^2
//! ```
//!
//! Which episodes it sees is not its business: given the truly best tenth it is the baseline "Top 10 % BC", given all of them it
//! imitates the whole dataset. It reads neither rewards nor discounts.
//!
//! | choice | ours | original (tinkoff-ai/CORL `algorithms/offline/any_percent_bc.py`) | paper |
//! |---|---|---|---|
//! | policy | deterministic, tanh of a perceptron | the same | not stated |
//! | loss | mean square over batch and coordinates | the same | not stated |
//! | hidden widths | 256, 256 | the same | not stated |
//! | first weights | uniform in +-1/sqrt(inputs), weights and biases | the same, PyTorch's default | not stated |
//! | optimiser | Adam, 3e-4, constant | the same | not stated |
//! | data actions | clipped to +-(1 - 1e-5), as every learner gets them | as recorded | not stated |
//! | observations | standardised by dataset statistics | the same | not stated |
//! | updates | 100,000, a config field | 1,000,000 | not stated |

mod config;
mod losses;
mod networks;
mod state;
#[cfg(test)]
mod tests;
mod update;

pub use config::BcConfig;
use losses::imitation_loss;
pub use networks::Bc;
pub use update::{Losses, UpdateMetrics};
