//! Standardises an observation: `norm = (raw - shift) * scale`.

use crate::error::{Part, ShapeError};
use crate::limits::MAX_WIDTH;

/// One shift and one scale per channel. The scale is the reciprocal of the spread, so a device multiplies.
#[derive(Clone, Copy, Debug)]
pub struct Normaliser<'a> {
    shift: &'a [f32],
    scale: &'a [f32],
}

impl<'a> Normaliser<'a> {
    /// Checks the sizes and borrows the statistics.
    ///
    /// # Errors
    /// When there is no channel, more than [`MAX_WIDTH`], or not one scale for every shift.
    pub fn new(shift: &'a [f32], scale: &'a [f32]) -> Result<Self, ShapeError> {
        ShapeError::within(Part::Shift, MAX_WIDTH, shift.len())?;
        ShapeError::same(Part::Scale, shift.len(), scale.len())?;
        Ok(Self { shift, scale })
    }

    /// Number of channels.
    #[must_use]
    pub fn channels(&self) -> usize {
        self.shift.len()
    }

    /// What is subtracted, per channel.
    #[must_use]
    pub fn shift(&self) -> &'a [f32] {
        self.shift
    }

    /// What the difference is multiplied with, per channel.
    #[must_use]
    pub fn scale(&self) -> &'a [f32] {
        self.scale
    }

    /// Standardises `values` in place.
    ///
    /// # Errors
    /// When there is not one value per channel.
    pub fn apply(&self, values: &mut [f32]) -> Result<(), ShapeError> {
        ShapeError::same(Part::Input, self.channels(), values.len())?;
        for ((value, shift), scale) in values.iter_mut().zip(self.shift).zip(self.scale) {
            *value = (*value - shift) * scale;
        }
        Ok(())
    }
}
