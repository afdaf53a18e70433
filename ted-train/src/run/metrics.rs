//! `metrics.jsonl`: one JSON object a line, in order of steps, without a clock so that equal runs write equal bytes.

use std::fs::{File, OpenOptions};
use std::io::{BufRead, BufReader, Write};
use std::path::Path;

use serde_json::{Map, Value};

use firmware_sim::disk::WriteError;

/// An append-only log of metrics.
#[derive(Debug)]
pub struct MetricsLog {
    file: File,
    path: std::path::PathBuf,
}

impl MetricsLog {
    /// Opens the log of a run that goes on after `step`: later rows and a torn last line are dropped, because the run
    /// will write them again.
    ///
    /// # Errors
    /// When the file cannot be read or written.
    pub fn resume(path: &Path, step: u64) -> Result<Self, WriteError> {
        let failed = |source| WriteError::at(path, source);
        let mut kept = Vec::new();
        if path.exists() {
            for line in BufReader::new(File::open(path).map_err(failed)?).lines() {
                let Ok(line) = line else { break };
                let row: Option<Map<String, Value>> = serde_json::from_str(&line).ok();
                match row.and_then(|row| row.get("step").and_then(Value::as_u64)) {
                    Some(at) if at <= step => kept.extend([line.as_bytes(), b"\n"].concat()),
                    _ => break,
                }
            }
        }
        firmware_sim::disk::replace(path, &kept)?;
        let file = OpenOptions::new().append(true).open(path).map_err(failed)?;
        Ok(Self {
            file,
            path: path.to_path_buf(),
        })
    }

    /// Appends a row: the phase, the step, and the fields of a serialisable value.
    ///
    /// # Errors
    /// When the disk is full or fails.
    ///
    /// # Panics
    /// Never: metrics are plain data.
    pub fn push(
        &mut self,
        phase: &str,
        step: u64,
        fields: &impl serde::Serialize,
    ) -> Result<Map<String, Value>, WriteError> {
        let mut row = Map::from_iter([
            ("phase".to_owned(), phase.into()),
            ("step".to_owned(), step.into()),
        ]);
        if let Value::Object(fields) = serde_json::to_value(fields).expect("metrics are plain data")
        {
            row.extend(fields);
        }
        let mut line = serde_json::to_vec(&row).expect("metrics are plain data");
        line.push(b'\n');
        self.file
            .write_all(&line)
            .map_err(|source| WriteError::at(&self.path, source))?;
        Ok(row)
    }

    /// The same log for another thread, which waits for the disk while this one appends.
    ///
    /// # Errors
    /// When the operating system gives no other handle.
    pub fn again(&self) -> Result<Self, WriteError> {
        let file = self.file.try_clone();
        Ok(Self {
            file: file.map_err(|source| WriteError::at(&self.path, source))?,
            path: self.path.clone(),
        })
    }

    /// Waits until every row is on the disk: a checkpoint must not outlive the rows before it.
    ///
    /// # Errors
    /// When the disk fails.
    pub fn sync(&self) -> Result<(), WriteError> {
        self.file
            .sync_data()
            .map_err(|source| WriteError::at(&self.path, source))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_after_the_checkpoint_and_a_torn_line_are_written_again() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("metrics.jsonl");
        let row = |x: f32| std::collections::BTreeMap::from([("loss", x)]);
        let mut log = MetricsLog::resume(&path, 0).unwrap();
        for step in [10, 20, 30] {
            log.push("iql", step, &row(step as f32)).unwrap();
        }
        let whole = std::fs::read(&path).unwrap();
        std::fs::write(&path, &whole[..whole.len() - 5]).unwrap();

        let mut log = MetricsLog::resume(&path, 10).unwrap();
        for step in [20, 30] {
            log.push("iql", step, &row(step as f32)).unwrap();
        }
        assert_eq!(std::fs::read(&path).unwrap(), whole);
    }
}
