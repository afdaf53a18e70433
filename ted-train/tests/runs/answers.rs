//! `ted answers` and what became of every line that a run was given.

use std::fs;

use serde_json::Value;

use crate::command::{Desk, Ended, assert_same_outcome, finish, ted};

/// A finished run, and its ten answers.
fn answered() -> (Desk, Vec<String>) {
    let desk = Desk::with_dataset();
    finish(&mut desk.train("first", "oprl-i+ted", &[])).with(0);
    let log = fs::read_to_string(desk.run("first").join("preferences.jsonl")).unwrap();
    let lines: Vec<String> = log.lines().map(str::to_owned).collect();
    assert_eq!(lines.len(), 10);
    (desk, lines)
}

/// The same line with the other answer.
fn turned(line: &str) -> String {
    match line.contains("\"answer\":1,") {
        true => line.replace("\"answer\":1,", "\"answer\":0,"),
        false => line.replace("\"answer\":0,", "\"answer\":1,"),
    }
}

fn write(desk: &Desk, name: &str, lines: &[String]) {
    fs::write(desk.run(name), lines.join("\n") + "\n").unwrap();
}

fn answers(desk: &Desk, args: &[&str]) -> Ended {
    finish(
        ted()
            .current_dir(desk.folder.path())
            .arg("answers")
            .args(args),
    )
}

fn train(desk: &Desk, out: &str) -> Ended {
    let mut train = desk.train(out, "oprl-i+ted", &[]);
    finish(train.args(["--preferences", "answers.jsonl"]))
}

/// What a finished run says of the lines that it was given.
fn account(desk: &Desk, out: &str) -> Vec<Value> {
    let text = fs::read_to_string(desk.run(out).join("answers.json")).unwrap();
    let account: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(account["file"], "answers.jsonl");
    account["lines"].as_array().unwrap().clone()
}

#[test]
fn every_line_that_a_run_was_given_is_used_or_said_not_to_be() {
    let (desk, lines) = answered();
    // A contradiction, an answer that nobody asks for, and all of it in another order.
    let mut given = lines.clone();
    given.reverse();
    given.push(turned(&lines[4]));
    let mut strange: Value = serde_json::from_str(&lines[0]).unwrap();
    for segment in strange["segments"].as_array_mut().unwrap() {
        segment["length"] = 3.into();
    }
    given.push(strange.to_string());
    write(&desk, "answers.jsonl", &given);
    train(&desk, "second")
        .with(0)
        .telling("answers.jsonl: lines 6, 11 contradict each other about")
        .telling("line 6 counts, the first of teacher:true-return")
        .telling("answers.jsonl: 10 of 12 lines are used")
        .telling("not line 11: teacher:true-return says something else in line 6")
        .telling("not line 12: the run does not ask about its two clips");
    assert_same_outcome(&desk.run("first"), &desk.run("second"));
    let account = account(&desk, "second");
    assert_eq!(account.len(), 12);
    assert_eq!(
        (&account[0]["line"], &account[0]["questions"][0]),
        (&1.into(), &10.into())
    );
    assert!(account[9]["why_not"].is_null() && account[10]["why_not"].is_string());
    // The same is said beforehand.
    let said = answers(&desk, &["answers.jsonl", "--for", "first", "--json"])
        .with(0)
        .said;
    let said: Value = serde_json::from_str(&said).unwrap();
    for (held, asked) in account.iter().zip(said["answers"].as_array().unwrap()) {
        assert_eq!(*held, asked["use"]);
    }
    assert_eq!(said["findings"][0]["kind"], "contradiction");
}

#[test]
fn what_an_editor_makes_of_a_file_loses_no_answer() {
    let (desk, lines) = answered();
    let text = lines.join("\r\n\r\n");
    let wide: Vec<u8> = format!("\u{feff}{text}")
        .encode_utf16()
        .flat_map(u16::to_le_bytes)
        .collect();
    fs::write(desk.run("answers.jsonl"), wide).unwrap();
    train(&desk, "second")
        .with(0)
        .telling("10 of 10 lines are used");
    assert_same_outcome(&desk.run("first"), &desk.run("second"));
}

#[test]
fn two_people_are_heard_together() {
    let (desk, lines) = answered();
    let ben: Vec<String> = lines
        .iter()
        .map(|line| turned(line).replace("teacher:true-return", "ben"))
        .collect();
    write(&desk, "a.jsonl", &lines);
    write(&desk, "b.jsonl", &ben[..1]);
    answers(
        &desk,
        &["a.jsonl", "b.jsonl", "a.jsonl", "--merge", "answers.jsonl"],
    )
    .with(0);
    let merged = fs::read_to_string(desk.run("answers.jsonl")).unwrap();
    assert_eq!(
        merged,
        [lines.as_slice(), &ben[..1]].concat().join("\n") + "\n"
    );
    answers(&desk, &["a.jsonl", "--merge", "answers.jsonl"])
        .with(2)
        .telling("answers.jsonl exists, and answers are never written over");
    // The first answer is a tie now; what is asked later may be something else.
    train(&desk, "second").telling("lines 1, 11 contradict each other");
    let log = fs::read_to_string(desk.run("second").join("preferences.jsonl")).unwrap();
    let first = log.lines().next().unwrap();
    assert!(
        first.contains("\"answer\":0.5,\"by\":\"teacher:true-return, ben\""),
        "{first}"
    );
}

#[test]
fn a_file_is_printed_as_people_read_it_and_checked_for_a_dataset() {
    let (desk, lines) = answered();
    let dated = lines[0].replace(
        "\"by\":\"teacher:true-return\"",
        "\"by\":\"anna\",\"at\":\"May 1\"",
    );
    let foreign = lines[1].replace("\"digest\":\"", "\"digest\":\"0");
    let mut long: Value = serde_json::from_str(&lines[2]).unwrap();
    long["segments"][0]["length"] = 300.into();
    let cut = lines[3][..60].to_owned();
    write(&desk, "answers.jsonl", &[dated, foreign, long.to_string()]);
    let dataset = desk.dataset();
    let dataset = dataset.to_str().unwrap();
    let said = answers(&desk, &["answers.jsonl", "--for", dataset])
        .with(0)
        .said;
    let rows: Vec<&str> = said.lines().collect();
    assert!(
        rows[0].starts_with("2 lines about ted/plain-v0, digest "),
        "{said}"
    );
    assert!(
        rows[3].contains("anna") && rows[3].contains("May 1") && rows[3].contains("yes"),
        "{said}"
    );
    assert!(
        rows[3].contains("is better") && rows[3].contains(", steps "),
        "{said}"
    );
    assert!(
        rows[4].contains("no: it is about the dataset ted/plain-v0"),
        "{said}"
    );
    assert!(
        rows[5].contains("no: steps ") && rows[5].contains("run past its end"),
        "{said}"
    );
    write(&desk, "answers.jsonl", &[lines[0].clone(), cut]);
    let ended = answers(&desk, &["answers.jsonl", "--merge", "whole.jsonl"])
        .with(3)
        .telling("line 2 of answers.jsonl is not a preference")
        .telling("whole.jsonl was not written");
    assert!(
        ended.said.contains("1  teacher:true-return"),
        "{}",
        ended.said
    );
    assert!(!desk.run("whole.jsonl").exists());
}

#[test]
fn a_table_is_imported_and_answers_what_it_is_about() {
    let (desk, lines) = answered();
    let mut table =
        "episode_1, start_1, length_1, episode_2, start_2, length_2, label, by\n".to_owned();
    for line in &lines {
        let line: Value = serde_json::from_str(line).unwrap();
        let of = |clip: usize| {
            let clip = &line["segments"][clip];
            format!("{},{},{}", clip["episode"], clip["start"], clip["length"])
        };
        table += &format!(
            "{}, {}, {}, \"teacher:true-return\"\n",
            of(0),
            of(1),
            line["answer"]
        );
    }
    fs::write(desk.run("labels.csv"), &table).unwrap();
    let dataset = desk.dataset();
    let import = [
        "--import",
        "csv",
        "labels.csv",
        "--dataset",
        dataset.to_str().unwrap(),
        "--out",
        "answers.jsonl",
    ];
    let said = answers(&desk, &import).with(0).said;
    assert!(said.starts_with("10 lines about ted/plain-v0"), "{said}");
    train(&desk, "second")
        .with(0)
        .telling("10 of 10 lines are used");
    assert_same_outcome(&desk.run("first"), &desk.run("second"));
    answers(&desk, &import)
        .with(2)
        .telling("never written over");
    fs::write(
        desk.run("labels.csv"),
        table.replacen(", \"teacher", ", left, \"teacher", 1),
    )
    .unwrap();
    fs::remove_file(desk.run("answers.jsonl")).unwrap();
    answers(&desk, &import)
        .with(3)
        .telling("line 2 of labels.csv cannot be imported");
    assert!(!desk.run("answers.jsonl").exists());
}
