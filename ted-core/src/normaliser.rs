//! Standardises an observation: `norm = (raw - shift) * scale`.

use nalgebra::{DVectorView, DVectorViewMut};

use crate::error::{Part, ShapeError};
use crate::limits::MAX_WIDTH;

/// One shift and one scale per channel. The scale is the reciprocal of the spread, so a device multiplies.
#[derive(Clone, Copy, Debug)]
pub struct Normaliser<'a> {
    shift: &'a [f32],
    scale: &'a [f32],
}

impl<'a> Normaliser<'a> {
    /// Of no channels.
    pub(crate) const NONE: Self = Self {
        shift: &[],
        scale: &[],
    };

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
        // `new` has compared these two; comparing again shows the compiler that no check inside nalgebra can fail.
        ShapeError::same(Part::Scale, self.channels(), self.scale.len())?;
        let mut values = DVectorViewMut::from_slice(values, self.channels());
        values -= DVectorView::from_slice(self.shift, self.channels());
        values.component_mul_assign(&DVectorView::from_slice(self.scale, self.channels()));
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn subtracts_then_multiplies_with_two_roundings() {
        let normaliser = Normaliser::new(&[0.1, -3.0], &[1.0 / 3.0, 1e-3]).unwrap();
        let mut values = [0.7, 1e6];
        normaliser.apply(&mut values).unwrap();
        assert_eq!(
            values,
            [(0.7_f32 - 0.1) * (1.0 / 3.0), (1e6_f32 + 3.0) * 1e-3]
        );
    }

    #[test]
    fn refuses_lengths_that_do_not_agree() {
        let error = Normaliser::new(&[0.0; 3], &[1.0; 2]).unwrap_err();
        assert_eq!(
            error,
            ShapeError::Mismatch {
                part: Part::Scale,
                expected: 3,
                actual: 2
            }
        );
        assert_eq!(
            Normaliser::new(&[], &[]).unwrap_err(),
            ShapeError::Empty { part: Part::Shift }
        );
        let error = Normaliser::new(&[0.0; 2], &[1.0; 2])
            .unwrap()
            .apply(&mut [0.0; 1])
            .unwrap_err();
        assert_eq!(
            error,
            ShapeError::Mismatch {
                part: Part::Input,
                expected: 2,
                actual: 1
            }
        );
    }
}
