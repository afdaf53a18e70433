//! Killed, stopped and crowded runs.

use std::fs;
use std::process::Stdio;

use rand::RngExt;
use ted_train::rng::Seed;

use crate::presets::{SEQUENCE, TRANSFORMER};

use crate::command::{
    Desk, assert_same_outcome, checkpoints, finish, kill, lines, start_until, terminate,
};

#[test]
fn a_run_killed_again_and_again_ends_with_the_bytes_of_one_that_was_left_alone() {
    let desk = Desk::with_dataset();
    // Long enough to be caught at work: the last kill finds most of the updates still to do.
    let sets = [
        "algorithm.steps=3000",
        "schedule.checkpoint_every=20",
        "reward.epochs=100",
    ];
    let train = |out: &str| desk.train(out, "oprl-i+ted", &sets);
    finish(&mut train("straight")).with(0);

    let killed = desk.run("killed");
    let (answers, metrics) = (
        killed.join("preferences.jsonl"),
        killed.join("metrics.jsonl"),
    );
    let mut rng = Seed::root(11).child("kills").rng();
    let mut caught = 0;
    // Three times while it asks and learns the reward, then at rising places of the offline phase.
    for _ in 0..3 {
        let wanted = rng.random_range(1..=10);
        let child = start_until(&mut train("killed"), || lines(&answers) >= wanted);
        caught += usize::from(kill(child));
    }
    for part in 0..5 {
        let wanted = rng.random_range(part * 60 + 1..part * 60 + 60);
        let child = start_until(&mut train("killed"), || lines(&metrics) >= wanted);
        caught += usize::from(kill(child));
    }
    assert!(
        caught >= 6,
        "only {caught} of 8 kills met a running process"
    );
    let told = finish(&mut train("killed")).with(0).told;
    assert_same_outcome(&killed, &desk.run("straight"));
    // The last one did not start from nothing.
    let resumed = fs::read_dir(&killed)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .filter(|name| {
            name.starts_with("events.out.tfevents.")
                && !name.contains("0000000000")
                && !name.contains("reward")
        })
        .count();
    assert!(resumed >= 3, "{resumed} resumed event files; {told}");
}

#[test]
fn a_finished_run_does_nothing_more() {
    let desk = Desk::with_dataset();
    let mut train = desk.train("run", "oprl-i+ted", &[]);
    finish(&mut train).with(0);
    let run = desk.run("run");
    let before = crate::command::outcome(&run);
    let written = fs::metadata(run.join("reward.state"))
        .unwrap()
        .modified()
        .unwrap();
    finish(&mut train).with(0);
    assert!(crate::command::outcome(&run) == before);
    let state = fs::metadata(run.join("reward.state")).unwrap();
    assert_eq!(
        state.modified().unwrap(),
        written,
        "the reward was not learned again"
    );
}

#[test]
fn a_run_asked_to_stop_saves_says_so_and_goes_on_to_the_same_bytes() {
    let desk = Desk::with_dataset();
    // No checkpoint falls due: the one that is there was made for the stop.
    let sets = [
        "algorithm.steps=3000",
        "schedule.checkpoint_every=100000",
        "schedule.log_every=5",
    ];
    let train = |out: &str| desk.train(out, "true", &sets);
    let run = desk.run("stopped");
    let metrics = run.join("metrics.jsonl");
    let child = start_until(train("stopped").stderr(Stdio::null()), || {
        lines(&metrics) >= 20
    });
    terminate(&child);
    let ended = child.wait_with_output().unwrap();
    assert_eq!(ended.status.code(), Some(130));
    assert_eq!(checkpoints(&run).len(), 1);
    assert!(!run.join("policy.ted").exists());
    finish(&mut train("stopped")).with(0);
    finish(&mut train("straight")).with(0);
    assert_same_outcome(&run, &desk.run("straight"));
}

#[test]
fn models_of_sequences_that_are_stopped_or_killed_go_on_to_the_same_bytes() {
    let desk = Desk::with_dataset();
    // No checkpoint of the policy falls due: the one that is there was made for the stop.
    let policy = [
        &SEQUENCE[..],
        &["algorithm.steps=400", "schedule.checkpoint_every=100000"],
    ]
    .concat();
    let reward = [
        &TRANSFORMER[..],
        &["reward.steps=3000", "algorithm.steps=20"],
    ]
    .concat();
    for (preset, sets, file, ends) in [
        ("oppo", policy, "metrics.jsonl", Some(130)),
        // Saved after every 500 steps, and then killed.
        ("pt", reward, "reward.training", None),
    ] {
        let train = |out: &str| desk.train(out, preset, &sets);
        let stopped = desk.run(&format!("{preset}-stopped"));
        let straight = desk.run(&format!("{preset}-straight"));
        let [stop, go] = [&stopped, &straight].map(|run| run.display().to_string());
        let reached = || match ends {
            Some(_) => lines(&stopped.join(file)) >= 5,
            None => stopped.join(file).exists(),
        };
        let mut child = start_until(&mut train(&stop), reached);
        if ends.is_some() {
            terminate(&child);
            assert_eq!(child.wait().unwrap().code(), ends, "{preset}");
            assert_eq!(checkpoints(&stopped).len(), 1);
        } else {
            assert!(kill(child), "{preset} was caught at work");
            assert!(checkpoints(&stopped).is_empty());
        }
        finish(&mut train(&stop)).with(0);
        finish(&mut train(&go)).with(0);
        assert_same_outcome(&stopped, &straight);
    }
}

#[test]
fn a_run_asked_to_stop_while_it_learns_the_reward_keeps_the_answers() {
    let desk = Desk::with_dataset();
    let answers = desk.run("run").join("preferences.jsonl");
    let mut endless = desk.train("run", "oprl-i", &["reward.epochs=1000000"]);
    let child = start_until(&mut endless, || lines(&answers) >= 7);
    terminate(&child);
    let ended = child.wait_with_output().unwrap();
    assert_eq!(ended.status.code(), Some(130));
    assert_eq!(lines(&answers), 7);
    assert!(!desk.run("run").join("reward.state").exists());
}

#[test]
fn a_second_process_on_the_same_folder_is_turned_away_and_disturbs_nothing() {
    let desk = Desk::with_dataset();
    let mut endless = desk.train("run", "true", &["algorithm.steps=100000000"]);
    let metrics = desk.run("run").join("metrics.jsonl");
    let first = start_until(&mut endless, || lines(&metrics) >= 2);
    let config = fs::read(desk.run("run").join("config.toml")).unwrap();
    for sets in [&["algorithm.steps=100000000"], &["algorithm.steps=10"]] {
        finish(&mut desk.train("run", "true", sets))
            .with(5)
            .telling("another process is writing to")
            .telling("run");
    }
    assert_eq!(
        fs::read(desk.run("run").join("config.toml")).unwrap(),
        config
    );
    assert!(kill(first), "the first one was still at work");
}

#[test]
fn a_damaged_newest_checkpoint_is_passed_over_for_the_one_before() {
    let desk = Desk::with_dataset();
    let train = |out: &str| desk.train(out, "true", &["algorithm.steps=60"]);
    finish(&mut train("straight")).with(0);
    finish(&mut train("run")).with(0);
    let run = desk.run("run");
    let newest = checkpoints(&run).pop().unwrap();
    let bytes = fs::read(&newest).unwrap();
    fs::write(&newest, &bytes[..bytes.len() / 2]).unwrap();
    fs::remove_file(run.join("policy.ted")).unwrap();
    finish(&mut train("run"))
        .with(0)
        .telling("pass over")
        .telling("its checksum does not match");
    assert_same_outcome(&run, &desk.run("straight"));
}

#[test]
fn a_folder_of_another_run_is_refused_and_left_as_it_is() {
    let desk = Desk::with_dataset();
    finish(&mut desk.train("run", "true", &[])).with(0);
    let before = crate::command::outcome(&desk.run("run"));
    finish(&mut desk.train("run", "true", &["algorithm.tau=0.9"]))
        .with(2)
        .telling("tau = 0.7")
        .telling("tau = 0.9");
    let other = crate::dataset::write(
        desk.folder.path(),
        "other",
        &crate::dataset::episodes(5, 30),
    );
    finish(&mut desk.train_on(&other, "run", "true", &[]))
        .with(2)
        .telling("it was trained on ted/plain-v0");
    assert!(crate::command::outcome(&desk.run("run")) == before);
}
