//! Finds QEMU, and starts boards in it.

use std::env;
use std::fs::{File, OpenOptions, TryLockError};
use std::io;
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::thread;
use std::time::Duration;

use super::board::FLASH_BYTES;
use super::{Board, Device, Firmware, Link, QemuError};

/// Names the emulator to use, if it is not the one on the path.
pub const EMULATOR_VARIABLE: &str = "TED_QEMU";

const NAME: &str = "qemu-system-arm";

/// The oldest version tried. Older ones may well do.
const OLDEST: u32 = 7;

/// Lets the kernel kill a process when its parent ends; on Linux it comes with the base system. The one of busybox cannot.
const GUARDIAN: [&str; 4] = ["setpriv", "--pdeathsig", "KILL", "--"];

/// A QEMU that can be started.
#[derive(Clone, Debug)]
pub struct Emulator {
    path: PathBuf,
    version: String,
    guarded: bool,
}

impl Emulator {
    /// The one named by `TED_QEMU`, or else `qemu-system-arm` on the path.
    ///
    /// # Errors
    /// When there is none, it does not run, or it is too old.
    pub fn find() -> Result<Self, QemuError> {
        let path = env::var_os(EMULATOR_VARIABLE).filter(|named| !named.is_empty());
        let path = path.map_or_else(|| PathBuf::from(NAME), PathBuf::from);
        let words = first_line(&path).map_err(|source| QemuError::NoEmulator {
            path: path.clone(),
            source,
        })?;
        let version = words
            .rsplit_once("version ")
            .map_or("", |(_, version)| version);
        let major = version.split('.').next().and_then(|it| it.parse().ok());
        match major {
            Some(OLDEST..) => Ok(Self {
                version: version.to_owned(),
                guarded: is_guarding(),
                path,
            }),
            Some(0..OLDEST) | None => Err(QemuError::UnfitEmulator {
                path,
                words,
                oldest: OLDEST,
            }),
        }
    }

    /// How it is called.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Its version, as it says.
    #[must_use]
    pub fn version(&self) -> &str {
        &self.version
    }

    /// Whether a board ends with the thread that started it, also when this process is killed. Where `setpriv` of
    /// util-linux is missing, it ends when it is dropped and not otherwise.
    #[must_use]
    pub const fn is_guarded(&self) -> bool {
        self.guarded
    }

    /// Starts a board. The flash for artefacts is in the file `flash_image`, which is made if it is not there or empty;
    /// without one it forgets everything when the device ends.
    ///
    /// The device ends at the latest with the thread that started it, however that ends, if [`Self::is_guarded`].
    ///
    /// # Errors
    /// When no process can be started, or the file cannot be written, is something else than a flash, or belongs to another
    /// board. What is wrong with it afterwards is found on the first use of the device.
    pub fn start(
        &self,
        firmware: &Firmware,
        link: Link,
        flash_image: Option<&Path>,
    ) -> Result<Device, QemuError> {
        let flash = flash_image.map(lock).transpose()?;
        let mut command = if self.guarded {
            let [program, args @ ..] = GUARDIAN;
            let mut command = Command::new(program);
            command.args(args).arg(&self.path);
            command
        } else {
            Command::new(&self.path)
        };
        let board: Board = firmware.board();
        command
            .args(board.arguments(flash_image))
            .args(link.arguments())
            .arg("-kernel")
            .arg(firmware.path())
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            // Out of the terminal's foreground group: Ctrl-C is the parent's business alone.
            .process_group(0);
        Device::spawn(&mut command, board, flash).map_err(|source| QemuError::Spawn {
            path: self.path.clone(),
            source,
        })
    }
}

/// How often, and after what pause, a lock is tried again: for a second in all.
const PATIENCE: u32 = 100;
const PAUSE: Duration = Duration::from_millis(10);

/// Opens the file of a flash for one board alone, if it is one or new. The lock ends with the board.
fn lock(path: &Path) -> Result<File, QemuError> {
    let open = OpenOptions::new()
        .read(true)
        .write(true)
        .create(true)
        .truncate(false)
        .open(path);
    let failed = |source| QemuError::FlashImage {
        path: path.to_owned(),
        source,
    };
    let file = open.map_err(failed)?;
    let mut locked = file.try_lock();
    for _ in 0..PATIENCE {
        // A process that is being started holds, for a moment, what its parent holds: a lock too that was given back since.
        if !matches!(locked, Err(TryLockError::WouldBlock)) {
            break;
        }
        thread::sleep(PAUSE);
        locked = file.try_lock();
    }
    match locked {
        // The board writes to it from its first artefact on, so it must not be somebody's film.
        Ok(()) => match file.metadata().map_err(failed)?.len() {
            0 | FLASH_BYTES => Ok(file),
            found => Err(QemuError::NoFlashImage {
                path: path.to_owned(),
                found,
            }),
        },
        Err(TryLockError::WouldBlock) => Err(QemuError::FlashInUse {
            path: path.to_owned(),
        }),
        Err(TryLockError::Error(source)) => Err(failed(source)),
    }
}

/// Whether the guardian is there and knows what is asked of it.
fn is_guarding() -> bool {
    let [program, args @ ..] = GUARDIAN;
    let tried = Command::new(program)
        .args(args)
        .arg("true")
        .stdin(Stdio::null())
        .output();
    tried.is_ok_and(|it| it.status.success())
}

/// The first line of what a program says of its version.
fn first_line(program: &Path) -> io::Result<String> {
    let output = Command::new(program)
        .arg("--version")
        .stdin(Stdio::null())
        .output()?;
    let words = String::from_utf8_lossy(&output.stdout);
    Ok(words.lines().next().unwrap_or_default().to_owned())
}
