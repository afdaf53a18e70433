//! The reason an artefact was refused as a number, for wires that are too narrow for words.

use crate::error::ArtifactError;

impl ArtifactError {
    /// The reason as a number that never changes its meaning.
    #[must_use]
    pub const fn code(&self) -> u8 {
        match self {
            Self::TooShort { .. } => 1,
            Self::WrongMagic { .. } => 2,
            Self::UnsupportedVersion { .. } => 3,
            Self::Truncated { .. } => 4,
            Self::TrailingBytes { .. } => 5,
            Self::Checksum { .. } => 6,
            Self::HeaderField { .. } => 7,
            Self::Metadata => 8,
            Self::MetadataLength { .. } => 9,
            Self::Misaligned { .. } => 10,
            Self::BlobLength { .. } => 11,
            Self::Padding { .. } => 12,
            Self::NotFinite { .. } => 13,
            Self::ScaleNotPositive { .. } => 14,
            Self::Shape { .. } => 15,
            Self::Integer(_) => 16,
            Self::Contract(_) => 17,
            Self::RewardRange { .. } => 18,
            Self::Discount(_) => 19,
            Self::NoGolden => 20,
            Self::GoldenMismatch { .. } => 21,
            Self::NoIntegers => 22,
            Self::IntegerPart { .. } => 23,
        }
    }
}
