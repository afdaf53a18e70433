//! Sums of products in the wider registers of x86-64 processors that have them, decided while the program runs.
//!
//! A binary runs on every x86-64 processor and gives the same bits on each: in AVX a register holds two rows' four lanes,
//! unsafe code of a host's build is in this folder: instructions that not every processor has, and loads.
#![allow(unsafe_code)]

mod floats;
mod instructions;

pub(crate) use floats::sums;
