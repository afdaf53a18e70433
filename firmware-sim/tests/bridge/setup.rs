//! Setting up the environment when it cannot work: named errors, and nothing of anyone else's is touched.

use std::env;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use firmware_sim::bridge::environment::{PYTHON_VARIABLE, VENV_VARIABLE, diagnose, ensure};
use firmware_sim::progress::Audience;

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
        Ok("diagnose") => {
            for check in diagnose() {
                eprintln!("{}: {:?}", check.name, check.outcome);
            }
        }
        _ => {}
    }
}

fn run(part: &str, venv: &Path, python: &str) -> (Option<i32>, String) {
    let output: Output = Command::new(env::current_exe().expect("this program"))
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
        .output()
        .expect("the process runs");
    (
        output.status.code(),
        String::from_utf8_lossy(&output.stderr).into_owned(),
    )
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
