//! Multi-layer perceptrons with a leading member axis, their gradients and their optimiser, over burn tensors.
//!
//! One call evaluates or trains every member: `x [member, batch, in]`, `weight [member, in, out]`. Twin critics, reward
//! ensembles and several seeds are all members. Gradients are written out instead of taken by automatic differentiation:
//! for a perceptron they are four lines a layer, every loss is tested against finite differences, and a step needs no
//! bookkeeping.
//!
//! Two engines compute a perceptron: `plain` by tensor operations, on every burn device, and `fused` by passes of its own
//! over buffers, on processors. Which one it is, is seen by nobody above [`Mlp`] and [`Adam`].

mod adam;
mod export;
#[cfg(test)]
pub(crate) mod fixtures;
mod fused;
mod host;
mod init;
mod mlp;
mod parameters;
mod plain;
#[cfg(test)]
pub(crate) mod scalar;
#[cfg(test)]
mod tests;

pub use adam::{Adam, AdamState, Moments};
pub use export::{ExportedLayer, ExportedMlp};
pub use init::{Initialiser, orthogonal};
pub use mlp::{Activation, Linear, Mlp, MlpShape};

/// What training runs on: a burn device, and the engine of its networks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Backend {
    /// Networks by passes of our own over buffers, everything else on burn's portable CPU backend: the default.
    #[default]
    Fused,
    /// burn's portable CPU backend: the plain reference.
    Flex,
    /// burn's older CPU backend on the `ndarray` crate: the independent second opinion of the cross-check.
    Ndarray,
}

impl Backend {
    pub(crate) fn device(self) -> burn::tensor::Device {
        match self {
            Self::Fused | Self::Flex => burn::tensor::Device::flex(),
            #[expect(
                deprecated,
                reason = "upstream favours flex; a second opinion has to come from elsewhere"
            )]
            Self::Ndarray => burn::tensor::Device::ndarray(),
        }
    }
}
