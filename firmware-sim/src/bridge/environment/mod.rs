//! The Python side: a virtual environment of its own, installed by the first command that needs it.
//!
//! It lives in the user's cache folder under a name that holds the digest of the locked requirements, so that versions of
//! this program with different requirements do not disturb each other. `TED_METAWORLD_VENV` names another place,
//! `TED_PYTHON` another interpreter. Nothing outside that folder is touched.

mod checks;
mod error;
mod install;
mod kit;
mod python;
mod sources;
mod stamp;

use std::env;
use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};
use std::process::Command;

pub use checks::{Check, diagnose};
pub use error::SetupError;
pub use kit::{INSTALLER, Kit};
pub use python::{Interpreter, call, find as interpreter};
pub use sources::WORKER_KIT;

use super::engine::Engine;
use crate::progress::Audience;

/// Names a place for the virtual environment other than the cache folder.
pub const VENV_VARIABLE: &str = "TED_METAWORLD_VENV";
/// Names the Python interpreter that creates the virtual environment.
pub const PYTHON_VARIABLE: &str = "TED_PYTHON";

/// What the simulator's environment is made of.
const SIMULATOR: Kit = Kit {
    name: "metaworld",
    what: "the Meta-World simulator",
    variable: VENV_VARIABLE,
    files: &sources::FILES,
    checked: true,
};

/// A Python interpreter and the worker it can run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Environment {
    python: PathBuf,
    worker: PathBuf,
    scratch: PathBuf,
    /// Whether this program installed it, in the folder `scratch`.
    ours: bool,
    plays: Plays,
}

/// What the worker is told to play.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Plays {
    /// Meta-World on this engine.
    MetaWorld(Engine),
    /// A task of another world that this program knows.
    Task(&'static str),
    /// A world of one's own.
    Own(OsString),
}

/// What simulates a task in the simulator's environment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Program {
    /// The worker of Meta-World, on this engine.
    MetaWorld(Engine),
    /// A worker of another world.
    Worker {
        /// The folder of its files is called this, with their digest.
        name: &'static str,
        /// Its files beside [`WORKER_KIT`], by name.
        files: &'static [(&'static str, &'static str)],
        /// The one that is run.
        script: &'static str,
        /// The task, which it is told.
        task: &'static str,
    },
}

impl Environment {
    /// An interpreter and a worker script of one's own: for another simulator that speaks the protocol, and for tests.
    #[must_use]
    pub fn custom(python: &Path, worker: &Path, scratch: &Path) -> Self {
        Self {
            python: python.to_owned(),
            worker: worker.to_owned(),
            scratch: scratch.to_owned(),
            ours: false,
            plays: Plays::MetaWorld(Engine::default()),
        }
    }

    /// The interpreter of whoever calls, with the worker for a world of one's own; `world` is a Python file or `gym:` and the id of an
    /// environment. The worker starts in `folder`.
    ///
    /// # Errors
    /// When the worker's files cannot be written into the cache folder.
    pub fn own(world: &OsStr, folder: &Path) -> Result<Self, SetupError> {
        let python = set(PYTHON_VARIABLE).unwrap_or_else(|| "python3".into());
        let worker = sources::write_worker(&cache()?, "own-world", &[])?.join(sources::OWN_WORKER);
        Ok(Self {
            plays: Plays::Own(world.to_owned()),
            ..Self::custom(&python, &worker, folder)
        })
    }

    /// How the worker is started. Neither `PYTHONPATH` nor the user's own packages may change what Meta-World imports; a world of
    /// one's own may need them.
    pub(super) fn command(&self) -> Command {
        let ours = |plays: &str| {
            let mut command = call(&self.python);
            command.arg("-Es").arg(&self.worker).arg(plays);
            command
        };
        match &self.plays {
            Plays::MetaWorld(engine) => ours(engine.name()),
            Plays::Task(task) => ours(task),
            Plays::Own(world) => {
                let mut command = Command::new(&self.python);
                command.arg(&self.worker).arg(world);
                command
            }
        }
    }

    /// The same environment with another engine.
    #[must_use]
    pub fn with_engine(self, engine: Engine) -> Self {
        Self {
            plays: Plays::MetaWorld(engine),
            ..self
        }
    }

    /// The same interpreter with the program that simulates a task.
    ///
    /// # Errors
    /// When the program's files cannot be written into the environment.
    pub fn running(self, program: Program) -> Result<Self, SetupError> {
        match program {
            Program::MetaWorld(engine) => Ok(self.with_engine(engine)),
            Program::Worker {
                name,
                files,
                script,
                task,
            } => Ok(Self {
                worker: sources::write_worker(&self.scratch, name, files)?.join(script),
                plays: Plays::Task(task),
                ..self
            }),
        }
    }

    /// How its workers simulate Meta-World.
    #[must_use]
    pub const fn engine(&self) -> Engine {
        match self.plays {
            Plays::MetaWorld(engine) => engine,
            Plays::Task(_) | Plays::Own(_) => Engine::Reference,
        }
    }

    /// The interpreter that runs the workers.
    #[must_use]
    pub fn python(&self) -> &Path {
        &self.python
    }

    /// The worker's script.
    #[must_use]
    pub fn worker(&self) -> &Path {
        &self.worker
    }

    /// The workers' current directory, where MuJoCo leaves its log.
    #[must_use]
    pub fn scratch(&self) -> &Path {
        &self.scratch
    }

    /// What helps when the worker does not even start: an environment of ours can be broken after its installation, by an
    /// upgrade of its Python for instance, and its stamp cannot tell.
    pub(super) fn remedy(&self) -> String {
        if self.ours {
            let place = self.scratch.display();
            format!(
                "delete the folder {place} and run this again, which installs the simulator anew"
            )
        } else {
            format!("check {}", self.worker.display())
        }
    }

    /// The environment in this folder with the worker's files in that one.
    fn installed(venv: &Path, bridge: &Path) -> Self {
        Self {
            ours: true,
            ..Self::custom(&python_of(venv), &bridge.join(sources::WORKER), venv)
        }
    }
}

/// The environment, installed first if need be: a few hundred megabytes and a minute or two.
///
/// Safe against a second installer at the same time and against being killed in the middle.
///
/// # Errors
/// When Python, its venv module, the network or the disk will not do; the message says which, and the way out.
pub fn ensure(audience: Audience) -> Result<Environment, SetupError> {
    SIMULATOR.ensure(audience)?;
    let venv = location()?;
    Ok(Environment::installed(&venv, &SIMULATOR.write(&venv)?))
}

/// The environment if it is installed; none if it is not, and nothing is installed.
///
/// # Errors
/// When nobody knows where it would be, or the worker's files cannot be written into it.
pub fn find() -> Result<Option<Environment>, SetupError> {
    let venv = location()?;
    if !SIMULATOR.is_ready(&venv) {
        return Ok(None);
    }
    Ok(Some(Environment::installed(
        &venv,
        &SIMULATOR.write(&venv)?,
    )))
}

/// Names everything that decides how a state looks in a picture, beside the state: a picture that was kept under another name may
/// be of another camera.
#[must_use]
pub fn drawing_digest() -> String {
    sources::drawing_digest()
}

/// Where the virtual environment is or would be, as an absolute path: workers run in another folder than this process.
///
/// # Errors
/// When there is neither a home folder nor a variable that names the place.
pub fn location() -> Result<PathBuf, SetupError> {
    SIMULATOR.location()
}

/// This program's folder in the user's cache.
fn cache() -> Result<PathBuf, SetupError> {
    let cache = match (set("XDG_CACHE_HOME"), set("HOME")) {
        (Some(cache), _) if cache.is_absolute() => cache,
        (_, Some(home)) => home.join(".cache"),
        _ => return Err(SetupError::NoHome),
    };
    Ok(cache.join("ted"))
}

fn python_of(venv: &Path) -> PathBuf {
    venv.join("bin").join("python")
}

fn set(variable: &str) -> Option<PathBuf> {
    env::var_os(variable)
        .filter(|value| !value.is_empty())
        .map(PathBuf::from)
}
