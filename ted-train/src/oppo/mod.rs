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
//! it is flown from the host.
//!
//! | choice | ours | original (bkkgbkjb/OPPO `oppo/human`) | paper |
//! |---|---|---|---|
//! | queries | 10 random pairs | a file of human answers | as few as the others' |
//! | clips of an update | K steps inside an episode, uniform over (episode, start) | uniform over episodes, any start, padded where the episode ends | not stated |
//! | pairs of an update | all | 64 drawn with replacement from all | not stated |
//! | encoder | the same blocks as the policy's, not causal | BERT's, which normalise after adding | not stated |
//! | widths | 128, 3 blocks, 2 heads, latent 16 | the same (`args.py`) | not stated |
//! | latent at the start | N(0, 1) | the same (`experiment.py`) | not stated |
//! | order of an update | policy and encoder (every second one), encoder, latent | the same (`pdt_trainer.py`) | not stated |
//! | equal answers | pulled together where the first is farther away | the same | y = 0.5 |
//! | noise on observations | N(0, 0.1^2), standardised, where the policy is trained | the same | not stated |
//! | gradients | clipped to length 0.25 in each network | the same | not stated |
//! | optimiser | AdamW 1e-4, decay 1e-4; the policy's rate rises for 10,000 updates; latent 1e-2 | the same | not stated |
//! | updates | 100,000, a config field | 100 x 1,000 | not stated |
//! | first weights | N(0, 1 / inputs), biases 0 | PyTorch's | not stated |

mod config;
mod learn;
mod losses;
mod networks;
mod player;
mod state;
#[cfg(test)]
mod tests;
mod update;

pub use config::OppoConfig;
pub use learn::{Learned, OppoError, learn};
pub use player::Player;
pub use update::{Oppo, UpdateLosses};
