//! Answers that people already have, in the shapes of other programs, as the lines of a log.

mod error;
mod export;
mod flat;
mod pickles;
mod table;

pub use error::ImportError;

use std::path::Path;

use crate::dataset::Dataset;
use crate::preferences::{Answer, Line, Span};

use super::merge::write;

/// Whose shape it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// A table with a row for each answer.
    Csv,
    /// Preference Transformer's three pickles.
    Pt,
    /// Uni-RLHF's three pickles, or what its platform exports.
    UniRlhf,
}

/// What is to be known besides the file.
#[derive(Clone, Debug)]
pub struct Source<'a> {
    /// What was asked about.
    pub dataset: &'a Dataset,
    /// Who answered, where the file does not say.
    pub by: &'a str,
    /// Steps of a clip, where the file does not say.
    pub length: Option<u32>,
}

/// An answer before anybody has looked whether the dataset has its clips.
pub(super) struct Given {
    spans: [Span; 2],
    answer: Option<Answer>,
    by: Option<String>,
    at: Option<String>,
}

/// Reads the answers at `path`, each of which must be about clips that the dataset has.
///
/// # Errors
/// When something cannot be read, by file and line.
pub fn import(shape: Shape, path: &Path, source: &Source<'_>) -> Result<Vec<Line>, ImportError> {
    match shape {
        Shape::Csv => table::read(path, source),
        Shape::Pt => pickles::read(&pickles::PT, path, source),
        Shape::UniRlhf if export::is_one(path) => export::read(path, source),
        Shape::UniRlhf => pickles::read(&pickles::UNI_RLHF, path, source),
    }
}

/// Writes a log of these lines.
///
/// # Errors
/// When the disk is full or fails.
pub fn keep(lines: &[Line], path: &Path) -> Result<(), firmware_sim::disk::WriteError> {
    write(path, lines.iter())
}

impl Given {
    /// As a line about the dataset.
    ///
    /// # Errors
    /// When the dataset has no such clips.
    fn line(self, source: &Source<'_>) -> Result<Line, String> {
        let line = Line {
            dataset: source.dataset.id().to_owned(),
            digest: source.dataset.digest().to_owned(),
            round: 0,
            member: None,
            segments: self.spans,
            why: None,
            answer: self.answer,
            later: false,
            by: self.by.unwrap_or_else(|| source.by.to_owned()),
            at: self.at,
        };
        match line.entry(source.dataset) {
            Ok(_) => Ok(line),
            Err(misfit) => Err(misfit.to_string()),
        }
    }
}
