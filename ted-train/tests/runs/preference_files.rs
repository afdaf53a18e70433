//! Preference files: replayed, torn, wrong, and about something else.

use std::fs;

use crate::command::{Desk, assert_same_outcome, finish, outcome};

/// A finished run with its ten answers.
fn answered() -> (Desk, String) {
    let desk = Desk::with_dataset();
    finish(&mut desk.train("first", "oprl-i+ted", &[])).with(0);
    let log = fs::read_to_string(desk.run("first").join("preferences.jsonl")).unwrap();
    assert_eq!(log.lines().count(), 10);
    (desk, log)
}

#[test]
fn a_run_is_replayed_from_its_preference_file_alone() {
    let (desk, log) = answered();
    fs::write(desk.run("answers.jsonl"), log).unwrap();
    let mut train = desk.train("second", "oprl-i+ted", &[]);
    finish(train.args(["--preferences", "answers.jsonl"])).with(0);
    assert_same_outcome(&desk.run("first"), &desk.run("second"));
}

#[test]
fn a_replay_that_was_killed_between_two_answers_goes_on() {
    let (desk, log) = answered();
    let four: String = log.split_inclusive('\n').take(4).collect();
    fs::write(desk.run("answers.jsonl"), log).unwrap();
    fs::create_dir(desk.run("second")).unwrap();
    fs::write(desk.run("second").join("preferences.jsonl"), four).unwrap();
    let mut train = desk.train("second", "oprl-i+ted", &[]);
    finish(train.args(["--preferences", "answers.jsonl"])).with(0);
    assert_same_outcome(&desk.run("first"), &desk.run("second"));
}

#[test]
fn a_torn_last_line_is_recovered_told_and_asked_again() {
    let (desk, log) = answered();
    let whole: usize = log.split_inclusive('\n').take(6).map(str::len).sum();
    fs::create_dir(desk.run("torn")).unwrap();
    fs::write(
        desk.run("torn").join("preferences.jsonl"),
        &log[..whole + 40],
    )
    .unwrap();
    finish(&mut desk.train("torn", "oprl-i+ted", &[]))
        .with(0)
        .telling("torn last line; 6 answers are kept");
    assert_same_outcome(&desk.run("first"), &desk.run("torn"));
}

#[test]
fn an_answer_that_is_none_of_the_three_is_refused_with_its_line() {
    let (desk, log) = answered();
    let third = log.lines().nth(2).unwrap();
    let (before, after) = third.split_once("\"answer\":").unwrap();
    let (_, after) = after.split_once(',').unwrap();
    let wrong = log.replace(third, &format!("{before}\"answer\":0.7,{after}"));
    fs::write(desk.run("answers.jsonl"), &wrong).unwrap();
    let mut train = desk.train("second", "oprl-i+ted", &[]);
    finish(train.args(["--preferences", "answers.jsonl"]))
        .with(3)
        .telling("line 3 of answers.jsonl is not a preference: the answer 0.7 is not 0");
    // The same in the folder of the run itself: refused, and the file kept for whoever repairs it.
    fs::create_dir(desk.run("third")).unwrap();
    let kept = desk.run("third").join("preferences.jsonl");
    fs::write(&kept, &wrong).unwrap();
    finish(&mut desk.train("third", "oprl-i+ted", &[]))
        .with(3)
        .telling("the answer 0.7 is not 0");
    assert_eq!(fs::read_to_string(kept).unwrap(), wrong);
}

#[test]
fn answers_about_another_dataset_are_refused() {
    let (desk, log) = answered();
    fs::write(desk.run("answers.jsonl"), log).unwrap();
    let other = crate::dataset::write(
        desk.folder.path(),
        "other",
        &crate::dataset::episodes(5, 30),
    );
    let mut train = desk.train_on(&other, "second", "oprl-i+ted", &[]);
    finish(train.args(["--preferences", "answers.jsonl"]))
        .with(3)
        .telling("line 1 of answers.jsonl")
        .telling("ted/plain-v0");
}

#[test]
fn too_few_answers_are_counted() {
    let (desk, log) = answered();
    let nine: String = log.split_inclusive('\n').take(9).collect();
    fs::write(desk.run("answers.jsonl"), nine).unwrap();
    let mut train = desk.train("second", "oprl-i+ted", &[]);
    finish(train.args(["--preferences", "answers.jsonl"]))
        .with(3)
        .telling("answers.jsonl does not answer question 10 (9 of 9 lines are used)");
}

#[test]
fn answers_of_a_file_are_not_ignored_for_those_that_the_folder_holds() {
    let (desk, log) = answered();
    let third = log.lines().nth(2).unwrap();
    let turned = match third.contains("\"answer\":1,") {
        true => third.replace("\"answer\":1,", "\"answer\":0,"),
        false => third.replace("\"answer\":0,", "\"answer\":1,"),
    };
    let turned = log.replace(third, &turned);
    assert_ne!(turned, log);
    let nine: String = log.split_inclusive('\n').take(9).collect();
    let four: String = log.split_inclusive('\n').take(4).collect();
    fs::create_dir(desk.run("second")).unwrap();
    fs::write(desk.run("second").join("preferences.jsonl"), four).unwrap();
    let train = |out: &str, text: &str| {
        fs::write(desk.run("answers.jsonl"), text).unwrap();
        let mut train = desk.train(out, "oprl-i+ted", &[]);
        finish(train.args(["--preferences", "answers.jsonl"]))
    };
    let before = outcome(&desk.run("first"));
    // A finished run, one that was begun, and a file that has the same answers but not all of them.
    for (out, text, number) in [
        ("first", &turned, 3),
        ("second", &turned, 3),
        ("first", &nine, 10),
    ] {
        train(out, text)
            .with(2)
            .telling(&format!("{out} holds another run"))
            .telling(&format!("its answer {number} is not one of answers.jsonl"));
    }
    train("first", &log).with(0);
    assert!(outcome(&desk.run("first")) == before);
}
