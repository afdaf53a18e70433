//! The identity of a dataset's content: BLAKE3 over its arrays in a canonical order.
//!
//! Each episode is hashed alone, so that the work is parallel; the dataset's digest is the hash of the episodes' hashes in
//! order. Floats enter as their little-endian bytes, rewards in double precision, flags as one byte each.

use firmware_sim::robot::Robot;

use super::assemble::UNIT;

#[cfg(target_endian = "big")]
compile_error!("the dataset digest and the Arrow files are little-endian; this host is not");

/// Domain and version of the digest; a change of the canonical order must change it.
const DOMAIN: &[u8] = b"ted dataset 1";

/// The arrays of one episode that the digest covers.
pub(super) struct EpisodeArrays<'a> {
    pub observations: &'a [f32],
    pub actions: &'a [f32],
    pub rewards: &'a [f64],
    pub terminations: &'a [bool],
    pub truncations: &'a [bool],
    pub success: &'a [bool],
}

impl EpisodeArrays<'_> {
    pub(super) fn hash(&self) -> blake3::Hash {
        let mut hasher = blake3::Hasher::new();
        hasher.update(DOMAIN);
        hasher.update(&(self.rewards.len() as u64).to_le_bytes());
        hasher.update(bytemuck::cast_slice(self.observations));
        hasher.update(bytemuck::cast_slice(self.actions));
        hasher.update(bytemuck::cast_slice(self.rewards));
        for flags in [self.terminations, self.truncations, self.success] {
            hasher.update(bytemuck::cast_slice(flags));
        }
        hasher.finalize()
    }
}

/// The digest of a dataset, in hexadecimal.
pub(super) fn combine(robot: &Robot, episodes: &[blake3::Hash]) -> String {
    let mut hasher = blake3::Hasher::new();
    hasher.update(DOMAIN);
    for width in [robot.observation.len(), robot.action.len(), episodes.len()] {
        hasher.update(&(width as u64).to_le_bytes());
    }
    // What is learned from depends on the ranges that recorded actions are seen in.
    if robot.action.iter().any(|it| it.range != UNIT) {
        for range in robot.action.iter().map(|it| it.range) {
            hasher.update(bytemuck::cast_slice(&range));
        }
    }
    for episode in episodes {
        hasher.update(episode.as_bytes());
    }
    hasher.finalize().to_hex().to_string()
}
