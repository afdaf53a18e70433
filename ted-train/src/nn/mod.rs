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
mod adamw;
mod backend;
mod device;
mod export;
#[cfg(test)]
pub(crate) mod fixtures;
mod fused;
mod host;
mod init;
pub(crate) mod lanes;
mod mlp;
mod momentum;
mod parameters;
mod passes;
mod plain;
#[cfg(test)]
pub(crate) mod scalar;
mod schedule;
#[cfg(test)]
mod tests;
pub(crate) mod transformer;

pub use adam::{Adam, AdamState, Moments};
pub use adamw::AdamW;
pub(crate) use adamw::AdamWState;
pub use backend::{Backend, BackendError};
pub use export::{ExportedLayer, ExportedMlp};
pub(crate) use host::mask_inactive;
pub use init::{Initialiser, orthogonal};
pub use mlp::{Activation, Linear, Mlp, MlpShape};
pub use momentum::Velocity;
pub use schedule::{WarmupCosine, average_share};
