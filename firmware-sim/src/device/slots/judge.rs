//! Whether the bytes in a slot are an artefact that this device flies, and what distinguishes it from others.

use ted_policy::{Artifact, ArtifactError, Terms, crc32};

use crate::controller::Numeric;
use crate::device::frame::NAME_LENGTH;
use crate::device::message::{Name, Refusal};
use crate::proven::Proven;

/// What is worth remembering of an artefact that was found good.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Judged {
    /// The checksum in its header.
    pub(super) checksum: u32,
    /// Whether it holds networks in integers.
    pub(super) integers: bool,
    /// What must be the same for the same wiring: see [`wiring`].
    pub(super) wiring: u32,
    /// The task, as far as there is room.
    pub(super) task: Name,
}

/// Everything a device can find out about an artefact, golden vectors last.
///
/// # Errors
/// The first defect.
#[inline(never)]
pub(super) fn judge(bytes: &[u8]) -> Result<Judged, Refusal> {
    let artifact = Artifact::parse(bytes).map_err(refusal)?;
    Proven::of(&artifact, Numeric::F32).map_err(refusal)?;
    if artifact.has_integers() {
        Proven::of(&artifact, Numeric::Integer).map_err(refusal)?;
    }
    let terms = artifact.terms();
    if !terms.declared {
        return Err(Refusal::Undeclared);
    }
    Ok(Judged {
        checksum: artifact.checksum(),
        integers: artifact.has_integers(),
        wiring: wiring(terms),
        // It fits, or it would be shorter.
        task: Name::from_slice(terms.task.beginning(NAME_LENGTH).as_bytes()).unwrap_or_default(),
    })
}

/// As a refusal on the wire.
pub(in crate::device) fn refusal(error: ArtifactError) -> Refusal {
    match error {
        ArtifactError::Checksum { expected, actual } => Refusal::Checksum { expected, actual },
        ArtifactError::GoldenMismatch { case, .. } => Refusal::Golden { case: case as u16 },
        other => Refusal::Defect { code: other.code() },
    }
}

/// A digest of what a robot is wired by: names, units and order of the channels, and the control period.
///
/// It stands for the contract itself, because two artefacts do not fit into the memory of a device at once.
fn wiring(terms: &Terms<'_>) -> u32 {
    let observation = terms
        .observation
        .iter()
        .map(|channel| (channel.name, channel.unit));
    let action = terms
        .action
        .iter()
        .map(|channel| (channel.name, channel.unit));
    let mut digest = crc32(&[&terms.control_period_us.to_le_bytes()]);
    for (kind, (name, unit)) in observation.map(|c| (0, c)).chain(action.map(|c| (1, c))) {
        // The lengths keep "ab", "c" apart from "a", "bc".
        let (name, unit) = (name.as_bytes(), unit.as_bytes());
        let lengths = [kind, name.len() as u8, unit.len() as u8];
        digest = crc32(&[&digest.to_le_bytes(), &lengths, name, unit]);
    }
    digest
}
