//! What this processor has beyond SSE2, which every x86-64 processor has.

use core::arch::x86_64::{__cpuid, __cpuid_count, _xgetbv};
use core::sync::atomic::{AtomicU8, Ordering};

/// Eight floats in a register.
pub(super) const AVX: u8 = 1 << 0;

/// Sixteen 16-bit integers in a register.
pub(super) const AVX2: u8 = 1 << 1;

/// The processor was asked.
const KNOWN: u8 = 1 << 7;

/// Whether this processor has `instructions` and the operating system keeps their registers.
#[inline]
pub(super) fn has(instructions: u8) -> bool {
    /// Asked once: on a virtual machine the question takes longer than a policy does.
    static ANSWER: AtomicU8 = AtomicU8::new(0);
    let mut answer = ANSWER.load(Ordering::Relaxed);
    if answer == 0 {
        answer = KNOWN | ask();
        ANSWER.store(answer, Ordering::Relaxed);
    }
    answer & instructions != 0
}

#[cold]
fn ask() -> u8 {
    const FEATURES: u32 = 1;
    const OSXSAVE_AND_AVX: u32 = 0b11 << 27;
    const XMM_AND_YMM: u64 = 0b110;
    const MORE_FEATURES: u32 = 7;
    const AVX2_THERE: u32 = 1 << 5;
    if __cpuid(FEATURES).ecx & OSXSAVE_AND_AVX != OSXSAVE_AND_AVX {
        return 0;
    }
    // SAFETY: OSXSAVE says that the instruction is there.
    if unsafe { kept_registers() } & XMM_AND_YMM != XMM_AND_YMM {
        return 0;
    }
    let last_question = __cpuid(0).eax;
    if last_question >= MORE_FEATURES && __cpuid_count(MORE_FEATURES, 0).ebx & AVX2_THERE != 0 {
        AVX | AVX2
    } else {
        AVX
    }
}

#[target_feature(enable = "xsave")]
fn kept_registers() -> u64 {
    // SAFETY: register 0 is there wherever the instruction is.
    unsafe { _xgetbv(0) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_answer_is_that_of_the_standard_library() {
        for _ in 0..2 {
            assert_eq!(has(AVX), std::is_x86_feature_detected!("avx"));
            assert_eq!(has(AVX2), std::is_x86_feature_detected!("avx2"));
        }
    }
}
