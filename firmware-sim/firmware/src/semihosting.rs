//! Calls to whatever runs this processor, an emulator or a debugger, if there is one that answers.
//!
//! Where there is none, the instruction that asks is a fault. The fault handler here knows that instruction and answers in
//! the host's place, so one image runs with a host and without.

use core::arch::global_asm;
use core::ffi::CStr;
use core::sync::atomic::{AtomicBool, Ordering};

/// The answer of a host that refuses, and in the place of a host that is not there.
const REFUSED: usize = usize::MAX;

const OPEN: usize = 0x01;
const WRITE_LINE: usize = 0x04;
const WRITE: usize = 0x05;
const READ: usize = 0x06;
const GET_COMMAND_LINE: usize = 0x15;
const EXIT_EXTENDED: usize = 0x20;

const STOPPED_BY_APPLICATION: usize = 0x20026;

/// Whether a host has answered.
static PRESENT: AtomicBool = AtomicBool::new(false);

unsafe extern "C" {
    fn ted_ask_host(operation: usize, argument: *mut usize) -> usize;
}

// The handler is entered by the processor: the first words of the interrupted stack are r0 to r3, r12, lr, pc and xpsr.
global_asm!(
    ".section .text.ted_ask_host, \"ax\"",
    ".global ted_ask_host",
    ".type ted_ask_host, %function",
    ".thumb_func",
    "ted_ask_host:",
    "bkpt 0xab",
    "bx lr",
    ".size ted_ask_host, . - ted_ask_host",
    ".section .text.HardFault, \"ax\"",
    ".global HardFault",
    ".type HardFault, %function",
    ".thumb_func",
    "HardFault:",
    "ldr r0, [sp, #24]",
    "ldr r1, =ted_ask_host",
    "bic r1, r1, #1",
    "cmp r0, r1",
    "it ne",
    "bne ted_halt",
    "adds r0, #2",
    "str r0, [sp, #24]",
    "mvn r0, #0",
    "str r0, [sp]",
    "bx lr",
    ".ltorg",
    ".size HardFault, . - HardFault",
);

/// How a file is opened.
#[derive(Clone, Copy)]
pub enum Mode {
    /// For reading, `rb`.
    Read = 1,
    /// For writing, `wb`.
    Write = 5,
}

/// An open file of the host.
#[derive(Clone, Copy)]
pub struct File(usize);

/// The words that the host was started with for this program, if there is a host and they fit. A zero
/// ends them.
pub fn command_line(into: &mut [u8]) -> Option<&mut [u8]> {
    let mut block = [into.as_mut_ptr() as usize, into.len()];
    // SAFETY: the block names memory that is ours to write, and its length, which the host replaces by that of the words.
    let answer = unsafe { ask(GET_COMMAND_LINE, &mut block) };
    PRESENT.store(answer == 0, Ordering::Relaxed);
    if answer == 0 { Some(into) } else { None }
}

/// Opens a file of the host, by a path that ends with zero.
pub fn open(path: &[u8], mode: Mode) -> Option<File> {
    let [path @ .., 0] = path else { return None };
    let mut block = [path.as_ptr() as usize, mode as usize, path.len()];
    // SAFETY: the block names a path that ends with zero, and its length.
    let handle = unsafe { ask(OPEN, &mut block) };
    (handle != REFUSED).then_some(File(handle))
}

impl File {
    /// Reads at least one byte, and waits for it; none at the end of the file.
    pub fn read(self, into: &mut [u8]) -> usize {
        let mut block = [self.0, into.as_mut_ptr() as usize, into.len()];
        // SAFETY: the block names memory that is ours to write, and its length.
        let left = unsafe { ask(READ, &mut block) };
        into.len().saturating_sub(left)
    }

    /// Writes, and returns how many bytes were taken.
    pub fn write(self, bytes: &[u8]) -> usize {
        let mut block = [self.0, bytes.as_ptr() as usize, bytes.len()];
        // SAFETY: the block names memory that is only read, and its length.
        let left = unsafe { ask(WRITE, &mut block) };
        bytes.len().saturating_sub(left)
    }
}

/// Says something to whoever watches the host, and ends the host's run of this program with this status. Returns if there
/// is no host.
pub fn exit(words: &CStr, status: usize) {
    if PRESENT.load(Ordering::Relaxed) {
        // SAFETY: the words end with zero and are only read.
        unsafe { ted_ask_host(WRITE_LINE, words.as_ptr().cast_mut().cast()) };
        // SAFETY: the block is what this call takes.
        unsafe { ask(EXIT_EXTENDED, &mut [STOPPED_BY_APPLICATION, status]) };
    }
}

/// Asks the host, which writes into the block where the operation says so.
///
/// # Safety
/// The block must be what the operation takes, and what it names must be ours.
unsafe fn ask(operation: usize, block: &mut [usize]) -> usize {
    // SAFETY: the caller promises it. A host keeps the registers that a function keeps.
    unsafe { ted_ask_host(operation, block.as_mut_ptr()) }
}
