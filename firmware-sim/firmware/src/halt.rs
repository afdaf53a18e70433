//! The ends that must not come: a fault of the processor, or a panic, which no release image can reach.
//!
//! Nothing more is sent, which whoever moves the plant must take for a reason to stop.

use core::panic::PanicInfo;

use cortex_m::interrupt;

use crate::semihosting;

#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    ted_halt()
}

/// Where the fault handler ends. With interrupts off and nothing to wake it, the processor sleeps until it is reset.
#[unsafe(no_mangle)]
pub extern "C" fn ted_halt() -> ! {
    interrupt::disable();
    semihosting::exit(c"firmware: the processor took a fault and halts\n", 1);
    loop {
        cortex_m::asm::wfi();
    }
}
