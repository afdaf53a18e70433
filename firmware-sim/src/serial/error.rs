//! Why a serial port could not be had, or why it is gone.

use std::fs;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

use thiserror::Error;

use crate::exit::ExitCode;
use crate::remote::NoLink;

/// How the names of ports begin, of USB and of a board computer's own pins, on Linux and on macOS.
const NAMES: [&str; 5] = ["ttyACM", "ttyUSB", "ttyAMA", "cu.usb", "cu.wchusb"];

/// What went wrong with a serial port.
#[derive(Debug, Error)]
pub enum SerialError {
    /// There is none of this name.
    #[error("open the serial port {path}: there is no such port; {there}")]
    Missing {
        /// The port.
        path: PathBuf,
        /// Those that there are.
        there: String,
    },
    /// It belongs to a group that this user is not in.
    #[error(
        "open the serial port {path}: {source}; join the group that owns it (on Debian and Ubuntu: sudo usermod -aG dialout \
         $USER) and log in again"
    )]
    Denied {
        /// The port.
        path: PathBuf,
        /// What the operating system said.
        source: io::Error,
    },
    /// Another program has it.
    #[error(
        "open the serial port {path}: another program uses it; close that one (`fuser -v {path}` names it), or name another \
         port"
    )]
    InUse {
        /// The port.
        path: PathBuf,
    },
    /// It is something else.
    #[error(
        "open the serial port {path}: it is no serial port and is left alone; name one such as /dev/ttyACM0"
    )]
    NoPort {
        /// What was named.
        path: PathBuf,
    },
    /// It runs at other speeds.
    #[error(
        "set the serial port {path} to {baud} baud: it runs at {found} instead; name a speed with --baud that both it and the \
         board have, such as 115200"
    )]
    Speed {
        /// The port.
        path: PathBuf,
        /// What was asked for.
        baud: u32,
        /// What the port made of it.
        found: u32,
    },
    /// The operating system does not open it or set it up.
    #[error("open the serial port {path}: {source}; unplug the board, plug it in, and try again")]
    Open {
        /// The port.
        path: PathBuf,
        /// What the operating system said.
        source: io::Error,
    },
    /// It was unplugged, or the board took its USB away.
    #[error(
        "talk to the board at {path}: its port is gone; plug it in, or see why it was reset, and run the command again: what \
         flew before flies on"
    )]
    Unplugged {
        /// The port.
        path: PathBuf,
    },
    /// Nobody takes what is sent.
    #[error(
        "talk to the board at {path}: its port takes no bytes any more; is the board running? Reset it and run the command again"
    )]
    Stuck {
        /// The port.
        path: PathBuf,
    },
    /// The person asked to stop.
    #[error("talk to the board at {path}: stopped on request")]
    Interrupted {
        /// The port.
        path: PathBuf,
    },
}

impl SerialError {
    /// What it means that a port cannot be opened.
    pub(super) fn opening(path: &Path, source: io::Error) -> Self {
        let path = path.to_owned();
        match source.kind() {
            ErrorKind::NotFound => Self::Missing {
                path,
                there: ports(),
            },
            ErrorKind::PermissionDenied => Self::Denied { path, source },
            ErrorKind::ResourceBusy | ErrorKind::WouldBlock => Self::InUse { path },
            _ => Self::Open { path, source },
        }
    }

    /// How a command ends that fails with this error.
    #[must_use]
    pub const fn exit_code(&self) -> ExitCode {
        match self {
            Self::NoPort { .. } | Self::Speed { .. } => ExitCode::Usage,
            Self::InUse { .. } => ExitCode::Busy,
            Self::Interrupted { .. } => ExitCode::Interrupted,
            Self::Missing { .. }
            | Self::Denied { .. }
            | Self::Open { .. }
            | Self::Unplugged { .. }
            | Self::Stuck { .. } => ExitCode::Environment,
        }
    }
}

impl From<SerialError> for NoLink {
    fn from(error: SerialError) -> Self {
        Self::new(error.exit_code(), error)
    }
}

/// The ports of this machine, in words.
fn ports() -> String {
    let names = fs::read_dir("/dev").into_iter().flatten().flatten();
    let mut names: Vec<String> = names
        .filter_map(|entry| entry.file_name().into_string().ok())
        .filter(|name| NAMES.iter().any(|it| name.starts_with(it)))
        .map(|name| format!("/dev/{name}"))
        .collect();
    names.sort();
    match names.is_empty() {
        true => "this machine has none of USB: is the board plugged in?".to_owned(),
        false => format!("this machine has {}", names.join(", ")),
    }
}
