//! Virtual environments with the packages that tests compare with, installed once at locked versions under the target folder.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

use firmware_sim::bridge::environment::interpreter;

/// Every package here has wheels for it, and some for no older one.
const OLDEST_PYTHON: (u32, u32) = (3, 11);

/// The interpreter of the environment of this name, with the packages of a `requirements.lock`, made on first use. `TED_<NAME>_VENV` names
/// another place for it. A stamp with the requirements is written last, so that an interrupted installation is made anew and a
/// change of versions is seen. A test process has one environment.
pub fn python(name: &str, requirements: &Path) -> &'static Path {
    static PYTHON: OnceLock<PathBuf> = OnceLock::new();
    PYTHON.get_or_init(|| {
        let variable = format!("TED_{}_VENV", name.to_uppercase());
        let venv = std::env::var_os(variable).map_or_else(
            || Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{name}-venv")),
            PathBuf::from,
        );
        let python = venv.join("bin/python");
        let wanted = fs::read(requirements).unwrap();
        let stamp = venv.join(format!("ted-{name}"));
        // Held by one test process at a time, and released however it ends.
        fs::create_dir_all(venv.parent().unwrap()).unwrap();
        let lock = fs::File::create(venv.with_file_name(format!("ted-{name}.lock"))).unwrap();
        lock.lock().unwrap();
        if fs::read(&stamp).ok().as_ref() != Some(&wanted) {
            install(&venv, &python, requirements);
            fs::write(stamp, wanted).unwrap();
        }
        python
    })
}

fn install(venv: &Path, python: &Path, requirements: &Path) {
    // The interpreter that the bridge would choose: the packages are built for the same ones.
    let system = interpreter().unwrap_or_else(|error| panic!("failed to {error}"));
    assert!(
        system.version >= OLDEST_PYTHON,
        "these packages need Python 3.11: name one with TED_PYTHON"
    );
    succeed(
        Command::new(system.path)
            .args(["-Es", "-m", "venv", "--clear"])
            .arg(venv),
    );
    let pip = [
        "-Es",
        "-m",
        "pip",
        "install",
        "--quiet",
        "--disable-pip-version-check",
    ];
    let options = [
        "--no-user",
        "--require-hashes",
        "--only-binary",
        ":all:",
        "--requirement",
    ];
    succeed(
        Command::new(python)
            .args(pip)
            .args(options)
            .arg(requirements),
    );
}

fn succeed(command: &mut Command) {
    let output = command.output().unwrap();
    assert!(
        output.status.success(),
        "{command:?}: {}",
        String::from_utf8_lossy(&output.stderr)
    );
}
