//! Sending an artefact into the slot that does not fly.

use std::io::{Read, Write};

use super::{Connection, RemoteError};
use crate::device::frame::CHUNK_LENGTH;
use crate::device::message::{FlashBegin, Reply, Request};
use crate::device::slots::SlotReport;

/// Where the checksum is in an artefact's header.
const CHECKSUM_AT: usize = 12;

/// How far the sending of an artefact is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    /// Bytes in the slot.
    pub sent: usize,
    /// Bytes of the artefact.
    pub total: usize,
}

/// What a device says of an artefact that flies from now on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Flashed {
    /// Its slot.
    pub slot: u8,
    /// The checksum in its header.
    pub checksum: u32,
}

/// Sends `artefact` to the device, which judges it and flies it from now on. `progress` hears of every chunk.
///
/// Whatever goes wrong on the way, the policy that flew before flies on.
///
/// # Errors
/// When the device cannot be reached, or refuses the artefact; the refusal says why. Or when the device does not fly it
/// although it says so.
pub fn flash<S: Read + Write>(
    connection: &mut Connection<S>,
    artefact: &[u8],
    accept_other_contract: bool,
    mut progress: impl FnMut(Progress),
) -> Result<Flashed, RemoteError> {
    let total = artefact.len();
    let checksum = artefact.get(CHECKSUM_AT..).and_then(<[u8]>::first_chunk);
    let announced = checksum.map(|bytes| u32::from_le_bytes(*bytes));
    let begin = Request::FlashBegin(FlashBegin {
        // What does not fit 32 bits fits no device either, and is refused as that.
        length: u32::try_from(total).unwrap_or(u32::MAX),
        checksum: announced.unwrap_or(0),
        accept_other_contract,
    });
    done(connection, "announce the artefact", &begin)?;
    let mut sent = 0;
    progress(Progress { sent, total });
    for bytes in artefact.chunks(CHUNK_LENGTH) {
        let offset = sent as u32;
        let data = Request::FlashData { offset, bytes };
        done(connection, "send the artefact", &data)?;
        sent += bytes.len();
        progress(Progress { sent, total });
    }
    let asked = "put the artefact into service";
    let flashed = match connection.ask(asked, &Request::FlashCommit)? {
        Reply::Flashed { slot, checksum } => Flashed { slot, checksum },
        _ => return Err(RemoteError::Unexpected { asked }),
    };
    connection.greet()?;
    let slot = connection.hello().slots.get(usize::from(flashed.slot));
    match slot {
        Some(SlotReport::Active { checksum }) if Some(*checksum) == announced => Ok(flashed),
        _ => Err(RemoteError::NotFlying),
    }
}

fn done<S: Read + Write>(
    connection: &mut Connection<S>,
    asked: &'static str,
    request: &Request<'_>,
) -> Result<(), RemoteError> {
    match connection.ask(asked, request)? {
        Reply::Done => Ok(()),
        _ => Err(RemoteError::Unexpected { asked }),
    }
}
