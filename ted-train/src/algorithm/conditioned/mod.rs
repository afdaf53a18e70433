//! Behaviour cloning conditioned on how good an episode is predicted to be, flown at the best.
//!
//! ```text
//! f_c = (1 + c gain) f0(s) + c h(s)
//! L   = mean over batch and action coordinates of (f_c(s) - a)^2  at  c = c_e
//! c_e = (R_e - mean R) / (mean R of the `best` episodes - mean R)
//! pi  = (1 + c haste gain) f0(s) + c h(s)  at  c = aim * advance
//! ```
//!
//! `e` is the episode of a transition and `R_e` its quality, or its predicted return if a reward knows transitions only; the means are over the episodes that the filter keeps. So 0
//! is the average of the logs, which `f0` imitates, and 1 the best of them. The condition enters linearly: all episodes teach the
//! one way from the average to the better ones, and a single wrong return among hundreds turns it little. Good episodes often do
//! what the average does, and do more of it, so that is one number: `gain`, learned at ten times the network's rate. What else they do is
//! `h`, which begins at 0 and decays, so it is there only where the logs insist on it. What flies is a plain network, whose last layer is
//! `(1 + c haste gain) W0 + c W1`: the best of noisy episodes are hasty, and a policy that has no noise arrives with less. `advance` in [0, 1] is what the reward is trusted with: 1 unless somebody says another. Where the
//! returns are equal, every condition is 0 and nothing is learned about `gain` and `h`, so the policy flies at 0: plain cloning. It reads
//! no discounts.
//!
//! The idea is that of "Reward-conditioned policies" (Kumar et al. 2019), offline in "RvS" (Emmons et al. 2022), whose code is the
//! second column; the third has what that paper says beside it.
//!
//! | choice | ours | original (scottemmons/rvs at 6edcd42, reward-conditioned) | Kumar et al. 2019 |
//! |---|---|---|---|
//! | condition | predicted quality or return of the whole episode | mean of the true rewards still to come | return or advantage |
//! | scale | 0 is the mean of the logs, 1 that of their best | the environment's | not compared |
//! | how it enters | linearly, `(1 + c gain) f0 + c h` on one trunk | one more input | not compared |
//! | flown at | `aim`, times what the reward is trusted with, and a share `haste` of the gain | a return that is chosen for each environment | high returns, drawn |
//! | loss | mean square over batch and coordinates | `-log N(a \| f(s, c), sigma^2)`, sigma learned | log-likelihood |
//! | policy's mean | linear; the controller limits it to [-1, 1] | linear, limited by the environment | not compared |
//! | hidden widths | 256, 256 | 1024, 1024, with dropout of 0.1 | not compared |
//! | first weights | uniform in +-1/sqrt(inputs), weights and biases; 0 for `h` and the gain | orthogonal | not compared |
//! | optimiser | AdamW, decay 0.1, half a cosine from 1e-3 to 1e-5 | Adam, 1e-3, constant | not compared |
//! | what flies | an average of the weights; update `t` has a share of max(1e-3, 10/(t + 10)) | the weights | not compared |
//! | data actions | clipped to +-(1 - 1e-5), as every learner gets them | as recorded | not compared |
//! | observations | standardised by the dataset | raw | not compared |
//! | data | the logs | the same | and episodes flown at high conditions |

mod config;
mod losses;
mod networks;
mod state;
#[cfg(test)]
mod tests;
mod update;

pub use config::ConditionedConfig;
pub use networks::Conditioned;
pub use update::{Losses, UpdateMetrics};
