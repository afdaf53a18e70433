//! Requests and their replies over a link that may lose either: asked again until answered, done once.

use std::io::{self, ErrorKind, Read, Write};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use super::{RemoteError, Stream};
use crate::device::frame::{self, MAX_FRAME};
use crate::device::message::{Acted, Hello, PROTOCOL_VERSION, Reply, Request};
use crate::device::slots::SlotReport;
use crate::device::{Counters, Receiver};

/// How patient a host is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LinkOptions {
    /// How long an answer is waited for before the request is sent again. A device that judges an artefact takes a while.
    pub timeout: Duration,
    /// How often a request is sent.
    pub tries: u32,
    /// The session's number: none of the last two.
    pub session: u32,
}

impl Default for LinkOptions {
    /// Ten tries of a second, and a session drawn from the clock.
    fn default() -> Self {
        let now = SystemTime::now().duration_since(UNIX_EPOCH);
        Self {
            timeout: Duration::from_secs(1),
            tries: 10,
            session: now.map_or(0, |now| now.as_nanos() as u32),
        }
    }
}

/// What went wrong on a link, seen from the host.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LinkErrors {
    /// Requests that had to be sent again.
    pub retries: u32,
    /// Replies to a request that had been answered before.
    pub stale: u32,
    /// Damaged bytes from the device; the other counters of this kind are 0.
    pub received: Counters,
}

/// Who is there: [`Hello`], owned.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DeviceHello {
    /// The board.
    pub board: String,
    /// The version of the firmware.
    pub firmware: String,
    /// The slot that flies, if one does.
    pub active: Option<u8>,
    /// The task that its policy was trained for; empty if none flies.
    pub task: String,
    /// What is in each slot.
    pub slots: [SlotReport; 2],
    /// The largest artefact that fits a slot, in bytes.
    pub slot_bytes: u32,
    /// Ticks in a second of the counter that measures the device's work; 0 if that is not known.
    pub work_hz: u32,
}

/// A link to a device that was greeted.
#[derive(Debug)]
pub struct Connection<S> {
    stream: S,
    options: LinkOptions,
    receiver: Receiver,
    number: u16,
    errors: LinkErrors,
    silent: Option<Acted>,
    hello: DeviceHello,
}

impl<S: Read + Write> Connection<S> {
    /// Greets the device at the other end.
    ///
    /// # Errors
    /// When nobody answers, or someone with another version of the protocol.
    pub fn open(stream: S, options: LinkOptions) -> Result<Self, RemoteError> {
        let mut connection = Self {
            stream,
            options,
            receiver: Receiver::new(),
            number: before(options.session),
            errors: LinkErrors::default(),
            silent: None,
            hello: DeviceHello {
                board: String::new(),
                firmware: String::new(),
                active: None,
                task: String::new(),
                slots: [SlotReport::Empty; 2],
                slot_bytes: 0,
                work_hz: 0,
            },
        };
        connection.greet()?;
        Ok(connection)
    }

    /// Asks again who is there: after an artefact was sent, another policy flies.
    ///
    /// # Errors
    /// As [`Self::open`].
    pub fn greet(&mut self) -> Result<(), RemoteError> {
        let hello = Request::Hello {
            protocol: PROTOCOL_VERSION,
            session: self.options.session,
        };
        let Reply::Hello(hello) = self.ask("greet the device", &hello)? else {
            return Err(RemoteError::Unexpected {
                asked: "greet the device",
            });
        };
        self.hello = DeviceHello::of(&hello);
        Ok(())
    }

    /// Asks who is there as another host would, that knows nothing of this one.
    ///
    /// # Errors
    /// As [`Self::open`].
    pub fn greet_anew(&mut self, session: u32) -> Result<(), RemoteError> {
        (self.options.session, self.number) = (session, before(session));
        self.greet()
    }

    /// Who is there.
    pub fn hello(&self) -> &DeviceHello {
        &self.hello
    }

    /// What went wrong so far.
    pub fn errors(&self) -> LinkErrors {
        self.errors
    }

    /// What the device did by itself when it heard nothing, if it did since this was last asked.
    pub fn take_silent(&mut self) -> Option<Acted> {
        self.silent.take()
    }

    /// The stream below.
    pub fn stream(&mut self) -> &mut S {
        &mut self.stream
    }

    /// Hangs up, and gives the stream back.
    pub fn into_stream(self) -> S {
        self.stream
    }

    /// The same connection, over a stream of any kind.
    pub fn boxed(self) -> Connection<Box<dyn Stream>>
    where
        S: Stream + 'static,
    {
        Connection {
            stream: Box::new(self.stream),
            options: self.options,
            receiver: self.receiver,
            number: self.number,
            errors: self.errors,
            silent: self.silent,
            hello: self.hello,
        }
    }

    /// Sends a request until it is answered. `asked` says what it is for, in errors.
    ///
    /// # Errors
    /// When no answer comes, the link breaks, or the device refuses.
    pub fn ask(
        &mut self,
        asked: &'static str,
        request: &Request<'_>,
    ) -> Result<Reply<'_>, RemoteError> {
        self.number = self.number.wrapping_add(1);
        // A zero first: whatever a disturbance left on the line ends there.
        let mut frame = [0; 1 + MAX_FRAME];
        let length = frame::build(&mut frame[1..], self.number, request);
        let length = 1 + length.ok_or(RemoteError::TooLong { asked })?;
        let mut answered = false;
        for attempt in 0..self.options.tries {
            self.errors.retries += u32::from(attempt > 0);
            self.stream.write_all(&frame[..length])?;
            self.stream.flush()?;
            answered = self.hear(request)?;
            if answered {
                break;
            }
        }
        if !answered {
            let LinkOptions { timeout, tries, .. } = self.options;
            return Err(RemoteError::Silent {
                asked,
                tries,
                timeout,
            });
        }
        match parse(self.receiver.body().message) {
            Some(Reply::Refused(refusal)) => Err(RemoteError::Refused { asked, refusal }),
            Some(reply) => Ok(reply),
            None => Err(match version(self.receiver.body().message) {
                Some(device) => RemoteError::Version {
                    host: PROTOCOL_VERSION,
                    device,
                },
                None => RemoteError::Unexpected { asked },
            }),
        }
    }

    /// Waits for what the device says by itself, for as long as an answer may take.
    ///
    /// # Errors
    /// When the link breaks.
    pub fn listen(&mut self) -> Result<Option<Acted>, RemoteError> {
        let until = Instant::now() + self.options.timeout;
        while self.silent.is_none() && Instant::now() < until {
            while self.receiver.advance(&mut self.errors.received) {
                self.overhear();
            }
            if self.silent.is_none() {
                self.read()?;
            }
        }
        Ok(self.take_silent())
    }

    /// Reads until the reply to this request is in the receiver, or it is time to ask again.
    fn hear(&mut self, request: &Request<'_>) -> io::Result<bool> {
        let until = Instant::now() + self.options.timeout;
        loop {
            while self.receiver.advance(&mut self.errors.received) {
                let body = self.receiver.body();
                if body.number == self.number && may_answer(request, body.message) {
                    return Ok(true);
                }
                self.overhear();
            }
            if Instant::now() >= until {
                return Ok(false);
            }
            self.read()?;
        }
    }

    /// Notes a frame that is no answer.
    fn overhear(&mut self) {
        match parse(self.receiver.body().message) {
            Some(Reply::Silent(acted)) => self.silent = Some(acted),
            _ => self.errors.stale += 1,
        }
    }

    fn read(&mut self) -> io::Result<()> {
        let room = self.receiver.room(&mut self.errors.received);
        match self.stream.read(room) {
            Ok(0) => Err(io::Error::new(
                ErrorKind::UnexpectedEof,
                "the device hung up",
            )),
            Ok(length) => {
                self.receiver.received(length);
                Ok(())
            }
            Err(error) => match error.kind() {
                ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted => Ok(()),
                _ => Err(error),
            },
        }
    }
}

impl DeviceHello {
    fn of(hello: &Hello<'_>) -> Self {
        Self {
            board: hello.board.to_owned(),
            firmware: hello.firmware.to_owned(),
            active: hello.active,
            task: hello.task.as_str().to_owned(),
            slots: hello.slots,
            slot_bytes: hello.slot_bytes,
            work_hz: hello.work_hz,
        }
    }
}

/// The number before the first of a session. Sessions begin at different numbers, so that an old reply is taken for a new one
/// as seldom as can be.
fn before(session: u32) -> u16 {
    (session as u16).wrapping_sub(1)
}

/// Whether this can be a reply to that request, rather than something that was said to another host or without being asked.
fn may_answer(request: &Request<'_>, message: &[u8]) -> bool {
    match (request, parse(message)) {
        (Request::Hello { session, .. }, Some(Reply::Hello(hello))) => hello.session == *session,
        (Request::Hello { .. }, _) => version(message).is_some(),
        (Request::Tick { .. }, _) => true,
        (_, reply) => !matches!(reply, Some(Reply::Silent(_))),
    }
}

/// A message of this version, and nothing behind it.
fn parse(message: &[u8]) -> Option<Reply<'_>> {
    match postcard::take_from_bytes(message) {
        Ok((Reply::Hello(hello), _)) if hello.protocol != PROTOCOL_VERSION => None,
        Ok((reply, [])) => Some(reply),
        _ => None,
    }
}

/// The version in a greeting that is not of this one: the only thing of it that may be believed.
fn version(message: &[u8]) -> Option<u16> {
    match postcard::take_from_bytes::<(u8, u16)>(message) {
        Ok(((0, version), _)) if version != PROTOCOL_VERSION => Some(version),
        _ => None,
    }
}
