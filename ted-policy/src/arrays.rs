//! The weight blob, cut into arrays that are borrowed in place.
//!
//! Whoever finds a defect leaves it with the arrays and returns nothing. An error with its evidence is six words: handed on
//! beside a value from call to call, it takes more of a device's flash than all that finds it.

use bytemuck::AnyBitPattern;
use ted_core::ShapeError;
use ted_core::integer::IntegerError;

use crate::envelope::{ALIGNMENT, Envelope, check_padding};
use crate::error::{ArtifactError, Place};

/// The bytes that hold the arrays, and where they lie in the file.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Blob<'a> {
    bytes: &'a [u8],
    offset: usize,
}

impl<'a> Blob<'a> {
    pub(crate) fn of(envelope: &Envelope<'a>) -> Result<Self, ArtifactError> {
        let expected = align_of::<f32>();
        let actual = envelope.blob.as_ptr().addr() % expected;
        if actual != 0 {
            return Err(ArtifactError::Misaligned { expected, actual });
        }
        Ok(Self {
            bytes: envelope.blob,
            offset: envelope.blob_offset,
        })
    }

    /// The arrays from this position on, which is 0 or [`Arrays::position`] of others.
    pub(crate) fn arrays(self, position: usize) -> Arrays<'a> {
        Arrays {
            blob: self,
            position,
            defect: None,
        }
    }
}

/// Takes the arrays of a blob one after the other. There is no table of offsets: shapes decide where each one starts.
#[derive(Debug)]
pub(crate) struct Arrays<'a> {
    blob: Blob<'a>,
    position: usize,
    defect: Option<ArtifactError>,
}

impl<'a> Arrays<'a> {
    /// Where the next one starts.
    pub(crate) fn position(&self) -> usize {
        self.position
    }

    /// The defect for which a reader returned nothing.
    pub(crate) fn defect(&self) -> ArtifactError {
        // There is one; if not, something is wrong with the artefact all the same.
        self.defect.unwrap_or(ArtifactError::Metadata)
    }

    /// Notes a defect. Nothing that was read before it counts.
    pub(crate) fn refuse<T>(&mut self, error: ArtifactError) -> Option<T> {
        self.defect = Some(error);
        None
    }

    /// A part that fits, at this place.
    pub(crate) fn shaped<T>(&mut self, place: Place, part: Result<T, ShapeError>) -> Option<T> {
        match part {
            Ok(part) => Some(part),
            Err(error) => self.refuse(ArtifactError::Shape { place, error }),
        }
    }

    /// A part of a network in integers that can be used.
    pub(crate) fn integer<T>(&mut self, part: Result<T, IntegerError>) -> Option<T> {
        match part {
            Ok(part) => Some(part),
            Err(error) => self.refuse(ArtifactError::Integer(error)),
        }
    }

    /// The next `count` finite floats.
    pub(crate) fn take_f32(&mut self, count: usize, place: Place) -> Option<&'a [f32]> {
        let offset = self.blob.offset + self.position;
        let values: &[f32] = self.take(count)?;
        match values.iter().position(|value| !value.is_finite()) {
            Some(index) => self.refuse(ArtifactError::NotFinite {
                place,
                offset: offset + 4 * index,
            }),
            None => Some(values),
        }
    }

    /// The next `count` numbers, and the padding behind them.
    pub(crate) fn take<T: AnyBitPattern>(&mut self, count: usize) -> Option<&'a [T]> {
        let bytes = self.take_bytes(count.saturating_mul(size_of::<T>()))?;
        // Aligned: the blob was for the widest number there is, and arrays start at multiples of more.
        bytemuck::try_cast_slice(bytes).ok()
    }

    #[inline(never)]
    fn take_bytes(&mut self, length: usize) -> Option<&'a [u8]> {
        let Blob {
            bytes: blob,
            offset,
        } = self.blob;
        let end = self.position.saturating_add(length);
        let padded = end
            .checked_next_multiple_of(ALIGNMENT)
            .unwrap_or(usize::MAX);
        let parts = (blob.get(self.position..end), blob.get(end..padded));
        let (Some(bytes), Some(padding)) = parts else {
            return self.refuse(ArtifactError::BlobLength {
                expected: padded,
                actual: blob.len(),
            });
        };
        if let Err(error) = check_padding(padding, offset + end) {
            return self.refuse(error);
        }
        self.position = padded;
        Some(bytes)
    }

    /// Passes when every byte was taken.
    pub(crate) fn finish(&mut self) -> Option<()> {
        let (expected, actual) = (self.position, self.blob.bytes.len());
        if expected == actual {
            Some(())
        } else {
            self.refuse(ArtifactError::BlobLength { expected, actual })
        }
    }
}
