//! Adversarially trained actor critic (Cheng, Xie, Jiang, Agarwal 2022) with a discount of its own for every transition.
//!
//! The critic judges the policy against the data: among the critics that explain the rewards, it is the one least in favour of
//! what the policy would rather do (relative pessimism). The policy climbs that critic, a thousand times more slowly.
//!
//! ```text
//! E_i(theta) = 1/2 E[ (Q_i(s, a) - y)^2 ] + 1/2 E[ (Q_i(s, a) - r - gamma(s, a) (1 - terminal) Q_i(s', a'))^2 ]
//!              y = r + gamma(s, a) (1 - terminal) min_j Qtarget_j(s', a'),    a' ~ pi(s')             (DQRA)
//! L_Q(theta) = sum_i [ 1/beta E[ Q_i(s, pi(s)) - Q_i(s, a) ] + E_i(theta) ]    (beta at most 1: E[..] + beta E_i)
//! theta      <- theta with every weight matrix shrunk to Frobenius norm 100 at most
//! L(alpha)   = log alpha (H - H_target),    H = -E[ log pi(u|s) ],    H_target = -|A|
//! L_pi(phi)  = 1/max(alpha, 1) (-E[ Q_2(s, pi(s)) ]) + min(alpha, 1) (-H)
//! warm start:  E_i for the critics, -E[ log pi(a|s) ] in the place of -E[ Q_2(s, pi(s)) ] for the policy
//! ```
//!
//! The policy is a Gaussian squashed by tanh; one network gives mean and log standard deviation. TED (Eq. 5) changes
//! `gamma(s, a)`, which stands in three places: in the target y, in the residual, and in both of these during the warm start.
//!
//! | choice | ours | original (microsoft/lightATAC) | paper |
//! |---|---|---|---|
//! | which implementation | lightATAC's rules | there is another one, microsoft/ATAC, with beta 16 | "original" settings |
//! | beta | 4 | 3 (`main.py`) | 4 |
//! | order in an update | critics, projection, targets, alpha, policy | the same (`atac.py`) | not stated |
//! | two-critic loss | sum; the residual's gradient goes through `Q_i(s', a')` too | the same | not stated |
//! | critic that the policy climbs | the second alone, after this update's step | the same | not stated |
//! | two time scales | 5e-4 for critics, alpha and warm start, 5e-7 for the policy | the same (`main.py`) | not stated |
//! | warm start | 100,000 updates; then new optimisers and alpha, the same targets | the same (`bp.py`) | not stated |
//! | targets during the warm start | averaged before an update, not after it | the same | not stated |
//! | weight of the warm start's critic loss | 1/2: an expectile loss at 1/2 | the same; for Adam it makes no difference | not stated |
//! | likelihood and entropy | mean over batch and action coordinates, against `-|A|` | the same: its `Normal` is never summed over coordinates | not stated |
//! | standard deviation | of each observation, 1 at first, in [1e-5, 10] | the same (`policy.py`) | not stated |
//! | first weights | uniform in +-1/sqrt(inputs), weights and biases | the same, PyTorch's default | not stated |
//! | data actions | clipped to +-(1 - 1e-5) | to +-(1 - 1e-6) | not stated |
//! | last transition of a timed-out episode | kept, with its next observation; bootstraps | dropped | not stated |
//! | limits on the target's values | none | `--clip_v`, off | not stated |
//! | observations | standardised by dataset statistics | raw | not stated |
//! | rewards | mapped to [0, 1] over the dataset | raw | not stated |
//! | discount | of each transition, 0 after a terminal | constant times a mask | Eq. 5 |
//! | action at evaluation | tanh of the mean | the same | not stated |

mod config;
mod gaussian;
mod losses;
mod networks;
mod state;
#[cfg(test)]
mod tests;
mod update;

pub use config::AtacConfig;
use gaussian::Gaussian;
use losses::{Shares, bellman_loss};
pub use networks::Atac;
pub use update::{Losses, UpdateMetrics};
