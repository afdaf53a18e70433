//! What is flashed in a drill: an old artefact, a new one, and some that must be refused.

use ted_policy::{ArtifactBytes, crc32, write};

use crate::plants::toy::{self, ToyError};

/// Where the checksum is in an artefact's header.
const CHECKSUM_AT: usize = 12;

/// The toy's policy in several shapes.
#[derive(Debug)]
pub(super) struct Artefacts {
    /// What flies before anything happens.
    pub(super) old: ArtifactBytes,
    /// The same policy from another run.
    pub(super) new: ArtifactBytes,
    /// A policy for a robot with two channels exchanged.
    pub(super) rewired: ArtifactBytes,
    /// A policy with a golden vector that comes out differently everywhere.
    pub(super) other_golden: ArtifactBytes,
}

impl Artefacts {
    pub(super) fn new() -> Result<Self, ToyError> {
        let mut spec = toy::artifact_spec()?;
        let old = write(&spec)?;
        spec.provenance.seed = 1;
        let new = write(&spec)?;
        spec.contract.observation.swap(0, 1);
        let rewired = write(&spec)?;
        let mut other_golden = new.clone();
        let last_reward = other_golden.len() - 16;
        other_golden[last_reward] ^= 1;
        other_golden[CHECKSUM_AT..CHECKSUM_AT + 4].fill(0);
        let checksum = crc32(&[&other_golden]).to_le_bytes();
        other_golden[CHECKSUM_AT..CHECKSUM_AT + 4].copy_from_slice(&checksum);
        Ok(Self {
            old: ArtifactBytes::from_vec(old),
            new: ArtifactBytes::from_vec(new),
            rewired: ArtifactBytes::from_vec(rewired),
            other_golden: ArtifactBytes::from_vec(other_golden),
        })
    }
}
