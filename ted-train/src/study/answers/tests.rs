//! The plan, its parts, the lines, the tables, and joining.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

use firmware_sim::bridge::Engine;
use firmware_sim::controller::Numeric;

use super::*;
use crate::evaluate::Evaluation;
use crate::study::cells;

fn planned(families: &[Family], methods: &[Method]) -> Vec<Planned> {
    let desk = Desk {
        datasets: Path::new("data"),
        out: Path::new("out"),
        sets: &[],
    };
    plan(families, methods, desk).unwrap()
}

fn whole() -> Vec<Planned> {
    planned(&Family::ALL, &Method::ALL)
}

/// A score that nobody flew for.
fn score(of: &Planned, score: f64, success: f64) -> RunScore {
    let seed = of.run.config.seed;
    RunScore {
        dataset: of.run.dataset.clone(),
        dataset_digest: format!("digest of {}", of.run.dataset),
        config: of.run.config.clone(),
        evaluation: Evaluation {
            task: of.task.to_owned(),
            world: None,
            numeric: Numeric::F32,
            engine: Engine::default(),
            seed,
            returns: vec![10.0 * score],
            return_mean: 10.0 * score,
            return_sd: 0.0,
            score: Some(score),
            success,
            faulted: 0,
            faults: Vec::new(),
            dataset_mean: 1.0,
            dataset_max: 10.0,
        },
        quality: None,
        minutes: None,
        machine: "a machine".to_owned(),
    }
}

fn write(path: &Path, lines: &[AnswerScore]) {
    let _ = std::fs::remove_file(path);
    for line in lines {
        cells::append(path, line).unwrap();
    }
}

#[test]
fn every_question_has_its_rows_and_every_log_a_name() {
    let mut rows_of: BTreeMap<Family, usize> = BTreeMap::new();
    let mut logs = BTreeSet::new();
    for row in rows() {
        *rows_of.entry(row.family).or_default() += 1;
        logs.insert(
            row.log
                .collect(Path::new(""))
                .dataset_id()
                .unwrap()
                .to_string(),
        );
    }
    let expected = [10, 6, 6, 18, 21, 35, 50, 2, 40];
    assert!(rows_of.into_values().eq(expected));
    for id in [
        "ted/drawer-open-v3-paper-s0-v0",
        "ted/box-close-v3-drift-s0-v0",
        "ted/reach-left_reach-right_second-paper-n400-s0-v0",
        "ted/sweep-into-v3-paper-n300-s0-v0",
        "ted/toy-micrometres-paper-s0-v0",
    ] {
        assert!(logs.contains(id), "{id} of {logs:?}");
    }
    assert_eq!(logs.len(), 10 + 6 + 6 + 15 + 2 + 40);
}

#[test]
fn what_two_rows_have_in_common_is_one_run_and_is_called_by_the_first() {
    let whole = whole();
    let made = to_make(&whole);
    assert!(made.len() < whole.len());
    let folders: BTreeSet<&PathBuf> = made.iter().map(|one| &one.run.folder).collect();
    assert_eq!(folders.len(), made.len(), "a folder for each");
    let same = |one: &Planned, other: &Planned| {
        (&one.run.dataset, &one.run.config) == (&other.run.dataset, &other.run.config)
    };
    for one in &whole {
        let found = made.iter().filter(|other| same(one, other)).count();
        assert_eq!(found, 1, "{one:?}");
    }
    // Also where the first row is not asked for.
    let few = planned(&[Family::Few], &[Method::Clone]);
    let full = few.iter().find(|one| one.variant == "50 good of 1,000");
    let line = full.unwrap().line(score(full.unwrap(), 0.5, 0.5));
    assert_eq!((line.family, line.variant.as_str()), (Family::Ten, "paper"));
}

#[test]
fn what_is_cheap_comes_first_and_seeds_come_one_after_the_other() {
    let made = to_make(&whole());
    let keys: Vec<_> = made
        .iter()
        .map(|one| (one.method.is_slow(), one.run.config.seed))
        .collect();
    assert!(keys.is_sorted());
    // Within a seed a dataset comes once.
    let first: Vec<&str> = made
        .iter()
        .filter(|one| !one.method.is_slow() && one.run.config.seed == 0)
        .map(|one| one.run.dataset.as_str())
        .collect();
    let (mut changes, names) = (first.clone(), first.iter().collect::<BTreeSet<_>>());
    changes.dedup();
    assert_eq!(changes.len(), names.len());
}

#[test]
fn parts_have_each_run_once_about_as_much_work_each_and_keep_datasets_together() {
    let made = to_make(&whole());
    let minutes = |runs: &[Planned]| runs.iter().map(|one| one.method.minutes()).sum::<f64>();
    for of in [1, 3, 8, 40] {
        let part = |index| -> Vec<Planned> {
            let shard: Shard = format!("{index}/{of}").parse().unwrap();
            shard.of(made.clone())
        };
        let parts: Vec<Vec<Planned>> = (1..=of).map(part).collect();
        assert_eq!(parts.iter().map(Vec::len).sum::<usize>(), made.len());
        for one in &made {
            let with_it = parts.iter().filter(|part| part.contains(one)).count();
            assert_eq!(with_it, 1);
        }
        let most = parts.iter().map(|part| minutes(part)).fold(0.0, f64::max);
        let fair = minutes(&made) / f64::from(of);
        assert!(most < 4.0 / 3.0 * fair, "{most} of {fair} in {of} parts");
    }
    let quarter: Shard = "3/4".parse().unwrap();
    let names = |runs: &[Planned]| -> BTreeSet<String> {
        runs.iter().map(|one| one.run.dataset.clone()).collect()
    };
    let mine = names(&quarter.of(made.clone()));
    let others = (1..=4).filter(|index| *index != 3).map(|index| {
        let shard: Shard = format!("{index}/4").parse().unwrap();
        names(&shard.of(made.clone()))
    });
    let shared = others.flatten().filter(|name| mine.contains(name)).count();
    assert_eq!(
        shared, 0,
        "none is more than a third of a quarter of the work"
    );
}

#[test]
fn what_names_no_part_is_refused_with_the_way_to_write_it() {
    for text in ["", "2", "0/8", "9/8", "1/0", "-1/8", "a/b", "1/8/2"] {
        let error = text.parse::<Shard>().unwrap_err();
        assert!(error.contains("write 2/8"), "{text}: {error}");
    }
    assert_eq!(" 2/8".parse::<Shard>().unwrap().to_string(), "2/8");
}

#[test]
fn a_line_says_outside_what_its_run_says_inside() {
    let of = &planned(&[Family::Number], &[Method::Steer])[20];
    let line = of.line(score(of, 0.75, 0.5));
    let text = serde_json::to_string(&line).unwrap();
    assert!(text.starts_with(
        "{\"family\":\"number\",\"variant\":\"0 answers\",\"task\":\"drawer-open-v3\",\"method\":\"steer\",\"preset\":\"steer\",\
         \"seed\":2,\"answers\":0,\"score\":0.75,\"success\":0.5,\"run\":{"
    ), "{text}");
    assert_eq!(serde_json::from_str::<AnswerScore>(&text).unwrap(), line);
    let other = text.replace("\"success\":0.5,\"run\"", "\"success\":0.75,\"run\"");
    let error = serde_json::from_str::<AnswerScore>(&other).unwrap_err();
    assert!(
        error.to_string().contains("not that of its `run`"),
        "{error}"
    );
}

#[test]
fn a_table_has_score_and_success_of_every_row_and_says_what_is_missing() {
    let planned = planned(
        &[Family::Other, Family::Few],
        &[Method::Clone, Method::Steer],
    );
    let of_toy = |one: &&Planned| one.family == Family::Other;
    let mut lines: Vec<AnswerScore> = planned
        .iter()
        .filter(of_toy)
        .map(|one| {
            let seed = one.run.config.seed as f64;
            let steer = f64::from(u8::from(one.method == Method::Steer));
            one.line(score(one, 0.25 * seed, steer))
        })
        .collect();
    lines.retain(|line| {
        let run = &line.run;
        (line.method, run.config.seed, run.evaluation.task.as_str()) != (Method::Steer, 2, "toy")
    });
    let expected = "\
**Logs that are no Meta-World** (`other`), 11 of 12 runs

| logs and teacher | task | clone | steer |
|---|---|---:|---:|
| paper | toy | 0.25 / 0.00 | 0.12 / 1.00 (2 of 3) |
| paper | toy-micrometres | 0.25 / 0.00 | 0.25 / 1.00 |

| logs and teacher | method | runs | mean score | IQM | success |
|---|---|---:|---:|---:|---:|
| paper | clone | 6 | 0.25 [0.08, 0.42] | 0.25 [0.06, 0.44] | 0.00 [0.00, 0.00] |
| paper | steer | 5 | 0.19 [0.04, 0.33] | 0.17 [0.00, 0.42] | 1.00 [1.00, 1.00] |";
    assert_eq!(markdown(&sections(&planned, &lines)), expected);
    assert_eq!(sections(&planned, &[]), []);
}

#[test]
fn files_are_joined_without_doubles_and_in_one_order() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let lines: Vec<AnswerScore> = planned(&[Family::Other], &[Method::Clone])
        .iter()
        .map(|one| one.line(score(one, 0.5, 0.5)))
        .collect();
    write(&at("a"), &[lines[3].clone(), lines[1].clone()]);
    write(&at("b"), &[lines[1].clone(), lines[0].clone()]);
    let into = at("all.jsonl");
    let files = [at("a"), at("b")];
    let merged = merge(&files, &into).unwrap();
    assert_eq!((merged.lines, merged.doubles, merged.foreign), (3, 1, 0));
    let held: Vec<AnswerScore> = cells::read(&into).unwrap();
    assert_eq!(held, [lines[3].clone(), lines[0].clone(), lines[1].clone()]);
    // Again changes nothing, and neither does another order.
    let before = std::fs::read(&into).unwrap();
    assert_eq!(merge(&[at("b"), at("a")], &into).unwrap().doubles, 4);
    assert_eq!(std::fs::read(&into).unwrap(), before);

    let missing = merge(&[at("c")], &into).unwrap_err().to_string();
    assert!(missing.contains("cannot read"), "{missing}");
}

#[test]
fn contradictions_are_refused_with_both_files_named_and_nothing_written() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let one = &planned(&[Family::Other], &[Method::Clone])[0];
    write(&at("a"), &[one.line(score(one, 0.5, 0.5))]);
    write(&at("b"), &[one.line(score(one, 0.6, 0.5))]);
    let error = merge(&[at("a"), at("b")], &at("all")).unwrap_err();
    let error = error.to_string();
    for part in [
        "clone on ted/toy-paper-s0-v0, seed 0",
        "came to 5 in",
        "to 6 in",
        "/a ",
        "/b:",
    ] {
        assert!(error.contains(part), "no {part} in {error}");
    }
    assert!(!at("all").exists());

    let mut other = one.line(score(one, 0.5, 0.5));
    other.run.dataset_digest = "another".to_owned();
    write(&at("b"), &[other.clone()]);
    let error = merge(&[at("a"), at("b")], &at("all"))
        .unwrap_err()
        .to_string();
    assert!(error.contains("with digest"), "{error}");

    // On another processor a recorded log has other last bits.
    other.run.machine = "another".to_owned();
    write(&at("c"), &[other]);
    let merged = merge(&[at("a"), at("c")], &at("all")).unwrap();
    assert_eq!((merged.lines, merged.doubles), (1, 1));
}

#[test]
fn the_other_study_s_scores_are_taken_in_where_the_plan_has_their_runs() {
    let folder = tempfile::tempdir().unwrap();
    let into = folder.path().join("answers.jsonl");
    let methods = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/methods.jsonl");
    let merged = merge(&[methods], &into).unwrap();
    // Three presets, two tasks, three seeds.
    assert_eq!((merged.lines, merged.doubles, merged.foreign), (18, 0, 120));
    let lines: Vec<AnswerScore> = cells::read(&into).unwrap();
    let slow = planned(
        &[Family::Ten],
        &[Method::Zero, Method::OprlITed, Method::True],
    );
    let found = slow
        .iter()
        .filter(|one| one.score(&lines).is_some())
        .count();
    assert_eq!(found, 18);
    assert!(lines.iter().all(|line| line.family == Family::Ten));
}
