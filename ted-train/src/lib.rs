//! Preferences to policies: datasets, reward ensembles, TED, offline RL, evaluation, export, and the `ted` command.

pub mod dataset;
pub mod preferences;
pub mod rng;
