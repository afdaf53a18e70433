//! Implicit Q-learning (Kostrikov, Nair, Levine 2021) with a discount of its own for every transition.
//!
//! ```text
//! L_V(w)     = E[ |tau - 1(u < 0)| u^2 ],                u = min_i Qtarget_i(s, a) - V(s)
//! L_pi(phi)  = -E[ min(exp(beta (min_i Qtarget_i(s, a) - V(s))), 100) log pi(a|s) ]
//! L_Q(theta) = E[ sum_i (Q_i(s, a) - y)^2 ],             y = r + gamma(s, a) (1 - terminal) V(s')
//! ```
//!
//! TED (Eq. 7) changes one thing: `gamma(s, a)` comes from [`crate::ted`] instead of being a constant.
//!
//! | choice | ours | original (ikostrikov/implicit_q_learning) |
//! |---|---|---|
//! | order in a step | V, pi, Q, target | the same (`learner.py`) |
//! | V in the advantage and in the target | after this step's V update | the same |
//! | two-critic loss | sum of the two means | the same (`critic.py`) |
//! | initial weights | orthogonal, gain sqrt 2, every layer | the same (`common.py`) |
//! | log-std | state-independent, clipped to [-5, 2] | the same (`policy.py`) |
//! | learning rates | 3e-4; cosine to 0 on the actor | the same (`learner.py`) |
//! | observations | standardised by dataset statistics | raw |
//! | rewards | mapped to [0, 1] over the dataset | raw outside D4RL |
//! | steps | 100,000, a config field | 1,000,000 |
//! | action at evaluation | the mean | a draw with temperature 0, the same value |

mod config;
mod losses;
mod networks;
mod state;
#[cfg(test)]
mod tests;
mod update;

pub use config::IqlConfig;
use losses::{critic_loss, expectile_loss, policy_loss};
pub use networks::{ACTOR_OUTPUT, Iql};
pub use update::{Losses, UpdateMetrics};
