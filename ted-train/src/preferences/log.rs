//! The append-only file of questions and answers: on the disk before the answer is used, and never asked twice.

use super::error::describe;
use super::text::{MARK, is_utf16};
use super::{Answer, Line, LogEntry, PreferenceError, Question, Teacher, Untold};
use crate::dataset::Dataset;
use serde::de::IgnoredAny;
use std::fs::{File, OpenOptions};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// The preferences of one run about one dataset.
///
/// Opened on an existing file, it first gives the answers in it to the same questions in the same order, and only then lets
/// the teacher answer.
#[derive(Debug)]
pub struct PreferenceLog {
    path: PathBuf,
    file: File,
    /// Length of the file up to the last whole line: where the next one goes, whatever a failed write has left behind.
    end: u64,
    entries: Vec<LogEntry>,
    asked: usize,
    recovered: Option<Recovered>,
}

/// What was lost of a log whose last line had been cut off, by a kill in mid-write or a full disk.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Recovered {
    /// Answers before it, all kept.
    pub kept: usize,
    /// The incomplete text that was removed from the file.
    pub dropped: String,
}

impl PreferenceLog {
    /// Opens the log at `path` for this dataset, or begins one.
    pub fn open(path: impl AsRef<Path>, dataset: &Dataset) -> Result<Self, PreferenceError> {
        let path = path.as_ref().to_path_buf();
        let read_error = |source| PreferenceError::Read {
            path: path.clone(),
            source,
        };
        let mut file = OpenOptions::new()
            .read(true)
            .write(true)
            .create(true)
            .truncate(false)
            .open(&path)
            .map_err(read_error)?;
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes).map_err(read_error)?;
        let (entries, whole) = parse(&path, &bytes, dataset)?;
        let mut log = Self {
            path,
            file,
            end: whole as u64,
            entries,
            asked: 0,
            recovered: None,
        };
        let rest = &bytes[whole..];
        if !rest.is_empty() {
            log.recover(rest, dataset)?;
        }
        if bytes.is_empty() {
            log.sync_name()?;
        }
        Ok(log)
    }

    /// Reads the answers of a log without the intention to add to it: an incomplete last line is left alone and out.
    pub fn read(
        path: impl AsRef<Path>,
        dataset: &Dataset,
    ) -> Result<Vec<LogEntry>, PreferenceError> {
        let path = path.as_ref();
        let bytes = std::fs::read(path).map_err(|source| PreferenceError::Read {
            path: path.to_path_buf(),
            source,
        })?;
        parse(path, &bytes, dataset).map(|(entries, _)| entries)
    }

    /// What is said to `question`: by the log if it has not been used up, otherwise by `teacher`, and then kept in the log. None
    /// when whoever is asked cannot tell.
    pub fn ask(
        &mut self,
        dataset: &Dataset,
        teacher: &mut dyn Teacher,
        question: Question,
    ) -> Result<Option<Answer>, PreferenceError> {
        let number = self.asked + 1;
        if let Some(logged) = self.entries.get(self.asked) {
            let what = |it: &Question| (it.context, it.query);
            if what(&logged.question) != what(&question) {
                let describe = |Question { context, query, .. }: &Question| {
                    let member = context
                        .member
                        .map_or("all members".into(), |member| format!("member {member}"));
                    format!(
                        "{} in round {} for {member}",
                        describe(query),
                        context.round
                    )
                };
                return Err(PreferenceError::OtherQuestion {
                    number,
                    asked: describe(&question),
                    logged: describe(&logged.question),
                });
            }
            self.asked = number;
            return Ok(logged.said.answer);
        }
        let said = teacher.answer(dataset, &self.entries, &question)?;
        let answer = said.answer;
        let entry = LogEntry { question, said };
        self.append(&format!("{}\n", Line::new(dataset, &entry).text()))?;
        self.entries.push(entry);
        self.asked = number;
        Ok(answer)
    }

    /// The pairs that were asked about in this run and that nobody could tell apart. What a log holds beyond the questions so far
    /// does not count yet: a run that starts again chooses as it did.
    #[must_use]
    pub fn untold(&self) -> Untold<'_> {
        Untold::of(&self.entries[..self.asked])
    }

    /// Why no more is asked of somebody who could not tell.
    pub(super) fn nobody_can_tell(&self) -> PreferenceError {
        PreferenceError::NobodyCanTell {
            path: self.path.clone(),
            asked: self.asked,
            untold: self.untold().count(),
        }
    }

    /// How many questions of this run were answered so far.
    pub(super) fn answered(&self) -> usize {
        self.asked - self.untold().count()
    }

    /// All questions so far with what was said, those of earlier runs included.
    #[must_use]
    pub fn entries(&self) -> &[LogEntry] {
        &self.entries
    }

    /// What was lost when the log was opened; none when its last line was whole.
    #[must_use]
    pub fn recovered(&self) -> Option<&Recovered> {
        self.recovered.as_ref()
    }

    /// BLAKE3 of the whole lines of the file, in hexadecimal: what a trained policy names as its preferences.
    pub fn digest(&mut self) -> Result<String, PreferenceError> {
        let mut bytes = Vec::new();
        self.file
            .seek(SeekFrom::Start(0))
            .and_then(|_| (&mut self.file).take(self.end).read_to_end(&mut bytes))
            .map_err(|source| PreferenceError::Read {
                path: self.path.clone(),
                source,
            })?;
        Ok(blake3::hash(&bytes).to_hex().to_string())
    }

    /// Deals with text after the last line end: a whole preference lost only its line end and is kept, anything else goes.
    fn recover(&mut self, rest: &[u8], dataset: &Dataset) -> Result<(), PreferenceError> {
        // What is torn is no whole value; a whole one that is wrong is for whoever wrote it to correct.
        if serde_json::from_slice::<IgnoredAny>(unmarked(rest)).is_ok() {
            let line = self.entries.len() + 1;
            self.entries
                .push(parse_line(&self.path, line, rest, dataset)?);
            let whole = [rest, b"\n"].concat();
            return self.append(&String::from_utf8_lossy(&whole));
        }
        self.file
            .set_len(self.end)
            .and_then(|()| self.file.sync_all())
            .map_err(|error| self.write_error(error))?;
        let dropped = String::from_utf8_lossy(rest).into_owned();
        self.recovered = Some(Recovered {
            kept: self.entries.len(),
            dropped,
        });
        Ok(())
    }

    /// Writes one line after the last whole one and waits until it is on the disk.
    fn append(&mut self, line: &str) -> Result<(), PreferenceError> {
        let written = self
            .file
            .seek(SeekFrom::Start(self.end))
            .and_then(|_| self.file.write_all(line.as_bytes()))
            .and_then(|()| self.file.sync_data());
        if let Err(error) = written {
            // Part of the line may have been written. If it cannot be removed either, the next opening does it.
            let _ = self.file.set_len(self.end);
            return Err(self.write_error(error));
        }
        self.end += line.len() as u64;
        Ok(())
    }

    /// Brings the name of a new file to the disk.
    fn sync_name(&self) -> Result<(), PreferenceError> {
        let folder = match self.path.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder,
            _ => Path::new("."),
        };
        File::open(folder)
            .and_then(|folder| folder.sync_all())
            .map_err(|error| self.write_error(error))
    }

    fn write_error(&self, source: io::Error) -> PreferenceError {
        let path = self.path.clone();
        match source.kind() {
            io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => {
                PreferenceError::DiskFull { path, source }
            }
            _ => PreferenceError::Write { path, source },
        }
    }
}

/// The entries of all whole lines, and how many bytes these have. Lines without anything on them say nothing.
fn parse(
    path: &Path,
    bytes: &[u8],
    dataset: &Dataset,
) -> Result<(Vec<LogEntry>, usize), PreferenceError> {
    if is_utf16(bytes) {
        let path = path.to_path_buf();
        return Err(PreferenceError::Utf16 { path });
    }
    let whole = bytes
        .iter()
        .rposition(|&byte| byte == b'\n')
        .map_or(0, |at| at + 1);
    let lines = bytes[..whole].split_inclusive(|&byte| byte == b'\n');
    let entries = (1..)
        .zip(lines)
        .filter(|(_, line)| !line.trim_ascii().is_empty())
        .map(|(number, line)| parse_line(path, number, line, dataset))
        .collect::<Result<_, _>>()?;
    Ok((entries, whole))
}

/// A line without the mark that an editor puts before the first one.
fn unmarked(line: &[u8]) -> &[u8] {
    line.strip_prefix(MARK).unwrap_or(line)
}

fn parse_line(
    path: &Path,
    line: usize,
    text: &[u8],
    dataset: &Dataset,
) -> Result<LogEntry, PreferenceError> {
    let path = || path.to_path_buf();
    let parsed: Line =
        serde_json::from_slice(unmarked(text)).map_err(|error| PreferenceError::Line {
            path: path(),
            line,
            reason: error.to_string(),
        })?;
    let entry = parsed.entry(dataset);
    entry.map_err(|misfit| PreferenceError::Misfit {
        path: path(),
        line,
        misfit,
    })
}

#[cfg(test)]
#[path = "log_tests.rs"]
mod tests;
