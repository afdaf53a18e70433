//! What differs between the boards: addresses, interrupt numbers, clock rates.

/// A board, as far as this firmware uses it.
pub struct Map {
    /// What it is called.
    pub name: &'static str,
    /// Processor clock, which SysTick counts.
    pub clock_hz: u32,
    /// The CMSDK UART that carries the link.
    pub uart: usize,
    /// The interrupt of a received byte.
    pub uart_receive: u16,
    /// The memory that plays the flash of the artefact slots: it keeps its bytes over a reset, and over the end of the
    /// emulator where that is told to keep them in a file.
    pub slots: usize,
}

/// Bytes of memory for the artefact slots.
pub const SLOTS_SIZE: usize = 16 * 1024 * 1024;

/// Cortex-M4 with single-precision floating point.
#[cfg(feature = "mps2-an386")]
pub const MAP: Map = Map {
    name: "mps2-an386",
    clock_hz: 25_000_000,
    uart: 0x4000_4000,
    uart_receive: 0,
    slots: 0x2100_0000,
};

/// Cortex-M7.
#[cfg(feature = "mps2-an500")]
pub const MAP: Map = Map {
    name: "mps2-an500",
    clock_hz: 25_000_000,
    uart: 0x4000_4000,
    uart_receive: 0,
    slots: 0x6000_0000,
};

/// Cortex-M33, which starts in the secure state; addresses are the secure aliases.
#[cfg(feature = "mps2-an505")]
pub const MAP: Map = Map {
    name: "mps2-an505",
    clock_hz: 20_000_000,
    uart: 0x5020_0000,
    uart_receive: 32,
    slots: 0x8000_0000,
};
