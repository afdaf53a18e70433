//! How far two computations that should agree may be apart: one table for the whole project.
//!
//! Exact things come first. Everything that runs on `ted-core` agrees to the bit, on every machine, because the order of its
//! sums is part of its contract. burn is free to sum in any order and to fuse multiply and add, so against burn there is a
//! tolerance, and it is absolute: an action is a number in [-1, 1] that is sent to a motor, and where the network's last sum
//! cancels to nearly zero, a difference of no consequence is thousands of units in the last place.

use serde::Serialize;

/// What is allowed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Allowed {
    /// The same bits.
    Exact,
    /// At most this far apart.
    Absolute(f64),
}

/// One line of the table.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Tolerance {
    /// What is compared.
    pub what: &'static str,
    /// How far apart it may be.
    pub allowed: Allowed,
}

/// The golden vectors of an artefact, computed again.
pub const GOLDEN: Tolerance = exact("golden vectors, this machine - the artefact");
/// The same in integers.
pub const INTEGER_GOLDEN: Tolerance = exact("golden vectors in integers");
/// The numbers in an artefact and those in the state that it was made from.
pub const WEIGHTS: Tolerance = exact("weights, artefact - checkpoint");
/// The artefact made again from a run's state, byte by byte.
pub const EXPORT: Tolerance = exact("bytes, exported again - the artefact");
/// Rewards that the artefact's ensemble computes and those that the learner was given.
pub const LABELS: Tolerance = exact("rewards, artefact - labels of training");
/// Which episodes keep the full discount factor, by the artefact's threshold and by ranking them.
pub const CLASSES: Tolerance = exact("TED classes, artefact - ranking");
/// Which recorded episodes a controller says lie in the top k %, scoring them step by step, and the trainer's answer.
pub const SCORED_F32: Tolerance = exact("TED classes, controller on the logs - trainer");
/// The same in integers, which have a border of their own.
pub const SCORED_INTEGER: Tolerance = exact("the same, in integers");
/// Returns of the episodes of an evaluation, flown again.
pub const RETURNS: Tolerance = exact("returns, flown again - evaluation");
/// Actions of an exported C header in the robot's units, without a `tanh`: its sums are in the order of `ted-core`.
pub const EXPORTED_SUMS: Tolerance = exact("actions without tanh, exported C header - ted-core");
/// Actions of the engine that training runs on.
pub const ACTIONS_FUSED: Tolerance = absolute("actions, fused - ted-core", 1e-5);
/// Actions of burn's default CPU backend.
pub const ACTIONS_FLEX: Tolerance = absolute("actions, burn flex - ted-core", 1e-5);
/// Actions of burn's second CPU backend.
pub const ACTIONS_NDARRAY: Tolerance = absolute("actions, burn ndarray - ted-core", 1e-5);
/// Actions of burn's two CPU backends; each may be that far from `ted-core`.
pub const ACTIONS_BURN: Tolerance = absolute("actions, burn flex - burn ndarray", 2e-5);
/// Outputs of a layer of 64 by 64 weights, all numbers in [-1, 1], on any engine against double precision.
pub const LAYER: Tolerance = absolute("one layer, any engine - double precision", 1e-5);
/// Outputs, gradients in parameters and inputs, and updated parameters of networks on the fast engine: length of the difference to length.
pub const NETWORK_FUSED: Tolerance = absolute("networks, fused - burn flex", 1e-6);
/// Actions of an exported C header in the robot's units, by the largest number of the channel's range: `tanhf` is the C library's, a
/// few units in the last place from ours.
pub const EXPORTED_C: Tolerance = absolute("actions, exported C header - ted-core", 5e-7);
/// The same of ONNX and safetensors files, whose readers sum in any order.
pub const EXPORTED: Tolerance = absolute("actions, exported tensors - ted-core", 1e-5);

/// The whole table.
pub const TABLE: [Tolerance; 18] = [
    GOLDEN,
    INTEGER_GOLDEN,
    WEIGHTS,
    EXPORT,
    LABELS,
    CLASSES,
    SCORED_F32,
    SCORED_INTEGER,
    RETURNS,
    EXPORTED_SUMS,
    ACTIONS_FUSED,
    ACTIONS_FLEX,
    ACTIONS_NDARRAY,
    ACTIONS_BURN,
    LAYER,
    NETWORK_FUSED,
    EXPORTED_C,
    EXPORTED,
];

impl Allowed {
    /// Whether a largest difference of `absolute`, and `unequal` pairs of different bits, are within it.
    #[must_use]
    pub fn holds(self, absolute: f64, unequal: u64) -> bool {
        match self {
            Self::Exact => unequal == 0,
            Self::Absolute(limit) => absolute <= limit,
        }
    }
}

impl std::fmt::Display for Allowed {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Exact => f.write_str("same bits"),
            Self::Absolute(limit) => write!(f, "{limit:e}"),
        }
    }
}

const fn exact(what: &'static str) -> Tolerance {
    Tolerance {
        what,
        allowed: Allowed::Exact,
    }
}

const fn absolute(what: &'static str, limit: f64) -> Tolerance {
    Tolerance {
        what,
        allowed: Allowed::Absolute(limit),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_things_come_first_in_the_table() {
        let exact = TABLE.map(|tolerance| tolerance.allowed == Allowed::Exact);
        assert!(exact.is_sorted_by(|before, after| before >= after));
    }

    #[test]
    fn exact_allows_no_other_bits_and_absolute_allows_its_limit() {
        assert!(Allowed::Exact.holds(0.0, 0) && !Allowed::Exact.holds(0.0, 1));
        assert!(Allowed::Absolute(1e-5).holds(1e-5, 9));
        assert!(!Allowed::Absolute(1e-5).holds(1.1e-5, 9));
        assert!(!Allowed::Absolute(1e-5).holds(f64::NAN, 1));
    }
}
