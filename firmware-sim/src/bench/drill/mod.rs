//! A drill for devices: every fault there is, one after the other, and a table of what the controller did about each.
//!
//! It knows a device as a stream of bytes and a flash that can be filled, so it runs against a thread, an emulated core, or
//! a board on a desk. The toy flies; its actions are compared with those of a controller on this machine.

mod artefacts;
mod flight;
mod scenario;
mod table;

use std::io::{self, Read, Write};

use thiserror::Error;

use crate::device::message::Refusal;
use crate::plant::PlantError;
use crate::plants::toy::ToyError;
use crate::remote::{LinkOptions, RemoteError};

pub use scenario::{Scenario, scenarios};
pub use table::{Row, table};

/// A device that can be switched on with a given flash.
pub trait Rig {
    /// What is at the host's end of its link. When it is dropped, the device may go.
    type Link: Read + Write;

    /// Bytes of the device's flash.
    fn flash_bytes(&self) -> usize;

    /// Starts a device whose flash holds this, and connects to it.
    ///
    /// # Errors
    /// When there is no such device.
    fn power_on(&mut self, flash: &[u8]) -> io::Result<Self::Link>;

    /// How patient to be with its link.
    fn link_options(&self) -> LinkOptions;
}

/// Why a drill could not go on. What a device does wrong is in the table; this is a device that is not there.
#[derive(Debug, Error)]
pub enum DrillError {
    /// The device cannot be switched on.
    #[error("switch the device on: {0}")]
    PowerOn(#[source] io::Error),
    /// The device does not do what no fault can keep it from doing.
    #[error(transparent)]
    Remote(#[from] RemoteError),
    /// A flash for the device could not be filled.
    #[error("fill the device's flash: {0}")]
    Flash(Refusal),
    /// The toy's artefact could not be made.
    #[error(transparent)]
    Toy(#[from] ToyError),
    /// The toy could not be flown.
    #[error(transparent)]
    Plant(#[from] PlantError),
}

impl From<Refusal> for DrillError {
    fn from(refusal: Refusal) -> Self {
        Self::Flash(refusal)
    }
}

/// Runs all scenarios, each from power on.
///
/// # Errors
/// When there is no device to drill.
pub fn drill(rig: &mut impl Rig) -> Result<Vec<Row>, DrillError> {
    let artefacts = artefacts::Artefacts::new()?;
    scenarios()
        .iter()
        .map(|scenario| scenario.run(rig, &artefacts))
        .collect()
}
