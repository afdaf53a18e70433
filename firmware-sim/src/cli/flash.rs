//! `firmware-sim flash`: another policy for a board.

use std::path::PathBuf;

use clap::Args;
use serde::Serialize;

use super::artefact;
use super::boards::BoardArgs;
use super::on::On;
use crate::exit::ExitCode;
use crate::failure::Failure;
use crate::interrupt;
use crate::output::OutputArgs;
use crate::remote::flash;

const EXAMPLES: &str = "\
Examples:
  firmware-sim flash policy.ted --on mps2-an386 --flash-image robot.flash
  firmware-sim fly policy.ted --task drawer-open-v3 --on mps2-an386 --flash-image robot.flash
  firmware-sim flash policy.ted --on serial:/dev/ttyACM0
  firmware-sim flash policy.ted --on serial:/dev/ttyUSB0 --baud 115200 --accept-other-contract

The board writes the artefact into the slot that does not fly, and flies it once it has found it good: checksum, contract, \
golden vectors in all numbers. Whatever happens before that, a power cut included, the policy that flew before flies on.

Exit codes: 0 it flies, 2 usage, 3 the artefact is broken or has another contract, or the file is no flash, 4 QEMU, the \
firmware or the board is missing or failed, 5 somebody else has the file or the serial port, 6 the file cannot be written, \
7 the board does not compute its golden vectors, 130 interrupted.";

/// Give a board another policy
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct FlashArgs {
    /// The artefact
    policy: PathBuf,
    /// A board that QEMU emulates, mps2-an386, mps2-an500 or mps2-an505, which is a rehearsal without --flash-image; or a
    /// board of your own, serial:PORT, such as serial:/dev/ttyACM0
    #[arg(long, value_name = "WHERE")]
    on: On,
    #[command(flatten)]
    board: BoardArgs,
    /// Take an artefact whose channels, units or control period are not those of the policy that flies
    #[arg(long)]
    accept_other_contract: bool,
    #[command(flatten)]
    output: OutputArgs,
}

/// What the board says.
#[derive(Debug, Serialize)]
struct Flashed {
    board: String,
    slot: u8,
    crc32: String,
    task: String,
    bytes: usize,
    kept: bool,
}

/// Sends the artefact.
pub fn run(args: &FlashArgs) -> Result<ExitCode, Failure> {
    let bytes = artefact::read(&args.policy)?;
    artefact::parse(&bytes, &args.policy)?;
    interrupt::install()
        .map_err(|error| Failure::new(ExitCode::Failure, format_args!("catch Ctrl-C: {error}")))?;
    let audience = args.output.audience();
    let boards = args.board.boards(&args.on, audience)?.ok_or_else(|| {
        Failure::new(
            ExitCode::Usage,
            "this machine has no flash for artefacts: name a board with --on",
        )
    })?;
    let mut connection = boards.connect()?;
    let progress = audience.start("flash", bytes.len() as u64, "bytes");
    let mut shown = 0;
    let done = flash(&mut connection, &bytes, args.accept_other_contract, |now| {
        progress.advance((now.sent - shown) as u64);
        shown = now.sent;
    });
    progress.finish();
    let done = done?;
    let hello = connection.hello();
    let flashed = Flashed {
        board: hello.board.clone(),
        slot: done.slot,
        crc32: format!("{:08x}", done.checksum),
        task: hello.task.clone(),
        bytes: bytes.len(),
        kept: boards.remember(),
    };
    args.output.print(&flashed, || {
        let Flashed {
            board,
            slot,
            crc32,
            task,
            ..
        } = &flashed;
        let kept = match flashed.kept {
            true => "",
            false => {
                "\nthe board is off now and has forgotten it: --flash-image FILE keeps its flash"
            }
        };
        format!("{board} flies {task} from slot {slot}, crc32 {crc32}{kept}")
    })?;
    Ok(ExitCode::Success)
}
