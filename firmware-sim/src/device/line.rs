//! The device's end of the link: whole requests, each once and in order, and the last reply kept for whoever missed it.

use embedded_io::{Read, ReadReady, Write};
use ted_policy::decode;

use super::counters::count;
use super::frame::{self, MAX_FRAME, MAX_REPLY_FRAME};
use super::message::{PROTOCOL_VERSION, Refusal, Reply, Request};
use super::{Board, Counters, Receiver};

/// Half of all numbers: a number less than that ahead is newer, any other is older.
const AHEAD: u16 = 1 << 15;

/// What happened on the line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Event {
    /// A new request is in [`Line::request`].
    Request,
    /// Nothing came for too long.
    Silence,
    /// The other end is gone for good.
    Closed,
}

/// How long a line may be silent.
#[derive(Debug)]
pub(super) struct Patience {
    until_us: u64,
    /// Bytes that may still be read when that time has come: what had arrived by then, but not a line that never rests.
    late: usize,
}

impl Patience {
    /// From now on, on the board's clock.
    pub(super) fn new(board: &mut impl Board, limit_us: u32) -> Self {
        Self {
            until_us: board.now_us().saturating_add(u64::from(limit_us)),
            late: 2 * MAX_FRAME,
        }
    }

    /// Whether it has ended, now that so many bytes were read.
    fn has_ended(&mut self, board: &mut impl Board, read: usize) -> bool {
        if board.now_us() < self.until_us {
            return false;
        }
        let left = self.late.checked_sub(read);
        self.late = left.unwrap_or(0);
        read == 0 || left.is_none()
    }
}

/// The line and its two buffers.
#[derive(Debug)]
pub(super) struct Line<L> {
    link: L,
    receiver: Receiver,
    reply: [u8; MAX_REPLY_FRAME],
    reply_length: usize,
    last_number: Option<u16>,
    session: Option<u32>,
    /// The session before, whose greeting may still be on its way.
    old_session: Option<u32>,
    pub(super) counters: Counters,
}

impl<L: Read + ReadReady + Write> Line<L> {
    pub(super) fn new(link: L) -> Self {
        Self {
            link,
            receiver: Receiver::new(),
            reply: [0; MAX_REPLY_FRAME],
            reply_length: 0,
            last_number: None,
            session: None,
            old_session: None,
            counters: Counters::default(),
        }
    }

    /// Waits for a request that is to be acted on, for as long as there is patience, if that is limited. Repeated requests
    /// are answered here, old and broken ones dropped.
    pub(super) fn wait(
        &mut self,
        board: &mut impl Board,
        mut patience: Option<&mut Patience>,
    ) -> Event {
        loop {
            while self.receiver.advance(&mut self.counters) {
                if self.is_next() {
                    return Event::Request;
                }
            }
            let Some(read) = self.read() else {
                return Event::Closed;
            };
            // Asked after the reading: bytes that are here already are no silence.
            if let Some(patience) = &mut patience
                && patience.has_ended(board, read)
            {
                return Event::Silence;
            }
            if read == 0 {
                board.idle();
            }
        }
    }

    /// Reads what there is, and says how much that was; nothing when the other end is gone.
    fn read(&mut self) -> Option<usize> {
        let read = match self.link.read_ready() {
            Ok(true) => {
                let room = self.receiver.room(&mut self.counters);
                self.link.read(room)
            }
            Ok(false) => return Some(0),
            Err(error) => Err(error),
        };
        match read {
            Ok(0) => return None,
            Ok(length) => self.receiver.received(length),
            Err(_) => count(&mut self.counters.link_errors),
        }
        Some(read.unwrap_or(0))
    }

    /// The request that [`Self::wait`] found.
    #[inline(never)]
    pub(super) fn request(&self) -> Request<'_> {
        let message = self.receiver.body().message;
        // Of a greeting of another version nothing is known but that it is one.
        let unread = Request::Hello {
            protocol: 0,
            session: 0,
        };
        parse(message)
            .filter(|_| !is_foreign(message))
            .unwrap_or(unread)
    }

    /// The number of the last request.
    pub(super) fn number(&self) -> u16 {
        self.last_number.unwrap_or(0)
    }

    /// Answers the last request, and keeps the answer.
    // By value: a constant that is borrowed would lie in flash, all 136 bytes of it.
    pub(super) fn reply(&mut self, reply: Reply<'_>) {
        let number = self.number();
        self.reply_length = frame::build(&mut self.reply, number, &reply).unwrap_or_else(|| {
            count(&mut self.counters.link_errors);
            0
        });
        self.send_reply();
    }

    /// Answers the greeting at hand. One of another version is answered and forgotten: nothing else about its sender may be
    /// believed.
    pub(super) fn greet(&mut self, hello: Reply<'_>) {
        let body = self.receiver.body();
        match is_foreign(body.message) {
            true => self.say_aside(body.number, &hello),
            false => self.reply(hello),
        }
    }

    /// Says something about the request of this number without being asked. If that is the last request, it is from now on
    /// the answer to it.
    pub(super) fn tell(&mut self, number: u16, reply: Reply<'_>) {
        if number == self.number() {
            self.reply(reply);
        } else {
            self.say_aside(number, &reply);
        }
    }

    /// Says something and does not keep it.
    #[inline(never)]
    fn say_aside(&mut self, number: u16, reply: &Reply<'_>) {
        let mut buffer = [0; MAX_REPLY_FRAME];
        match frame::build(&mut buffer, number, reply).and_then(|length| buffer.get(..length)) {
            Some(frame) => send(&mut self.link, frame, &mut self.counters),
            None => count(&mut self.counters.link_errors),
        }
    }

    fn send_reply(&mut self) {
        let frame = self.reply.get(..self.reply_length).unwrap_or_default();
        send(&mut self.link, frame, &mut self.counters);
    }

    /// Whether the received frame is to be acted on.
    fn is_next(&mut self) -> bool {
        let body = self.receiver.body();
        if is_foreign(body.message) {
            return true;
        }
        let (number, request) = (body.number, parse(body.message));
        if let Some(Request::Hello { session, .. }) = request
            && self.session != Some(session)
        {
            if self.old_session == Some(session) {
                count(&mut self.counters.reordered);
                return false;
            }
            self.old_session = self.session.replace(session);
            self.last_number = Some(number);
            return true;
        }
        match self.last_number.map(|last| number.wrapping_sub(last)) {
            Some(0) => {
                count(&mut self.counters.duplicates);
                self.send_reply();
                return false;
            }
            Some(AHEAD..) => {
                count(&mut self.counters.reordered);
                return false;
            }
            Some(ahead) => {
                let dropped = u32::from(ahead) - 1;
                self.counters.dropped = self.counters.dropped.saturating_add(dropped);
            }
            None => {}
        }
        self.last_number = Some(number);
        if request.is_none() {
            count(&mut self.counters.malformed);
            self.reply(Reply::Refused(Refusal::Malformed));
            return false;
        }
        true
    }
}

/// Sends all of it, or counts an error: the host will ask again. (`write_all` panics at a driver that takes nothing.)
fn send(link: &mut impl Write, mut frame: &[u8], counters: &mut Counters) {
    while !frame.is_empty() {
        match link.write(frame) {
            Ok(length @ 1..) => frame = frame.get(length..).unwrap_or_default(),
            Ok(0) | Err(_) => return count(&mut counters.link_errors),
        }
    }
    if link.flush().is_err() {
        count(&mut counters.link_errors);
    }
}

/// Whether this is a greeting of another version, whatever follows.
fn is_foreign(message: &[u8]) -> bool {
    // A varint of this version is one byte; that of another version begins with another one.
    const { assert!(PROTOCOL_VERSION < 0x80) }
    matches!(message, [0, version, ..] if *version != PROTOCOL_VERSION as u8)
}

/// A message of this protocol, and nothing behind it.
fn parse(message: &[u8]) -> Option<Request<'_>> {
    let mut rest = message;
    decode(&mut rest).filter(|_| rest.is_empty())
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(4096))]

        #[test]
        fn any_request_is_read_as_postcard_reads_it(
            variant in 0..12_u8,
            rest in prop::collection::vec(prop_oneof![2 => 0..4_u8, 1 => any::<u8>(), 1 => 0x7e..=0x81_u8], 0..24),
        ) {
            let message = [&[variant][..], &rest].concat();
            let expected = match postcard::take_from_bytes(&message) {
                Ok((request, [])) => Some(request),
                _ => None,
            };
            prop_assert_eq!(parse(&message), expected);
        }
    }
}
