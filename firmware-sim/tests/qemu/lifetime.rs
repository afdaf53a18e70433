//! No emulator is left running, however its parent ends: a process of its own plays the parent, and is then killed.

use std::env;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use firmware_sim::qemu::Link;

use super::boards;

/// Where the parent writes the emulator's process id; only in a process that plays the parent.
const FILE: &str = "TED_TEST_QEMU_FILE";

/// Not a test of its own: the process that the test below starts runs this and nothing else.
#[test]
fn plays_the_parent_when_a_test_asks_for_it() {
    let Ok(file) = env::var(FILE) else { return };
    let (emulator, firmware) = boards::m4();
    // Over the serial port the board never hears that nobody is there any more.
    let device = emulator
        .start(&firmware, Link::Uart, None)
        .expect("it starts");
    fs::write(format!("{file}.new"), device.id().to_string()).expect("the number is written");
    fs::rename(format!("{file}.new"), file).expect("the number is there");
    thread::sleep(Duration::from_secs(600));
}

/// Looks again and again until something is so; what is waited for happens in another process.
fn within_a_minute(is_so: impl Fn() -> bool) -> bool {
    let deadline = Instant::now() + Duration::from_secs(60);
    while Instant::now() < deadline {
        if is_so() {
            return true;
        }
        thread::sleep(Duration::from_millis(20));
    }
    false
}

/// Whether a process computes: neither gone nor only waiting to be asked how it ended.
fn runs(process: u32) -> bool {
    let state = Command::new("ps")
        .args(["-o", "stat=", "-p", &process.to_string()])
        .output()
        .expect("ps runs");
    let state = String::from_utf8_lossy(&state.stdout).trim().to_owned();
    !state.is_empty() && !state.starts_with('Z')
}

#[test]
fn an_emulator_ends_when_its_parent_is_killed() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("process");
    // Built before, so that the parent has nothing else to start.
    boards::m4();
    let mut parent = Command::new(env::current_exe().expect("this program"))
        .args([
            "--exact",
            "lifetime::plays_the_parent_when_a_test_asks_for_it",
        ])
        .env(FILE, &file)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("the parent starts");
    assert!(
        within_a_minute(|| Path::exists(&file)),
        "it tells its child"
    );
    let emulator: u32 = fs::read_to_string(&file).unwrap().parse().unwrap();
    assert!(runs(emulator));
    parent.kill().expect("it is killed");
    parent.wait().expect("it ends");
    assert!(within_a_minute(|| !runs(emulator)));
}

#[test]
fn an_emulator_ends_when_its_device_is_dropped() {
    let (emulator, firmware) = boards::m4();
    let device = emulator.start(&firmware, Link::Uart, None).unwrap();
    let process = device.id();
    assert!(runs(process));
    drop(device);
    assert!(!runs(process));
}
