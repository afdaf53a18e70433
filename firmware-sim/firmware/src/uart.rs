//! The link over a CMSDK UART: an interrupt receives into a ring, sending waits for room.

use core::convert::Infallible;

use cortex_m::interrupt;
use cortex_m::peripheral::NVIC;
use cortex_m_rt::exception;
use embedded_io::{ErrorType, Read, ReadReady, Write};
use vcell::VolatileCell;

use crate::map::MAP;
use crate::ring::Ring;

const BAUD: u32 = 115_200;
const STATE_SEND_FULL: u32 = 1 << 0;
const STATE_RECEIVED: u32 = 1 << 1;
const CONTROL_SEND: u32 = 1 << 0;
const CONTROL_RECEIVE: u32 = 1 << 1;
const CONTROL_RECEIVE_INTERRUPT: u32 = 1 << 3;
const INTERRUPT_RECEIVE: u32 = 1 << 1;

/// The longest link frame fits, so that a frame which comes while a tick computes is not lost.
static RECEIVED: Ring<1024> = Ring::new();

#[repr(C)]
struct Registers {
    data: VolatileCell<u32>,
    state: VolatileCell<u32>,
    control: VolatileCell<u32>,
    interrupt: VolatileCell<u32>,
    baud_divisor: VolatileCell<u32>,
}

fn registers() -> &'static Registers {
    // SAFETY: the board has these registers there, for ever. They are read and written whole, and what the interrupt and
    // the program do to them does not overlap: the one reads data, the other writes it.
    unsafe { &*(MAP.uart as *const Registers) }
}

/// The interrupt of the board's UART, as cortex-m names interrupts.
#[derive(Clone, Copy)]
struct Receive;

// SAFETY: the number is the board's own and always the same.
unsafe impl cortex_m::interrupt::InterruptNumber for Receive {
    fn number(self) -> u16 {
        MAP.uart_receive
    }
}

/// Every interrupt that has no handler of its own; the only one that is enabled is the UART's.
#[exception]
unsafe fn DefaultHandler(_interrupt: i16) {
    let uart = registers();
    uart.interrupt.set(INTERRUPT_RECEIVE);
    while uart.state.get() & STATE_RECEIVED != 0 {
        RECEIVED.put(uart.data.get() as u8);
    }
}

/// The UART, receiving.
pub struct Uart(());

impl Uart {
    /// Starts it.
    pub fn start() -> Self {
        let uart = registers();
        uart.baud_divisor.set(MAP.clock_hz / BAUD);
        uart.control
            .set(CONTROL_SEND | CONTROL_RECEIVE | CONTROL_RECEIVE_INTERRUPT);
        // SAFETY: the handler is there and shares nothing with the program but the ring.
        unsafe { NVIC::unmask(Receive) };
        Self(())
    }

    /// Sleeps until something is received or the clock's round ends.
    pub fn sleep() {
        // With interrupts held back, or a byte that comes between looking and sleeping would not wake anybody.
        interrupt::free(|_| {
            if RECEIVED.is_empty() {
                cortex_m::asm::wfi();
            }
        });
    }
}

impl ErrorType for Uart {
    type Error = Infallible;
}

impl Read for Uart {
    fn read(&mut self, into: &mut [u8]) -> Result<usize, Infallible> {
        while !into.is_empty() {
            match RECEIVED.take(into) {
                0 => Self::sleep(),
                count => return Ok(count),
            }
        }
        Ok(0)
    }
}

impl ReadReady for Uart {
    fn read_ready(&mut self) -> Result<bool, Infallible> {
        Ok(!RECEIVED.is_empty())
    }
}

impl Write for Uart {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, Infallible> {
        let uart = registers();
        for &byte in bytes {
            while uart.state.get() & STATE_SEND_FULL != 0 {}
            uart.data.set(u32::from(byte));
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> Result<(), Infallible> {
        while registers().state.get() & STATE_SEND_FULL != 0 {}
        Ok(())
    }
}
