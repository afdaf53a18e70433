//! The interrupts that the processor can be sent to: as many as the board's table needs, which is up to the UART's.

use crate::map::MAP;

type Handler = unsafe extern "C" fn();

unsafe extern "C" {
    fn DefaultHandler();
}

/// Behind the exceptions in the table that the processor reads. Interrupts with a higher number are never enabled.
#[unsafe(link_section = ".vector_table.interrupts")]
#[unsafe(no_mangle)]
static __INTERRUPTS: [Handler; MAP.uart_receive as usize + 1] =
    [DefaultHandler; MAP.uart_receive as usize + 1];
