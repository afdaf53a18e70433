//! Each way in which a worker can fail is a named error that carries what it said last.

use std::time::Duration;

use firmware_sim::bridge::frame::PROTOCOL_VERSION;
use firmware_sim::bridge::{BridgeError, Environment, EpisodeJob, Worker};
use firmware_sim::exit::ExitCode;

use crate::fake::{Fake, environment, job};

fn start(mode: &str) -> (Fake, Result<Worker, BridgeError>) {
    let fake = Fake::new(mode);
    let worker = Worker::spawn(&fake.environment());
    (fake, worker)
}

/// The error of collecting an episode from a worker in this mode, after which the worker has to be gone.
fn collect(mode: &str) -> BridgeError {
    let (fake, worker) = start(mode);
    let mut worker = worker.expect("the worker starts");
    let error = worker.collect(&job(1)).expect_err("the worker misbehaves");
    assert!(fake.all_ended(), "{mode}: the worker is still there");
    assert!(
        matches!(worker.step(&[0.0]), Err(BridgeError::NoTask)),
        "{mode}: a failed worker has no task"
    );
    error
}

#[test]
fn a_good_worker_plays_and_steps() {
    let (fake, worker) = start("good");
    let mut worker = worker.expect("the worker starts");
    assert_eq!(worker.versions(), "fake=1");
    let episode = worker.collect(&job(7)).expect("an episode");
    assert_eq!((episode.steps(), episode.goal), (20, vec![7.0]));
    let (observation, goal) = worker.reset(0, 5).expect("a reset");
    assert_eq!((observation, goal), (vec![0.0, 5.0], vec![5.0]));
    assert_eq!(worker.step(&[0.5]).expect("a step").reward, -0.5);
    drop(worker);
    assert!(fake.all_ended());
}

#[test]
fn an_interpreter_that_is_not_there_is_named() {
    let fake = Fake::new("good");
    let missing = Environment::custom(
        "/nowhere/python3".as_ref(),
        fake.environment().worker(),
        fake.path(),
    );
    let error = Worker::spawn(&missing).expect_err("there is no interpreter");
    assert!(matches!(error, BridgeError::Spawn { .. }));
    assert!(error.to_string().contains("/nowhere/python3"));
    assert_eq!(error.exit_code(), ExitCode::Environment);
}

#[test]
fn a_worker_of_another_protocol_version_is_refused_with_both_versions() {
    let (fake, worker) = start("speaks another version");
    let error = worker.expect_err("the version is another");
    assert!(matches!(
        error,
        BridgeError::ProtocolVersion {
            expected: PROTOCOL_VERSION,
            actual,
            ..
        } if actual == PROTOCOL_VERSION + 1
    ));
    assert!(fake.all_ended());
}

#[test]
fn a_program_that_is_no_worker_is_found_out_by_its_first_bytes() {
    let (fake, worker) = start("babbles");
    assert!(matches!(worker, Err(BridgeError::NotAWorker { .. })));
    assert!(fake.all_ended());
}

#[test]
fn a_worker_that_ends_at_once_leaves_its_last_words() {
    let (_fake, worker) = start("dies at once");
    let error = worker.expect_err("the worker is gone");
    assert!(matches!(error, BridgeError::Died { .. }));
    assert!(error.to_string().contains("no simulator here"), "{error}");
}

#[test]
fn a_worker_without_its_simulator_says_which_module_is_missing() {
    let (_fake, worker) = start("cannot start");
    let error = worker.expect_err("there is no simulator");
    assert!(matches!(error, BridgeError::CannotStart { .. }));
    assert!(error.to_string().contains("mujoco"), "{error}");
    assert!(
        !error.to_string().contains("delete"),
        "only an environment of our own may be deleted: {error}"
    );
}

#[test]
fn a_worker_that_dies_in_mid_episode_leaves_its_last_words() {
    let error = collect("dies always");
    assert!(
        matches!(&error, BridgeError::Died { status, .. } if status == "signal: 9 (SIGKILL)"),
        "{error}"
    );
    assert!(
        error.to_string().contains("the simulator exploded"),
        "{error}"
    );
    assert!(error.is_worker_failure());
}

#[test]
fn a_reply_cut_short_by_death_is_a_death() {
    assert!(matches!(collect("stops halfway"), BridgeError::Died { .. }));
}

#[test]
fn replies_that_make_no_sense_are_refused() {
    for mode in [
        "flips a bit",
        "answers another request",
        "answers another kind",
        "answers too briefly",
        "announces too much",
    ] {
        let error = collect(mode);
        assert!(
            matches!(error, BridgeError::Garbled { .. }),
            "{mode}: {error}"
        );
        assert!(error.is_worker_failure());
    }
}

#[test]
fn a_worker_that_gives_no_answer_is_stopped() {
    let fake = Fake::new("hangs");
    let patience = Duration::from_secs(1);
    let mut worker =
        Worker::spawn_patiently(&fake.environment(), patience).expect("the worker starts");
    worker.open("fake-v3").expect("a task");
    worker.reset(0, 1).expect("an episode");
    assert!(matches!(
        worker.step(&[0.0]),
        Err(BridgeError::Silent { seconds: 1, .. })
    ));
    assert!(fake.all_ended());
}

#[test]
fn a_worker_that_gives_no_episode_is_told_to_have_had_the_time_of_one() {
    let fake = Fake::new("hangs");
    let mut worker = Worker::spawn_patiently(&fake.environment(), Duration::from_secs(1))
        .expect("the worker starts");
    // Half a second for each of two steps, on top.
    let short = EpisodeJob { steps: 2, ..job(1) };
    assert!(matches!(
        worker.collect(&short),
        Err(BridgeError::Silent { seconds: 2, .. })
    ));
}

#[test]
fn a_refusal_leaves_the_worker_well() {
    let (_fake, worker) = start("refuses");
    let mut worker = worker.expect("the worker starts");
    let error = worker.collect(&job(1)).expect_err("it refuses");
    assert!(matches!(error, BridgeError::Refused { .. }) && !error.is_worker_failure());
    assert!(error.to_string().contains("the drawer fell off"));
    worker.reset(0, 1).expect("it still works");
}

#[test]
fn requests_out_of_order_are_refused_before_they_are_sent() {
    let (_fake, worker) = start("good");
    let mut worker = worker.expect("the worker starts");
    assert!(matches!(worker.reset(0, 1), Err(BridgeError::NoTask)));
    assert!(matches!(worker.step(&[0.0]), Err(BridgeError::NoTask)));
    worker.open("fake-v3").expect("a task");
    assert!(matches!(
        worker.step(&[0.0, 0.0]),
        Err(BridgeError::ActionLength {
            expected: 1,
            actual: 2
        })
    ));
}

#[test]
fn a_worker_without_its_folder_is_a_spawn_error() {
    let gone = Fake::new("good").path().to_owned();
    assert!(matches!(
        Worker::spawn(&environment(&gone)),
        Err(BridgeError::Spawn { .. })
    ));
}
