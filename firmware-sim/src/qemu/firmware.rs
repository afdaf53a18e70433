//! Finds the image of a board, and builds it where the sources are.

use std::env;
use std::io;
use std::panic;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use rustix::process::{Pid, Signal, kill_process};

use super::{Board, QemuError};
use crate::interrupt;
use crate::progress::Audience;

/// Names a folder with images, `BOARD.elf`, if they are not to be built.
pub const FIRMWARE_VARIABLE: &str = "TED_FIRMWARE";

pub(super) const SCRIPT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/firmware/build.sh");

/// An image that is the newest takes less to find out; a build is worth a word.
const UNNOTICED: Duration = Duration::from_secs(2);

/// How soon the end of a build, or a request to stop, is noticed.
const SLICE: Duration = Duration::from_millis(20);

/// The image of a board.
#[derive(Clone, Debug)]
pub struct Firmware {
    board: Board,
    path: PathBuf,
}

impl Firmware {
    /// The image in the folder named by `TED_FIRMWARE`, or else the one that the sources of this program give: it is built
    /// if it is not there or not the newest, which takes a minute the first time and which the audience is told.
    ///
    /// # Errors
    /// When it is not there or cannot be built, or the person asked to stop.
    pub fn find(board: Board, audience: Audience) -> Result<Self, QemuError> {
        let folder = env::var_os(FIRMWARE_VARIABLE).filter(|named| !named.is_empty());
        let path = match folder {
            Some(folder) => Path::new(&folder).join(format!("{board}.elf")),
            None => build(board, audience)?,
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
fn build(board: Board, audience: Audience) -> Result<PathBuf, QemuError> {
    let script = Path::new(SCRIPT);
    if !script.is_file() {
        return Err(QemuError::NoSources { board });
    }
    let failed = |source| QemuError::Script {
        script: script.to_owned(),
        source,
    };
    let child = Command::new(script)
        .arg(board.name())
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .map_err(failed)?;
    let output = wait(child, board, audience)?.map_err(failed)?;
    // Ctrl-C reaches the script as well, which then fails.
    if interrupt::requested() {
        return Err(QemuError::BuildInterrupted { board });
    }
    let said = String::from_utf8_lossy(&output.stdout);
    match said.lines().last() {
        Some(path) if output.status.success() => Ok(PathBuf::from(path)),
        _ => Err(QemuError::NotBuilt {
            board,
            words: String::from_utf8_lossy(&output.stderr).trim().to_owned(),
        }),
    }
}

/// Waits for the script, and says so if that takes long.
fn wait(child: Child, board: Board, audience: Audience) -> Result<io::Result<Output>, QemuError> {
    let began = Instant::now();
    let process = Pid::from_child(&child);
    let reader = thread::spawn(move || child.wait_with_output());
    let mut told = false;
    while !reader.is_finished() {
        if interrupt::requested() {
            // It is gone if this fails. What the compiler wrote by then is used the next time.
            kill_process(process, Signal::TERM).ok();
            return Err(QemuError::BuildInterrupted { board });
        }
        if !told && began.elapsed() > UNNOTICED {
            audience.note(&format!(
                "building the firmware of {board}, which takes a minute the first time"
            ));
            told = true;
        }
        thread::sleep(SLICE);
    }
    Ok(match reader.join() {
        Ok(output) => output,
        Err(panic) => panic::resume_unwind(panic),
    })
}
