//! Nothing is left running, however the parent ends: a process of its own plays the parent, and is then treated badly.

use std::env;
use std::fs;
use std::io::Read;
use std::ops::ControlFlow;
use std::os::unix::process::CommandExt;
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};

use firmware_sim::bridge::{BridgeError, Environment, Pool, Worker, speed};
use firmware_sim::exit::ExitCode;
use firmware_sim::interrupt;
use rustix::process::{Pid, Signal, kill_process_group};

use crate::fake::{Fake, environment, job, within_seconds};

/// Names the folder of the fake workers; only in a process that plays the parent.
const FOLDER: &str = "TED_TEST_FAKE_FOLDER";
/// What that process does.
const PART: &str = "TED_TEST_PART";

/// A measurement that never ends, in the manner of `fake_worker.py`.
const ENDLESS_SPEED: &str = r#"
import fcntl
alive = open("alive", "w")
fcntl.flock(alive, fcntl.LOCK_SH)
with open("busy", "a") as busy:
    print("measuring", file=busy)
while True:
    pass
"#;

/// Not a test of its own: the process that the tests below start runs this and nothing else.
#[test]
fn plays_the_parent_when_a_test_asks_for_it() {
    let (Ok(folder), Ok(part)) = (env::var(FOLDER), env::var(PART)) else {
        return;
    };
    let environment = environment(Path::new(&folder));
    match part.as_str() {
        "collects" => {
            interrupt::install().expect("signals can be taken over");
            let jobs: Vec<_> = (0..4).map(job).collect();
            let result = Pool::new(&environment, 2).run(&jobs, |_, _| ControlFlow::Continue(()));
            assert!(
                matches!(result, Err(BridgeError::Interrupted)),
                "{result:?}"
            );
            ExitCode::Interrupted.exit();
        }
        "measures" => {
            interrupt::install().expect("signals can be taken over");
            // It lies beside the worker.
            let folder = environment.scratch();
            fs::write(folder.join("speed.py"), ENDLESS_SPEED).expect("the script is written");
            let environment =
                Environment::custom(environment.python(), &folder.join("worker.py"), folder);
            let result = speed::measure(&environment, "fake-v3", 1);
            assert!(
                matches!(result, Err(BridgeError::Interrupted)),
                "{result:?}"
            );
            ExitCode::Interrupted.exit();
        }
        "panics" => {
            let _worker = Worker::spawn(&environment).expect("the worker starts");
            panic!("as asked");
        }
        part => unreachable!("there is no part {part}"),
    }
}

fn parent(fake: &Fake, part: &str) -> Child {
    Command::new(env::current_exe().expect("this program"))
        .args([
            "--exact",
            "lifetime::plays_the_parent_when_a_test_asks_for_it",
            "--nocapture",
        ])
        .env(FOLDER, fake.path())
        .env(PART, part)
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .process_group(0)
        .spawn()
        .expect("the parent starts")
}

/// Starts a parent whose two workers compute for ever, does something to it, and waits for its end.
fn collecting(harm: impl FnOnce(&mut Child)) -> (Fake, ExitStatus) {
    busy("collects", 2, harm)
}

/// Starts a parent whose processes compute for ever, does something to it, and waits for its end.
fn busy(part: &str, processes: usize, harm: impl FnOnce(&mut Child)) -> (Fake, ExitStatus) {
    let fake = Fake::new("computes for ever");
    let mut parent = parent(&fake, part);
    assert!(
        within_seconds(60, || fake.busy() == processes),
        "the processes are in mid-episode"
    );
    harm(&mut parent);
    let status = parent.wait().expect("the parent ends");
    (fake, status)
}

fn signal_group(parent: &Child, signal: Signal) {
    let group = Pid::from_raw(parent.id().cast_signed()).expect("a process id");
    kill_process_group(group, signal).expect("the signal is sent");
}

#[test]
fn workers_in_mid_episode_end_when_their_parent_is_killed() {
    let (fake, status) = collecting(|parent| parent.kill().expect("it is killed"));
    assert!(!status.success());
    assert!(fake.all_ended());
}

#[test]
fn ctrl_c_stops_the_parent_cleanly_and_leaves_no_worker() {
    let (fake, status) = collecting(|parent| signal_group(parent, Signal::INT));
    assert_eq!(status.code(), Some(i32::from(ExitCode::Interrupted.code())));
    assert!(fake.all_ended());
}

#[test]
fn sigterm_does_the_same() {
    let (fake, status) = collecting(|parent| signal_group(parent, Signal::TERM));
    assert_eq!(status.code(), Some(i32::from(ExitCode::Interrupted.code())));
    assert!(fake.all_ended());
}

#[test]
fn ctrl_c_stops_a_measurement_inside_python_cleanly() {
    let (fake, status) = busy("measures", 1, |parent| signal_group(parent, Signal::INT));
    assert_eq!(status.code(), Some(i32::from(ExitCode::Interrupted.code())));
    assert!(fake.all_ended());
}

#[test]
fn a_panic_of_the_parent_leaves_no_worker() {
    let fake = Fake::new("good");
    let mut parent = parent(&fake, "panics");
    let mut words = String::new();
    parent
        .stderr
        .take()
        .expect("a pipe")
        .read_to_string(&mut words)
        .expect("text");
    assert!(!parent.wait().expect("the parent ends").success());
    assert!(words.contains("as asked"), "{words}");
    assert!(fake.all_ended());
}
