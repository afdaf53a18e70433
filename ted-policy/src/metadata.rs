//! The metadata read where it lies. Lists stay in the bytes and are decoded again whenever they are asked for, so that an
//! artefact takes a device a few hundred bytes of memory and not a few thousand.
//!
//! Fields follow each other without anything between them, so reading a struct is reading its fields, in the order of
//! [`crate::wire`].

use core::marker::PhantomData;

use serde::Deserialize;
use ted_core::{MAX_ACTION, MAX_MEMBERS, MAX_OBSERVATION};

use crate::contract::{ActionChannel, ContractFault, ObservationChannel, SafeAction};
use crate::decode::decode;
use crate::digest::Digest;
use crate::error::ArtifactError;
use crate::text::Text;
use crate::wire::{Integers, Network, Sees, Ted};

/// A list that was decoded once, so that it can be again.
#[derive(Debug)]
pub struct List<'a, T> {
    bytes: &'a [u8],
    length: u8,
    of: PhantomData<T>,
}

impl<T> Clone for List<'_, T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T> Copy for List<'_, T> {}

impl<'a, T: Deserialize<'a>> List<'a, T> {
    /// How many there are.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.length as usize
    }

    /// Whether there are none.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.length == 0
    }

    /// All of them, in order.
    pub fn iter(&self) -> impl Iterator<Item = T> + use<'a, T> {
        let mut reader = Reader { rest: self.bytes };
        (0..self.length).map_while(move |_| reader.take())
    }
}

/// The contract of an artefact, as [`Contract`](crate::Contract) but with its channels where they lie.
#[derive(Clone, Copy, Debug)]
pub struct Terms<'a> {
    /// The task it was trained for.
    pub task: Text<'a>,
    /// The raw observation, in order.
    pub observation: List<'a, ObservationChannel<'a>>,
    /// The action, in order.
    pub action: List<'a, ActionChannel<'a>>,
    /// Time between two ticks, in microseconds.
    pub control_period_us: u32,
    /// Oldest observation a controller acts on, in microseconds.
    pub max_observation_age_us: u32,
    /// Whether somebody declared the robot: see [`Contract`](crate::Contract).
    pub declared: bool,
}

impl Terms<'_> {
    /// Passes when the contract can be kept.
    pub(crate) fn check(&self) -> Result<(), ContractFault> {
        check(
            self.task,
            self.observation.iter(),
            self.action.iter(),
            self.control_period_us,
        )
    }
}

/// Passes when a contract of these parts can be kept. That there are not too many channels is seen to before.
pub(crate) fn check<'a>(
    task: Text<'_>,
    observation: impl Iterator<Item = ObservationChannel<'a>>,
    action: impl Iterator<Item = ActionChannel<'a>>,
    control_period_us: u32,
) -> Result<(), ContractFault> {
    if task.is_empty() {
        return Err(ContractFault::Task);
    }
    let mut observations = 0;
    for (channel, it) in observation.enumerate() {
        observations += 1;
        if it.name.is_empty() || !it.low.is_finite() || !it.high.is_finite() || it.low > it.high {
            return Err(ContractFault::Observation { channel });
        }
    }
    if observations == 0 {
        return Err(ContractFault::ObservationChannels {
            limit: MAX_OBSERVATION,
            actual: 0,
        });
    }
    let mut actions = 0;
    for (channel, it) in action.enumerate() {
        actions += 1;
        // Of finite width, both ends are finite.
        let positive = |number: f32| number > 0.0 && number.is_finite();
        if it.name.is_empty() || !positive(it.high - it.low) || !positive(it.slew_per_tick) {
            return Err(ContractFault::Action { channel });
        }
        let stops_at = match it.on_fault {
            SafeAction::Zero => 0.0,
            // Whatever it is, it went out once.
            SafeAction::HoldLast => it.low,
            SafeAction::Value(value) => value,
        };
        // A NaN is in no range.
        if !(it.low..=it.high).contains(&stops_at) {
            return Err(ContractFault::NoSafeAction { channel });
        }
    }
    if actions == 0 {
        return Err(ContractFault::ActionChannels {
            limit: MAX_ACTION,
            actual: 0,
        });
    }
    if control_period_us == 0 {
        Err(ContractFault::ControlPeriod)
    } else {
        Ok(())
    }
}

/// The shape of a reward ensemble.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RewardShape<'a> {
    pub(crate) input: Sees,
    pub(crate) low: f32,
    pub(crate) high: f32,
    pub(crate) members: List<'a, Network>,
}

impl RewardShape<'_> {
    /// How many values its members see under this contract.
    pub(crate) fn inputs(&self, terms: &Terms<'_>) -> usize {
        match self.input {
            Sees::Observation => terms.observation.len(),
            Sees::ObservationAction => terms.observation.len() + terms.action.len(),
        }
    }
}

/// All of the metadata.
#[derive(Clone, Debug)]
pub(crate) struct Outline<'a> {
    pub(crate) terms: Terms<'a>,
    /// Where the provenance lies.
    pub(crate) provenance: &'a [u8],
    pub(crate) finite_provenance: bool,
    pub(crate) policy: Network,
    pub(crate) reward: Option<RewardShape<'a>>,
    pub(crate) ted: Option<Ted>,
    pub(crate) integers: Option<Integers>,
    pub(crate) golden_cases: u16,
}

impl<'a> Outline<'a> {
    /// Decodes all of it once.
    pub(crate) fn read(metadata: &'a [u8]) -> Result<Self, ArtifactError> {
        let mut reader = Reader { rest: metadata };
        let outline = Self::take(&mut reader).ok_or(ArtifactError::Metadata)?;
        match reader.rest.len() {
            0 => Ok(outline),
            left => Err(ArtifactError::MetadataLength {
                expected: metadata.len() - left,
                actual: metadata.len(),
            }),
        }
    }

    fn take(reader: &mut Reader<'a>) -> Option<Self> {
        let terms = Terms {
            task: reader.take()?,
            observation: reader.list(MAX_OBSERVATION)?,
            action: reader.list(MAX_ACTION)?,
            control_period_us: reader.take()?,
            max_observation_age_us: reader.take()?,
            declared: reader.take()?,
        };
        let provenance = reader.rest;
        let finite_provenance = reader.take_provenance()?;
        Some(Self {
            terms,
            provenance,
            finite_provenance,
            policy: reader.take()?,
            reward: match reader.take()? {
                0_u8 => None,
                1 => Some(RewardShape {
                    input: reader.take()?,
                    low: reader.take()?,
                    high: reader.take()?,
                    members: reader.list(MAX_MEMBERS)?,
                }),
                _ => return None,
            },
            ted: reader.take()?,
            integers: reader.take()?,
            golden_cases: reader.take()?,
        })
    }
}

/// Takes values from the front of bytes.
struct Reader<'a> {
    rest: &'a [u8],
}

impl<'a> Reader<'a> {
    fn take<T: Deserialize<'a>>(&mut self) -> Option<T> {
        decode(&mut self.rest)
    }

    /// A list of at most `limit`, each of them decoded once.
    fn list<T: Deserialize<'a>>(&mut self, limit: usize) -> Option<List<'a, T>> {
        let length: u32 = self.take()?;
        if length as usize > limit {
            return None;
        }
        let bytes = self.rest;
        for _ in 0..length {
            self.take::<T>()?;
        }
        Some(List {
            bytes,
            length: length as u8,
            of: PhantomData,
        })
    }

    /// Goes on behind the provenance; whether its numbers are finite.
    #[inline(never)]
    fn take_provenance(&mut self) -> Option<bool> {
        // Field by field, as a device has no use for the whole: `Provenance` has these, in this order.
        self.take::<Text<'_>>()?;
        self.take::<Text<'_>>()?;
        self.take::<u64>()?;
        self.take::<u64>()?;
        self.skip_digest()?;
        self.take::<Text<'_>>()?;
        self.skip_digest()?;
        match self.take()? {
            0_u8 => {}
            1 => self.skip_digest()?,
            _ => return None,
        }
        let returns: [f64; 2] = [self.take()?, self.take()?];
        Some(returns.into_iter().all(f64::is_finite))
    }

    fn skip_digest(&mut self) -> Option<()> {
        self.rest = self.rest.get(size_of::<Digest>()..)?;
        Some(())
    }
}
