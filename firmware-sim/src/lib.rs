//! The controller loop, the plants it can drive, and the bridge to MuJoCo Meta-World.
#![cfg_attr(feature = "std", doc = include_str!("../README.md"))]
#![cfg_attr(not(feature = "std"), no_std)]
#![forbid(unsafe_code)]

#[cfg(feature = "std")]
pub mod bench;
#[cfg(feature = "std")]
pub mod bridge;
#[cfg(feature = "std")]
pub mod cli;
pub mod controller;
#[cfg(feature = "std")]
pub mod counts;
pub mod device;
#[cfg(feature = "std")]
pub mod disk;
#[cfg(feature = "std")]
pub mod exit;
#[cfg(feature = "std")]
pub mod failure;
#[cfg(feature = "std")]
pub mod interrupt;
#[cfg(feature = "std")]
pub mod last_words;
#[cfg(feature = "std")]
pub mod memory;
#[cfg(feature = "std")]
pub mod output;
#[cfg(feature = "std")]
pub mod plant;
#[cfg(feature = "std")]
pub mod plants;
#[cfg(feature = "std")]
pub mod progress;
pub mod proven;
#[cfg(feature = "std")]
pub mod qemu;
#[cfg(feature = "std")]
pub mod remote;
#[cfg(feature = "std")]
pub mod robot;
#[cfg(feature = "std")]
pub mod rollout;
pub mod safety;
pub mod scorer;
#[cfg(feature = "std")]
pub mod scoring;
#[cfg(feature = "std")]
pub mod serial;
#[cfg(feature = "std")]
pub mod size;
#[cfg(feature = "std")]
mod splitmix;
#[cfg(feature = "std")]
mod wait;
pub mod workspace;
#[cfg(feature = "std")]
pub mod worlds;
