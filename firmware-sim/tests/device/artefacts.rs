//! Artefacts to fly and to refuse, and devices that hold them.

use std::time::Duration;

use firmware_sim::bench::{HostDevice, MemoryFlash};
use firmware_sim::plants::toy;
use firmware_sim::remote::{Connection, LinkOptions};
use ted_policy::write;

/// Bytes of a test device's flash: two slots of four sectors.
pub const FLASH_BYTES: usize = 8 * 4096;

/// Patient enough for a loaded machine, and quick to ask again where a test loses frames.
pub const QUICK: LinkOptions = LinkOptions {
    timeout: Duration::from_millis(100),
    tries: 50,
    session: 7,
};

/// The toy's artefact.
pub fn toy_artefact() -> Vec<u8> {
    toy::artifact_bytes().unwrap()
}

/// The same policy from another run: same contract, other bytes.
pub fn other_artefact() -> Vec<u8> {
    let mut spec = toy::artifact_spec().unwrap();
    spec.provenance.seed = 1;
    write(&spec).unwrap()
}

/// An artefact for a robot that is wired otherwise.
pub fn rewired_artefact() -> Vec<u8> {
    let mut spec = toy::artifact_spec().unwrap();
    spec.contract.observation.swap(0, 1);
    write(&spec).unwrap()
}

/// An artefact that can be flown in floats only.
pub fn artefact_without_integers() -> Vec<u8> {
    let mut spec = toy::artifact_spec().unwrap();
    spec.integers = None;
    write(&spec).unwrap()
}

/// The checksum in an artefact's header.
pub fn checksum(artefact: &[u8]) -> u32 {
    u32::from_le_bytes(artefact[12..16].try_into().unwrap())
}

/// A flash in which these artefacts were put, one after the other.
pub fn flash_with(artefacts: &[&[u8]]) -> MemoryFlash {
    MemoryFlash::with_artefacts(FLASH_BYTES, artefacts).unwrap()
}

/// A device that flies the toy's policy.
pub fn toy_device() -> HostDevice {
    HostDevice::power_on(flash_with(&[&toy_artefact()]))
}

/// A greeted device with this flash.
pub fn connected(flash: MemoryFlash) -> Connection<HostDevice> {
    Connection::open(HostDevice::power_on(flash), QUICK).unwrap()
}
