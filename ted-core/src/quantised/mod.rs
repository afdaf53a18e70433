//! Where floats meet integers: networks in integers that read raw observations and write actions like the others.
//!
//! A value is standardised in `f32` exactly as for the trained networks, and then becomes
//! `floor(norm * 2^fraction_bits + 1/2)`, saturated to plus and minus 32767. The halves are decided exactly, without the
//! rounding of an addition. Everything after that is [`crate::integer`]; an action comes back as `fixed / 2^fraction_bits`,
//! which `f32` holds exactly.

mod policy;
mod quantiser;
mod reward;

pub use policy::QuantisedPolicy;
pub use quantiser::{fixed, resolution};
pub use reward::QuantisedRewardEnsemble;
