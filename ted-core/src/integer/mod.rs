//! Types of integer inference: 8-bit weights, 16-bit activations, 32-bit accumulators.
//!
//! The types say what an integer network is and prove that it cannot overflow; the artefact has their place. Nothing in
//! here does float arithmetic.

mod dense;
mod error;
mod policy;

pub use dense::{IntegerDense, MAX_ACTIVATION, MAX_WEIGHT, bias_limit};
pub use error::IntegerError;
pub use policy::{IntegerMlp, IntegerPolicy, MAX_FRACTION_BITS};
