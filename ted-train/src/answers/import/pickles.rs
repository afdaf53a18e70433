//! The labels that Preference Transformer and Uni-RLHF (Clean-Offline-RLHF) published: a folder with three pickles, the first steps of
//! the first clips, those of the second clips, and the answers: 0 when the first is better, 1 when the second is, -1 when they are
//! equal, or one row of two numbers for each answer, such as `[1, 0]`.
//!
//! A pickle is a program that its reader runs. Python's own reader takes a list of what it may name, and `read_pickle.py` lets it
//! name the parts of an array and nothing else. No crate reads pickled arrays of numpy, and a Python is here wherever this
//! project collects or flies.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Stdio;

use firmware_sim::bridge::environment::{call, interpreter};
use serde_json::Value;

use super::flat::FlatSteps;
use super::{Given, ImportError, Source};
use crate::preferences::{Answer, Line};

const READER: &str = include_str!("read_pickle.py");

/// How the three files are called.
pub(super) struct Names {
    /// How each name begins: first clips, second clips, answers.
    begin: [&'static str; 3],
    /// What stands before the length of a clip.
    length: &'static str,
}

/// Those of `human_label/<environment>/` of Preference Transformer.
pub(super) const PT: Names = Names {
    begin: ["indices_num", "indices_2_num", "label"],
    length: "_q",
};

/// Those of `crowdsource_human_labels/<environment>_human_labels/` of Clean-Offline-RLHF.
pub(super) const UNI_RLHF: Names = Names {
    begin: ["indices_1", "indices_2", "human_label"],
    length: "_len_",
};

/// The answers of a folder.
pub(super) fn read(
    names: &Names,
    folder: &Path,
    source: &Source<'_>,
) -> Result<Vec<Line>, ImportError> {
    let [first, second, labels] = files(names, folder)?;
    let length = match (source.length, length(names, &first)) {
        (Some(length), _) | (None, Some(length)) => length,
        (None, None) => {
            let reason = format!(
                "its name has no {}, which says how long clips are: say it with --length",
                names.length
            );
            return Err(ImportError::file(&first, reason));
        }
    };
    let [starts, others, answers] = [unpickled(&first)?, unpickled(&second)?, unpickled(&labels)?];
    for (path, values) in [(&second, &others), (&labels, &answers)] {
        if values.len() != starts.len() {
            let reason = format!(
                "it has {} entries, and {} has {}",
                values.len(),
                first.display(),
                starts.len()
            );
            return Err(ImportError::file(path, reason));
        }
    }
    let steps = FlatSteps::of(source.dataset);
    let span = |path: &Path, number, value: &Value| {
        let start = value.as_u64().ok_or_else(|| format!("{value} is no step"));
        start
            .and_then(|start| steps.span(start, length))
            .map_err(|reason| entry(path, number, reason))
    };
    let each = (1..).zip(starts.iter().zip(&others).zip(&answers));
    each.map(|(number, ((one, other), answer))| {
        let given = Given {
            spans: [span(&first, number, one)?, span(&second, number, other)?],
            answer: Some(label(answer).map_err(|reason| entry(&labels, number, reason))?),
            by: None,
            at: None,
        };
        given
            .line(source)
            .map_err(|reason| entry(&first, number, reason))
    })
    .collect()
}

fn entry(path: &Path, number: u64, reason: String) -> ImportError {
    ImportError::Part {
        path: path.to_path_buf(),
        what: "entry",
        number,
        reason,
    }
}

/// The one file of each kind.
fn files(names: &Names, folder: &Path) -> Result<[PathBuf; 3], ImportError> {
    let entries = std::fs::read_dir(folder).map_err(|source| ImportError::Read {
        path: folder.to_path_buf(),
        source,
    })?;
    let mut all: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
    all.sort();
    let one = |begin: &str| {
        let of_kind = |path: &&PathBuf| {
            let name = path.file_name().map(|name| name.to_string_lossy());
            name.is_some_and(|name| name.starts_with(begin))
        };
        let found: Vec<&PathBuf> = all.iter().filter(of_kind).collect();
        match found.as_slice() {
            [one] => Ok((*one).clone()),
            several => Err(ImportError::file(
                folder,
                format!(
                    "{} files in it are called {begin}...: there must be one, besides one {} and one {} of the same labels",
                    several.len(),
                    names.begin[1],
                    names.begin[2]
                ),
            )),
        }
    };
    let [first, second, labels] = names.begin;
    Ok([one(first)?, one(second)?, one(labels)?])
}

/// The length of a clip that a name says.
fn length(names: &Names, path: &Path) -> Option<u32> {
    let name = path.file_name()?.to_str()?;
    let (_, after) = name.rsplit_once(names.length)?;
    let digits = after.find(|c: char| !c.is_ascii_digit());
    after[..digits.unwrap_or(after.len())].parse().ok()
}

/// What a label says.
fn label(label: &Value) -> Result<Answer, String> {
    let rows = |row: &Vec<Value>| -> Option<[f64; 2]> {
        let row: Option<Vec<f64>> = row.iter().map(Value::as_f64).collect();
        row?.try_into().ok()
    };
    let row = match label {
        Value::Array(row) => rows(row),
        one => match one.as_f64() {
            Some(0.0) => Some([1.0, 0.0]),
            Some(1.0) => Some([0.0, 1.0]),
            Some(-1.0) => Some([0.5, 0.5]),
            _ => None,
        },
    };
    match row {
        Some([1.0, 0.0]) => Ok(Answer::First),
        Some([0.0, 1.0]) => Ok(Answer::Second),
        Some([0.5, 0.5]) => Ok(Answer::Equal),
        _ => Err(format!(
            "the label {label} is not 0 (first better), 1 (second better) or -1 (equal), nor one of [1, 0], [0, 1] and [0.5, 0.5]"
        )),
    }
}

/// The list in a pickle.
fn unpickled(path: &Path) -> Result<Vec<Value>, ImportError> {
    let bytes = std::fs::read(path).map_err(|source| ImportError::Read {
        path: path.to_path_buf(),
        source,
    })?;
    let python = interpreter()?;
    let fault = |reason: &dyn ToString| ImportError::file(path, reason.to_string());
    let mut child = call(&python.path)
        .args(["-Es", "-c", READER])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .map_err(|error| fault(&format!("{python} does not start: {error}")))?;
    // It reads all of it before it writes anything, or ends; what it then says is of more use than that it left.
    if let Some(mut input) = child.stdin.take() {
        let _ = input.write_all(&bytes);
    }
    let output = child.wait_with_output().map_err(|error| fault(&error))?;
    if !output.status.success() {
        let said = String::from_utf8_lossy(&output.stderr);
        return Err(fault(&format!(
            "it is no pickled array of numbers: {}",
            said.trim()
        )));
    }
    match serde_json::from_slice(&output.stdout) {
        Ok(Value::Array(values)) => Ok(values),
        Ok(other) => Err(fault(&format!("it is {other} and no list"))),
        Err(error) => Err(fault(&error)),
    }
}

#[cfg(test)]
#[path = "pickles_tests.rs"]
mod tests;
