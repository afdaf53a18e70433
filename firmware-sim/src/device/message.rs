//! What host and device say to each other, encoded with postcard. `docs/device-protocol.md` is the same in words.
//!
//! Variants are numbered in order; a new one goes to the end and raises [`PROTOCOL_VERSION`]. `Hello` stays the first of
//! both lists, and the version its first field, for ever.

use heapless::Vec;
use serde::{Deserialize, Serialize};
use ted_policy::Text;

use super::Counters;
use super::frame::NAME_LENGTH;
use super::slots::SlotReport;
use crate::controller::{Numeric, Status};
use crate::safety::Action;

/// The version of the protocol this program speaks.
pub const PROTOCOL_VERSION: u16 = 3;

/// What a host asks. A request that no reply is heard of is sent again, with the same number.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Request<'a> {
    /// Begins a session; answered with [`Reply::Hello`], whatever the version.
    Hello {
        /// The version that the host speaks.
        protocol: u16,
        /// A number that no host used in the last two sessions: it tells a new host from an old frame. The first request has
        /// its lower half as number.
        session: u32,
    },
    /// Begins an episode: the plant is at rest. Answered with [`Reply::Done`].
    Start(Start),
    /// One control period; answered with [`Reply::Acted`].
    Tick {
        /// The plant's clock, in microseconds.
        now_us: u64,
        /// The observation's number.
        sequence: u32,
        /// When the observation was taken, on the plant's clock, in microseconds.
        stamp_us: u64,
        /// The observation.
        #[serde(borrow)]
        values: Floats<'a>,
    },
    /// Gives the controls back to the policy after a fault; answered with [`Reply::Done`].
    Rearm,
    /// Announces an artefact for the slot that does not fly. Ends the episode. Answered with [`Reply::Done`].
    FlashBegin(FlashBegin),
    /// The next bytes of it; answered with [`Reply::Done`].
    FlashData {
        /// Where they belong: right behind the bytes before.
        offset: u32,
        /// At most [`CHUNK_LENGTH`](super::frame::CHUNK_LENGTH); as many as that, but for the last.
        bytes: &'a [u8],
    },
    /// All bytes were sent: judge them, and fly them from now on. Answered with [`Reply::Flashed`].
    FlashCommit,
    /// Answered with [`Reply::Health`].
    Health,
    /// One step of an episode that was flown some time ago, to be scored and not to be flown; answered with
    /// [`Reply::Scored`]. [`Self::Start`] begins such an episode too.
    Log {
        /// Its place in the dataset, which decides between equal returns: [`ted_core::NEW_EPISODE`] if it is not in it.
        episode: u32,
        /// What was seen.
        observation: Floats<'a>,
        /// What went out.
        action: Floats<'a>,
    },
}

/// How an episode is flown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Start {
    /// In which numbers.
    pub numeric: Numeric,
    /// After how long without a tick the device stops by itself, in microseconds of its own clock; 0 for never, when a
    /// simulation decides how time goes by. Counted from the first tick on.
    pub silence_us: u32,
}

/// What is about to be sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct FlashBegin {
    /// Bytes of the artefact.
    pub length: u32,
    /// The checksum in its header.
    pub checksum: u32,
    /// Whether it may have another contract than the artefact that flies.
    pub accept_other_contract: bool,
}

/// Numbers as they lie in a frame: 4 bytes each, little-endian, at any address.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Floats<'a>(&'a [u8]);

impl<'a> Floats<'a> {
    /// These bytes as numbers; nothing when they are not four times something.
    #[must_use]
    pub fn from_le_bytes(bytes: &'a [u8]) -> Option<Self> {
        bytes.len().is_multiple_of(4).then_some(Self(bytes))
    }

    /// Copies the numbers to the start of `room`; nothing when they are too many, or a broken number is among them.
    pub fn copy_to<'r>(&self, room: &'r mut [f32]) -> Option<&'r [f32]> {
        let (numbers, []) = self.0.as_chunks::<4>() else {
            return None;
        };
        let room = room.get_mut(..numbers.len())?;
        for (value, bytes) in room.iter_mut().zip(numbers) {
            *value = f32::from_le_bytes(*bytes);
        }
        Some(room)
    }
}

/// What a device answers, with the number of the request.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Reply<'a> {
    /// Who is there.
    #[serde(borrow)]
    Hello(Hello<'a>),
    /// What was asked for was done.
    Done,
    /// What a tick did.
    Acted(Acted),
    /// The artefact is in its slot, was judged, and flies from now on.
    Flashed {
        /// Its slot.
        slot: u8,
        /// The checksum in its header.
        checksum: u32,
    },
    /// How the device and its link are.
    Health(Health),
    /// Nothing was done, for this reason.
    Refused(Refusal),
    /// Nobody asked: no tick came in time, so the safe action goes out. Sent once for each silence, with the number of the
    /// last request.
    Silent(Acted),
    /// What the device thinks of a logged episode up to this step.
    Scored(Score),
}

/// Who is there.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Hello<'a> {
    /// The version that the device speaks. Nothing behind it may be believed of another version.
    pub protocol: u16,
    /// The session that the host named: another one's is an old reply.
    pub session: u32,
    /// The board.
    pub board: &'a str,
    /// The version of the firmware.
    pub firmware: &'a str,
    /// The slot that flies, if one does.
    pub active: Option<u8>,
    /// The task that its policy was trained for, as far as [`NAME_LENGTH`] reaches; empty if none flies.
    #[serde(borrow)]
    pub task: Text<'a>,
    /// What is in each slot.
    pub slots: [SlotReport; 2],
    /// The largest artefact that fits a slot, in bytes.
    pub slot_bytes: u32,
    /// Ticks in a second of the counter that [`Acted::work`] counts in; 0 if that is not known.
    pub work_hz: u32,
}

/// What a tick did, and what it took.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Acted {
    /// What goes out.
    pub action: Action,
    /// What the controller says of it.
    pub status: Status,
    /// What the tick cost, in ticks of the board's counter.
    pub work: u32,
    /// What the device thinks of the episode so far, if its artefact has a reward ensemble and TED's border.
    pub score: Option<Score>,
}

/// What the device thinks of the episode so far.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Score {
    /// The predicted return.
    pub return_hat: f32,
    /// Whether the episode would belong to the top k % if it ended now.
    pub top_k: bool,
    /// What the scoring of this step cost, in ticks of the board's counter.
    pub work: u32,
}

/// How the device and its link are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Health {
    /// Frames it did not act on, since it started.
    pub counters: Counters,
    /// The most stack that was ever in use, in bytes; 0 if that is not known.
    pub stack_high_water: u32,
}

/// Why nothing was done.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Refusal {
    /// The frame holds no message of this protocol.
    Malformed,
    /// No slot holds a policy that flies.
    NoPolicy,
    /// No episode was started.
    NotStarted,
    /// No artefact was announced.
    NotAnnounced,
    /// Bytes of the artefact belong elsewhere.
    Offset {
        /// Where the next bytes belong.
        expected: u32,
    },
    /// The artefact does not fit the slot.
    TooLarge {
        /// The largest that does, in bytes.
        limit: u32,
    },
    /// The flash could not be erased or written.
    Flash,
    /// The bytes in the slot are not those that were announced.
    Checksum {
        /// What was announced.
        expected: u32,
        /// What is there.
        actual: u32,
    },
    /// The artefact is not one that this firmware flies.
    Defect {
        /// [`ArtifactError::code`](ted_policy::ArtifactError::code).
        code: u8,
    },
    /// This device computes something else than the machine that wrote the artefact.
    Golden {
        /// The golden vector it was seen at.
        case: u16,
    },
    /// The artefact has other channels, units or another control period than the one that flies.
    OtherContract,
    /// The artefact has no reward ensemble in these numbers, or no border of TED's.
    CannotScore,
    /// A logged step has more or fewer values than the contract.
    OtherShape,
    /// The link cannot say that nothing comes, so its silence would never be noticed.
    CannotWatch,
    /// Nobody declared the robot of the artefact, so its units, ranges, times and safe actions mean nothing.
    Undeclared,
}

impl Refusal {
    /// The reason as a number that never changes its meaning: one more than its variant's number on the wire.
    #[must_use]
    pub const fn code(self) -> u8 {
        match self {
            Self::Malformed => 1,
            Self::NoPolicy => 2,
            Self::NotStarted => 3,
            Self::NotAnnounced => 4,
            Self::Offset { .. } => 5,
            Self::TooLarge { .. } => 6,
            Self::Flash => 7,
            Self::Checksum { .. } => 8,
            Self::Defect { .. } => 9,
            Self::Golden { .. } => 10,
            Self::OtherContract => 11,
            Self::CannotScore => 12,
            Self::OtherShape => 13,
            Self::CannotWatch => 14,
            Self::Undeclared => 15,
        }
    }
}

/// A name as long as a greeting has room for, in UTF-8.
pub type Name = Vec<u8, NAME_LENGTH>;
