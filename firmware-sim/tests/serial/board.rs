//! A board behind a pseudo-terminal, and the command that is run beside it.

use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{self, JoinHandle};

use embedded_io::{ErrorType, Read, ReadReady, Write};
use firmware_sim::bench::{HostBoard, MemoryFlash, Pty};
use firmware_sim::device::serve;
use serde_json::Value;

/// Bytes of a board's flash: two slots of four sectors.
pub const FLASH_BYTES: usize = 8 * 4096;

/// A running board.
pub struct Board {
    name: String,
    pulled: Arc<AtomicBool>,
    thread: JoinHandle<MemoryFlash>,
}

impl Board {
    /// Starts a board with this flash.
    pub fn power_on(flash: MemoryFlash) -> Self {
        Self::power_on_for(flash, usize::MAX)
    }

    /// The same; it is unplugged when it has read so many bytes.
    pub fn power_on_for(mut flash: MemoryFlash, bytes: usize) -> Self {
        let pty = Pty::open().unwrap();
        let name = format!("serial:{}", pty.path().display());
        let pulled = Arc::new(AtomicBool::new(false));
        let cord = Cord {
            pty,
            pulled: Arc::clone(&pulled),
            left: bytes,
        };
        let thread = thread::spawn(move || {
            serve(cord, &mut flash, &mut HostBoard::new());
            flash
        });
        Self {
            name,
            pulled,
            thread,
        }
    }

    /// What `--on` calls it.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Stops it, and takes the flash out.
    pub fn power_off(self) -> MemoryFlash {
        self.pulled.store(true, Ordering::Relaxed);
        self.thread.join().unwrap()
    }
}

/// A pseudo-terminal that can be unplugged.
struct Cord {
    pty: Pty,
    pulled: Arc<AtomicBool>,
    left: usize,
}

impl Cord {
    fn is_pulled(&self) -> bool {
        self.left == 0 || self.pulled.load(Ordering::Relaxed)
    }
}

impl ErrorType for Cord {
    type Error = embedded_io::ErrorKind;
}

impl ReadReady for Cord {
    fn read_ready(&mut self) -> Result<bool, Self::Error> {
        Ok(self.pty.read_ready()? || self.is_pulled())
    }
}

impl Read for Cord {
    fn read(&mut self, room: &mut [u8]) -> Result<usize, Self::Error> {
        if self.is_pulled() {
            return Ok(0);
        }
        let read = self.pty.read(room)?;
        self.left = self.left.saturating_sub(read);
        Ok(read)
    }
}

impl Write for Cord {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, Self::Error> {
        self.pty.write(bytes)
    }

    fn flush(&mut self) -> Result<(), Self::Error> {
        self.pty.flush()
    }
}

/// The command, not yet started.
pub fn command(folder: &Path, args: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_firmware-sim"));
    command.current_dir(folder).args(args).stdin(Stdio::null());
    command
}

/// Runs a command that must end with `code`; what it said, result and errors.
pub fn run(folder: &Path, code: i32, args: &[&str]) -> String {
    let output = command(folder, args).output().unwrap();
    let text = String::from_utf8([output.stdout, output.stderr].concat()).unwrap();
    assert_eq!(output.status.code(), Some(code), "{args:?}: {text}");
    text
}

/// The same, for a machine.
pub fn json(folder: &Path, code: i32, args: &[&str]) -> Value {
    serde_json::from_str(&run(folder, code, &[args, &["--json"]].concat())).unwrap()
}

/// A folder with the toy's artefact, `toy.ted`.
pub fn folder_with_toy() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    run(folder.path(), 0, &["toy", "toy.ted"]);
    folder
}
