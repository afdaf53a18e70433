//! Inner loops for a Cortex-M4, M7 or M33 with the DSP extension, under the feature `cortex-m`.
//!
//! On other machines, tests run the integer kernel that was made for them over an emulation of its loop.

#[cfg(all(target_arch = "arm", feature = "cortex-m"))]
mod assembly;
#[cfg(not(all(target_arch = "arm", feature = "cortex-m")))]
mod emulated;

#[cfg(all(target_arch = "arm", target_abi = "eabihf", feature = "cortex-m"))]
pub(crate) use assembly::add_dot_f32;
#[cfg(all(target_arch = "arm", feature = "cortex-m"))]
pub(crate) use assembly::add_dot_i8;
#[cfg(not(all(target_arch = "arm", feature = "cortex-m")))]
pub(crate) use emulated::add_dot_i8;

use crate::limits::MAX_WIDTH;

/// Weights in a word.
pub(crate) const COLUMNS: usize = 4;

/// Rows computed together.
pub(crate) const ROWS: usize = 4;

/// The 16-bit activations of four columns in the order of the weights that `sxtb16` takes out of a word: `(x0, x2)` and
/// `(x1, x3)`, the first of each in the lower half.
pub(crate) type Pairs = [u32; 2];

/// As many pairs as the widest layer has.
///
/// Where the last columns fill no word, they are at the end of one that overlaps with the word before it; what would count
/// twice is zero.
pub(crate) type AllPairs = [Pairs; MAX_WIDTH / COLUMNS];
