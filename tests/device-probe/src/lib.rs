//! The device crates behind two entry points, to prove on the linked result that they neither panic nor allocate.
//!
//! The panic handler calls a symbol that nobody defines. If any panic is reachable from [`ted_probe_fly`] or
//! [`serve::ted_probe_serve`], that symbol is in the linked object; if any code allocates, an allocator is missing and the
//! build fails. `check.sh` looks for both.
#![no_std]

mod serve;

use core::panic::PanicInfo;

use firmware_sim::controller::{Controller, Numeric};
use firmware_sim::safety::{Fault, ObservationFrame};
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

/// An observation as a link hands it over.
#[repr(C)]
pub struct Frame {
    values: *const f32,
    length: usize,
    sequence: u32,
    stamp_us: u64,
    now_us: u64,
}

/// Parses an artefact, puts a controller on it, flies it over the frames, and computes a reward, a return and a discount.
///
/// Everything that a tick depends on comes from outside, and there may be any number of ticks, so that no check and no
/// latched state can be computed away while this is built. Returns the discount, or a negative number if anything was
/// refused.
///
/// # Safety
/// `artifact` and `frames` must point to that many readable elements, each frame's `values` to its `length`, and
/// `action_env` to [`MAX_ACTION`] writable elements.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ted_probe_fly(
    artifact: *const u8,
    artifact_length: usize,
    frames: *const Frame,
    frame_count: usize,
    action_env: *mut f32,
) -> f32 {
    // SAFETY: the caller promises it.
    let (artifact, frames, action_env) = unsafe {
        (
            core::slice::from_raw_parts(artifact, artifact_length),
            core::slice::from_raw_parts(frames, frame_count),
            core::slice::from_raw_parts_mut(action_env, MAX_ACTION),
        )
    };
    fly(artifact, frames, action_env).unwrap_or(-1.0)
}

fn fly(artifact: &[u8], frames: &[Frame], action_env: &mut [f32]) -> Option<f32> {
    let artifact = Artifact::parse(artifact).ok()?;
    let mut controller = Controller::load(&artifact, Numeric::F32).ok()?;
    let (reward, discount) = (artifact.reward()?, artifact.ted()?);
    let mut scratch = Scratch::new();
    let mut episode = EpisodeReturn::new();
    for frame in frames {
        // SAFETY: the caller of the entry point promises it.
        let values = unsafe { core::slice::from_raw_parts(frame.values, frame.length) };
        let observed = ObservationFrame {
            sequence: frame.sequence,
            stamp_us: frame.stamp_us,
            values,
        };
        let (action, status) = controller.tick(frame.now_us, &observed);
        if cfg!(feature = "panic-on-purpose") && status.deadline_missed {
            action_env[values.len()] = 0.0;
        }
        action_env.get_mut(..action.len())?.copy_from_slice(&action);
        match status.fault.map(Fault::code) {
            Some(1..=4) => controller.rearm(),
            Some(_) => controller.reset(),
            None => {}
        }
        episode.push(reward.reward_hat(values, &action, &mut scratch).ok()?);
    }
    Some(discount.discount(discount.class(episode.return_hat(), ted_core::NEW_EPISODE)))
}
