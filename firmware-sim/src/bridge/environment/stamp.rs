//! The file that says whose folder this is and whether the installation was finished.

use std::fs;
use std::io::{self, Write};
use std::path::Path;

const NAME: &str = "ted-environment";
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
            Err(_) if is_empty(venv) => Self::Nothing,
            Err(_) => Self::Foreign,
        }
    }

    /// Marks a new folder as ours.
    pub(super) fn write_unfinished(venv: &Path) -> io::Result<()> {
        write(venv, UNFINISHED)
    }

    /// Marks the installation as complete: the last thing that is written.
    pub(super) fn write_ready(venv: &Path, digest: &str) -> io::Result<()> {
        write(venv, &format!("{READY}{digest}"))
    }
}

/// Writes beside and renames, so that the stamp is never seen half written.
fn write(venv: &Path, text: &str) -> io::Result<()> {
    let beside = venv.join(format!("{NAME}.new"));
    let mut file = fs::File::create(&beside)?;
    writeln!(file, "{text}")?;
    file.sync_all()?;
    fs::rename(beside, venv.join(NAME))
}

fn is_empty(venv: &Path) -> bool {
    match fs::read_dir(venv) {
        Ok(mut entries) => entries.next().is_none(),
        Err(error) => error.kind() == io::ErrorKind::NotFound,
    }
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
    fn a_folder_with_other_things_in_it_is_not_ours() -> io::Result<()> {
        let folder = tempfile::tempdir()?;
        fs::write(folder.path().join("thesis.tex"), "years of work")?;
        assert_eq!(Stamp::read(folder.path()), Stamp::Foreign);
        Ok(())
    }
}
