//! What the payload of each frame means: layouts only, no behaviour.

use thiserror::Error;

use super::episode::{Behaviour, Episode, EpisodeJob};
use super::picture::{PictureJob, Pictures, State};

/// The kinds of frames: requests of the parent, and replies of the worker with the high bit set.
pub mod kind {
    /// Open a task.
    pub const OPEN: u16 = 0x01;
    /// Start the episode of a seed.
    pub const RESET: u16 = 0x02;
    /// Apply one action.
    pub const STEP: u16 = 0x03;
    /// Play a whole episode of the scripted policy.
    pub const COLLECT: u16 = 0x04;
    /// Draw recorded states.
    pub const RENDER: u16 = 0x05;
    /// Say the state of a running episode.
    pub const STATE: u16 = 0x06;
    /// The worker has its simulator; comes once, unasked, with sequence number 0.
    pub const READY: u16 = 0x80;
    /// Answers [`OPEN`].
    pub const OPENED: u16 = 0x81;
    /// Answers [`RESET`].
    pub const RESETTED: u16 = 0x82;
    /// Answers [`STEP`].
    pub const STEPPED: u16 = 0x83;
    /// Answers [`COLLECT`].
    pub const COLLECTED: u16 = 0x84;
    /// Answers [`RENDER`].
    pub const RENDERED: u16 = 0x85;
    /// Answers [`STATE`].
    pub const STATED: u16 = 0x86;
    /// Answers any request that cannot be served.
    pub const FAULT: u16 = 0xFF;
}

/// Episodes that a worker plays side by side at most.
pub const SLOTS: u16 = 64;

const SUCCESS: u8 = 1;
const TERMINATED: u8 = 2;
const TRUNCATED: u8 = 4;

/// Why a worker refuses a request.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FaultCode {
    /// The request makes no sense.
    BadRequest,
    /// Meta-World has no such task.
    UnknownTask,
    /// A step before a reset, or a reset before a task was opened.
    NoEpisode,
    /// The simulator raised an error.
    Simulator,
    /// The simulator could not be imported.
    CannotStart,
    /// No picture can be made on this machine.
    NoPictures,
    /// A code that this version of the program does not know.
    Other(u16),
}

impl From<u16> for FaultCode {
    fn from(code: u16) -> Self {
        match code {
            1 => Self::BadRequest,
            2 => Self::UnknownTask,
            3 => Self::NoEpisode,
            4 => Self::Simulator,
            5 => Self::CannotStart,
            6 => Self::NoPictures,
            other => Self::Other(other),
        }
    }
}

/// A payload that does not have the layout of its kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum MessageError {
    /// The payload is too short or too long.
    #[error("a payload has {actual} bytes, its layout takes {expected}")]
    Length {
        /// Bytes of the layout.
        expected: usize,
        /// Bytes of the payload.
        actual: usize,
    },
    /// A text is not UTF-8.
    #[error("a text is not UTF-8")]
    Text,
}

/// The sizes of a task, told by the worker when it opens one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shape {
    /// Values of an observation.
    pub observation: usize,
    /// Values of an action.
    pub action: usize,
    /// Joint positions of the simulator.
    pub qpos: usize,
    /// Joint velocities of the simulator.
    pub qvel: usize,
    /// Mocap bodies of the simulator; each has a position (3) and a quaternion (4).
    pub mocap: usize,
    /// Values of the goal vector.
    pub goal: usize,
    /// Steps of an episode.
    pub horizon: u32,
}

/// An action for the episode in a slot.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Move {
    /// Where the episode was started, below [`SLOTS`].
    pub slot: u16,
    /// The action.
    pub action: Vec<f32>,
}

/// What came of one action.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Step {
    /// The observation after the action.
    pub observation: Vec<f32>,
    /// The task's own reward.
    pub reward: f64,
    /// Whether the task counts as solved after this step.
    pub success: bool,
    /// Whether the episode ended in a terminal state. Meta-World has none.
    pub terminated: bool,
    /// Whether the episode reached its time limit.
    pub truncated: bool,
}

/// The payload of OPEN.
#[must_use]
pub fn open(task: &str) -> Vec<u8> {
    text(task)
}

/// The payload of RESET.
#[must_use]
pub fn reset(slot: u16, seed: u64) -> Vec<u8> {
    let mut payload = slot.to_le_bytes().to_vec();
    payload.extend_from_slice(&seed.to_le_bytes());
    payload
}

/// The payload of STEP, into a buffer that is used again.
pub fn step(moves: &[Move], out: &mut Vec<u8>) {
    out.clear();
    for Move { slot, action } in moves {
        out.extend_from_slice(&slot.to_le_bytes());
        for value in action {
            out.extend_from_slice(&value.to_le_bytes());
        }
    }
}

/// The payload of COLLECT.
#[must_use]
pub fn collect(job: &EpisodeJob) -> Vec<u8> {
    let Behaviour {
        noise_std,
        epsilon,
        push: [x, y, z, gripper],
        drift_std,
        drift_correlation,
        purpose,
    } = job.behaviour;
    let mut payload = Vec::with_capacity(77);
    payload.extend_from_slice(&job.seed.to_le_bytes());
    payload.extend_from_slice(&job.steps.to_le_bytes());
    for number in [
        noise_std,
        epsilon,
        x,
        y,
        z,
        gripper,
        drift_std,
        drift_correlation,
    ] {
        payload.extend_from_slice(&number.to_le_bytes());
    }
    payload.push(purpose);
    payload
}

/// The payload of RENDER: states by array, not by state.
#[must_use]
pub fn render(job: &PictureJob) -> Vec<u8> {
    let mut payload = job.seed.to_le_bytes().to_vec();
    payload.extend_from_slice(&job.look.width.to_le_bytes());
    payload.extend_from_slice(&job.look.height.to_le_bytes());
    payload.push(job.look.quality);
    let frames = u32::try_from(job.states.len()).unwrap_or(u32::MAX);
    payload.extend_from_slice(&frames.to_le_bytes());
    let qpos = job.states.iter().flat_map(|state| &state.qpos);
    let mocap_pos = job.states.iter().flat_map(|state| &state.mocap_pos);
    let mocap_quat = job.states.iter().flat_map(|state| &state.mocap_quat);
    for value in qpos.chain(mocap_pos).chain(mocap_quat) {
        payload.extend_from_slice(&value.to_le_bytes());
    }
    payload
}

/// The payload of STATE.
#[must_use]
pub fn state(slot: u16) -> Vec<u8> {
    slot.to_le_bytes().to_vec()
}

/// Reads the versions out of READY.
///
/// # Errors
/// When the payload has another layout.
pub fn parse_ready(payload: &[u8]) -> Result<String, MessageError> {
    let mut fields = Fields::new(payload);
    let versions = fields.text()?;
    fields.end(versions)
}

/// Reads OPENED.
///
/// # Errors
/// When the payload has another layout.
pub fn parse_opened(payload: &[u8]) -> Result<Shape, MessageError> {
    let mut fields = Fields::new(payload);
    let shape = Shape {
        observation: fields.u16()?.into(),
        action: fields.u16()?.into(),
        qpos: fields.u32()? as usize,
        qvel: fields.u32()? as usize,
        mocap: fields.u32()? as usize,
        goal: fields.u32()? as usize,
        horizon: fields.u32()?,
    };
    fields.end(shape)
}

/// Reads RESETTED: the first observation and the goal that was drawn.
///
/// # Errors
/// When the payload has another layout.
pub fn parse_resetted(payload: &[u8], shape: &Shape) -> Result<(Vec<f32>, Vec<f64>), MessageError> {
    let mut fields = Fields::new(payload);
    let observation = fields.f32s(shape.observation)?;
    let goal = fields.f64s(shape.goal)?;
    fields.end((observation, goal))
}

/// Reads STEPPED, the answer to this many actions.
///
/// # Errors
/// When the payload has another layout.
pub fn parse_stepped(
    payload: &[u8],
    shape: &Shape,
    moves: usize,
) -> Result<Vec<Step>, MessageError> {
    let mut fields = Fields::new(payload);
    let mut steps = Vec::with_capacity(moves);
    for _ in 0..moves {
        let observation = fields.f32s(shape.observation)?;
        let reward = fields.f64()?;
        let flags = fields.u8()?;
        steps.push(Step {
            observation,
            reward,
            success: flags & SUCCESS != 0,
            terminated: flags & TERMINATED != 0,
            truncated: flags & TRUNCATED != 0,
        });
    }
    fields.end(steps)
}

/// Reads COLLECTED.
///
/// # Errors
/// When the payload has another layout.
pub fn parse_collected(payload: &[u8], shape: &Shape) -> Result<Episode, MessageError> {
    let mut fields = Fields::new(payload);
    let steps = fields.u32()? as usize;
    let rows = steps.saturating_add(1);
    let observations = fields.f32s(rows.saturating_mul(shape.observation))?;
    let actions = fields.f32s(steps.saturating_mul(shape.action))?;
    let rewards = fields.f64s(steps)?;
    let flags = fields.take(steps)?;
    let flag = |bit| flags.iter().map(|flags| flags & bit != 0).collect();
    let (success, terminations, truncations) = (flag(SUCCESS), flag(TERMINATED), flag(TRUNCATED));
    let episode = Episode {
        shape: *shape,
        observations,
        actions,
        rewards,
        success,
        terminations,
        truncations,
        qpos: fields.f64s(rows.saturating_mul(shape.qpos))?,
        qvel: fields.f64s(rows.saturating_mul(shape.qvel))?,
        mocap_pos: fields.f64s(rows.saturating_mul(shape.mocap * 3))?,
        mocap_quat: fields.f64s(rows.saturating_mul(shape.mocap * 4))?,
        goal: fields.f64s(shape.goal)?,
    };
    fields.end(episode)
}

/// Reads RENDERED, the answer to this many states.
///
/// # Errors
/// When the payload has another layout.
pub fn parse_rendered(payload: &[u8], states: usize) -> Result<Pictures, MessageError> {
    let mut fields = Fields::new(payload);
    let way = fields.text()?;
    let mut jpegs = Vec::with_capacity(states);
    for _ in 0..states {
        let length = fields.u32()? as usize;
        jpegs.push(fields.take(length)?.to_vec());
    }
    fields.end(Pictures { way, jpegs })
}

/// Reads STATED.
///
/// # Errors
/// When the payload has another layout.
pub fn parse_stated(payload: &[u8], shape: &Shape) -> Result<State, MessageError> {
    let mut fields = Fields::new(payload);
    let state = State {
        qpos: fields.f64s(shape.qpos)?,
        mocap_pos: fields.f64s(shape.mocap * 3)?,
        mocap_quat: fields.f64s(shape.mocap * 4)?,
    };
    fields.end(state)
}

/// Reads FAULT.
///
/// # Errors
/// When the payload has another layout.
pub fn parse_fault(payload: &[u8]) -> Result<(FaultCode, String), MessageError> {
    let mut fields = Fields::new(payload);
    let code = fields.u16()?.into();
    let message = fields.text()?;
    fields.end((code, message))
}

fn text(value: &str) -> Vec<u8> {
    let length = u16::try_from(value.len()).unwrap_or(u16::MAX);
    let mut payload = length.to_le_bytes().to_vec();
    payload.extend_from_slice(&value.as_bytes()[..usize::from(length)]);
    payload
}

/// Takes little-endian fields off the front of a payload.
struct Fields<'a> {
    payload: &'a [u8],
    at: usize,
}

impl<'a> Fields<'a> {
    const fn new(payload: &'a [u8]) -> Self {
        Self { payload, at: 0 }
    }

    fn take(&mut self, count: usize) -> Result<&'a [u8], MessageError> {
        let end = self.at.saturating_add(count);
        let taken = self.payload.get(self.at..end).ok_or(MessageError::Length {
            expected: end,
            actual: self.payload.len(),
        })?;
        self.at = end;
        Ok(taken)
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], MessageError> {
        let mut array = [0; N];
        array.copy_from_slice(self.take(N)?);
        Ok(array)
    }

    fn u8(&mut self) -> Result<u8, MessageError> {
        self.array().map(u8::from_le_bytes)
    }

    fn u16(&mut self) -> Result<u16, MessageError> {
        self.array().map(u16::from_le_bytes)
    }

    fn u32(&mut self) -> Result<u32, MessageError> {
        self.array().map(u32::from_le_bytes)
    }

    fn f64(&mut self) -> Result<f64, MessageError> {
        self.array().map(f64::from_le_bytes)
    }

    fn f32s(&mut self, count: usize) -> Result<Vec<f32>, MessageError> {
        let (quads, _) = self.take(count.saturating_mul(4))?.as_chunks::<4>();
        Ok(quads
            .iter()
            .map(|bytes| f32::from_le_bytes(*bytes))
            .collect())
    }

    fn f64s(&mut self, count: usize) -> Result<Vec<f64>, MessageError> {
        let (octets, _) = self.take(count.saturating_mul(8))?.as_chunks::<8>();
        Ok(octets
            .iter()
            .map(|bytes| f64::from_le_bytes(*bytes))
            .collect())
    }

    fn text(&mut self) -> Result<String, MessageError> {
        let length = self.u16()?;
        let bytes = self.take(length.into())?;
        String::from_utf8(bytes.to_vec()).map_err(|_| MessageError::Text)
    }

    /// Gives out what was read, if nothing is left over.
    fn end<T>(self, value: T) -> Result<T, MessageError> {
        if self.at == self.payload.len() {
            Ok(value)
        } else {
            Err(MessageError::Length {
                expected: self.at,
                actual: self.payload.len(),
            })
        }
    }
}
