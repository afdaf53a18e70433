//! The working memory of networks, apart from them: it is the largest thing a controller needs, and a controller and a
//! scorer can take turns with one.

use ted_core::Scratch;
use ted_core::integer::IntegerScratch;

use crate::controller::Numeric;

/// Working memory for networks in one kind of numbers.
// The larger variant cannot be boxed: a device has no heap.
#[allow(clippy::large_enum_variant)]
#[derive(Clone, Debug)]
pub enum Workspace {
    /// For floats.
    F32(Scratch),
    /// For integers.
    Integer(IntegerScratch),
}

impl Workspace {
    /// Memory for these numbers.
    #[must_use]
    pub fn new(numeric: Numeric) -> Self {
        match numeric {
            Numeric::F32 => Self::F32(Scratch::new()),
            Numeric::Integer => Self::Integer(IntegerScratch::new()),
        }
    }
}
