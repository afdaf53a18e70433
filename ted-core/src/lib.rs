//! On-device inference for preference-trained policies.
#![doc = include_str!("../README.md")]
#![no_std]
#![deny(unsafe_code)]

#[cfg(test)]
extern crate std;

pub mod activation;
pub mod integer;
pub mod quantised;
pub mod reference;

#[cfg(any(test, all(target_arch = "arm", feature = "cortex-m")))]
mod cortex_m;
mod dense;
mod error;
mod kernel;
mod limits;
mod mlp;
mod normaliser;
mod policy;
mod reward;
mod scratch;
mod ted;
#[cfg(target_arch = "x86_64")]
mod x86;

pub use dense::Dense;
pub use error::{Part, ShapeError};
pub use limits::{MAX_ACTION, MAX_LAYERS, MAX_MEMBERS, MAX_OBSERVATION, MAX_WIDTH};
pub use mlp::{Mlp, Output};
pub use normaliser::Normaliser;
pub use policy::Policy;
pub use reward::{RewardEnsemble, RewardInput, RewardRange};
pub use scratch::Scratch;
pub use ted::{
    DiscountClass, DiscountError, EpisodeReturn, NEW_EPISODE, ReturnThreshold, TedDiscount,
};
