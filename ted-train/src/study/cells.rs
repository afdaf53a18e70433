//! What a study has measured: a file with a line of JSON for each cell, appended as it is measured, so that a stopped study
//! goes on.

use std::fs::{File, OpenOptions};
use std::io::{self, ErrorKind, Read, Write};
use std::path::{Path, PathBuf};

use firmware_sim::disk::{self, WriteError};
use serde::Serialize;
use serde::de::DeserializeOwned;

/// Why the cells of a file are not known.
#[derive(Debug, thiserror::Error)]
pub enum CellsError {
    /// Their folder is another process's, or the disk fails.
    #[error(transparent)]
    Disk(#[from] WriteError),
    /// The file system.
    #[error("cannot read {path}: {source}")]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// A line that this study did not write.
    #[error("line {line} of {path} is none of this study: {message}; correct it, or take it out")]
    Line {
        /// The file.
        path: PathBuf,
        /// Counted from 1.
        line: usize,
        /// What the parser said.
        message: String,
    },
}

/// The cells of a file; none if there is no file. A last line that a kill tore is none.
///
/// # Errors
/// When it cannot be read, or another line is not a cell.
pub fn read<C: DeserializeOwned>(path: &Path) -> Result<Vec<C>, CellsError> {
    let held = match std::fs::read(path) {
        Err(error) if error.kind() == ErrorKind::NotFound => Vec::new(),
        held => held.map_err(|source| CellsError::Io {
            path: path.to_path_buf(),
            source,
        })?,
    };
    let whole = whole::<C>(&held).len();
    let lines = held[..whole].split(|&byte| byte == b'\n').enumerate();
    let lines = lines.filter(|(_, text)| !text.is_empty());
    let cell = |(line, text)| {
        serde_json::from_slice(text).map_err(|error| CellsError::Line {
            path: path.to_path_buf(),
            line: line + 1,
            message: error.to_string(),
        })
    };
    lines.map(cell).collect()
}

/// Whether cells can be added to a file, which is begun if there is none: to know before long work, not after.
///
/// # Errors
/// When the disk is full or the file cannot be written.
pub fn check_writable(path: &Path) -> Result<(), WriteError> {
    disk::create_folder(folder_of(path))?;
    open(path).map_err(|source| WriteError::at(path, source))?;
    Ok(())
}

/// Adds a cell to a file, which is begun if there is none, and waits until it is on the disk. Several processes may do so.
///
/// # Errors
/// When the disk is full or fails; the cells before are as they were.
///
/// # Panics
/// Never: a cell is plain data.
pub fn append<C: Serialize + DeserializeOwned>(path: &Path, cell: &C) -> Result<(), WriteError> {
    disk::create_folder(folder_of(path))?;
    append_line::<C>(path, &line(cell)).map_err(|source| WriteError::at(path, source))?;
    disk::sync_folder(folder_of(path))
}

/// A cell as a line of a file.
pub(super) fn line<C: Serialize>(cell: &C) -> String {
    serde_json::to_string(cell).expect("a cell is plain data") + "\n"
}

fn folder_of(path: &Path) -> &Path {
    let folder = path.parent().filter(|it| !it.as_os_str().is_empty());
    folder.unwrap_or(Path::new("."))
}

fn open(path: &Path) -> io::Result<File> {
    let mut options = OpenOptions::new();
    options.read(true).append(true).create(true).open(path)
}

fn append_line<C: DeserializeOwned>(path: &Path, line: &str) -> io::Result<()> {
    let mut file = open(path)?;
    file.lock()?;
    let mut held = Vec::new();
    file.read_to_end(&mut held)?;
    let whole = whole::<C>(&held);
    file.set_len(whole.len() as u64)?;
    let end = match whole.last() {
        None | Some(b'\n') => "",
        Some(_) => "\n",
    };
    let written = file.write_all(format!("{end}{line}").as_bytes());
    written.and_then(|()| file.sync_all()).inspect_err(|_| {
        // Half a line would spoil the next one, which may find room again.
        let _ = file.set_len(whole.len() as u64);
    })
}

/// All but a last line that a kill tore. One that only lost its end, in an editor as a rule, is whole.
fn whole<C: DeserializeOwned>(held: &[u8]) -> &[u8] {
    let end = held.iter().rposition(|&byte| byte == b'\n');
    let (before, last) = held.split_at(end.map_or(0, |end| end + 1));
    match serde_json::from_slice::<C>(last) {
        Ok(_) => held,
        Err(_) => before,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_torn_last_line_is_dropped_and_one_without_its_end_is_kept() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("not/yet/cells.jsonl");
        let cells = || read::<[u32; 1]>(&path).unwrap();
        assert!(cells().is_empty());
        append(&path, &[7]).unwrap();
        for (held, kept, then) in [
            ("[7]\n[12", vec![[7]], "[7]\n[8]\n"),
            ("[7]\n[12]", vec![[7], [12]], "[7]\n[12]\n[8]\n"),
            ("[12", vec![], "[8]\n"),
        ] {
            std::fs::write(&path, held).unwrap();
            assert_eq!(cells(), kept, "{held}");
            append(&path, &[8]).unwrap();
            assert_eq!(std::fs::read_to_string(&path).unwrap(), then, "{held}");
        }
    }

    #[test]
    fn a_damaged_line_is_named_and_kept() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("cells.jsonl");
        std::fs::write(&path, b"7\n\xff\n8\n").unwrap();
        let error = read::<u32>(&path).unwrap_err().to_string();
        assert!(error.contains("line 2 of"), "{error}");
        append(&path, &9_u32).unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"7\n\xff\n8\n9\n");
    }

    #[test]
    fn cells_of_several_writers_are_all_there() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("cells.jsonl");
        std::thread::scope(|scope| {
            for writer in 0..4_u32 {
                let path = &path;
                scope.spawn(move || {
                    for cell in 0..25 {
                        append(path, &(100 * writer + cell)).unwrap();
                    }
                });
            }
        });
        let mut cells = read::<u32>(&path).unwrap();
        cells.sort_unstable();
        let expected = (0..4).flat_map(|writer| (0..25).map(move |cell| 100 * writer + cell));
        assert_eq!(cells, expected.collect::<Vec<_>>());
    }
}
