//! The formats in which other programs read a policy.

use ted_policy::Artifact;

use super::floats::Floats;
use super::{c_header, onnx, safetensors};

/// A file that holds the policy in floats, its normaliser, the map to the robot's units, and the contract. Raw observations
/// go in, and actions in the units of the contract, inside its ranges, come out. `docs/export.md` says how to run it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Portable {
    /// An ONNX model.
    Onnx,
    /// Tensors in a safetensors file.
    Safetensors,
    /// A header for C and C++.
    CHeader,
}

impl Portable {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Onnx, Self::Safetensors, Self::CHeader];

    /// How a file's name ends.
    #[must_use]
    pub fn extension(self) -> &'static str {
        match self {
            Self::Onnx => "onnx",
            Self::Safetensors => "safetensors",
            Self::CHeader => "h",
        }
    }

    /// The bytes of the file: the same for the same artefact.
    #[must_use]
    pub fn bytes(self, artifact: &Artifact<'_>) -> Vec<u8> {
        let floats = Floats::of(artifact);
        match self {
            Self::Onnx => onnx::bytes(&floats),
            Self::Safetensors => safetensors::bytes(&floats),
            Self::CHeader => c_header::text(artifact, &floats).into_bytes(),
        }
    }
}
