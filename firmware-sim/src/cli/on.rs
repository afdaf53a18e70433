//! What `--on` names: this machine, an emulated board, or a board of one's own.

use std::fmt;
use std::path::PathBuf;
use std::str::FromStr;

use thiserror::Error;

use crate::qemu::Board;

/// How a serial port is named, before its path.
const SERIAL: &str = "serial:";

/// What may fly.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum On {
    /// This machine.
    Host,
    /// A board that QEMU emulates.
    Emulated(Board),
    /// The board at a serial port.
    Serial(PathBuf),
}

/// There is no such thing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error(
    "there are host, {}, and serial:PORT for a board of your own, such as serial:/dev/ttyACM0",
    Board::ALL.map(Board::name).join(", ")
)]
pub struct UnknownOn;

impl FromStr for On {
    type Err = UnknownOn;

    fn from_str(text: &str) -> Result<Self, UnknownOn> {
        if let Some(path) = text.strip_prefix(SERIAL).filter(|path| !path.is_empty()) {
            return Ok(Self::Serial(path.into()));
        }
        let mut boards = Board::ALL.into_iter();
        match boards.find(|board| board.name() == text) {
            Some(board) => Ok(Self::Emulated(board)),
            None if text == "host" => Ok(Self::Host),
            None => Err(UnknownOn),
        }
    }
}

impl fmt::Display for On {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Host => f.write_str("host"),
            Self::Emulated(board) => board.fmt(f),
            Self::Serial(path) => write!(f, "{SERIAL}{}", path.display()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_named_is_named_so_again() {
        for text in ["host", "mps2-an386", "mps2-an505", "serial:/dev/ttyACM0"] {
            assert_eq!(text.parse::<On>().unwrap().to_string(), text);
        }
    }

    #[test]
    fn a_wrong_name_is_answered_with_those_that_there_are() {
        for text in ["", "mps2", "serial:", "/dev/ttyACM0"] {
            let words = text.parse::<On>().unwrap_err().to_string();
            for part in ["host", "mps2-an386", "mps2-an500", "mps2-an505", "serial:"] {
                assert!(words.contains(part), "{words}");
            }
        }
    }
}
