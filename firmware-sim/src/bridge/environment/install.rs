//! Installs the environment, once, whoever else tries at the same time and however often it was killed before.

use std::fs::{self, File, TryLockError};
use std::io::{self, BufRead, BufReader, Read};
use std::os::unix::process::CommandExt;
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::thread;
use std::time::Duration;

use rustix::process::{Pid, Signal, kill_process_group};

use super::error::SetupError;
use super::kit::Kit;
use super::stamp::Stamp;
use super::{python, python_of, sources};
use crate::interrupt;
use crate::progress::{Audience, Progress};

/// How soon a request to stop is noticed.
const SLICE: Duration = Duration::from_millis(100);

/// Makes a complete environment at `venv`, or waits until another process has.
pub(super) fn install(kit: &Kit, venv: &Path, audience: Audience) -> Result<(), SetupError> {
    let interpreter = python::find()?;
    let _lock = lock(kit, venv, audience)?;
    if kit.is_ready(venv) {
        return Ok(());
    }
    clear(venv)?;
    audience.note(&format!(
        "installing {} into {} with {interpreter}",
        kit.what,
        venv.display()
    ));
    // One unit per package, one for the environment itself, one for the first import.
    let progress = audience.start("install", kit.locked_packages() + 2, "steps");
    let storage = |source| SetupError::storage("install into", venv, source);

    fs::create_dir_all(venv).map_err(storage)?;
    Stamp::write_unfinished(venv).map_err(storage)?;
    let bridge = kit.write(venv)?;
    let script = bridge.join(sources::INSTALL);
    let step = |name, python: &Path, arguments: &[&Path]| {
        let mut command = python::call(python);
        command.arg("-Esu").arg(&script).args(arguments);
        run(name, command, venv, &progress)
    };

    progress.message("creating the virtual environment");
    step(
        "create the virtual environment",
        &interpreter.path,
        &[Path::new("venv"), venv],
    )?;
    progress.advance(1);
    let requirements = bridge.join(sources::REQUIREMENTS);
    step(
        "install the packages",
        &python_of(venv),
        &[Path::new("pip"), &requirements],
    )?;
    if kit.checked {
        progress.message("importing the simulator for the first time");
        step(
            "import the simulator",
            &python_of(venv),
            &[Path::new("check")],
        )?;
    }
    progress.advance(1);

    Stamp::write_ready(venv, &kit.lock_digest()).map_err(storage)?;
    progress.finish();
    Ok(())
}

/// Holds off other installers until it is dropped, or this process ends in any way.
fn lock(kit: &Kit, venv: &Path, audience: Audience) -> Result<File, SetupError> {
    // The whole name, not another extension: `poetry.env` may have a `poetry.lock` beside it.
    let mut name = venv.file_name().unwrap_or_default().to_owned();
    name.push(".ted-lock");
    let path = venv.with_file_name(name);
    let storage = |source| SetupError::storage("lock", &path, source);
    if let Some(parent) = path.parent() {
        fs::create_dir_all(parent).map_err(storage)?;
    }
    // Without truncating, whatever the file is.
    let file = File::options().create(true).append(true).open(&path);
    let file = file.map_err(storage)?;
    let mut told = false;
    loop {
        match file.try_lock() {
            Ok(()) => return Ok(file),
            Err(TryLockError::Error(source)) => return Err(storage(source)),
            Err(TryLockError::WouldBlock) if interrupt::requested() => {
                return Err(SetupError::Interrupted);
            }
            Err(TryLockError::WouldBlock) => {
                if !told {
                    audience.note(&format!(
                        "waiting for another process that installs {}",
                        kit.what
                    ));
                    told = true;
                }
                thread::sleep(SLICE);
            }
        }
    }
}

/// Removes what an earlier installation left, and nothing that is not ours.
fn clear(venv: &Path) -> Result<(), SetupError> {
    match Stamp::read(venv) {
        Stamp::Nothing => Ok(()),
        Stamp::Foreign => Err(SetupError::NotOurs {
            path: venv.to_owned(),
        }),
        Stamp::Unfinished | Stamp::Ready(_) => {
            // Without its interpreter it is not ready, whatever the stamp says until the new one is written.
            match fs::remove_file(python_of(venv)) {
                Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(()),
                removed => removed,
            }
            .and_then(|()| Stamp::remove_the_rest(venv))
            .map_err(|source| SetupError::storage("remove an old environment from", venv, source))
        }
    }
}

/// Runs one step in a process group of its own, which ends with us, and follows its output.
fn run(
    step: &'static str,
    mut command: Command,
    venv: &Path,
    progress: &Progress,
) -> Result<(), SetupError> {
    let failed = |words: String| SetupError::Failed { step, words };
    let mut child = command
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .process_group(0)
        .spawn()
        .map_err(|error| failed(error.to_string()))?;
    // Held open as long as we live: its end is how the process learns that we are gone.
    let alive = child.stdin.take();
    let (lines, output) = channel();
    if let (Some(stdout), Some(stderr)) = (child.stdout.take(), child.stderr.take()) {
        forward(stdout, lines.clone());
        forward(stderr, lines);
    }
    let mut said = Vec::new();
    loop {
        match output.recv_timeout(SLICE) {
            Ok(line) => {
                follow(&line, progress);
                said.push(line);
            }
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => break,
        }
        if interrupt::requested() {
            break;
        }
    }
    if interrupt::requested()
        && let Some(group) = Pid::from_raw(child.id().cast_signed())
    {
        // It fails only for a group that is gone already.
        kill_process_group(group, Signal::KILL).ok();
    }
    // Closing its standard input ends what is left of the group; after a normal end it does nothing.
    drop(alive);
    let status = child.wait().map_err(|error| failed(error.to_string()))?;
    if interrupt::requested() {
        Err(SetupError::Interrupted)
    } else if status.success() {
        Ok(())
    } else {
        said.push(format!("({status})"));
        Err(SetupError::of_step(step, venv, &said))
    }
}

fn forward(stream: impl Read + Send + 'static, lines: Sender<String>) {
    thread::spawn(move || {
        for line in BufReader::new(stream).split(b'\n').map_while(Result::ok) {
            if lines
                .send(String::from_utf8_lossy(&line).trim_end().to_owned())
                .is_err()
            {
                return;
            }
        }
    });
}

/// Moves the bar along with the installer's output.
fn follow(line: &str, progress: &Progress) {
    if let Some(package) = line.strip_prefix("Collecting ") {
        progress.message(package.split([' ', '=']).next().unwrap_or_default());
        progress.advance(1);
    } else if line.starts_with("Installing collected packages") {
        progress.message("unpacking");
    }
}
