//! A file of answers as somebody hands it over: read whole, line by line, and never written to.

use std::path::{Path, PathBuf};

use super::text::decode;
use super::{Line, PreferenceError};

/// A line and where it stands, counted from 1.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Numbered {
    /// Its number.
    pub number: usize,
    /// What stands there.
    pub line: Line,
}

/// The lines of a file.
#[derive(Debug)]
pub struct AnswerFile {
    /// Where it lies.
    pub path: PathBuf,
    /// Those that are preferences.
    pub lines: Vec<Numbered>,
    /// Why the others are none.
    pub faults: Vec<PreferenceError>,
}

impl AnswerFile {
    /// Reads a file in UTF-8 or UTF-16, with any ends of lines. Empty lines say nothing, and the last one needs no end.
    ///
    /// # Errors
    /// When it cannot be read, or is no text.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, PreferenceError> {
        let path = path.as_ref().to_path_buf();
        let bytes = std::fs::read(&path).map_err(|source| PreferenceError::Read {
            path: path.clone(),
            source,
        })?;
        let text = decode(&bytes).map_err(|reason| PreferenceError::NoText {
            path: path.clone(),
            reason,
        })?;
        let (mut lines, mut faults) = (Vec::new(), Vec::new());
        for (number, text) in (1..).zip(text.lines()) {
            if text.trim().is_empty() {
                continue;
            }
            match serde_json::from_str(text) {
                Ok(line) => lines.push(Numbered { number, line }),
                Err(error) => faults.push(PreferenceError::Line {
                    path: path.clone(),
                    line: number,
                    reason: error.to_string(),
                }),
            }
        }
        Ok(Self {
            path,
            lines,
            faults,
        })
    }

    /// Its lines, if all of them are preferences.
    ///
    /// # Errors
    /// The first that is none.
    pub fn whole(self) -> Result<Vec<Numbered>, PreferenceError> {
        match self.faults.into_iter().next() {
            None => Ok(self.lines),
            Some(fault) => Err(fault),
        }
    }
}

#[cfg(test)]
#[path = "file_tests.rs"]
mod tests;
