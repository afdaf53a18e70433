//! Finds the image of a board, and builds it where the sources are.

use std::env;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use super::{Board, QemuError};

/// Names a folder with images, `BOARD.elf`, if they are not to be built.
pub const FIRMWARE_VARIABLE: &str = "TED_FIRMWARE";

pub(super) const SCRIPT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/firmware/build.sh");

/// The image of a board.
#[derive(Clone, Debug)]
pub struct Firmware {
    board: Board,
    path: PathBuf,
}

impl Firmware {
    /// The image in the folder named by `TED_FIRMWARE`, or else the one that the sources of this program give: it is built
    /// if it is not there or not the newest, which takes a minute the first time.
    ///
    /// # Errors
    /// When it is not there or cannot be built.
    pub fn find(board: Board) -> Result<Self, QemuError> {
        let folder = env::var_os(FIRMWARE_VARIABLE).filter(|named| !named.is_empty());
        let path = match folder {
            Some(folder) => Path::new(&folder).join(format!("{board}.elf")),
            None => build(board)?,
        };
        if path.is_file() {
            Ok(Self { board, path })
        } else {
            Err(QemuError::NoImage { path })
        }
    }

    /// The board it is for.
    #[must_use]
    pub const fn board(&self) -> Board {
        self.board
    }

    /// The file.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }
}

/// Runs the script that builds images; the last line it prints is the image's path.
fn build(board: Board) -> Result<PathBuf, QemuError> {
    let script = Path::new(SCRIPT);
    if !script.is_file() {
        return Err(QemuError::NoSources { board });
    }
    let output = Command::new(script)
        .arg(board.name())
        .stdin(Stdio::null())
        .output()
        .map_err(|source| QemuError::Script {
            script: script.to_owned(),
            source,
        })?;
    let said = String::from_utf8_lossy(&output.stdout);
    match said.lines().last() {
        Some(path) if output.status.success() => Ok(PathBuf::from(path)),
        _ => Err(QemuError::NotBuilt {
            board,
            words: String::from_utf8_lossy(&output.stderr).trim().to_owned(),
        }),
    }
}
