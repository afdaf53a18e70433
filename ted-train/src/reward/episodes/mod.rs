//! A Bayesian model of whole episodes: what the logs say by themselves, moved by as many answers as there are.
//!
//! ```text
//! f              = clone of all logs,  min E |f(s) - a|^2
//! x_e1           = competence    sum over t of a_t . f(s_t)  /  sum over t of |f(s_t)|
//! x_e2 .. x_eK   = whereabouts   principal directions of (mean over t of s_t), less what s_0 says of it
//! u_e            = w . x_e,      w ~ N((2 rho_1, 0, ..), diag(rho_1, rho_2 / 2, ..)^2),   rho: reliability of each descriptor
//! P(second better) = lapse / 2 + (1 - lapse) sigmoid(slope (u_second - u_first))
//! question       = argmax over pairs with a possibly best episode of  H(E_w P) - E_w H(P)
//! reward(s, a)   = a network fitted to each transition's share of u_e, so that their mean over an episode is about u_e
//! ```
//!
//! | choice | ours | where it comes from |
//! |---|---|---|
//! | descriptors | competence beside the clone of all, and the mean state less the first one's part | ours; expertise beside a shared policy: Beliaev et al. 2022 (ILEED), which learns both together |
//! | reliability | correlation of two halves of an episode, lengthened by Spearman and Brown | psychometrics |
//! | what is compared | whole episodes | 50 steps in OPRL |
//! | model | linear in the descriptors, normal prior, answers with a slope and a lapse | Bradley-Terry; Biyik and Sadigh 2018 have the same without lapse |
//! | posterior | 200 samples by elliptical slice sampling | Murray, Adams and MacKay 2010 |
//! | questions | most information about the weights, one of the two a candidate for the best | Houlsby et al. 2011 (BALD); the restriction is ours |
//! | equal answers | y = 0.5 | as everywhere in this project |
//! | reward | one small network, fitted to shares | ours: a controller computes it |

mod belief;
mod confidence;
mod config;
mod descriptors;
mod fitting;
mod interrogation;
mod learn;
mod learner;
mod posterior;
mod questions;
#[cfg(test)]
mod tests;
mod words;

pub use confidence::Confidence;
pub use config::{EpisodesConfig, Fitting};
pub use descriptors::Descriptors;
pub use learn::Look;

use serde::{Deserialize, Serialize};

use super::ExportedEnsemble;

/// What is left when the answers are in.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct EpisodeModel {
    /// Gives each transition its share of its episode's quality.
    pub network: ExportedEnsemble,
    /// How sure it is that the best episodes are better than the average.
    pub confidence: Confidence,
    /// The quality of every episode by the mean weights.
    pub quality: Vec<f32>,
}
