//! Preference Transformer (Kim et al. 2023): a reward that depends on what came before it, from ten preferences.
//!
//! ```text
//! x(2t - 1), x(2t) = norm(W_a a_t + b_a + p_t), norm(W_s s_t + b_s + p_t)       tokens of a clip of H steps, p learned
//! h_t              = the causal transformer's output at the token of s_t
//! per step:         r_t = W_2 relu(W_1 h_t + b_1) + b_2         score = mean over t of r_t
//! weighted sum:     (q_t, k_t, r_t) = W h_t + b                 score = mean over t of sum over u of softmax_u(q_t k_u) r_u
//! P(second preferred) = sigmoid(score(second) - score(first)),  L = -E[ y log P + (1 - y) log(1 - P) ]     (Eq. 2 and 3)
//! reward of a transition = r of the last step of the H steps that end with it, or of as many as there are
//! ```
//!
//! The label of a transition is `r` under both heads; the weights of the second one are there in training only.
//!
//! | choice | ours | original (csmile-1006/PreferenceTransformer) | paper |
//! |---|---|---|---|
//! | head | a config field, weighted sum by default | per step unless a flag is set, which its commands do not do | "a weighted sum of non-Markovian rewards" |
//! | queries | 10 random pairs of the whole dataset | a file of indices, 100 or more | 10 |
//! | clip length H | 100 | 100, and 50 for robosuite | not stated |
//! | width, blocks, heads | 256, 1, 4 | the same (README) | "original" |
//! | dropout | 0.1 on embeddings, attention, both residual paths; one mask for both clips of a pair | the same (`PrefTransformer.py`) | "original" |
//! | tokens | action before state of a step; timesteps count from the clip's start | the same (`trajectory_gpt2.py`) | "original" |
//! | score | mean over the steps | the same (`train_type="mean"`) | sum (Eq. 2) |
//! | attention of the weighted sum | scores are not scaled | the same: divided by the root of the value's width, 1 | |
//! | first weights | N(0, 1 / inputs), biases 0 | the same, cut off at 2 deviations | |
//! | optimiser | AdamW, decay 1e-4, all pairs in every step | the same | "original" |
//! | rate | 1e-4 to 1e-3 in the first tenth, a cosine back to 1e-4 | the same | "original" |
//! | steps | 10,000 | `n_epochs` x (pairs / 256 + 1) = 10,000 | "original" |
//! | which weights | the last | the best on "evaluation" queries, which are training queries | |
//! | equal answers | y = 0.5 | 0.5, or 0 (`label_type`) | y = 0.5 |
//! | inputs | observations standardised with a floor, actions in [-1, 1] | raw, actions clipped to +-0.999 | not stated |
//! | shorter clips at an episode's start | shorter sequences | padding behind a mask | |
//! | reward | mapped to [0, 1] over the dataset | times 1000 / (largest - smallest return), shifted for some tasks | not stated |

mod config;
mod head;
mod labels;
mod learn;
mod learner;
mod network;
#[cfg(test)]
mod tests;
mod training;

pub use config::{PtConfig, RewardHead};
pub use labels::transformer_labels;
pub use learn::{LOOK_EVERY, Trained, held_out_agreement, train};
pub use network::RewardTransformer;
