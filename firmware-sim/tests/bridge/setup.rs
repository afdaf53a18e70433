//! Setting up the environment when it cannot work: named errors, and nothing of anyone else's is touched.

use std::env;
use std::ffi::{OsStr, OsString};
use std::fs::{self, File};
use std::io::{BufRead, BufReader};
use std::os::unix::process::{CommandExt, ExitStatusExt};
use std::path::Path;
use std::process::{Command, Stdio};

use firmware_sim::bridge::environment::{
    PYTHON_VARIABLE, VENV_VARIABLE, diagnose, ensure, location,
};
use firmware_sim::bridge::{Environment, Worker};
use firmware_sim::progress::Audience;

use crate::fake::{bridge, python};

const PART: &str = "TED_TEST_SETUP_PART";
const FOLDER: &str = "TED_TEST_FOLDER";

/// Not a test of its own: environment variables belong to a whole process, so the tests below start one each.
#[test]
fn sets_up_when_a_test_asks_for_it() {
    match env::var(PART).as_deref() {
        Ok("ensure") => {
            let error = ensure(Audience::Nobody).expect_err("it cannot work");
            eprintln!("failed to {error}");
            error.exit_code().exit();
        }
        Ok("wait") => {
            let environment = ensure(Audience::Log).expect("another process has installed it");
            assert!(environment.worker().exists());
        }
        Ok("locate") => {
            let place = location().expect("it is named");
            eprintln!("place: {}", place.display());
        }
        Ok("start") => {
            let environment = ensure(Audience::Nobody).expect("it looks complete");
            let error = Worker::spawn(&environment).expect_err("it is broken");
            eprintln!("failed to {error}");
        }
        Ok("python") => {
            let folder = env::var_os(FOLDER).expect("it is named");
            let folder = Path::new(&folder);
            let ours = Environment::custom(&python(), &folder.join("worker.py"), folder);
            let world = OsString::from("world.py");
            let own = Environment::own(&world, folder).expect("its worker is written");
            for (whose, environment) in [("ours", ours), ("own", own)] {
                let error = Worker::spawn(&environment).expect_err("none is a worker");
                eprintln!("{whose}: {error}");
            }
        }
        Ok("diagnose") => {
            for check in diagnose() {
                eprintln!("{}: {:?}", check.name, check.outcome);
            }
        }
        _ => {}
    }
}

fn run(part: &str, venv: &Path, python: impl AsRef<OsStr>) -> (Option<i32>, String) {
    let output = command(part, venv, python)
        .output()
        .expect("the process runs");
    (
        output.status.code(),
        String::from_utf8_lossy(&output.stderr).into_owned(),
    )
}

fn command(part: &str, venv: &Path, python: impl AsRef<OsStr>) -> Command {
    let mut command = Command::new(env::current_exe().expect("this program"));
    command
        .args([
            "--exact",
            "setup::sets_up_when_a_test_asks_for_it",
            "--nocapture",
        ])
        .env(PART, part)
        .env(VENV_VARIABLE, venv)
        .env(PYTHON_VARIABLE, python)
        // No registry answers there, and pip is not to look anywhere else.
        .env("PIP_INDEX_URL", "http://127.0.0.1:9/simple")
        .env("PIP_NO_CACHE_DIR", "1")
        .env("PIP_FIND_LINKS", "")
        .env("PIP_RETRIES", "0")
        .stdout(Stdio::null());
    command
}

/// Makes an environment look as complete as another one.
fn stamp(from: &Path, to: &Path) {
    let name = "ted-environment";
    fs::copy(from.join(name), to.join(name)).expect("it is copied");
}

#[test]
fn without_python_the_message_says_what_to_install_or_to_set() {
    let folder = tempfile::tempdir().expect("a folder");
    let (code, words) = run("ensure", &folder.path().join("venv"), "/nowhere/python3");
    assert_eq!(code, Some(4));
    assert!(
        words.contains("/nowhere/python3") && words.contains(PYTHON_VARIABLE),
        "{words}"
    );
}

#[test]
fn without_a_network_the_message_says_so_and_the_next_try_starts_again() {
    let folder = tempfile::tempdir().expect("a folder");
    let venv = folder.path().join("venv");
    for _ in 0..2 {
        let (code, words) = run("ensure", &venv, python());
        assert_eq!(code, Some(4), "{words}");
        assert!(words.contains("registry cannot be reached"), "{words}");
    }
}

#[test]
fn a_folder_with_something_else_in_it_is_left_alone() {
    let folder = tempfile::tempdir().expect("a folder");
    let venv = folder.path().join("poetry.env");
    fs::create_dir(&venv).expect("a folder");
    let others = [
        venv.join("thesis.tex"),
        folder.path().join("poetry.lock"),
        folder.path().join("poetry.env.ted-lock"),
    ];
    for other in &others {
        fs::write(other, "years of work").expect("it is written");
    }
    let (code, words) = run("ensure", &venv, python());
    assert_eq!(code, Some(4));
    assert!(words.contains("there is something else"), "{words}");
    for other in &others {
        let text = fs::read_to_string(other).expect("it is still there");
        assert_eq!(text, "years of work", "{}", other.display());
    }
}

#[test]
fn a_place_named_from_the_current_folder_is_absolute_because_workers_run_elsewhere() {
    let folder = tempfile::tempdir().expect("a folder");
    let output = command("locate", Path::new("venvs/ted"), python())
        .current_dir(folder.path())
        .output()
        .expect("the process runs");
    let words = String::from_utf8_lossy(&output.stderr);
    let place = folder
        .path()
        .canonicalize()
        .expect("it is there")
        .join("venvs/ted");
    assert!(
        words.contains(&format!("place: {}\n", place.display())),
        "{words}"
    );
}

#[test]
fn an_environment_broken_after_its_installation_is_named_to_be_deleted() {
    let made = ensure(Audience::Log).expect("an environment to copy from");
    let folder = tempfile::tempdir().expect("a folder");
    let venv = folder.path().join("venv");
    // Another Python than the packages were installed for: none of them is found.
    let made_with = Command::new(python())
        .args(["-Es", "-m", "venv", "--without-pip"])
        .arg(&venv)
        .status()
        .expect("python starts");
    assert!(made_with.success());
    stamp(made.scratch(), &venv);
    let way_out = format!("delete the folder {}", venv.display());
    for part in ["start", "diagnose"] {
        let (_, words) = run(part, &venv, python());
        assert!(
            words.contains("ModuleNotFoundError") && words.contains(&way_out),
            "{words}"
        );
    }
}

/// What a person sets for Python programs of their own breaks others: `-E` keeps it from ours, and not from the processes that ours
/// start, as the simulator's libraries do.
#[test]
fn python_s_variables_reach_a_world_of_one_s_own_and_nothing_of_ours() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path();
    let worker = "import subprocess, sys\n\
        named = 'import os, sys; sys.exit(repr([it for it in os.environ if it.startswith(\"PYTHON\")]))'\n\
        ended = subprocess.run([sys.executable, '-c', named], stderr=subprocess.PIPE, text=True)\n\
        sys.exit(f'its child sees {ended.stderr}')\n";
    fs::write(path.join("worker.py"), worker).expect("it is written");
    fs::create_dir(path.join("packages")).expect("a folder");
    fs::write(
        path.join("packages/mine.py"),
        "said = 'a package of my own'\n",
    )
    .expect("it is written");
    fs::write(
        path.join("world.py"),
        "import mine\nraise RuntimeError(mine.said)\n",
    )
    .expect("it is written");
    let with = |name: &str, value: &OsStr| {
        let output = command("python", &path.join("venv"), python())
            .env(FOLDER, path)
            .env(name, value)
            .output()
            .expect("the process runs");
        String::from_utf8_lossy(&output.stderr).into_owned()
    };
    let words = with("PYTHONHOME", OsStr::new("/nowhere"));
    let (ours, _) = words.split_once("own: ").expect("both were tried");
    assert!(ours.contains("its child sees []"), "{words}");
    let words = with("PYTHONPATH", path.join("packages").as_os_str());
    let (ours, own) = words.split_once("own: ").expect("both were tried");
    assert!(ours.contains("its child sees []"), "{words}");
    assert!(own.contains("a package of my own"), "{words}");
}

#[test]
fn a_folder_that_cannot_be_written_is_a_storage_error() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("file");
    fs::write(&file, "").expect("it is written");
    let (code, words) = run("ensure", &file.join("venv"), python());
    assert_eq!(code, Some(6), "{words}");
}

#[test]
fn the_doctor_names_what_is_missing_and_installs_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    let venv = folder.path().join("venv");
    let (_, words) = run("diagnose", &venv, "/nowhere/python3");
    assert!(
        words.contains("python: Err") && words.contains("not installed yet"),
        "{words}"
    );
    // Neither a pip that is missing nor one that is forbidden keeps the doctor from asking.
    let output = command("diagnose", &venv, python())
        .env("PIP_REQUIRE_VIRTUALENV", "1")
        .output()
        .expect("the process runs");
    let words = String::from_utf8_lossy(&output.stderr);
    assert!(words.contains("package registry: Err"), "{words}");
    assert!(words.contains("cannot be reached"), "{words}");
    assert!(!venv.exists());
}

#[test]
fn a_second_installer_waits_for_the_first_and_uses_what_it_made() {
    let made = ensure(Audience::Log).expect("an environment to copy from");
    let folder = tempfile::tempdir().expect("a folder");
    let venv = folder.path().join("venv");
    let lock = File::create(folder.path().join("venv.ted-lock")).expect("the lock file");
    lock.lock().expect("nobody else has it");

    let mut second = command("wait", &venv, python())
        .stderr(Stdio::piped())
        .spawn()
        .expect("it starts");
    let mut words = BufReader::new(second.stderr.take().expect("a pipe"))
        .lines()
        .map_while(Result::ok);
    assert!(words.any(|line| line.contains("waiting for another process")));

    // What the first installer leaves: an interpreter, and the stamp as the very last thing.
    let bin = venv.join("bin");
    fs::create_dir_all(&bin).expect("a folder");
    fs::write(bin.join("python"), "").expect("it is written");
    stamp(made.scratch(), &venv);
    drop(lock);
    let rest: Vec<_> = words.collect();
    assert!(second.wait().expect("it ends").success(), "{rest:?}");
}

#[test]
fn a_step_that_fails_in_a_process_of_its_own_leaves_that_one_s_words() {
    let folder = tempfile::tempdir().expect("a folder");
    let venv = folder.path().join("venv");
    // Stands in for ensurepip: `venv` runs it in the new environment's interpreter and keeps what it says.
    let broken = "import subprocess, sys, venv; sys.path.insert(0, sys.argv.pop(1)); import install; \
        venv.EnvBuilder._setup_pip = lambda self, context: subprocess.check_output( \
            [context.env_exe, '-c', 'print(\"no wheels here\"); raise SystemExit(1)']); \
        install.main(*sys.argv[1:])";
    let mut step = Command::new(python())
        .args(["-Es", "-c", broken])
        .arg(bridge())
        .args(["venv".as_ref(), venv.as_os_str()])
        .stdin(Stdio::piped())
        .stderr(Stdio::piped())
        .process_group(0)
        .spawn()
        .expect("it starts");
    let _alive = step.stdin.take();
    let output = step.wait_with_output().expect("it ends");
    let words = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{words}");
    assert!(words.contains("no wheels here"), "{words}");
}

#[test]
fn an_installation_ends_with_its_parent() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut step = Command::new(python())
        .arg("-Es")
        .arg(bridge().join("install.py"))
        .args(["venv".as_ref(), folder.path().join("venv").as_os_str()])
        .stdin(Stdio::piped())
        .process_group(0)
        .spawn()
        .expect("it starts");
    drop(step.stdin.take());
    assert_eq!(step.wait().expect("it ends").signal(), Some(9));
}
