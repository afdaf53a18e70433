//! Studies by the command: the published table, and a table of nothing.

use std::path::Path;

use crate::command::{Desk, finish, ted};

#[test]
fn a_table_of_no_finished_run_is_an_error_that_says_where_it_looked() {
    let desk = Desk::new();
    let scores = desk.run("misspelt.jsonl");
    let out = desk.run("study");
    let mut study = ted();
    study.args(["study", "policies", "--presets", "zero", "--table"]);
    study.arg("--scores").arg(&scores).arg("--out").arg(&out);
    finish(&mut study)
        .with(2)
        .telling(scores.to_str().unwrap())
        .telling(out.to_str().unwrap());
    assert!(!scores.exists() && !out.exists());
}

#[test]
fn the_documents_have_the_table_that_their_command_prints_and_nothing_is_missing_of_it() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let page = std::fs::read_to_string(root.join("docs/results.md")).unwrap();
    let (_, section) = page.split_once("## Every method").unwrap();
    let (_, block) = section.split_once("```sh\n").unwrap();
    let (command, _) = block.split_once("\n```").unwrap();
    let command = command.replace("\\\n", " ");
    let mut words: Vec<&str> = command.split_whitespace().collect();
    assert_eq!(words.remove(0), "ted");
    // Where no run folder is, so that the table can only be of the file.
    let desk = Desk::new();
    let folder = desk.run("study");
    let out = words.iter().position(|word| *word == "--out").unwrap();
    words[out + 1] = folder.to_str().unwrap();

    let mut study = ted();
    study.current_dir(&root).args(&words).arg("--table");
    let table = finish(&mut study).with(0).said;
    assert!(section.contains(&table), "{table}");
    let rows: Vec<&str> = table.lines().skip(2).collect();
    for row in &rows {
        let seeds = row.split(" | ").nth(2);
        assert_eq!(seeds, Some("3"), "{row}");
    }
    let all = finish(ted().args(["train", "--preset", "list"])).with(0);
    // Those of the papers: what is ours has a page of its own.
    let lines = all.said.lines().skip(1);
    let presets = lines.filter(|line| !line.contains("docs/steer.md")).count();
    assert_eq!(rows.len(), 2 * presets, "two tasks");
}
