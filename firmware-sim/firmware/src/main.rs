//! The controller on a Cortex-M: start-up, and the parts of a board that `firmware_sim::device` asks for.
#![no_std]
#![no_main]

mod clock;
mod fifo;
mod halt;
mod link;
mod machine;
mod map;
mod memory;
mod ring;
mod semihosting;
mod slots;
mod stack;
mod uart;
mod vectors;

use cortex_m::Peripherals;
use cortex_m_rt::entry;
use firmware_sim::device::{LinkClosed, serve};

use link::Link;
use machine::Machine;
use slots::SlotMemory;

#[entry]
fn main() -> ! {
    // Taken once, here, so there are.
    let Some(peripherals) = Peripherals::take() else {
        halt::ted_halt();
    };
    let link = Link::open();
    let mut machine = Machine::start(peripherals.SYST, &link);
    // SAFETY: this function runs once and takes it once.
    let mut slots = unsafe { SlotMemory::take() };
    let LinkClosed = serve(link, &mut slots, &mut machine);
    semihosting::exit(c"", 0);
    halt::ted_halt();
}
