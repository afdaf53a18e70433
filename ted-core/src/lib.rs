#![no_std]
//! ted-core
