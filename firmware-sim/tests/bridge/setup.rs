//! Setting up the environment when it cannot work: named errors, and nothing of anyone else's is touched.

use std::env;
use std::fs::{self, File};
use std::io::{BufRead, BufReader};
use std::os::unix::process::{CommandExt, ExitStatusExt};
use std::path::Path;
use std::process::{Command, Stdio};

use firmware_sim::bridge::environment::{PYTHON_VARIABLE, VENV_VARIABLE, diagnose, ensure};
use firmware_sim::progress::Audience;

use crate::fake::{bridge, python};

const PART: &str = "TED_TEST_SETUP_PART";

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
        Ok("diagnose") => {
            for check in diagnose() {
                eprintln!("{}: {:?}", check.name, check.outcome);
            }
        }
        _ => {}
    }
}

fn run(part: &str, venv: &Path, python: &str) -> (Option<i32>, String) {
    let output = command(part, venv, python)
        .output()
        .expect("the process runs");
    (
        output.status.code(),
        String::from_utf8_lossy(&output.stderr).into_owned(),
    )
}

fn command(part: &str, venv: &Path, python: &str) -> Command {
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
        let (code, words) = run("ensure", &venv, "python3");
        assert_eq!(code, Some(4), "{words}");
        assert!(words.contains("registry cannot be reached"), "{words}");
    }
}

#[test]
fn a_folder_with_something_else_in_it_is_left_alone() {
    let folder = tempfile::tempdir().expect("a folder");
    let thesis = folder.path().join("thesis.tex");
    fs::write(&thesis, "years of work").expect("it is written");
    let (code, words) = run("ensure", folder.path(), "python3");
    assert_eq!(code, Some(4));
    assert!(words.contains("there is something else"), "{words}");
    assert!(thesis.exists());
}

#[test]
fn a_folder_that_cannot_be_written_is_a_storage_error() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("file");
    fs::write(&file, "").expect("it is written");
    let (code, words) = run("ensure", &file.join("venv"), "python3");
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
    let (_, words) = run("diagnose", &venv, "python3");
    assert!(words.contains("package registry: Err"), "{words}");
    assert!(!venv.exists());
}

#[test]
fn a_second_installer_waits_for_the_first_and_uses_what_it_made() {
    let made = ensure(Audience::Log).expect("an environment to copy from");
    let folder = tempfile::tempdir().expect("a folder");
    let venv = folder.path().join("venv");
    let lock = File::create(venv.with_extension("lock")).expect("the lock file");
    lock.lock().expect("nobody else has it");

    let mut second = command("wait", &venv, "python3")
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
    let stamp = "ted-environment";
    fs::copy(made.scratch().join(stamp), venv.join(stamp)).expect("it is copied");
    drop(lock);
    let rest: Vec<_> = words.collect();
    assert!(second.wait().expect("it ends").success(), "{rest:?}");
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
