//! `ted report`: what became of a run, as one page that needs nothing else: no network, no script, no other file.

mod clip;
mod facts;
mod figures;
mod logs;
mod page;
mod shot;
pub mod study;
mod verdict;

pub use verdict::{Comparison, Verdict};

use std::path::Path;

use firmware_sim::disk::{self, WriteError};
use firmware_sim::progress::Audience;

use crate::dataset::Dataset;
use crate::preferences::PreferenceError;
use crate::run::{RunError, RunFolder};
use crate::train::TrainError;
use ted_core::DiscountError;

use facts::Facts;

/// Why there is no report.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// The run's folder.
    #[error(transparent)]
    Run(#[from] RunError),
    /// The run's state.
    #[error(transparent)]
    Train(#[from] TrainError),
    /// The answers.
    #[error(transparent)]
    Preferences(#[from] PreferenceError),
    /// The discounts.
    #[error(transparent)]
    Discount(#[from] DiscountError),
    /// The page cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// A plot.
    #[error("a plot could not be drawn: {0}")]
    Figure(String),
}

/// Writes the report of a run to `out`, and returns what its first line says. What there is not yet is left out: answers of a run
/// that asked nobody, flights of one that nobody flew. The dataset is the one in the folder `at`.
///
/// # Errors
/// When a file of the run cannot be read, or the page not be written.
pub fn report(
    folder: &RunFolder,
    dataset: &Dataset,
    at: &Path,
    out: &Path,
    audience: Audience,
) -> Result<Verdict, ReportError> {
    let facts = Facts::gather(folder, dataset, at, audience)?;
    let page = page::page(&facts)?.into_string();
    disk::replace(out, page.as_bytes())?;
    Ok(facts.verdict)
}
