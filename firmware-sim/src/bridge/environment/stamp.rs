//! The file that says whose folder this is and whether the installation was finished.

use std::ffi::OsString;
use std::fs;
use std::io::{self, Write};
use std::path::Path;

const NAME: &str = "ted-environment";
/// What it is called while it is written.
const NEW: &str = "ted-environment.new";
const READY: &str = "ready ";
const UNFINISHED: &str = "unfinished";

/// What a folder is to us.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Stamp {
    /// There is nothing, or an empty folder.
    Nothing,
    /// Something that we did not make, and therefore never delete.
    Foreign,
    /// Ours, but the installation did not come to its end.
    Unfinished,
    /// Ours and complete, made from the requirements with this digest.
    Ready(String),
}

impl Stamp {
    pub(super) fn read(venv: &Path) -> Self {
        match fs::read_to_string(venv.join(NAME)) {
            Ok(text) => match text.trim_end().strip_prefix(READY) {
                Some(digest) => Self::Ready(digest.to_owned()),
                None => Self::Unfinished,
            },
            Err(_) => match entries(venv).as_deref() {
                Ok([]) => Self::Nothing,
                // We were stopped, or the disk was full, before the first stamp had its name.
                Ok([only]) if only == NEW => Self::Unfinished,
                Err(error) if error.kind() == io::ErrorKind::NotFound => Self::Nothing,
                _ => Self::Foreign,
            },
        }
    }

    /// Marks a new folder as ours.
    pub(super) fn write_unfinished(venv: &Path) -> io::Result<()> {
        write(venv, UNFINISHED)
    }

    /// Removes everything in a folder of ours but the stamp, which says whose the rest is if this is interrupted.
    pub(super) fn remove_the_rest(venv: &Path) -> io::Result<()> {
        for name in entries(venv)? {
            let path = venv.join(&name);
            if name == NAME {
                continue;
            } else if path.is_dir() && !path.is_symlink() {
                fs::remove_dir_all(path)?;
            } else {
                fs::remove_file(path)?;
            }
        }
        Ok(())
    }

    /// Marks the installation as complete: the last thing that is written.
    pub(super) fn write_ready(venv: &Path, digest: &str) -> io::Result<()> {
        write(venv, &format!("{READY}{digest}"))
    }
}

/// Writes beside and renames, so that the stamp is never seen half written.
fn write(venv: &Path, text: &str) -> io::Result<()> {
    let beside = venv.join(NEW);
    let mut file = fs::File::create(&beside)?;
    writeln!(file, "{text}")?;
    file.sync_all()?;
    fs::rename(beside, venv.join(NAME))
}

fn entries(venv: &Path) -> io::Result<Vec<OsString>> {
    fs::read_dir(venv)?
        .map(|entry| Ok(entry?.file_name()))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_is_nothing_then_unfinished_then_ready() -> io::Result<()> {
        let folder = tempfile::tempdir()?;
        assert_eq!(Stamp::read(&folder.path().join("absent")), Stamp::Nothing);
        assert_eq!(Stamp::read(folder.path()), Stamp::Nothing);
        Stamp::write_unfinished(folder.path())?;
        assert_eq!(Stamp::read(folder.path()), Stamp::Unfinished);
        Stamp::write_ready(folder.path(), "abc")?;
        assert_eq!(Stamp::read(folder.path()), Stamp::Ready("abc".to_owned()));
        Ok(())
    }

    #[test]
    fn a_folder_whose_first_stamp_was_not_finished_is_ours() -> io::Result<()> {
        let folder = tempfile::tempdir()?;
        fs::write(folder.path().join(NEW), "")?;
        assert_eq!(Stamp::read(folder.path()), Stamp::Unfinished);
        fs::write(folder.path().join("thesis.tex"), "years of work")?;
        assert_eq!(Stamp::read(folder.path()), Stamp::Foreign);
        Ok(())
    }

    #[test]
    fn the_stamp_outlives_everything_else() -> io::Result<()> {
        let folder = tempfile::tempdir()?;
        let elsewhere = tempfile::tempdir()?;
        fs::write(elsewhere.path().join("kept"), "")?;
        Stamp::write_unfinished(folder.path())?;
        fs::create_dir_all(folder.path().join("lib/python3.11"))?;
        fs::write(folder.path().join("pyvenv.cfg"), "")?;
        std::os::unix::fs::symlink(elsewhere.path(), folder.path().join("lib64"))?;
        Stamp::remove_the_rest(folder.path())?;
        assert_eq!(entries(folder.path())?, [NAME]);
        assert_eq!(Stamp::read(folder.path()), Stamp::Unfinished);
        assert!(elsewhere.path().join("kept").exists());
        Ok(())
    }

    #[test]
    fn a_folder_with_other_things_in_it_is_not_ours() -> io::Result<()> {
        let folder = tempfile::tempdir()?;
        fs::write(folder.path().join("thesis.tex"), "years of work")?;
        assert_eq!(Stamp::read(folder.path()), Stamp::Foreign);
        Ok(())
    }
}
