//! The inner loops in assembly. With `x86`, the only unsafe code of the crate.
//!
//! The compiler does not get there: it keeps a register for itself that the integer loop needs, and it scatters the loads
//! of the f32 loop, which cost a cycle more each when they do not follow one another. The kernels around these loops decide
//! what is computed and in which order; `tests/peers/device` compares the bits on the emulated core.
//!
//! Every load of activations is aligned. Words of weights are loaded where a row begins: f32 rows are aligned, and so are
//! 8-bit rows where the number of inputs is a multiple of four and the weights begin on a word. Other 8-bit rows cost a
//! cycle more a word.
#![allow(unsafe_code)]

use core::arch::asm;
#[cfg(target_abi = "eabihf")]
use core::arch::naked_asm;

use super::{AllPairs, COLUMNS, Pairs, ROWS};
use crate::limits::MAX_WIDTH;

/// Adds to each sum the dot product of its row of 8-bit weights with as many activations in [`super::Pairs`].
///
/// Nothing is added when `rows` are not four rows of `inputs` weights, or these are fewer than four or more than
/// [`MAX_WIDTH`].
#[inline(always)]
pub(crate) fn add_dot_i8(rows: &[i8], inputs: usize, pairs: &AllPairs, sums: &mut [i32; ROWS]) {
    if (COLUMNS..=MAX_WIDTH).contains(&inputs) && rows.len() == ROWS * inputs {
        // SAFETY: four rows of `inputs` weights are there, and pairs for as many activations.
        unsafe { four_rows_i8(rows.as_ptr(), inputs, pairs.as_ptr(), sums) };
    }
}

/// Adds to each lane of each sum the products of its row with `x`, column by column. Nothing is added when a row has another
/// length than `x`.
#[cfg(target_abi = "eabihf")]
#[inline(always)]
pub(crate) fn add_dot_f32(
    rows: [&[[f32; COLUMNS]]; ROWS],
    x: &[[f32; COLUMNS]],
    sums: &mut [[f32; COLUMNS]; ROWS],
) {
    if rows.iter().all(|row| row.len() == x.len()) {
        // SAFETY: the rows and `x` have as many blocks as said.
        unsafe { four_rows_f32(&rows.map(<[_]>::as_ptr), x.len(), x.as_ptr(), sums) };
    }
}

/// Four columns in four rows.
///
/// r0 and r8 point into the first and the third row, each other row is r1 bytes further; r2 to the pairs; r4 to r7 are the
/// sums. The other registers are free. All pointers move on.
macro_rules! columns_i8 {
    () => {
        "ldrd r10, r11, [r2], #8
        ldr r12, [r0, r1]
        ldr r9, [r0], #4
        sxtb16 lr, r9
        smlad r4, lr, r10, r4
        sxtb16 r9, r9, ror #8
        smlad r4, r9, r11, r4
        sxtb16 lr, r12
        smlad r5, lr, r10, r5
        sxtb16 r12, r12, ror #8
        smlad r5, r12, r11, r5
        ldr r12, [r8, r1]
        ldr r9, [r8], #4
        sxtb16 lr, r9
        smlad r6, lr, r10, r6
        sxtb16 r9, r9, ror #8
        smlad r6, r9, r11, r6
        sxtb16 lr, r12
        smlad r7, lr, r10, r7
        sxtb16 r12, r12, ror #8
        smlad r7, r12, r11, r7"
    };
}

/// # Safety
/// Four rows of `inputs` weights lie at `rows`, and the pairs of as many activations at `pairs`; `inputs` is at least four.
#[inline(never)]
unsafe fn four_rows_i8(
    rows: *const i8,
    inputs: usize,
    pairs: *const Pairs,
    sums: &mut [i32; ROWS],
) {
    // SAFETY: reads what the caller promises and writes `sums`. r6 and r7 may not be named below and are put back; smlad
    // sets the sticky flag Q when a sum overflows, which `IntegerDense` has proved that none does.
    unsafe {
        asm!(
            "push {{r3, r6, r7}}",
            "ldm r3, {{r4-r7}}",
            "add r8, r0, r1, lsl #1",
            // r3: where the pairs of whole words end.
            "bic r3, r1, #3",
            "add r3, r2, r3, lsl #1",
            // Word by word until a multiple of four is left, then four at a time.
            "2:",
            "sub r9, r3, r2",
            "tst r9, #24",
            "beq 3f",
            columns_i8!(),
            "b 2b",
            "3:",
            "cmp r2, r3",
            "beq 5f",
            "4:",
            columns_i8!(),
            columns_i8!(),
            columns_i8!(),
            columns_i8!(),
            "cmp r2, r3",
            "bne 4b",
            "5:",
            // What is left: go back to the last four columns.
            "ands r9, r1, #3",
            "beq 6f",
            "rsb r9, r9, #4",
            "sub r0, r0, r9",
            "sub r8, r8, r9",
            columns_i8!(),
            "6:",
            "pop {{r3}}",
            "stm r3, {{r4-r7}}",
            "pop {{r6, r7}}",
            inout("r0") rows => _,
            in("r1") inputs,
            inout("r2") pairs => _,
            inout("r3") sums => _,
            out("r4") _,
            out("r5") _,
            out("r8") _,
            out("r9") _,
            out("r10") _,
            out("r11") _,
            out("r12") _,
            out("lr") _,
        );
    }
}

/// The products of one row with four columns, added to its sums. The weights are in s24 to s27 and the activations in four
/// registers from the given one; sums, products and additions are apart so that none waits for the one before it.
#[cfg(target_abi = "eabihf")]
macro_rules! products_f32 {
    ($w0:literal $w1:literal $w2:literal $w3:literal, $x0:literal $x1:literal $x2:literal $x3:literal,
     $a0:literal $a1:literal $a2:literal $a3:literal) => {
        concat!(
            "vmul.f32 ",
            $w0,
            ", ",
            $w0,
            ", ",
            $x0,
            "\n",
            "vmul.f32 ",
            $w1,
            ", ",
            $w1,
            ", ",
            $x1,
            "\n",
            "vmul.f32 ",
            $w2,
            ", ",
            $w2,
            ", ",
            $x2,
            "\n",
            "vmul.f32 ",
            $w3,
            ", ",
            $w3,
            ", ",
            $x3,
            "\n",
            "vadd.f32 ",
            $a0,
            ", ",
            $a0,
            ", ",
            $w0,
            "\n",
            "vadd.f32 ",
            $a1,
            ", ",
            $a1,
            ", ",
            $w1,
            "\n",
            "vadd.f32 ",
            $a2,
            ", ",
            $a2,
            ", ",
            $w2,
            "\n",
            "vadd.f32 ",
            $a3,
            ", ",
            $a3,
            ", ",
            $w3,
            "\n",
        )
    };
}

/// Four columns, or eight, of the row that a register points to; it moves on.
#[cfg(target_abi = "eabihf")]
macro_rules! row_f32 {
    (4, $row:literal, $a0:literal $a1:literal $a2:literal $a3:literal) => {
        concat!(
            "vldmia ", $row, "!, {{s24-s27}}\n",
            products_f32!("s24" "s25" "s26" "s27", "s16" "s17" "s18" "s19", $a0 $a1 $a2 $a3),
        )
    };
    (8, $row:literal, $a0:literal $a1:literal $a2:literal $a3:literal) => {
        concat!(
            "vldmia ", $row, "!, {{s24-s31}}\n",
            products_f32!("s24" "s25" "s26" "s27", "s16" "s17" "s18" "s19", $a0 $a1 $a2 $a3),
            products_f32!("s28" "s29" "s30" "s31", "s20" "s21" "s22" "s23", $a0 $a1 $a2 $a3),
        )
    };
}

/// # Safety
/// `blocks` blocks of four columns lie at each of `rows` and at `x`.
#[cfg(target_abi = "eabihf")]
#[unsafe(naked)]
unsafe extern "C" fn four_rows_f32(
    rows: &[*const [f32; COLUMNS]; ROWS],
    blocks: usize,
    x: *const [f32; COLUMNS],
    sums: &mut [[f32; COLUMNS]; ROWS],
) {
    naked_asm!(
        // With link-time optimisation, the assembler does not hear of the floating-point unit otherwise.
        ".fpu fpv4-sp-d16",
        "push {{r4-r7}}",
        "vpush {{s16-s31}}",
        "ldm r0, {{r4-r7}}",
        "vldmia r3, {{s0-s15}}",
        // r1: where the activations end.
        "add r1, r2, r1, lsl #4",
        "sub r0, r1, r2",
        "tst r0, #16",
        "beq 2f",
        "vldmia r2!, {{s16-s19}}",
        row_f32!(4, "r4", "s0" "s1" "s2" "s3"),
        row_f32!(4, "r5", "s4" "s5" "s6" "s7"),
        row_f32!(4, "r6", "s8" "s9" "s10" "s11"),
        row_f32!(4, "r7", "s12" "s13" "s14" "s15"),
        "2:",
        "cmp r2, r1",
        "beq 4f",
        "3:",
        "vldmia r2!, {{s16-s23}}",
        row_f32!(8, "r4", "s0" "s1" "s2" "s3"),
        row_f32!(8, "r5", "s4" "s5" "s6" "s7"),
        row_f32!(8, "r6", "s8" "s9" "s10" "s11"),
        row_f32!(8, "r7", "s12" "s13" "s14" "s15"),
        "cmp r2, r1",
        "bne 3b",
        "4:",
        "vstmia r3, {{s0-s15}}",
        "vpop {{s16-s31}}",
        "pop {{r4-r7}}",
        "bx lr",
    )
}
