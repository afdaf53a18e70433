//! A line between a host and a device that loses, repeats, swaps, cuts and bends frames, on purpose and as planned.

use std::collections::VecDeque;
use std::io::{self, Read, Write};

use crate::splitmix::{fraction, mix};

/// What happens to a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Disturbance {
    /// It is lost.
    Drop,
    /// It arrives twice.
    Duplicate,
    /// It arrives behind the next one that is sent the same way.
    Reorder,
    /// Only its first half arrives.
    Truncate,
    /// One of its bits is flipped.
    FlipBit,
    /// Other bytes come before it, among them zeros.
    Noise,
    /// It arrives, and once more behind the next one that is sent the same way.
    Echo,
}

/// Which way a frame goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// From the host to the device.
    ToDevice,
    /// From the device to the host.
    ToHost,
}

/// Which frame is disturbed, and how.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Strike {
    /// Which way it goes.
    pub direction: Direction,
    /// How many went that way before it.
    pub frame: u32,
    /// What happens to it.
    pub disturbance: Disturbance,
}

/// A host's stream with a bad line behind it.
#[derive(Debug)]
pub struct Disturbed<S> {
    stream: S,
    strikes: Vec<Strike>,
    /// The share of frames that are disturbed beyond that, and the seed they are drawn from.
    chance: f32,
    seed: u64,
    there: Way,
    back: Way,
}

/// One direction: bytes go in, frames come out.
#[derive(Debug, Default)]
struct Way {
    frames: u32,
    begun: Vec<u8>,
    held_back: Option<Vec<u8>>,
    through: VecDeque<u8>,
}

impl Disturbance {
    /// All of them.
    pub const ALL: [Self; 7] = [
        Self::Drop,
        Self::Duplicate,
        Self::Reorder,
        Self::Truncate,
        Self::FlipBit,
        Self::Noise,
        Self::Echo,
    ];

    /// What a person calls it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Drop => "dropped",
            Self::Duplicate => "duplicated",
            Self::Reorder => "reordered",
            Self::Truncate => "truncated",
            Self::FlipBit => "bit flipped",
            Self::Noise => "behind noise",
            Self::Echo => "echoed later",
        }
    }
}

impl<S> Disturbed<S> {
    /// A line that disturbs these frames.
    pub fn planned(stream: S, strikes: Vec<Strike>) -> Self {
        Self {
            stream,
            strikes,
            chance: 0.0,
            seed: 0,
            there: Way::default(),
            back: Way::default(),
        }
    }

    /// A line that disturbs this share of the frames, from 0 to 1, each in some way drawn from `seed`.
    pub fn by_chance(stream: S, chance: f32, seed: u64) -> Self {
        Self {
            chance,
            seed,
            ..Self::planned(stream, Vec::new())
        }
    }

    /// Frames that have gone this way so far, disturbed ones included.
    pub fn frames(&self, direction: Direction) -> u32 {
        match direction {
            Direction::ToDevice => self.there.frames,
            Direction::ToHost => self.back.frames,
        }
    }

    /// The stream below, past all disturbances.
    pub fn inner(&mut self) -> &mut S {
        &mut self.stream
    }

    /// Disturbs one more frame.
    pub fn plan(&mut self, strike: Strike) {
        self.strikes.push(strike);
    }

    fn strike(&self, direction: Direction, frame: u32) -> Option<Disturbance> {
        let planned = self
            .strikes
            .iter()
            .find(|strike| (strike.direction, strike.frame) == (direction, frame));
        let draw = mix(self.seed ^ direction as u64, u64::from(frame));
        let some = (mix(draw, 0) % Disturbance::ALL.len() as u64) as usize;
        planned
            .map(|strike| strike.disturbance)
            .or((fraction(draw) < self.chance).then_some(Disturbance::ALL[some]))
    }

    fn pass(&mut self, direction: Direction, bytes: &[u8]) {
        for &byte in bytes {
            let way = self.way(direction);
            way.begun.push(byte);
            if byte != 0 {
                continue;
            }
            let frame = std::mem::take(&mut way.begun);
            if frame.len() == 1 {
                way.through.extend(frame);
                continue;
            }
            let number = way.frames;
            way.frames += 1;
            let disturbance = self.strike(direction, number);
            self.way(direction).carry(frame, number, disturbance);
        }
    }

    fn way(&mut self, direction: Direction) -> &mut Way {
        match direction {
            Direction::ToDevice => &mut self.there,
            Direction::ToHost => &mut self.back,
        }
    }
}

impl Way {
    fn carry(&mut self, mut frame: Vec<u8>, number: u32, disturbance: Option<Disturbance>) {
        let draw = mix(u64::from(number), frame.len() as u64) as usize;
        let before = self.held_back.take();
        match disturbance {
            Some(Disturbance::Drop) => frame.clear(),
            Some(Disturbance::Duplicate) => frame = frame.repeat(2),
            Some(Disturbance::Echo) => self.held_back = Some(frame.clone()),
            Some(Disturbance::Reorder) => self.held_back = Some(std::mem::take(&mut frame)),
            Some(Disturbance::Truncate) => {
                frame.truncate(frame.len() / 2);
                frame.push(0);
            }
            Some(Disturbance::FlipBit) => {
                let at = draw % frame.len();
                frame[at] ^= 1 << (draw % 8);
            }
            Some(Disturbance::Noise) => {
                let noise = (0..60).map(|index| mix(draw as u64, index) as u8 & 0x8f);
                frame.splice(0..0, noise.chain([0]));
            }
            None => {}
        }
        self.through.extend(frame);
        self.through.extend(before.into_iter().flatten());
    }
}

impl<S: Read> Read for Disturbed<S> {
    fn read(&mut self, room: &mut [u8]) -> io::Result<usize> {
        if self.back.through.is_empty() {
            let mut bytes = [0; 256];
            let length = self.stream.read(&mut bytes)?;
            if length == 0 {
                return Ok(0);
            }
            self.pass(Direction::ToHost, &bytes[..length]);
        }
        if self.back.through.is_empty() {
            return Err(io::ErrorKind::TimedOut.into());
        }
        self.back.through.read(room)
    }
}

impl<S: Write> Write for Disturbed<S> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.pass(Direction::ToDevice, bytes);
        let through: Vec<u8> = self.there.through.drain(..).collect();
        self.stream.write_all(&through)?;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.stream.flush()
    }
}
