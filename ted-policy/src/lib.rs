//! The policy artefact: everything a controller needs to fly a trained policy, in one checked file.
#![cfg_attr(feature = "std", doc = include_str!("../README.md"))]
#![no_std]
#![forbid(unsafe_code)]

#[cfg(any(feature = "std", test))]
extern crate std;

#[cfg(target_endian = "big")]
compile_error!(
    "the artefact's weights are little-endian and borrowed in place: a big-endian machine cannot read them"
);

mod action_map;
mod arrays;
mod artifact;
mod code;
mod contract;
mod crc;
mod decode;
mod digest;
mod envelope;
mod error;
mod golden;
mod integers;
mod metadata;
mod networks;
mod provenance;
mod text;
mod wire;

#[cfg(feature = "std")]
mod golden_outputs;
#[cfg(feature = "std")]
mod load;
#[cfg(feature = "std")]
mod write;

pub use action_map::ActionMap;
pub use artifact::Artifact;
pub use contract::{ActionChannel, Contract, ContractFault, ObservationChannel, SafeAction};
pub use crc::crc32;
pub use decode::decode;
pub use digest::{Digest, DigestError};
pub use envelope::{FORMAT_VERSION, HEADER_LENGTH, MAGIC};
pub use error::{ArtifactError, Place};
pub use golden::{Golden, GoldenCase};
pub use integers::IntegerNetworks;
pub use metadata::{List, Terms};
pub use provenance::Provenance;
pub use text::Text;

#[cfg(feature = "std")]
pub use load::{ArtifactBytes, LoadError};
#[cfg(feature = "std")]
pub use write::{ArtifactSpec, IntegerSpec, WriteError, write};
