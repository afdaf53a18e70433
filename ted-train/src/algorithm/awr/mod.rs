//! Advantage-weighted regression (Peng, Kumar, Zhang, Levine 2019), the policy learner that OPRL was published with, and a discount
//! of its own for every transition.
//!
//! An iteration looks at the whole dataset twice: once for what V should be, once for how much better than that each action was.
//!
//! ```text
//! R_t      = r_t + gamma_t [ (1 - lambda) V(s_t+1) + lambda R_t+1 ],     R after an episode's last step = V of its last observation
//! L_V(w)   = 1/2 E[ (V(s_t) - R_t)^2 / scale^2 ],                        R from the V that the iteration began with
//! A_t      = R_t - V(s_t),                                               both from the V that it arrived at
//! omega_t  = min(exp((A_t - mean A) / (std A + 1e-5) / temperature), 20)
//! L_pi(phi) = -E[ omega_t log N(a_t | pi(s_t), 0.2^2) ]
//! ```
//!
//! `gamma_t` is the transition's own discount and 0 after a terminal: TED (Eq. 5) needs nothing else.
//!
//! | choice | ours | original (danielshin1/oprl `policy_learning/awr/learning/awr_agent.py`) | paper |
//! |---|---|---|---|
//! | iteration | 500 steps of V, then 1,000 of the policy | the same per 2,048 newly simulated steps, or more of both for more | replaces it by IQL |
//! | iterations | 100: `steps` of 150,000 | `max_iter` 2,000 | - |
//! | data | the whole dataset | a buffer of its last 50,000 transitions | - |
//! | simulation while training | none | 2,048 steps an iteration, counted and not learned from | - |
//! | episodes | the dataset's own | cut at terminals and after a fixed number of steps | - |
//! | batches | uniform with replacement | shuffled passes | - |
//! | networks | 128, 64, ReLU; Xavier; the policy's last layer uniform in +-0.01; biases 0 | the same | - |
//! | policy | Gaussian, fixed std 0.2, mean tanh of the network | mean linear, and a loss of weight 10 on a mean outside the range | - |
//! | V | the network's output times 100 | times 1/(1 - gamma), which is 100 | - |
//! | optimiser | SGD, momentum 0.9, 0.01 for V and 5e-5 for the policy | the same | - |
//! | lambda, temperature, weight clip | 0.95, 1, 20 | the same | - |
//! | advantages | normalised over every transition that may be drawn | over the buffer | - |
//! | data actions | clipped to +-(1 - 1e-5), as every learner gets them | as recorded | - |
//! | observations | standardised by dataset statistics | by running ones | - |
//! | rewards | mapped to [0, 1] over the dataset | raw | - |
//! | discount | of each transition, 0 after a terminal | constant; V is 0 after a terminal | Eq. 5 |

mod config;
mod losses;
mod networks;
mod returns;
mod state;
mod sweep;
#[cfg(test)]
mod tests;
mod update;

pub use config::AwrConfig;
use losses::{regression_loss, value_loss};
pub use networks::Awr;
use returns::{advantage_weights, lambda_returns};
use sweep::Sweep;
pub use update::{Losses, UpdateMetrics};
