//! What the platform of Uni-RLHF exports: a folder with a `.json` that says how long clips are, and a `.csv` with a row for each
//! query: the first steps of its clips, and a label such as `{'1': {'0': 2}}`, 0 when the left one is better, 1 when they are
//! equal, 2 when the right one is.

use std::path::{Path, PathBuf};

use serde::Deserialize;
use serde_json::Value;

use super::flat::FlatSteps;
use super::table::{columns, rows, table, text};
use super::{Given, ImportError, Source};
use crate::preferences::{Answer, Line};

/// What is used of the `.json`.
#[derive(Deserialize)]
struct Metadata {
    query_length: u32,
    feedback_type: String,
}

#[derive(Deserialize)]
struct Row {
    start_indices_1: u64,
    start_indices_2: u64,
    label: String,
}

/// Whether a folder holds an export rather than pickles.
pub(super) fn is_one(folder: &Path) -> bool {
    only(folder, "csv").is_ok()
}

/// The answers of an export.
pub(super) fn read(folder: &Path, source: &Source<'_>) -> Result<Vec<Line>, ImportError> {
    let path = only(folder, "json")?;
    let metadata: Metadata =
        serde_json::from_str(&text(&path)?).map_err(|error| ImportError::file(&path, error))?;
    if metadata.feedback_type != "comparative" {
        let reason = format!(
            "its feedback is {}, and only comparative feedback says which of two clips is better",
            metadata.feedback_type
        );
        return Err(ImportError::file(&path, reason));
    }
    let length = source.length.unwrap_or(metadata.query_length);
    let steps = FlatSteps::of(source.dataset);
    let path = only(folder, "csv")?;
    let text = text(&path)?;
    let mut table = table(&text);
    let wanted = ["start_indices_1", "start_indices_2", "label"];
    columns(&path, &mut table, &wanted, None)?;
    let mut lines = Vec::new();
    rows(&path, &mut table, |row: Row| {
        let given = Given {
            spans: [
                steps.span(row.start_indices_1, length)?,
                steps.span(row.start_indices_2, length)?,
            ],
            answer: Some(label(&row.label)?),
            by: None,
            at: None,
        };
        lines.push(given.line(source)?);
        Ok(())
    })?;
    Ok(lines)
}

/// What the label of a row says.
fn label(text: &str) -> Result<Answer, String> {
    // It is written as Python writes it.
    let value: Option<Value> = serde_json::from_str(&text.replace('\'', "\"")).ok();
    let number = value.as_ref().and_then(|it| it["1"]["0"].as_u64());
    match number {
        Some(0) => Ok(Answer::First),
        Some(1) => Ok(Answer::Equal),
        Some(2) => Ok(Answer::Second),
        _ => Err(format!(
            "the label {text} is not {{'1': {{'0': n}}}} with 0 (left better), 1 (equal) or 2 (right better)"
        )),
    }
}

/// The one file of a folder whose name ends so.
fn only(folder: &Path, extension: &str) -> Result<PathBuf, ImportError> {
    let entries = std::fs::read_dir(folder).map_err(|source| ImportError::Read {
        path: folder.to_path_buf(),
        source,
    })?;
    let paths = entries.flatten().map(|entry| entry.path());
    let found: Vec<PathBuf> = paths
        .filter(|path| path.extension().is_some_and(|it| it == extension))
        .collect();
    match found.as_slice() {
        [one] => Ok(one.clone()),
        several => Err(ImportError::file(
            folder,
            format!(
                "it holds {} files .{extension}, and there must be one",
                several.len()
            ),
        )),
    }
}
