//! OPRL (Shin, Dragan, Brown 2022): a reward ensemble from ten preferences.
//!
//! ```text
//! P(second preferred) = exp(sum r(second)) / (exp(sum r(first)) + exp(sum r(second)))          (Eq. 2)
//! L(psi)              = -E[ (1 - y) log P(first preferred) + y log P(second preferred) ]       (Eq. 3)
//! query               = argmax over a random pool of p (1 - p), p = share of members preferring the second
//! ```
//!
//! | choice | ours | original (danielshin1/oprl) | paper |
//! |---|---|---|---|
//! | members | 7 | 7 | 7 |
//! | first queries | one random pair for each member | `initial_pairs` for each member, from the head of the data | 1 random |
//! | later queries | 3 rounds of 1, shared | `num_rounds` of `num_queries`, shared | 3 rounds of 1 |
//! | pool | 1,000 random pairs of the whole dataset | random pairs of its first tenth | "a large number" |
//! | ties in p (1 - p) | a seeded draw among the largest | order of an unstable sort | not stated |
//! | segments | any 50 steps inside an episode | chunks of 50, across episode ends | length not stated |
//! | equal returns | y = 0.5 | arbitrary order | y = 0.5 |
//! | network, epochs, rate, inputs | config fields chosen by the study in docs/rewards.md | 512-256-128-64-32, 5 epochs, 5e-5, state | not stated |
//! | reward | mean of the members, mapped to [0, 1] | mean of the members | not stated |

mod config;
mod disagreement;
mod ensemble;
mod learn;
mod learner;
#[cfg(test)]
mod tests;

pub use config::OprlConfig;
pub use disagreement::MostDisputed;
pub use ensemble::Ensemble;
pub use learn::{Trained, ask, held_out_agreement, train};
