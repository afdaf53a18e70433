//! What `ted doctor` tells about the Python side, without installing anything.

use std::process::{Command, Stdio};

use super::error::SetupError;
use super::stamp::Stamp;
use super::{Environment, is_ready, location, python, sources};
use crate::bridge::Worker;

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
    if is_ready(&venv) {
        checks.push(Check::new(
            "environment",
            Ok(format!("installed in {place}")),
        ));
        checks.push(Check::new("simulator", simulator(&venv)));
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

fn simulator(venv: &std::path::Path) -> Result<String, String> {
    let environment = Environment::installed(venv).map_err(|error| error.to_string())?;
    let worker = Worker::spawn(&environment).map_err(|error| error.to_string())?;
    Ok(worker.versions().to_owned())
}

/// Asks for one small package with the person's own pip and its settings, which is the only way to know.
fn registry(interpreter: &python::Interpreter) -> Result<String, String> {
    let nowhere = std::env::temp_dir().join(format!("ted-doctor-{}", std::process::id()));
    let output = Command::new(&interpreter.path)
        .args([
            "-Es",
            "-m",
            "pip",
            "download",
            "--no-deps",
            "--only-binary",
            ":all:",
            "--disable-pip-version-check",
        ])
        .args([
            "--no-cache-dir",
            "--retries",
            "0",
            "--timeout",
            "10",
            "--dest",
        ])
        .arg(&nowhere)
        .arg(sources::SMALL_PACKAGE)
        .stdin(Stdio::null())
        .output();
    // It may not have been made; what matters is that nothing stays.
    std::fs::remove_dir_all(&nowhere).ok();
    let output = output.map_err(|error| error.to_string())?;
    let text = String::from_utf8_lossy(&output.stderr);
    let lines: Vec<String> = text.lines().map(str::to_owned).collect();
    if output.status.success() {
        Ok("reachable".to_owned())
    } else if lines
        .iter()
        .any(|line| line.contains("No module named pip"))
    {
        Ok(format!(
            "cannot tell: {} has no pip of its own",
            interpreter.path.display()
        ))
    } else {
        Err(
            SetupError::of_step("ask the package registry", std::path::Path::new(""), &lines)
                .to_string(),
        )
    }
}
