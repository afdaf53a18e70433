//! OPPO (Kang et al. 2023): a policy for sequences with a latent that says which behaviour it continues, and the latent that
//! people prefer, learned together and without a reward.
//!
//! ```text
//! z(clip)       = W sum over tokens of encoder(s_1, a_1, ..., s_K, a_K) + b                the hindsight encoder, sees all tokens
//! (a^, s^)(z)   = policy(z, s_1, a_1, z, s_2, a_2, ...)                                    causal; s with noise
//! L_rec         = mean (a^ - a)^2 + mean (s^ - s)^2                                        over both networks, every second update
//! d(x, y)       = |x - y + 1e-6|
//! L_pref        = mean over pairs of max(d(z*, z better) - d(z*, z worse) + 1, 0)          for equal answers without the 1
//! L_norm        = mean max(|z| - 1, 0), first clips and second clips added
//! L_encoder     = L_rec(both clips) + 10 L_pref + 0.1 L_norm                               the policy and z* held still
//! L_latent      = L_pref                                                                   in z*, with the encoder just moved
//! ```
//!
//! The policy acts with `z = z*` on the last K steps of what it has seen and done ([`Player`]). No controller has room for it:
//! it is flown from the host ([`SequencePilot`]).
//!
//! Choices and deviations: `docs/learners.md`.

mod config;
mod lanes;
mod losses;
mod networks;
mod pilot;
mod player;
mod state;
#[cfg(test)]
mod tests;
mod update;

pub use config::OppoConfig;
pub use pilot::SequencePilot;
pub use player::Player;
pub use update::{Oppo, UpdateLosses};
