//! The device crates behind one entry point, to prove on the linked result that they neither panic nor allocate.
//!
//! The panic handler calls a symbol that nobody defines. If any panic is reachable from [`ted_probe_tick`], that symbol is
//! in the linked object; if any code allocates, an allocator is missing and the build fails. `check.sh` looks for both.
#![no_std]

use core::panic::PanicInfo;

use firmware_sim::controller::Controller;
use firmware_sim::safety::ObservationFrame;
use ted_core::{EpisodeReturn, MAX_ACTION, Scratch};
use ted_policy::Artifact;

unsafe extern "C" {
    fn ted_probe_panic_is_reachable() -> !;
}

#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    // SAFETY: never runs. The function has no definition: its name in the object is the whole point.
    unsafe { ted_probe_panic_is_reachable() }
}

/// Parses an artefact, puts a controller on it, and computes one tick, reward, return and discount.
///
/// Returns the discount, or a negative number if anything was refused.
///
/// # Safety
/// `artifact` and `obs_raw` must point to that many readable elements, `action_env` to [`MAX_ACTION`] writable ones.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ted_probe_tick(
    artifact: *const u8,
    artifact_length: usize,
    obs_raw: *const f32,
    obs_length: usize,
    now_us: u64,
    action_env: *mut f32,
) -> f32 {
    // SAFETY: the caller promises it.
    let (artifact, obs_raw, action_env) = unsafe {
        (
            core::slice::from_raw_parts(artifact, artifact_length),
            core::slice::from_raw_parts(obs_raw, obs_length),
            core::slice::from_raw_parts_mut(action_env, MAX_ACTION),
        )
    };
    tick(artifact, obs_raw, now_us, action_env).unwrap_or(-1.0)
}

fn tick(artifact: &[u8], obs_raw: &[f32], now_us: u64, action_env: &mut [f32]) -> Option<f32> {
    if cfg!(feature = "panic-on-purpose") {
        action_env[obs_raw.len()] = 0.0;
    }
    let artifact = Artifact::parse(artifact).ok()?;
    let mut controller = Controller::load(&artifact).ok()?;
    controller.reset();
    let frame = ObservationFrame {
        sequence: 0,
        stamp_us: now_us,
        values: obs_raw,
    };
    let (action, status) = controller.tick(now_us, &frame);
    action_env.get_mut(..action.len())?.copy_from_slice(&action);
    if status.fault.is_some() {
        controller.rearm();
    }
    let mut scratch = Scratch::new();
    let mut episode = EpisodeReturn::new();
    episode.push(
        artifact
            .reward()?
            .reward_hat(obs_raw, &action, &mut scratch)
            .ok()?,
    );
    let discount = artifact.ted()?;
    Some(discount.discount(discount.class(episode.return_hat(), ted_core::NEW_EPISODE)))
}
