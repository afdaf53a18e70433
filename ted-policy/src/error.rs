//! Why an artefact was refused.

use core::fmt;

use ted_core::integer::IntegerError;
use ted_core::{DiscountError, ShapeError};

use crate::contract::ContractFault;

/// Which part of an artefact an error is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Place {
    /// The normaliser of the policy.
    Normaliser,
    /// The policy.
    Policy,
    /// The input normaliser of the reward ensemble.
    RewardNormaliser,
    /// One member of the reward ensemble.
    RewardMember(u8),
    /// The reward ensemble as a whole.
    Reward,
    /// TED's discount.
    Discount,
    /// The policy in integers.
    IntegerPolicy,
    /// The reward ensemble in integers.
    IntegerReward,
    /// The golden vectors.
    Golden,
    /// The provenance.
    Provenance,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Normaliser => "normaliser",
            Self::Policy => "policy",
            Self::RewardNormaliser => "reward normaliser",
            Self::RewardMember(member) => return write!(f, "reward member {member}"),
            Self::Reward => "reward ensemble",
            Self::Discount => "discount",
            Self::IntegerPolicy => "integer policy",
            Self::IntegerReward => "integer reward ensemble",
            Self::Golden => "golden vectors",
            Self::Provenance => "provenance",
        })
    }
}

/// Why an artefact was refused.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum ArtifactError {
    /// There is a reward ensemble or a discount in floats but not in integers beside other integers, or the reverse.
    IntegerPart {
        /// Which of the two.
        place: Place,
    },
    /// The artefact is sound, but holds no networks in integers.
    NoIntegers,
    /// Fewer bytes than a header has.
    TooShort {
        /// Length of a header.
        expected: usize,
        /// Length of the input.
        actual: usize,
    },
    /// The first bytes are not those of an artefact.
    WrongMagic {
        /// The magic of an artefact.
        expected: [u8; 8],
        /// The first eight bytes of the input.
        actual: [u8; 8],
    },
    /// Another format version.
    UnsupportedVersion {
        /// The version this build reads.
        expected: u32,
        /// The version of the input.
        actual: u32,
    },
    /// The input ends before the length in its header.
    Truncated {
        /// The length in the header.
        expected: usize,
        /// Length of the input.
        actual: usize,
    },
    /// The input goes on after the length in its header.
    TrailingBytes {
        /// The length in the header.
        expected: usize,
        /// Length of the input.
        actual: usize,
    },
    /// The bytes are not those that were written.
    Checksum {
        /// The checksum in the header.
        expected: u32,
        /// The checksum of the input.
        actual: u32,
    },
    /// A header field has not the one value that the other fields allow.
    HeaderField {
        /// Offset of the field in the file.
        offset: usize,
        /// The value it must have.
        expected: u32,
        /// The value it has.
        actual: u32,
    },
    /// The metadata cannot be decoded.
    Metadata,
    /// The metadata goes on after its last field.
    MetadataLength {
        /// Length that was decoded.
        expected: usize,
        /// Length in the header.
        actual: usize,
    },
    /// The input does not start at an address where its numbers can be read in place.
    Misaligned {
        /// The address must be a multiple of this.
        expected: usize,
        /// The remainder it has.
        actual: usize,
    },
    /// The weight blob has not the length that the metadata asks for.
    BlobLength {
        /// Length asked for; so far, if the blob ends early.
        expected: usize,
        /// Length in the header.
        actual: usize,
    },
    /// A byte between two sections is not zero.
    Padding {
        /// Offset of the byte in the file.
        offset: usize,
    },
    /// A number is NaN or infinite.
    NotFinite {
        /// Where it is used.
        place: Place,
        /// Offset of the number in the file; 0 if it is part of the metadata.
        offset: usize,
    },
    /// A scale is zero or negative.
    ScaleNotPositive {
        /// Which normaliser.
        place: Place,
        /// Which channel.
        channel: usize,
    },
    /// Sizes that do not fit together, or not to the contract.
    Shape {
        /// Where.
        place: Place,
        /// What does not fit.
        error: ShapeError,
    },
    /// A network of the integer policy cannot be used.
    Integer(IntegerError),
    /// The contract cannot be kept.
    Contract(ContractFault),
    /// The reward range is not finite and ordered.
    RewardRange {
        /// Its low end.
        low: f32,
        /// Its high end.
        high: f32,
    },
    /// The discount cannot be used.
    Discount(DiscountError),
    /// There is no golden vector, so nothing proves that this machine computes what was trained.
    NoGolden,
    /// This machine computes something else than the machine that wrote the artefact.
    GoldenMismatch {
        /// [`Place::Policy`] or [`Place::Reward`].
        place: Place,
        /// Which golden vector.
        case: usize,
        /// Which output of it.
        output: usize,
        /// The bits in the artefact.
        expected: u32,
        /// The bits computed here.
        actual: u32,
    },
}

impl fmt::Display for ArtifactError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::IntegerPart { place } => {
                write!(f, "{place} is there in floats or in integers, not in both")
            }
            Self::NoIntegers => {
                f.write_str("artefact holds no networks in integers: export it again with them")
            }
            Self::TooShort { expected, actual } => {
                write!(
                    f,
                    "artefact has {actual} bytes, its header alone has {expected}: copy the file again"
                )
            }
            Self::WrongMagic { actual, .. } => {
                write!(
                    f,
                    "not a policy artefact, it starts with {:02x?}: give a policy.ted file",
                    actual
                )
            }
            Self::UnsupportedVersion { expected, actual } => write!(
                f,
                "artefact has format version {actual}, this program reads version {expected}: export the policy again"
            ),
            Self::Truncated { expected, actual } => {
                write!(
                    f,
                    "artefact ends after {actual} of {expected} bytes: copy the file again"
                )
            }
            Self::TrailingBytes { expected, actual } => {
                write!(
                    f,
                    "artefact has {actual} bytes, its header says {expected}: copy the file again"
                )
            }
            Self::Checksum { expected, actual } => write!(
                f,
                "artefact is damaged, its checksum is {actual:08x} and should be {expected:08x}: copy the file again"
            ),
            Self::HeaderField {
                offset,
                expected,
                actual,
            } => {
                write!(
                    f,
                    "artefact header field at byte {offset} is {actual}, only {expected} is valid"
                )
            }
            Self::Metadata => {
                f.write_str(
                    "artefact metadata is not what its format version describes, or has more layers, members or channels than \
                     this reader has room for",
                )
            }
            Self::MetadataLength { expected, actual } => {
                write!(
                    f,
                    "artefact metadata ends after {expected} of {actual} bytes"
                )
            }
            Self::Misaligned { expected, actual } => write!(
                f,
                "artefact was loaded {actual} bytes past a multiple of {expected}: load it to an aligned address"
            ),
            Self::BlobLength { expected, actual } => {
                write!(
                    f,
                    "artefact networks take {expected} bytes, its weight blob has {actual}"
                )
            }
            Self::Padding { offset } => write!(f, "artefact padding at byte {offset} is not zero"),
            Self::NotFinite { place, offset: 0 } => {
                write!(f, "{place} holds a number that is not finite")
            }
            Self::NotFinite { place, offset } => {
                write!(
                    f,
                    "{place} holds a number that is not finite, at byte {offset}"
                )
            }
            Self::ScaleNotPositive { place, channel } => {
                write!(
                    f,
                    "{place} has a scale that is not positive, in channel {channel}"
                )
            }
            Self::Shape { place, error } => write!(f, "{place} does not fit: {error}"),
            Self::Integer(error) => write!(f, "integer policy cannot be used: {error}"),
            Self::Contract(fault) => write!(f, "contract cannot be kept: {fault}"),
            Self::RewardRange { low, high } => {
                write!(f, "reward range {low} to {high} is not ordered with a finite width")
            }
            Self::Discount(error) => error.fmt(f),
            Self::NoGolden => {
                f.write_str("artefact has no golden vectors, nothing could be verified")
            }
            Self::GoldenMismatch {
                place,
                case,
                output,
                expected,
                actual,
            } => write!(
                f,
                "golden vector {case} differs in {place} output {output}: expected bits {expected:08x}, \
                 computed {actual:08x}; this machine does not compute what was trained"
            ),
        }
    }
}

impl core::error::Error for ArtifactError {}
