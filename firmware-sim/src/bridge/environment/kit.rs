//! What a virtual environment of ours is made of: the files that this program carries, locked requirements among them, and where it
//! is put. There is one for the simulator, and one for the reader of other people's logs.

use std::path::{Path, PathBuf};

use crate::progress::Audience;

use super::error::SetupError;
use super::stamp::Stamp;
use super::{cache, install, python_of, set, sources};

/// The requirements among the files of a kit.
const REQUIREMENTS: &str = "requirements.lock";

/// An environment, and the files that run in it.
#[derive(Clone, Copy, Debug)]
pub struct Kit {
    /// Its folder in the cache is called this, with the digest of the requirements.
    pub name: &'static str,
    /// What it is to people.
    pub what: &'static str,
    /// Names another place for it.
    pub variable: &'static str,
    /// The files, by name. `requirements.lock`, `install.py` and `parent.py` are among them.
    pub files: &'static [(&'static str, &'static str)],
    /// Whether `install.py check` imports everything once, after the installation.
    pub checked: bool,
}

/// The steps of an installation, for the files of a kit.
pub const INSTALLER: [(&str, &str); 2] = [
    (
        "install.py",
        include_str!("../../../metaworld-bridge/install.py"),
    ),
    (
        "parent.py",
        include_str!("../../../metaworld-bridge/parent.py"),
    ),
];

impl Kit {
    /// The interpreter of the environment, installed first if need be, and the folder with the files.
    ///
    /// Safe against a second installer at the same time and against being killed in the middle.
    ///
    /// # Errors
    /// When Python, its venv module, the network or the disk will not do; the message says which, and the way out.
    pub fn ensure(&self, audience: Audience) -> Result<(PathBuf, PathBuf), SetupError> {
        let venv = self.location()?;
        if !self.is_ready(&venv) {
            install::install(self, &venv, audience)?;
        }
        Ok((python_of(&venv), self.write(&venv)?))
    }

    /// Where the environment is or would be, as an absolute path: workers run in another folder than this process.
    pub(super) fn location(&self) -> Result<PathBuf, SetupError> {
        if let Some(named) = set(self.variable) {
            return std::path::absolute(&named)
                .map_err(|source| SetupError::storage("find", &named, source));
        }
        let digest = self.lock_digest();
        Ok(cache()?.join(format!("{}-{}", self.name, &digest[..16])))
    }

    /// Whether the environment is complete and made from this program's requirements.
    pub(super) fn is_ready(&self, venv: &Path) -> bool {
        Stamp::read(venv) == Stamp::Ready(self.lock_digest()) && python_of(venv).exists()
    }

    /// The digest of the locked requirements, which names the environment made from them.
    pub(super) fn lock_digest(&self) -> String {
        sources::digest((self.files.iter()).filter(|(name, _)| *name == REQUIREMENTS))
    }

    /// How many packages the lock file holds, for progress.
    pub(super) fn locked_packages(&self) -> u64 {
        let lock = (self.files.iter())
            .find(|(name, _)| *name == REQUIREMENTS)
            .map_or("", |(_, text)| text);
        let mut names: Vec<_> = (lock.lines())
            .filter_map(|line| Some(line.split_once("==")?.0))
            .collect();
        names.dedup();
        names.len() as u64
    }

    /// Puts the files into the environment, under a name that holds their digest, and returns their folder.
    pub(super) fn write(&self, venv: &Path) -> Result<PathBuf, SetupError> {
        sources::put(self.folder(venv), self.files)
    }

    /// Where the files are once they are written.
    pub(super) fn folder(&self, venv: &Path) -> PathBuf {
        venv.join(format!(
            "bridge-{}",
            &sources::digest(self.files.iter())[..16]
        ))
    }
}
