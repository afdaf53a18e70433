//! Runs of the `ted` command as a person has them: killed, stopped, repeated, on full disks and with bad files.

mod answers;
mod ask;
mod bad_datasets;
mod bad_settings;
mod batch;
mod check;
mod command;
mod dataset;
mod export;
mod fleet;
mod full_disk;
mod interruptions;
mod preference_files;
mod presets;
mod repeatability;
mod report;
mod studies;
mod teachers;
mod too_much;
#[path = "../venv/mod.rs"]
mod venv;
