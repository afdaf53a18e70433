//! A disk that is full: a limit on the size of files stands in for it, which every user may set and which fails writes in
//! the same place.

use std::fs;

use crate::command::{Desk, assert_same_outcome, checkpoints, finish, limited};

#[test]
fn a_checkpoint_that_does_not_fit_leaves_the_one_before_and_the_run_goes_on_later() {
    let desk = Desk::with_dataset();
    // Checkpoints of 80 kB; metrics and events stay well below the limit of 40 kB.
    let train = |out: &str| desk.train(out, "true", &[]);
    finish(&mut train("straight")).with(0);

    // As a kill before the last checkpoint leaves it.
    finish(&mut train("full")).with(0);
    let run = desk.run("full");
    fs::remove_file(checkpoints(&run).pop().unwrap()).unwrap();
    fs::remove_file(run.join("policy.ted")).unwrap();
    let before: Vec<_> = read_all(&run);
    assert_eq!(before.len(), 1);
    finish(&mut limited(&train("full"), 80))
        .with(6)
        .telling("no space left while writing")
        .telling("checkpoints/");
    assert!(
        read_all(&run) == before,
        "the checkpoints before are as they were"
    );
    assert!(!run.join("policy.ted").exists());

    finish(&mut train("full")).with(0);
    assert_same_outcome(&run, &desk.run("straight"));
}

fn read_all(run: &std::path::Path) -> Vec<(std::path::PathBuf, Vec<u8>)> {
    let read = |path: std::path::PathBuf| (path.clone(), fs::read(path).unwrap());
    checkpoints(run).into_iter().map(read).collect()
}

#[test]
fn a_reward_or_artefact_that_does_not_fit_is_named_and_made_later() {
    let desk = Desk::with_dataset();
    let train = |out: &str| desk.train(out, "oprl-i+ted", &["reward.hidden=[64, 64]"]);
    finish(&mut train("straight")).with(0);
    let run = desk.run("full");
    finish(&mut limited(&train("full"), 40))
        .with(6)
        .telling("no space left while writing")
        .telling("reward.");
    assert!(!run.join("reward.state").exists());
    let answers = fs::read(run.join("preferences.jsonl")).unwrap();
    finish(&mut train("full")).with(0);
    assert_eq!(
        fs::read(run.join("preferences.jsonl")).unwrap(),
        answers,
        "nobody was asked again"
    );
    assert_same_outcome(&run, &desk.run("straight"));
}
