//! TensorBoard event files: TFRecord framing around `Event` messages that carry scalar summaries.
//!
//! A row is `u64 length, u32 masked CRC-32C of the length, payload, u32 masked CRC-32C of the payload`, all little-endian
//! (tensorflow `core/lib/io/record_writer.h`, `core/util/event.proto`).

use std::fs::{File, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

use serde_json::{Map, Value};

use firmware_sim::disk::WriteError;

use crate::protobuf::Message;

/// Writes scalars that TensorBoard shows as curves.
#[derive(Debug)]
pub struct EventWriter {
    file: File,
    path: PathBuf,
}

impl EventWriter {
    /// Starts an event file in a folder, under a name that no other one there has; TensorBoard joins them by step.
    ///
    /// # Errors
    /// When the file cannot be created.
    pub fn create(folder: &Path, name: &str) -> Result<Self, WriteError> {
        let path = folder.join(format!("events.out.tfevents.{name}.ted"));
        let file = OpenOptions::new()
            .write(true)
            .create(true)
            .truncate(true)
            .open(&path)
            .map_err(|source| WriteError::at(&path, source))?;
        let mut writer = Self { file, path };
        // Event { wall_time = 1; file_version = 3 }
        writer.record(&event().text(3, "brain.Event:2").encoded())?;
        Ok(writer)
    }

    /// Writes every number of a row of metrics under `phase/name`.
    ///
    /// # Errors
    /// When the disk is full or fails.
    pub fn push(
        &mut self,
        phase: &str,
        step: u64,
        row: &Map<String, Value>,
    ) -> Result<(), WriteError> {
        // Summary { repeated Value value = 1 }, Value { string tag = 1; float simple_value = 2 }
        let mut summary = Message::new();
        for (name, value) in row.iter().filter(|(name, _)| *name != "step") {
            if let Some(number) = value.as_f64() {
                let tag = Message::new().text(1, &format!("{phase}/{name}"));
                summary = summary.message(1, &tag.float(2, number as f32));
            }
        }
        // Event { double wall_time = 1; int64 step = 2; Summary summary = 5 }
        let event = event().integer(2, step).message(5, &summary);
        self.record(&event.encoded())
    }

    fn record(&mut self, payload: &[u8]) -> Result<(), WriteError> {
        let length = (payload.len() as u64).to_le_bytes();
        let record = [
            &length[..],
            &masked_crc32c(&length).to_le_bytes(),
            payload,
            &masked_crc32c(payload).to_le_bytes(),
        ]
        .concat();
        self.file
            .write_all(&record)
            .map_err(|source| WriteError::at(&self.path, source))
    }
}

/// An event of this moment, in seconds since 1970.
fn event() -> Message {
    let seconds = SystemTime::now()
        .duration_since(UNIX_EPOCH)
        .map_or(0.0, |d| d.as_secs_f64());
    Message::new().double(1, seconds)
}

fn masked_crc32c(data: &[u8]) -> u32 {
    let mut crc = !0u32;
    for &byte in data {
        crc ^= u32::from(byte);
        for _ in 0..8 {
            crc = crc >> 1 ^ if crc & 1 == 1 { 0x82F6_3B78 } else { 0 };
        }
    }
    (!crc).rotate_right(15).wrapping_add(0xA282_EAD8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_checksum_is_crc_32c() {
        // CRC-32C of "123456789" is 0xE3069283 (RFC 3720, appendix B.4 polynomial).
        let unmasked = masked_crc32c(b"123456789")
            .wrapping_sub(0xA282_EAD8)
            .rotate_left(15);
        assert_eq!(unmasked, 0xE306_9283);
    }

    /// The payloads of a file whose frames are whole, each without the wall time that it begins with.
    fn payloads(mut rest: &[u8]) -> Vec<Vec<u8>> {
        const WALL_TIME: usize = 9;
        let mut payloads = Vec::new();
        while let Some((length, after)) = rest.split_first_chunk::<8>() {
            let (length_crc, after) = after.split_first_chunk().unwrap();
            assert_eq!(u32::from_le_bytes(*length_crc), masked_crc32c(length));
            let (payload, after) = after.split_at(u64::from_le_bytes(*length) as usize);
            let (payload_crc, after) = after.split_first_chunk().unwrap();
            assert_eq!(u32::from_le_bytes(*payload_crc), masked_crc32c(payload));
            let seconds = f64::from_le_bytes(payload[1..WALL_TIME].try_into().unwrap());
            assert_eq!(payload[0], 0x09);
            assert!(seconds > 1.7e9, "{seconds}");
            payloads.push(payload[WALL_TIME..].to_vec());
            rest = after;
        }
        payloads
    }

    #[test]
    fn a_file_holds_the_version_and_every_number_as_tensorboard_reads_them() {
        let folder = tempfile::tempdir().unwrap();
        let mut writer = EventWriter::create(folder.path(), "0000000007").unwrap();
        let row = serde_json::json!({ "phase": "iql", "step": 300, "loss": 0.5 });
        writer.push("iql", 300, row.as_object().unwrap()).unwrap();
        let path = folder.path().join("events.out.tfevents.0000000007.ted");
        let bytes = std::fs::read(path).unwrap();
        // How the files of TensorFlow itself begin: a length of 24 and its checksum.
        assert_eq!(bytes[..12], *b"\x18\0\0\0\0\0\0\0\xa3\x7fK\"");
        let version = b"\x1a\x0dbrain.Event:2";
        // step = 300; summary { value { tag = "iql/loss"; simple_value = 0.5 } }
        let row = b"\x10\xac\x02\x2a\x11\x0a\x0f\x0a\x08iql/loss\x15\0\0\0\x3f";
        assert_eq!(payloads(&bytes), [version.to_vec(), row.to_vec()]);
    }
}
