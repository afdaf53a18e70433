//! Studies by the command: the published table, and a table of nothing.

use std::path::Path;
use std::process::{Command, Stdio};

use crate::ask::chromium::Chromium;
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

/// A section of the page of results, and what its first command prints of its file of scores, without a run folder.
fn section_and_table(title: &str) -> (String, String) {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let page = std::fs::read_to_string(root.join("docs/results.md")).unwrap();
    let (_, section) = page.split_once(&format!("## {title}\n")).unwrap();
    let section = section.split("\n## ").next().unwrap();
    let (_, block) = section.split_once("```sh\n").unwrap();
    let (command, _) = block.split_once("\n```").unwrap();
    let command = command.replace("\\\n", " ");
    let mut words: Vec<&str> = command.split_whitespace().collect();
    assert_eq!(words.remove(0), "ted");
    // Where no run folder is, so that the table can only be of the file.
    let desk = Desk::new();
    let folder = desk.run("study");
    words.retain(|word| *word != "--table");
    if let Some(out) = words.iter().position(|word| *word == "--out") {
        words.drain(out..out + 2);
    }
    let mut study = ted();
    study.current_dir(&root).args(&words);
    study.args(["--table", "--out"]).arg(&folder);
    (section.to_owned(), finish(&mut study).with(0).said)
}

#[test]
fn the_documents_have_the_table_that_their_command_prints_and_nothing_is_missing_of_it() {
    let (section, table) = section_and_table("Every method");
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

#[test]
fn the_documents_have_the_tables_of_answers_that_their_command_prints() {
    let (section, tables) = section_and_table("Ten answers");
    assert!(section.contains(&tables), "{tables}");
}

#[test]
fn a_study_of_answers_of_which_nothing_is_finished_is_an_error_that_says_where_it_looked() {
    let desk = Desk::new();
    let scores = desk.run("misspelt.jsonl");
    let mut study = ted();
    study.args(["study", "answers", "--methods", "clone", "--table"]);
    finish(study.arg("--scores").arg(&scores))
        .with(2)
        .telling(scores.to_str().unwrap());
    assert!(!scores.exists());
}

#[test]
fn the_tables_of_answers_are_a_page_as_well_that_everybody_can_read() {
    let desk = Desk::new();
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let page = desk.run("answers.html");
    let mut study = ted();
    study
        .current_dir(root)
        .args(["study", "answers", "--table"]);
    study.args(["--families", "ten"]);
    finish(study.arg("--page").arg(&page)).with(0);
    let text = std::fs::read_to_string(&page).unwrap();
    assert!(text.contains("<td>box-close-v3</td>"), "{text}");
    let browser = Chromium::start([1280, 720]);
    browser.open(&format!("file://{}", page.display()));
    browser.photograph("study");
    assert_eq!(browser.complaints(), Vec::<serde_json::Value>::new());
}

/// The cheapest study there is: clones of two updates on the toy, which is collected on the way.
fn clones(desk: &Desk) -> Command {
    let mut study = ted();
    study.env("MINARI_DATASETS_PATH", desk.run("data"));
    study.current_dir(desk.folder.path());
    study.args([
        "study",
        "answers",
        "--families",
        "other",
        "--methods",
        "clone",
    ]);
    study.args([
        "--set",
        "algorithm.steps=2",
        "--set",
        "algorithm.hidden=[8]",
    ]);
    study.args(["--scores", "all.jsonl", "--out", "runs"]);
    study
}

#[test]
fn parts_of_a_study_collect_what_they_need_side_by_side_and_join_to_the_whole() {
    let desk = Desk::new();
    let parts: Vec<_> = ["1/2", "2/2"]
        .map(|part| {
            let mut study = clones(&desk);
            study
                .args(["--shard", part, "--quiet"])
                .stdout(Stdio::null());
            study.spawn().unwrap()
        })
        .into_iter()
        .map(|mut part| part.wait().unwrap().code())
        .collect();
    assert_eq!(parts, [Some(0), Some(0)]);
    let mut merge = ted();
    merge
        .current_dir(desk.folder.path())
        .args(["study", "merge"]);
    merge.args([
        "all.1-of-2.jsonl",
        "all.2-of-2.jsonl",
        "--into",
        "all.jsonl",
    ]);
    let said = finish(&mut merge).with(0).said;
    assert!(said.starts_with("6 scores in all.jsonl"), "{said}");

    // From the scores alone: nothing is left to do or to collect.
    for folder in ["data", "runs"] {
        std::fs::remove_dir_all(desk.run(folder)).unwrap();
    }
    let tables = finish(&mut clones(&desk)).with(0).said;
    assert!(tables.contains("(`other`), 6 of 6 runs"), "{tables}");
    let page = std::fs::read_to_string(desk.run("runs/report.html")).unwrap();
    assert!(page.contains("6 of 6 runs"), "{page}");
    assert!(!desk.run("data").exists());

    // A line that says something else is not joined.
    let scores = std::fs::read_to_string(desk.run("all.jsonl")).unwrap();
    let mean = scores.split("\"return_mean\":").nth(1).unwrap();
    let mean = mean.split(',').next().unwrap();
    let other = scores.replacen(
        &format!("\"return_mean\":{mean}"),
        "\"return_mean\":-1.0",
        1,
    );
    std::fs::write(desk.run("all.1-of-2.jsonl"), other).unwrap();
    finish(&mut merge).with(3).telling("all.1-of-2.jsonl");
    assert_eq!(
        std::fs::read_to_string(desk.run("all.jsonl")).unwrap(),
        scores
    );
}

#[test]
fn without_a_cluster_slurm_is_an_error_that_says_so() {
    let desk = Desk::new();
    let mut study = clones(&desk);
    study.env("PATH", desk.folder.path()).args(["--slurm", "2"]);
    finish(&mut study).with(1).telling("cannot run sbatch");
}

#[test]
fn a_page_that_cannot_be_written_is_told_before_anything_is_made() {
    let desk = Desk::new();
    let mut study = clones(&desk);
    finish(study.args(["--page", "missing/answers.html"]))
        .with(6)
        .telling("missing/answers.html");
    assert!(!desk.run("data").exists() && !desk.run("all.jsonl").exists());
}
