//! A table of answers: a header, and a row for each answer.
//!
//! ```csv
//! episode_1,start_1,length_1,episode_2,start_2,length_2,label,by,at
//! 4,120,50,9,7,50,0,anna,2026-05-01 14:03
//! ```
//! The columns may stand in any order; `by` and `at` may be missing. `label` is 0 when the first clip is better, 1 when the second
//! is, 0.5 when they are equal, and empty when whoever was asked could not tell. Spaces around a cell and quotes are allowed.

use std::path::Path;

use csv::{Reader, ReaderBuilder, StringRecord, Trim};
use serde::Deserialize;
use serde::de::DeserializeOwned;

use super::{Given, ImportError, Source};
use crate::preferences::{Answer, Line, Span, decode};

/// The columns that there must be, and those that there may be.
const COLUMNS: [&str; 7] = [
    "episode_1",
    "start_1",
    "length_1",
    "episode_2",
    "start_2",
    "length_2",
    "label",
];
const OTHERS: [&str; 2] = ["by", "at"];

#[derive(Deserialize)]
struct Row {
    episode_1: u32,
    start_1: u32,
    length_1: u32,
    episode_2: u32,
    start_2: u32,
    length_2: u32,
    label: Option<f64>,
    by: Option<String>,
    at: Option<String>,
}

/// The answers of a table.
pub(super) fn read(path: &Path, source: &Source<'_>) -> Result<Vec<Line>, ImportError> {
    let text = text(path)?;
    let mut table = table(&text);
    columns(path, &mut table, &COLUMNS, Some(&OTHERS))?;
    let mut lines = Vec::new();
    rows(path, &mut table, |row: Row| {
        let span = |episode, start, length| Span {
            episode,
            start,
            length,
        };
        let answer = match row.label {
            None => None,
            Some(label) => Some(Answer::from_label(label).ok_or_else(|| {
                format!(
                    "the label {label} is not 0 (first better), 1 (second better), 0.5 (equal) or empty (could not tell)"
                )
            })?),
        };
        let given = Given {
            spans: [
                span(row.episode_1, row.start_1, row.length_1),
                span(row.episode_2, row.start_2, row.length_2),
            ],
            answer,
            by: row.by,
            at: row.at,
        };
        lines.push(given.line(source)?);
        Ok(())
    })?;
    Ok(lines)
}

/// The text of a file, whatever an editor or a spreadsheet has made of it.
pub(super) fn text(path: &Path) -> Result<String, ImportError> {
    let bytes = std::fs::read(path).map_err(|source| ImportError::Read {
        path: path.to_path_buf(),
        source,
    })?;
    decode(&bytes).map_err(|reason| ImportError::file(path, reason))
}

/// The table in a text.
pub(super) fn table(text: &str) -> Reader<&[u8]> {
    ReaderBuilder::new()
        .trim(Trim::All)
        .from_reader(text.as_bytes())
}

/// Refuses a table that lacks one of these columns, or has others than `more` besides, if that is given.
pub(super) fn columns(
    path: &Path,
    table: &mut Reader<&[u8]>,
    wanted: &[&str],
    more: Option<&[&str]>,
) -> Result<(), ImportError> {
    let headers = table
        .headers()
        .map_err(|error| ImportError::line(path, 1, error))?;
    let has = |name: &&&str| headers.iter().any(|it| it == **name);
    let wants = format!("the first line names the columns, {}", wanted.join(","));
    if let Some(missing) = wanted.iter().find(|name| !has(name)) {
        let reason = format!("there is no column {missing}: {wants}");
        return Err(ImportError::line(path, 1, reason));
    }
    let strange =
        |name: &&str| more.is_some_and(|more| !more.contains(name) && !wanted.contains(name));
    match headers.iter().find(strange) {
        None => Ok(()),
        Some(name) => {
            let reason = format!("nothing is known of a column {name:?}: {wants}");
            Err(ImportError::line(path, 1, reason))
        }
    }
}

/// A cell without quotes that a space stood before: the reader takes those for a part of it.
fn unquoted(cell: &str) -> &str {
    let inside = cell.strip_prefix('"').and_then(|it| it.strip_suffix('"'));
    inside.map_or(cell, str::trim)
}

/// Hands on every row of a table; what goes wrong with one is named with its line.
pub(super) fn rows<T: DeserializeOwned>(
    path: &Path,
    table: &mut Reader<&[u8]>,
    mut each: impl FnMut(T) -> Result<(), String>,
) -> Result<(), ImportError> {
    let headers = table.headers().cloned().unwrap_or_default();
    let mut record = StringRecord::new();
    loop {
        let from = table.position().line();
        match table.read_record(&mut record) {
            Ok(false) => return Ok(()),
            Ok(true) => {}
            Err(error) => {
                let line = error.position().map_or(from, csv::Position::line);
                return Err(ImportError::line(path, line, error));
            }
        }
        let line = record.position().map_or(from, csv::Position::line);
        let bare: StringRecord = record.iter().map(unquoted).collect();
        let row = bare.deserialize(Some(&headers));
        row.map_err(|error| error.to_string())
            .and_then(&mut each)
            .map_err(|reason| ImportError::line(path, line, reason))?;
    }
}

#[cfg(test)]
#[path = "table_tests.rs"]
mod tests;
