//! Answers that were given after one that was taken back. Where the same question comes again, nobody is asked twice.

use std::io;
use std::path::{Path, PathBuf};

use firmware_sim::disk;

use super::AskError;
use crate::dataset::Dataset;
use crate::preferences::{LogEntry, PreferenceError, PreferenceLog, Query};
use crate::run::{PREFERENCES, RunFolder};

/// The file beside the log, whose lines are those of a log.
const ASIDE: &str = "preferences.aside.jsonl";

/// Lines of a log, and what they say.
pub(super) struct Aside {
    path: PathBuf,
    lines: Vec<(String, LogEntry)>,
}

impl Aside {
    /// What the folder holds of it.
    pub fn open(folder: &RunFolder, dataset: &Dataset) -> Result<Self, AskError> {
        let path = folder.file(ASIDE);
        let lines = match path.exists() {
            true => lines(&path, dataset)?,
            false => Vec::new(),
        };
        Ok(Self { path, lines })
    }

    /// What was said to this question before.
    pub fn said_to(&self, query: &Query) -> Option<&LogEntry> {
        let mut said = self.lines.iter().map(|(_, entry)| entry);
        said.find(|entry| entry.question.query == *query)
    }

    /// Cuts the log off before the line of this place, counted from 0, and sets what stood after it aside. A place beyond its end
    /// changes nothing. Killed between the two files, both are whole and nothing was taken back.
    pub fn reopen(
        mut self,
        folder: &RunFolder,
        dataset: &Dataset,
        place: usize,
    ) -> Result<(), AskError> {
        let log = folder.file(PREFERENCES);
        let mut kept = lines(&log, dataset)?;
        if place >= kept.len() {
            return Ok(());
        }
        let mut rest = kept.split_off(place).into_iter();
        let taken_back = rest.next().map(|(_, entry)| entry.question.query);
        // The newest answer to a question is the one that counts.
        let older = std::mem::take(&mut self.lines);
        for line in rest.chain(older) {
            let query = line.1.question.query;
            if Some(query) != taken_back && self.said_to(&query).is_none() {
                self.lines.push(line);
            }
        }
        disk::replace(&self.path, text(&self.lines).as_bytes())?;
        disk::replace(&log, text(&kept).as_bytes())?;
        Ok(())
    }
}

/// The whole lines of a log, with what they say.
fn lines(path: &Path, dataset: &Dataset) -> Result<Vec<(String, LogEntry)>, PreferenceError> {
    let entries = PreferenceLog::read(path, dataset)?;
    let text =
        std::fs::read_to_string(path).map_err(|source: io::Error| PreferenceError::Read {
            path: path.to_path_buf(),
            source,
        })?;
    Ok(text.lines().map(str::to_owned).zip(entries).collect())
}

fn text(lines: &[(String, LogEntry)]) -> String {
    lines.iter().map(|(line, _)| format!("{line}\n")).collect()
}
