//! Finds a Python that the simulator's packages were built for.

use std::env;
use std::fmt;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use super::error::SetupError;
use super::{PYTHON_VARIABLE, set};

/// The versions that all locked packages have wheels for.
pub(super) const OLDEST: (u32, u32) = (3, 10);
pub(super) const NEWEST: (u32, u32) = (3, 13);

/// Tried in this order when the person names none.
const CANDIDATES: [&str; 5] = [
    "python3",
    "python3.13",
    "python3.12",
    "python3.11",
    "python3.10",
];

const PROBE: &str = "\
import sys
print(sys.version_info[0], sys.version_info[1])
try:
    import venv, ensurepip
    print('venv')
except ImportError:
    print('no venv')
";

/// A Python interpreter that can create the environment.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Interpreter {
    /// How to call it.
    pub path: PathBuf,
    /// Its version, such as 3.11.
    pub version: (u32, u32),
}

impl fmt::Display for Interpreter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} (Python {}.{})",
            self.path.display(),
            self.version.0,
            self.version.1
        )
    }
}

/// The interpreter named by `TED_PYTHON`, or else the first one on the path that will do.
///
/// # Errors
/// That of the named one, or of the plain `python3`, if none will do.
pub fn find() -> Result<Interpreter, SetupError> {
    if let Some(named) = set(PYTHON_VARIABLE) {
        return probe(&named);
    }
    let mut found = CANDIDATES.iter().map(|name| probe(Path::new(name)));
    let first = found.next().unwrap_or(Err(SetupError::NoPython {
        python: CANDIDATES[0].into(),
    }));
    match first {
        Ok(python) => Ok(python),
        Err(error) => found.find_map(Result::ok).ok_or(error),
    }
}

/// A call of an interpreter that runs a program of ours. Variables such as `PYTHONHOME` and `PYTHONPATH`, which the person may have
/// for Python programs of their own, are not handed on: `-E` alone would leave them to the processes that ours start.
#[must_use]
pub fn call(python: &Path) -> Command {
    let mut command = Command::new(python);
    for (name, _) in env::vars_os() {
        if name.as_encoded_bytes().starts_with(b"PYTHON") {
            command.env_remove(name);
        }
    }
    command
}

fn probe(python: &Path) -> Result<Interpreter, SetupError> {
    let output = call(python)
        .args(["-Es", "-c", PROBE])
        .stdin(Stdio::null())
        .output()
        .map_err(|_| SetupError::NoPython {
            python: python.to_owned(),
        })?;
    let answer = String::from_utf8_lossy(&output.stdout);
    let mut lines = answer.lines();
    let version = lines.next().and_then(parse_version);
    let Some(version) = version.filter(|_| output.status.success()) else {
        let words = String::from_utf8_lossy(&output.stderr).trim().to_owned();
        return Err(SetupError::BrokenPython {
            python: python.to_owned(),
            words,
        });
    };
    if !(OLDEST..=NEWEST).contains(&version) {
        return Err(SetupError::PythonVersion {
            python: python.to_owned(),
            actual: version,
        });
    }
    if lines.next() != Some("venv") {
        return Err(SetupError::NoVenv {
            python: python.to_owned(),
            version,
        });
    }
    Ok(Interpreter {
        path: python.to_owned(),
        version,
    })
}

fn parse_version(line: &str) -> Option<(u32, u32)> {
    let (major, minor) = line.split_once(' ')?;
    Some((major.parse().ok()?, minor.parse().ok()?))
}

#[cfg(test)]
mod tests {
    use std::io;

    use super::*;

    /// An executable that answers the probe with a fixed text.
    ///
    /// A process of its own writes it: a file that is open for writing cannot be executed, and while it were open here, a
    /// process that another test starts could take it along, open.
    fn fake(folder: &Path, answer: &str) -> io::Result<PathBuf> {
        let path = folder.join("python3");
        let script = format!("#!/bin/sh\n{answer}\n");
        let written = Command::new("sh")
            .args([
                "-c",
                r#"printf %s "$1" >"$2" && chmod +x "$2""#,
                "sh",
                &script,
            ])
            .arg(&path)
            .status()?;
        assert!(written.success());
        Ok(path)
    }

    #[test]
    fn a_python_that_is_not_there_is_named() {
        let error = probe(Path::new("/nowhere/python3"));
        assert!(matches!(error, Err(SetupError::NoPython { .. })));
    }

    #[test]
    fn a_python_too_old_or_too_new_is_named_with_its_version() -> io::Result<()> {
        for (answer, actual) in [
            ("echo 3 9; echo venv", (3, 9)),
            ("echo 3 14; echo venv", (3, 14)),
        ] {
            let folder = tempfile::tempdir()?;
            let error = probe(&fake(folder.path(), answer)?);
            assert!(
                matches!(error, Err(SetupError::PythonVersion { actual: found, .. }) if found == actual)
            );
        }
        Ok(())
    }

    #[test]
    fn a_python_without_venv_is_told_apart() -> io::Result<()> {
        let folder = tempfile::tempdir()?;
        let error = probe(&fake(folder.path(), "echo 3 11; echo no venv")?);
        assert!(matches!(error, Err(SetupError::NoVenv { .. })));
        Ok(())
    }

    #[test]
    fn a_python_that_fails_is_quoted() -> io::Result<()> {
        let folder = tempfile::tempdir()?;
        let error = probe(&fake(folder.path(), "echo broken >&2; exit 1")?);
        assert!(matches!(error, Err(SetupError::BrokenPython { words, .. }) if words == "broken"));
        Ok(())
    }
}
