//! The weight blob, cut into arrays that are borrowed in place.

use bytemuck::AnyBitPattern;

use crate::envelope::{ALIGNMENT, Envelope, check_padding};
use crate::error::{ArtifactError, Place};

/// Takes the arrays of a blob one after the other. There is no table of offsets: shapes decide where each one starts.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Arrays<'a> {
    blob: &'a [u8],
    blob_offset: usize,
    position: usize,
}

impl<'a> Arrays<'a> {
    pub(crate) fn new(envelope: &Envelope<'a>) -> Result<Self, ArtifactError> {
        let expected = align_of::<f32>();
        let actual = envelope.blob.as_ptr().addr() % expected;
        if actual != 0 {
            return Err(ArtifactError::Misaligned { expected, actual });
        }
        Ok(Self {
            blob: envelope.blob,
            blob_offset: envelope.blob_offset,
            position: 0,
        })
    }

    /// The next `count` finite floats.
    pub(crate) fn take_f32(
        &mut self,
        count: usize,
        place: Place,
    ) -> Result<&'a [f32], ArtifactError> {
        let offset = self.blob_offset + self.position;
        let values: &[f32] = self.take(count)?;
        match values.iter().position(|value| !value.is_finite()) {
            Some(index) => Err(ArtifactError::NotFinite {
                place,
                offset: offset + 4 * index,
            }),
            None => Ok(values),
        }
    }

    /// The next `count` numbers, and the padding behind them.
    pub(crate) fn take<T: AnyBitPattern>(
        &mut self,
        count: usize,
    ) -> Result<&'a [T], ArtifactError> {
        let actual = self.blob.len();
        let length = count.saturating_mul(size_of::<T>());
        let end = self.position.saturating_add(length);
        let padded = end
            .checked_next_multiple_of(ALIGNMENT)
            .unwrap_or(usize::MAX);
        let too_long = ArtifactError::BlobLength {
            expected: padded,
            actual,
        };
        let bytes = self.blob.get(self.position..end).ok_or(too_long)?;
        let padding = self.blob.get(end..padded).ok_or(too_long)?;
        check_padding(padding, self.blob_offset + end)?;
        self.position = padded;
        bytemuck::try_cast_slice(bytes).map_err(|_| ArtifactError::Misaligned {
            expected: align_of::<T>(),
            actual: bytes.as_ptr().addr() % align_of::<T>(),
        })
    }

    /// Passes when every byte was taken.
    pub(crate) fn finish(&self) -> Result<(), ArtifactError> {
        let (expected, actual) = (self.position, self.blob.len());
        if expected == actual {
            Ok(())
        } else {
            Err(ArtifactError::BlobLength { expected, actual })
        }
    }
}
