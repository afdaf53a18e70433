//! Multi-layer perceptrons with a leading member axis, their gradients and their optimiser, over burn tensors.
//!
//! One call evaluates or trains every member: `x [member, batch, in]`, `weight [member, in, out]`. Twin critics, reward
//! ensembles and several seeds are all members. Gradients are written out instead of taken by automatic differentiation:
//! for a perceptron they are four lines a layer, every loss is tested against finite differences, and a step needs no
//! bookkeeping. Nothing here knows which burn device it runs on.

mod adam;
mod export;
#[cfg(test)]
pub(crate) mod fixtures;
mod host;
mod init;
mod mlp;
#[cfg(test)]
pub(crate) mod scalar;
#[cfg(test)]
mod tests;

pub use adam::{Adam, AdamState, Moments};
pub use export::{ExportedLayer, ExportedMlp};
pub use init::{Initialiser, orthogonal};
pub use mlp::{Activation, Linear, Mlp, MlpShape, Tape};

/// The burn device that training runs on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Backend {
    /// burn's portable CPU backend, the default.
    #[default]
    Flex,
    /// burn's older CPU backend on the `ndarray` crate: the independent second opinion of the cross-check.
    Ndarray,
}

impl Backend {
    pub(crate) fn device(self) -> burn::tensor::Device {
        match self {
            Self::Flex => burn::tensor::Device::flex(),
            #[expect(
                deprecated,
                reason = "upstream favours flex; a second opinion has to come from elsewhere"
            )]
            Self::Ndarray => burn::tensor::Device::ndarray(),
        }
    }
}
