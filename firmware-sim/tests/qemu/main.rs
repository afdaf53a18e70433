//! The firmware on emulated boards: what it computes, what it flies, and what is left when its plug is pulled.
//!
//! QEMU and the cross compiler are needed; where they are missing, every test here says which and how to get it.

mod artefacts;
mod bits;
mod boards;
mod budget;
mod command;
mod drill;
mod flashing;
mod flight;
mod lifetime;
mod memory;
mod serial;
mod shapes;
