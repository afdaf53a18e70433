//! Ctrl-C and SIGTERM: the first asks the work to stop cleanly, the second ends the process at once.

use std::io;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;

use crate::exit::ExitCode;

static REQUESTED: OnceLock<Arc<AtomicBool>> = OnceLock::new();

fn requested_flag() -> &'static Arc<AtomicBool> {
    REQUESTED.get_or_init(|| Arc::new(AtomicBool::new(false)))
}

/// Takes over SIGINT and SIGTERM for this process. Once is enough; again does no harm.
///
/// # Errors
/// When the operating system refuses the handler.
pub fn install() -> io::Result<()> {
    static INSTALLED: AtomicBool = AtomicBool::new(false);
    if INSTALLED.swap(true, Ordering::SeqCst) {
        return Ok(());
    }
    for signal in [SIGINT, SIGTERM] {
        // The order counts: the first action ends the process only if the flag is already up when the signal comes.
        let end = i32::from(ExitCode::Interrupted.code());
        flag::register_conditional_shutdown(signal, end, Arc::clone(requested_flag()))?;
        flag::register(signal, Arc::clone(requested_flag()))?;
    }
    Ok(())
}

/// Whether the work should come to a clean stop.
#[must_use]
pub fn requested() -> bool {
    requested_flag().load(Ordering::Relaxed)
}
