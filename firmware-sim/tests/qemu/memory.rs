//! The memory that an image may use, all of it together: static memory, the deepest stack, and an interrupt on top.

use std::fs;

use firmware_sim::device::frame::{MAX_FRAME, MAX_REPLY_FRAME};
use firmware_sim::progress::Audience;
use firmware_sim::qemu::{Board, Firmware};

/// What the budget allows beyond the link's buffers.
const BUDGET: u32 = 8 * 1024;

/// The ring that the serial port receives into, in static memory, and the two frames, on the stack.
const LINK_BUFFERS: u32 = 1024 + (MAX_FRAME + MAX_REPLY_FRAME) as u32;

/// What an interrupt takes that comes at the deepest point, where the measured one had none: 26 registers with those of
/// the floating-point unit, up to 4 bytes to align them, and the handler's own.
const INTERRUPT: u32 = 104 + 4 + 32;

/// A section of memory that is written: `SHF_WRITE` and `SHF_ALLOC`.
const WRITTEN: u32 = 1 | 2;

/// Fails over the budget.
pub fn within_budget(board: Board, stack: u32) {
    let image =
        Firmware::find(board, Audience::Nobody).unwrap_or_else(|error| panic!("failed to {error}"));
    let fixed = written_sections(&fs::read(image.path()).unwrap());
    let sum = fixed + stack + INTERRUPT - LINK_BUFFERS;
    println!(
        "{board}: {fixed} static, {stack} of stack, {sum} with an interrupt and without link buffers"
    );
    assert!(
        sum <= BUDGET,
        "{board}: {fixed} bytes of static memory and {stack} of stack, with an interrupt and without the link's buffers \
         {sum}; {BUDGET} are allowed"
    );
}

/// The bytes of all sections that are written at run time, of an ELF file for a 32-bit machine.
fn written_sections(elf: &[u8]) -> u32 {
    let word = |at: usize| u32::from_le_bytes(elf[at..at + 4].try_into().unwrap());
    let half = |at: usize| usize::from(u16::from_le_bytes(elf[at..at + 2].try_into().unwrap()));
    assert_eq!(elf[..5], *b"\x7fELF\x01");
    let (table, entry, count) = (word(0x20) as usize, half(0x2e), half(0x30));
    let sections = (0..count).map(|index| table + index * entry);
    sections
        .filter(|at| word(at + 8) & WRITTEN == WRITTEN)
        .map(|at| word(at + 20))
        .sum()
}
