//! Any link to a device, for whoever need not know which.

use std::fmt::Debug;
use std::io::{Read, Write};

/// Bytes to a device and back. `read` comes back after a while when nothing comes, as [`super`] says.
pub trait Stream: Read + Write + Debug {}

impl<T: Read + Write + Debug> Stream for T {}
