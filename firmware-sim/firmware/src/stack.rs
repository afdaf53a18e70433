//! How deep the stack ever was: start-up paints it, and what is not painted any more was used.

use core::ptr;

use cortex_m_rt::STACK_PAINT_VALUE;

unsafe extern "C" {
    static _stack_start: u32;
    static _stack_end: u32;
}

/// Bytes of the stack that were used since start-up, at most.
pub fn high_water() -> u32 {
    let (end, start) = (&raw const _stack_end, &raw const _stack_start);
    let mut word = end;
    // SAFETY: all words between the two are the stack's; those that are looked at are below what is in use, or the first
    // that is. Volatile, because the compiler knows nothing of the paint.
    while word < start && unsafe { ptr::read_volatile(word) } == STACK_PAINT_VALUE {
        word = word.wrapping_add(1);
    }
    (start as usize).wrapping_sub(word as usize) as u32
}
