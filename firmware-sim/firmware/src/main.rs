//! The controller on a Cortex-M: start-up, and the parts of the board that `firmware_sim::device` is given.
#![no_std]
#![no_main]

mod board;
mod clock;
mod fifo;
mod halt;
mod link;
mod ring;
mod semihosting;
mod slots;
mod stack;
mod uart;

use cortex_m::Peripherals;
use cortex_m_rt::entry;
use embedded_io::{Read, Write};

use clock::Clock;
use link::Link;
use slots::SlotMemory;

#[entry]
fn main() -> ! {
    let Some(peripherals) = Peripherals::take() else {
        halt::ted_halt();
    };
    let clock = Clock::start(peripherals.SYST);
    let mut link = Link::open();
    // SAFETY: once
    let mut flash = unsafe { SlotMemory::take() };
    let mut buffer = [0; 256];
    loop {
        match link.read(&mut buffer) {
            Ok(0) | Err(_) => {
                semihosting::exit(c"bye\n", 0);
            }
            Ok(n) => {
                if link.write(&buffer[..n]).is_err() {
                    semihosting::exit(c"bye\n", 0);
                }
            }
        }
        if buffer[0] == b'!' {
            use embedded_storage::nor_flash::NorFlash;
            flash.erase(8192, 12288).ok();
            flash.write(8192, b"abcdefgh").ok();
        }
        if buffer[0] == b'=' {
            use embedded_storage::nor_flash::ReadNorFlash;
            let mut b=[0;8];
            flash.read(8192, &mut b).ok();
            link.write(&b).ok();
        }
        if buffer[0] == b'?' {
            for v in [clock.ticks() as u32, clock.now_us() as u32, stack::high_water()] {
                link.write(&v.to_le_bytes()).ok();
            }
        }
    }
}
