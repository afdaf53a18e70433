//! A device's refusals in words. They are written here and not on the device, which has no room for text.

use std::fmt;

use crate::device::message::Refusal;

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Malformed => f.write_str("it could not read the message"),
            Self::NoPolicy => f.write_str("no slot holds a policy that flies: flash one"),
            Self::NotStarted => f.write_str("no episode was started"),
            Self::NotAnnounced => f.write_str("no artefact was announced"),
            Self::Offset { expected } => {
                write!(f, "the bytes from {expected} on have to come next")
            }
            Self::TooLarge { limit } => {
                write!(f, "a slot holds {limit} bytes: export a smaller artefact")
            }
            Self::Flash => f.write_str("its flash could not be erased or written"),
            Self::Checksum { expected, actual } => write!(
                f,
                "the checksum of what arrived is {actual:08x} and should be {expected:08x}: is the file whole?"
            ),
            Self::Defect { code } => write!(f, "{} (defect {code})", defect(*code)),
            Self::Golden { case } => write!(
                f,
                "golden vector {case} came out differently: it does not compute what was trained"
            ),
            Self::OtherContract => f.write_str(
                "its channels, units or control period are not those of the policy that flies: if the wiring was changed, \
                 `firmware-sim flash --accept-other-contract` accepts that",
            ),
            Self::CannotScore => f.write_str(
                "its artefact has no reward ensemble in these numbers, or no border of TED's: export a run with a learned \
                 reward and TED's discount",
            ),
            Self::OtherShape => {
                f.write_str("an observation or an action has another length than the contract says")
            }
            Self::Undeclared => f.write_str(
                "its robot is undeclared: write down channels, units, ranges, times and safe actions (`ted robot draft DATASET`), \
                 declare it for the dataset (`ted robot declare`), and export the run again (`ted export`)",
            ),
            Self::CannotWatch => f.write_str(
                "its link cannot notice a silence: use a serial port, or fly in lockstep with a silence of 0",
            ),
        }
    }
}

/// What a defect's code means: the codes of `ArtifactError::code`.
fn defect(code: u8) -> &'static str {
    match code {
        1 => "the artefact is shorter than its header",
        2 => "the bytes are no artefact",
        3 => "the artefact has another format version: export it with the release of the firmware",
        4 => "the artefact ends before the length in its header",
        5 => "the artefact goes on after the length in its header",
        7 => "a field of the artefact's header is wrong",
        8 => "the artefact's metadata cannot be decoded",
        9 => "the artefact's metadata has another length than its header says",
        10 => {
            "the artefact lies at an address where it cannot be read: the board's flash is not aligned"
        }
        11 => "the artefact's weights have another length than its networks",
        12 => "the artefact's padding is not zero",
        13 => "a number in the artefact is not finite",
        14 => "a scale in the artefact is not positive",
        15 => "sizes in the artefact do not fit together",
        16 => "the artefact's integer networks cannot be used",
        17 => "the artefact's contract cannot be kept",
        18 => "the artefact's reward range is not ordered",
        19 => "the artefact's discount cannot be used",
        20 => "the artefact has no golden vectors",
        22 => "the artefact holds no networks in integers: export it again with them",
        23 => "a part of the artefact is there in floats and not in integers, or the reverse",
        _ => "the artefact has a defect that this program does not know",
    }
}
