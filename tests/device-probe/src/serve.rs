//! The loop of a device behind an entry point: a link, a flash and a board that are somebody else's functions.

use core::convert::Infallible;

use embedded_io::{ErrorType, Read, ReadReady, Write};
use embedded_storage::nor_flash::{self, NorFlash, NorFlashErrorKind, ReadNorFlash};
use firmware_sim::device::{Board, MappedFlash, serve};

/// What the outside does for a device.
#[repr(C)]
pub struct Outside {
    read: extern "C" fn(*mut u8, usize) -> usize,
    write: extern "C" fn(*const u8, usize) -> usize,
    ready: extern "C" fn() -> bool,
    erase: extern "C" fn(u32) -> bool,
    program: extern "C" fn(u32, *const u8, usize) -> bool,
    now_us: extern "C" fn() -> u64,
    work: extern "C" fn() -> u32,
    notices_silence: extern "C" fn() -> bool,
    flash: *const u8,
    flash_length: usize,
}

/// Serves whoever is at the other end, until the link is closed.
///
/// # Safety
/// `outside` must point to functions that keep to the lengths they are given, and its `flash` to `flash_length` readable
/// bytes that change only when `erase` or `program` is called.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ted_probe_serve(outside: *const Outside) {
    // SAFETY: the caller promises it.
    let outside = unsafe { &*outside };
    serve(Link(outside), &mut Flash(outside), &mut Parts(outside));
}

struct Link<'a>(&'a Outside);
struct Flash<'a>(&'a Outside);
struct Parts<'a>(&'a Outside);

impl ErrorType for Link<'_> {
    type Error = Infallible;
}

impl Read for Link<'_> {
    fn read(&mut self, room: &mut [u8]) -> Result<usize, Infallible> {
        Ok((self.0.read)(room.as_mut_ptr(), room.len()))
    }
}

impl ReadReady for Link<'_> {
    fn read_ready(&mut self) -> Result<bool, Infallible> {
        Ok((self.0.ready)())
    }
}

impl Write for Link<'_> {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, Infallible> {
        Ok((self.0.write)(bytes.as_ptr(), bytes.len()))
    }

    fn flush(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
}

impl nor_flash::ErrorType for Flash<'_> {
    type Error = NorFlashErrorKind;
}

impl ReadNorFlash for Flash<'_> {
    const READ_SIZE: usize = 1;

    fn read(&mut self, _: u32, _: &mut [u8]) -> Result<(), NorFlashErrorKind> {
        Err(NorFlashErrorKind::Other)
    }

    fn capacity(&self) -> usize {
        self.0.flash_length
    }
}

impl NorFlash for Flash<'_> {
    const WRITE_SIZE: usize = 4;
    const ERASE_SIZE: usize = 4096;

    fn erase(&mut self, from: u32, _: u32) -> Result<(), NorFlashErrorKind> {
        (self.0.erase)(from)
            .then_some(())
            .ok_or(NorFlashErrorKind::Other)
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), NorFlashErrorKind> {
        let done = (self.0.program)(offset, bytes.as_ptr(), bytes.len());
        done.then_some(()).ok_or(NorFlashErrorKind::Other)
    }
}

impl MappedFlash for Flash<'_> {
    fn bytes(&self) -> &[u8] {
        // SAFETY: the caller of the entry point promises it.
        unsafe { core::slice::from_raw_parts(self.0.flash, self.0.flash_length) }
    }
}

impl Board for Parts<'_> {
    const NAME: &'static str = "probe";
    const WORK_HZ: u32 = 0;

    fn now_us(&mut self) -> u64 {
        (self.0.now_us)()
    }

    fn work(&mut self) -> u32 {
        (self.0.work)()
    }

    fn notices_silence(&self) -> bool {
        (self.0.notices_silence)()
    }

    fn stack_high_water(&mut self) -> u32 {
        0
    }

    fn idle(&mut self) {}
}
