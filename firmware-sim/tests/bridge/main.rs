//! The bridge against real processes: a fake worker that misbehaves, and the simulator itself.

mod failures;
mod fake;
mod lifetime;
mod metaworld;
mod pool;
mod python;
mod setup;
