//! A world of one's own: a Python file with three functions, or an environment of Gymnasium, in the person's own interpreter.
//! `docs/own-world.md` says what a file looks like.

use std::ffi::OsString;
use std::fmt;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use crate::bridge::Environment;
use crate::bridge::environment::SetupError;

/// A world that a person brings.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum OwnWorld {
    /// A Python file, as an absolute path.
    File(PathBuf),
    /// An environment of Gymnasium, by its id.
    Gymnasium(String),
}

const GYM: &str = "gym:";

impl OwnWorld {
    /// What names it from anywhere on this machine.
    #[must_use]
    pub fn source(&self) -> String {
        match self {
            Self::File(path) => path.to_string_lossy().into_owned(),
            Self::Gymnasium(id) => format!("{GYM}{id}"),
        }
    }

    /// Its worker, which starts where the file is.
    ///
    /// # Errors
    /// When the worker's files cannot be written.
    pub fn environment(&self) -> Result<Environment, SetupError> {
        let (name, folder) = match self {
            Self::File(path) => (path.clone().into_os_string(), path.parent()),
            Self::Gymnasium(id) => (OsString::from(format!("{GYM}{id}")), None),
        };
        let here = || std::env::current_dir().unwrap_or_else(|_| Path::new(".").to_owned());
        let folder = folder.map_or_else(here, Path::to_owned);
        Environment::own(&name, &folder)
    }
}

impl fmt::Display for OwnWorld {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File(path) => {
                let name = path.file_name().unwrap_or(path.as_os_str());
                f.write_str(&name.to_string_lossy())
            }
            Self::Gymnasium(id) => write!(f, "{GYM}{id}"),
        }
    }
}

impl FromStr for OwnWorld {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if let Some(id) = text.strip_prefix(GYM) {
            return match id {
                "" => Err(
                    "gym: is followed by the id of an environment, such as gym:Pendulum-v1"
                        .to_owned(),
                ),
                id => Ok(Self::Gymnasium(id.to_owned())),
            };
        }
        let path = std::path::absolute(text).map_err(|error| format!("{text}: {error}"))?;
        if path.is_file() {
            Ok(Self::File(path))
        } else {
            Err(format!(
                "there is no file {text}: a world is a Python file with make(), reset() and step(), or gym: and the id of an environment of Gymnasium"
            ))
        }
    }
}
