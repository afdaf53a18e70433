//! Preferences to policies: datasets, reward ensembles, TED, offline RL, evaluation, export, and the `ted` command.

pub mod collect;
pub mod dataset;
mod disk;
pub mod preferences;
pub mod rng;
