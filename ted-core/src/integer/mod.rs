//! Integer inference: 8-bit weights, 16-bit activations, 32-bit accumulators.
//!
//! The types say what an integer network is and prove that it cannot overflow; the artefact has their place. Nothing in
//! here does float arithmetic.
//!
//! ```text
//! acc[o] = bias[o] + sum_i w[o][i] * x[i]                               exact in 32 bits
//! y[o]   = saturate(floor(acc[o] * multiplier[o] * 2^(shift[o] - 31) + 1/2))
//! hidden layers: max(y, 0); the last one: y, or tanh with 15 fraction bits from a table
//! reward = clamp(sum of members, low, high) - low                       a whole number, 0 to high - low
//! ```

#![deny(clippy::float_arithmetic)]

mod dense;
mod error;
mod kernel;
mod mlp;
mod policy;
mod requantise;
mod reward;
mod scratch;
mod tanh;

pub use dense::{IntegerDense, MAX_ACTIVATION, MAX_WEIGHT, bias_limit};
pub use error::IntegerError;
pub use mlp::{IntegerMlp, MAX_FRACTION_BITS, Q15};
pub use policy::IntegerPolicy;
pub use reward::{IntegerRange, IntegerRewardEnsemble};
pub use scratch::IntegerScratch;
pub use tanh::tanh_q15;
