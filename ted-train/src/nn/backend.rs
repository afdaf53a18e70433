//! What training runs on, and whether this build and this machine have it.

use burn::tensor::Device;

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
    /// burn's CUDA backend, tensor operations throughout: an NVIDIA GPU.
    Cuda,
}

/// Why a backend cannot be used.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum BackendError {
    /// The cargo feature is off.
    #[error(
        "this `ted` was built without CUDA: `cargo install --path ted-train --features cuda` builds one with it, and \
         `--device cpu` trains without"
    )]
    NotBuilt,
    /// There is no driver, or it knows no GPU.
    #[error("no CUDA device was found: see what `nvidia-smi` says, or train with `--device cpu`")]
    NoDevice,
}

impl Backend {
    /// Whether this build and this machine have it. Asked before anything is begun.
    ///
    /// # Errors
    /// When they have not.
    pub fn usable(self) -> Result<(), BackendError> {
        match self {
            Self::Fused | Self::Flex | Self::Ndarray => Ok(()),
            Self::Cuda => cuda_device(),
        }
    }

    /// Whether one kernel for many lanes takes hardly longer than for one, and a kernel for one leaves most of it idle.
    #[must_use]
    pub fn is_gpu(self) -> bool {
        self == Self::Cuda
    }

    pub(crate) fn device(self) -> Device {
        match self {
            Self::Fused | Self::Flex => Device::flex(),
            #[expect(
                deprecated,
                reason = "upstream favours flex; a second opinion has to come from elsewhere"
            )]
            Self::Ndarray => Device::ndarray(),
            #[cfg(feature = "cuda")]
            Self::Cuda => Device::cuda(burn::tensor::DeviceIndex::Default),
            // No run gets here, see `usable`. Tests do: what a GPU would be given to compute, computed by the processor.
            #[cfg(not(feature = "cuda"))]
            Self::Cuda => Device::flex(),
        }
    }

    /// Runs `body` where [`Self::join`] works best. On a processor that is a worker of the pool it is called from, or else of
    /// the global one: from elsewhere every parallel part would hand over to the workers and back.
    pub(crate) fn run<T: Send>(self, body: impl FnOnce() -> T + Send) -> T {
        if self.is_gpu() {
            body()
        } else {
            rayon::scope(|_| body())
        }
    }

    /// Computes both, on a processor side by side. A GPU has a queue for each thread and would wait for one in the other.
    pub(crate) fn join<A: Send, B: Send>(
        self,
        a: impl FnOnce() -> A + Send,
        b: impl FnOnce() -> B + Send,
    ) -> (A, B) {
        if self.is_gpu() {
            (a(), b())
        } else {
            rayon::join(a, b)
        }
    }
}

#[cfg(feature = "cuda")]
fn cuda_device() -> Result<(), BackendError> {
    let devices = Device::enumerate(burn::tensor::DeviceType::Cuda);
    match devices.into_iter().next() {
        Some(_) => Ok(()),
        None => Err(BackendError::NoDevice),
    }
}

#[cfg(not(feature = "cuda"))]
fn cuda_device() -> Result<(), BackendError> {
    Err(BackendError::NotBuilt)
}
