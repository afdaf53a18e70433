//! The boards that there are images for, the links to them, and how QEMU is told about both.

use std::fmt;
use std::path::Path;

use clap::ValueEnum;

/// Instructions in a second of an emulated board's time. Its clock counts instructions, 32 ns each, and nothing else; so
/// what a tick cost follows from the clock, and is the same in every run.
pub const INSTRUCTIONS_PER_SECOND: u64 = 31_250_000;

/// What makes the clock count instructions: each takes 2^5 ns.
const CLOCK: [&str; 2] = ["-icount", "shift=5"];

/// A board that QEMU emulates and that there is an image for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, ValueEnum)]
pub enum Board {
    /// An Arm Cortex-M4 with single-precision floating point.
    #[value(name = "mps2-an386")]
    An386,
    /// An Arm Cortex-M7.
    #[value(name = "mps2-an500")]
    An500,
    /// An Arm Cortex-M33.
    #[value(name = "mps2-an505")]
    An505,
}

impl Board {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::An386, Self::An500, Self::An505];

    /// The name of the board, of its machine in QEMU, and of its image.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::An386 => "mps2-an386",
            Self::An500 => "mps2-an500",
            Self::An505 => "mps2-an505",
        }
    }

    /// What QEMU is told: no devices but the board's own, and where the flash for artefacts keeps its bytes.
    pub(super) fn arguments(self, flash_image: Option<&Path>) -> Vec<String> {
        let mut arguments: Vec<String> = ["-nodefaults", "-no-user-config", "-display", "none"]
            .into_iter()
            .chain(["-monitor", "none"])
            .chain(CLOCK)
            .map(str::to_owned)
            .collect();
        let mut machine = self.name().to_owned();
        if let Some(path) = flash_image {
            // A comma in a path is doubled, or it would end it.
            let path = path.display().to_string().replace(',', ",,");
            let object =
                format!("memory-backend-file,id=slots,size={FLASH_BYTES},share=on,mem-path={path}");
            arguments.extend(["-object".to_owned(), object]);
            machine += ",memory-backend=slots";
        }
        arguments.extend(["-machine".to_owned(), machine]);
        arguments
    }
}

/// The flash for artefacts, as large as the memory that plays it.
pub(super) const FLASH_BYTES: u64 = 16 << 20;

impl fmt::Display for Board {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// How bytes get to a board and back. Either way they come through QEMU's standard streams.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Link {
    /// Blocks of bytes through QEMU's semihosting: fast, and the board's time stands still while it waits
    #[default]
    Fifo,
    /// The board's serial port, byte by byte with an interrupt for each: slow, and as it is on hardware
    Uart,
}

impl Link {
    pub(super) const fn arguments(self) -> &'static [&'static str] {
        match self {
            Self::Fifo => &[
                "-semihosting-config",
                "enable=on,target=native,arg=fifo,arg=/dev/stdin,arg=/dev/stdout",
            ],
            Self::Uart => &[
                "-chardev",
                "stdio,id=link,signal=off",
                "-serial",
                "chardev:link",
            ],
        }
    }
}

impl fmt::Display for Link {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Fifo => "fifo",
            Self::Uart => "uart",
        })
    }
}

/// What so many ticks of a board's counter are in instructions, at `work_hz` ticks a second of its time; 0 if that is not
/// known.
#[must_use]
pub fn instructions(ticks: f64, work_hz: u32) -> f64 {
    if work_hz == 0 {
        return 0.0;
    }
    ticks * INSTRUCTIONS_PER_SECOND as f64 / f64::from(work_hz)
}
