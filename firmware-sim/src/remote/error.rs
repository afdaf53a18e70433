//! Why a device could not be talked to, or would not do what it was asked.

use std::io;
use std::time::Duration;

use thiserror::Error;

use super::NoLink;
use crate::device::message::Refusal;
use crate::exit::ExitCode;

/// Why a request to a device failed.
#[derive(Debug, Error)]
pub enum RemoteError {
    /// The link broke, nobody knows why.
    #[error("talk to the device: {0}")]
    Link(#[source] io::Error),
    /// There is no link, or none any more, and whoever provides it knows why.
    #[error(transparent)]
    NoLink(#[from] NoLink),
    /// No answer came, however often the request was sent.
    #[error(
        "{asked}: no answer from the device after {tries} tries of {} ms; is it running, and is this its link, at its speed?",
        timeout.as_millis()
    )]
    Silent {
        /// What it was asked to do.
        asked: &'static str,
        /// How often.
        tries: u32,
        /// How long each try waited.
        timeout: Duration,
    },
    /// The device speaks another version of the protocol.
    #[error(
        "greet the device: it speaks version {device} of the protocol and this program version {host}; use the two of one release"
    )]
    Version {
        /// The version of this program.
        host: u16,
        /// The version of the device.
        device: u16,
    },
    /// The device answered something else than what was asked.
    #[error("{asked}: the device answered something else; is this the link of a controller?")]
    Unexpected {
        /// What it was asked to do.
        asked: &'static str,
    },
    /// A message is longer than a frame.
    #[error("{asked}: the message is too long for a frame; fly an artefact with fewer channels")]
    TooLong {
        /// What it was asked to do.
        asked: &'static str,
    },
    /// The device took an artefact and flies another one.
    #[error(
        "put the artefact into service: the device took it and flies another one; send it again, and if that does not help, \
         its flash is broken"
    )]
    NotFlying,
    /// The device did not do it, for a reason of its own.
    #[error("{asked}: the device refused, {refusal}")]
    Refused {
        /// What it was asked to do.
        asked: &'static str,
        /// Why not.
        refusal: Refusal,
    },
}

impl RemoteError {
    /// How a command ends that fails with this error.
    #[must_use]
    pub fn exit_code(&self) -> ExitCode {
        match self {
            Self::NoLink(reason) => reason.exit_code(),
            Self::Link(_)
            | Self::Silent { .. }
            | Self::Version { .. }
            | Self::Unexpected { .. }
            | Self::NotFlying => ExitCode::Environment,
            Self::TooLong { .. } => ExitCode::BadInput,
            Self::Refused { refusal, .. } => match refusal {
                Refusal::Golden { .. } => ExitCode::Faulted,
                Refusal::NoPolicy
                | Refusal::TooLarge { .. }
                | Refusal::Checksum { .. }
                | Refusal::Defect { .. }
                | Refusal::OtherContract
                | Refusal::Undeclared
                | Refusal::CannotScore
                | Refusal::OtherShape => ExitCode::BadInput,
                Refusal::Malformed
                | Refusal::CannotWatch
                | Refusal::NotStarted
                | Refusal::NotAnnounced
                | Refusal::Offset { .. }
                | Refusal::Flash => ExitCode::Environment,
            },
        }
    }
}

impl From<io::Error> for RemoteError {
    fn from(error: io::Error) -> Self {
        match error.downcast() {
            Ok(reason) => Self::NoLink(reason),
            Err(error) => Self::Link(error),
        }
    }
}
