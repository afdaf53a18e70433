//! What `ted doctor` tells about the Python side, without installing anything.

use std::path::Path;
use std::process::Stdio;

use super::error::SetupError;
use super::stamp::Stamp;
use super::{Environment, SIMULATOR, location, python, python_of, sources};
use crate::bridge::message::FaultCode;
use crate::bridge::{BridgeError, Look, PictureJob, Worker};
use crate::worlds::metaworld::tasks;

/// One thing that was looked at.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Check {
    /// What was looked at.
    pub name: &'static str,
    /// What was found, or what is wrong and the way out.
    pub outcome: Result<String, String>,
}

impl Check {
    fn new(name: &'static str, outcome: Result<String, String>) -> Self {
        Self { name, outcome }
    }

    /// Whether nothing is wrong with it.
    #[must_use]
    pub const fn is_good(&self) -> bool {
        self.outcome.is_ok()
    }
}

/// Looks at the interpreter, the environment and the simulator, or at the registry if the simulator is not installed yet.
#[must_use]
pub fn diagnose() -> Vec<Check> {
    let interpreter = python::find();
    let mut checks = vec![Check::new("python", tell(interpreter.as_ref()))];
    let venv = match location() {
        Ok(venv) => venv,
        Err(error) => {
            checks.push(Check::new("environment", Err(error.to_string())));
            return checks;
        }
    };
    let place = venv.display();
    if SIMULATOR.is_ready(&venv) {
        checks.push(Check::new(
            "environment",
            Ok(format!("installed in {place}")),
        ));
        checks.extend(simulator(&venv));
        return checks;
    }
    checks.push(Check::new(
        "environment",
        match Stamp::read(&venv) {
            Stamp::Foreign => Err(SetupError::NotOurs { path: venv.clone() }.to_string()),
            Stamp::Nothing => Ok(format!(
                "not installed yet; the first command that needs it installs it into {place}"
            )),
            Stamp::Unfinished => Ok(format!(
                "half installed in {place}; the first command that needs it starts again"
            )),
            Stamp::Ready(_) => Ok(format!(
                "outdated in {place}; the first command that needs it installs it anew"
            )),
        },
    ));
    if let Ok(interpreter) = interpreter {
        checks.push(Check::new("package registry", registry(&interpreter)));
    }
    checks
}

fn tell<T: ToString>(result: Result<&T, &SetupError>) -> Result<String, String> {
    result.map(T::to_string).map_err(ToString::to_string)
}

/// Whether it starts, and if so whether it can draw.
fn simulator(venv: &Path) -> Vec<Check> {
    let check = |outcome| Check::new("simulator", outcome);
    let bridge = SIMULATOR.folder(venv);
    if !bridge.is_dir() {
        let untried =
            "not tried: the first command that needs it writes this version's worker files";
        return vec![check(Ok(untried.to_owned()))];
    }
    match Worker::spawn(&Environment::installed(venv, &bridge)) {
        Ok(mut worker) => {
            let versions = worker.versions().to_owned();
            vec![
                check(Ok(versions)),
                Check::new("pictures", pictures(&mut worker)),
            ]
        }
        Err(error) => vec![check(Err(error.to_string()))],
    }
}

/// By which way `ted ask` gets pictures of its clips. Without one it shows numbers.
fn pictures(worker: &mut Worker) -> Result<String, String> {
    let none = PictureJob {
        task: tasks::ALL[0].to_owned(),
        seed: 0,
        look: Look {
            width: 64,
            height: 48,
            quality: 80,
        },
        states: Vec::new(),
    };
    match worker.render(&none) {
        Ok(pictures) => Ok(format!("drawn without a screen by {}", pictures.way)),
        Err(BridgeError::Refused {
            code: FaultCode::NoPictures,
            message,
            ..
        }) => Err(message),
        Err(error) => Err(error.to_string()),
    }
}

/// Asks for one small package with pip and the person's settings, which is the only way to know.
///
/// The pip is that of a throw-away environment, as the installation's is: an interpreter may have none of its own, or the
/// person's settings may forbid its use.
fn registry(interpreter: &python::Interpreter) -> Result<String, String> {
    let throw_away = std::env::temp_dir().join(format!("ted-doctor-{}", std::process::id()));
    let asked = ask_registry(&interpreter.path, &throw_away);
    // It may not have been made; what matters is that nothing stays.
    std::fs::remove_dir_all(&throw_away).ok();
    asked
        .map(|()| "reachable".to_owned())
        .map_err(|error| error.to_string())
}

fn ask_registry(python: &Path, throw_away: &Path) -> Result<(), SetupError> {
    let step = |step, python: &Path, arguments: &[&str]| {
        let output = python::call(python)
            .args(["-Es", "-m"])
            .args(arguments)
            .arg(throw_away)
            .stdin(Stdio::null())
            .output()
            .map_err(|error| SetupError::Failed {
                step,
                words: error.to_string(),
            })?;
        let text = String::from_utf8_lossy(&output.stderr);
        let lines: Vec<String> = text.lines().map(str::to_owned).collect();
        if output.status.success() {
            Ok(())
        } else {
            Err(SetupError::of_step(step, throw_away, &lines))
        }
    };
    step("create a virtual environment", python, &["venv"])?;
    let options = [
        "--no-deps",
        "--only-binary",
        ":all:",
        "--disable-pip-version-check",
        "--no-cache-dir",
    ];
    // pip names a network that fails only when it tries again.
    let patience = ["--retries", "1", "--timeout", "10"];
    let download = [
        &["pip", "download"],
        &options[..],
        &patience,
        &[sources::SMALL_PACKAGE, "--dest"],
    ]
    .concat();
    step(
        "ask the package registry",
        &python_of(throw_away),
        &download,
    )
}
