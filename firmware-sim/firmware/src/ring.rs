//! Bytes from an interrupt to the program: one side puts, the other takes, nobody waits for anybody.

use core::sync::atomic::{AtomicU8, AtomicU32, Ordering};

/// A ring of `N` bytes; `N` must be a power of two.
pub struct Ring<const N: usize> {
    bytes: [AtomicU8; N],
    put: AtomicU32,
    taken: AtomicU32,
}

impl<const N: usize> Ring<N> {
    const MASK: u32 = {
        assert!(N.is_power_of_two() && N <= 1 << 16);
        N as u32 - 1
    };

    /// An empty ring.
    pub const fn new() -> Self {
        Self {
            bytes: [const { AtomicU8::new(0) }; N],
            put: AtomicU32::new(0),
            taken: AtomicU32::new(0),
        }
    }

    /// Whether there is nothing to take.
    pub fn is_empty(&self) -> bool {
        self.put.load(Ordering::Acquire) == self.taken.load(Ordering::Relaxed)
    }

    /// Puts one byte. A full ring loses it, as a UART without flow control does: the frame's checksum tells.
    pub fn put(&self, byte: u8) {
        let put = self.put.load(Ordering::Relaxed);
        let held = put.wrapping_sub(self.taken.load(Ordering::Acquire));
        if held <= Self::MASK
            && let Some(slot) = self.bytes.get((put & Self::MASK) as usize)
        {
            slot.store(byte, Ordering::Relaxed);
            self.put.store(put.wrapping_add(1), Ordering::Release);
        }
    }

    /// Takes what there is, as much as fits, and returns how much that was.
    pub fn take(&self, into: &mut [u8]) -> usize {
        let put = self.put.load(Ordering::Acquire);
        let mut taken = self.taken.load(Ordering::Relaxed);
        let mut count = 0;
        for byte in into {
            if taken == put {
                break;
            }
            if let Some(slot) = self.bytes.get((taken & Self::MASK) as usize) {
                *byte = slot.load(Ordering::Relaxed);
            }
            taken = taken.wrapping_add(1);
            count += 1;
        }
        self.taken.store(taken, Ordering::Release);
        count
    }
}
