//! Sums of products in the wider registers of x86-64 processors that have them, decided while the program runs.
//!
//! A binary runs on every x86-64 processor and gives the same bits on each: in AVX a register holds two rows' four lanes,
//! never more lanes of one row, so that [`crate::reference`] stays the definition; integers have no order to keep. The only
//! unsafe code of a host's build is in this folder: instructions that not every processor has, and loads.
#![allow(unsafe_code)]

mod floats;
mod instructions;
mod integers;

pub(crate) use floats::sums;
pub(crate) use integers::{COLUMNS, add_dot};
