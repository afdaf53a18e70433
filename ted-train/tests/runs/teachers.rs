//! Simulated teachers of every kind, people who cannot tell, and logs that say nothing: each a run or a named error.

use std::fs;
use std::path::Path;

use serde_json::Value;
use ted_policy::{Artifact, ArtifactBytes};
use ted_train::dataset::EpisodeRecord;

use crate::command::{Desk, Ended, assert_same_outcome, finish, lines, ted};
use crate::dataset::{episodes, write};
use crate::presets::{EPISODES, SEQUENCE, TRANSFORMER};

/// The presets that ask one question after the other.
const ASKING: [&str; 2] = ["steer", "oprl-i+ted"];

/// What makes a preset learn in a moment, and more settings.
fn small<'s>(preset: &str, more: &[&'s str]) -> Vec<&'s str> {
    let own: &[&str] = match preset {
        "steer" => &EPISODES,
        "pt" => &TRANSFORMER,
        "oppo" => &SEQUENCE,
        _ => &[],
    };
    let mut sets = [own, more].concat();
    if preset == "steer" {
        // Fewer than all episodes, or none would be better than the average.
        sets.push("algorithm.best=2");
    }
    sets
}

/// Trains on a dataset to the end, and fails unless all that is left are numbers.
#[track_caller]
fn sane(desk: &Desk, dataset: &Path, out: &str, preset: &str, more: &[&str]) -> Ended {
    let sets = small(preset, more);
    let ended = finish(&mut desk.train_on(dataset, out, preset, &sets)).with(0);
    let run = desk.run(out);
    let bytes = ArtifactBytes::read(run.join("policy.ted")).unwrap();
    Artifact::parse(&bytes).unwrap();
    let report = fs::read(run.join("reward.json")).unwrap();
    let report: Value = serde_json::from_slice(&report).unwrap();
    // A number that is none is written as null. Where there is nothing to compare with, there is none of the whole.
    let compared = |whole: &str| !report[whole].is_null();
    let compared = [
        ("held_out", "/held_out/agreement"),
        ("quality", "/quality/spearman"),
    ]
    .into_iter()
    .filter_map(|(whole, place)| compared(whole).then_some(place));
    for place in ["/low", "/high"].into_iter().chain(compared) {
        let number = report.pointer(place);
        assert!(number.is_some_and(Value::is_number), "{place} in {report}");
    }
    let fits = report["fits"].as_array().unwrap();
    assert!(fits.iter().all(|fit| fit["loss"].is_number()), "{report}");
    if preset == "steer" {
        for place in ["gain", "better"] {
            assert!(report["confidence"][place].is_number(), "{report}");
        }
    }
    ended
}

#[test]
fn teachers_of_every_kind_are_asked_and_the_log_says_which() {
    let desk = Desk::with_dataset();
    for preset in ASKING {
        for (kind, by) in [
            ("teacher.says=equal", "teacher:equal"),
            ("teacher.says=first", "teacher:first"),
            ("teacher.says=random", "teacher:random"),
            ("teacher.says=reversed", "teacher:reversed"),
            ("teacher.errs=0.25", "teacher:true-return,errs=0.25"),
            ("teacher.tolerance=9", "teacher:true-return,tolerance=9"),
        ] {
            let out = format!("{preset}-{kind}");
            sane(&desk, &desk.dataset(), &out, preset, &[kind]);
            let log = fs::read_to_string(desk.run(&out).join("preferences.jsonl")).unwrap();
            let by = format!("\"by\":\"{by}\"}}\n");
            assert_eq!(log.matches(&by).count(), log.lines().count(), "{log}");
            let config = fs::read_to_string(desk.run(&out).join("config.toml")).unwrap();
            assert!(config.contains("[teacher]"), "{config}");
        }
        sane(&desk, &desk.dataset(), preset, preset, &[]);
        let config = fs::read_to_string(desk.run(preset).join("config.toml")).unwrap();
        assert!(!config.contains("teacher"), "{config}");
    }
}

#[test]
fn a_teacher_out_of_range_or_of_no_use_is_refused_and_nothing_is_begun() {
    let desk = Desk::with_dataset();
    for (preset, sets, told) in [
        (
            "steer",
            &["teacher.errs=1.5"][..],
            "teacher.errs is 1.5, but must be in [0, 1]",
        ),
        (
            "steer",
            &["teacher.cannot_tell=nan"],
            "teacher.cannot_tell is NaN, but must be in [0, 1]",
        ),
        (
            "steer",
            &["teacher.tolerance=-1"],
            "teacher.tolerance is -1, but must be in [0, inf)",
        ),
        ("steer", &["teacher.says=maybe"], "unknown variant `maybe`"),
        ("steer", &["teacher.err=0.1"], "unknown field `err`"),
        (
            "steer",
            &["teacher.says=random", "teacher.errs=0.1"],
            "nothing would come of teacher.errs",
        ),
        (
            "steer",
            &["teacher.says=first", "teacher.tolerance=0.1"],
            "nothing would come of teacher.tolerance",
        ),
        ("bc", &["teacher.errs=0.1"], "this run asks nobody"),
    ] {
        finish(&mut desk.train("run", preset, sets))
            .with(3)
            .telling(told);
    }
    fs::write(desk.run("answers.jsonl"), "").unwrap();
    let mut train = desk.train("run", "steer", &["teacher.says=random"]);
    finish(train.args(["--preferences", "answers.jsonl"]))
        .with(2)
        .telling("--preferences are answers, and so are those of teacher:random");
    assert!(!desk.run("run").exists(), "nothing was begun");
}

#[test]
fn who_cannot_tell_is_asked_something_else_and_a_run_that_begins_again_hears_the_same() {
    let desk = Desk::with_dataset();
    for (preset, wanted) in [("steer", 3), ("oprl-i+ted", 10), ("pt", 3)] {
        let half = ["teacher.cannot_tell=0.5", "teacher.errs=0.3"];
        let [straight, again] = ["straight", "again"].map(|it| format!("{preset}-{it}"));
        finish(&mut desk.train(&straight, preset, &small(preset, &half))).with(0);
        let log = fs::read_to_string(desk.run(&straight).join("preferences.jsonl")).unwrap();
        let untold = log.matches("\"answer\":null,").count();
        assert!(untold > 0, "{log}");
        assert_eq!(log.lines().count(), wanted + untold);
        // As if it had been killed between two questions, with and without an answer.
        let begun: String = log.split_inclusive('\n').take(wanted - 1).collect();
        fs::create_dir(desk.run(&again)).unwrap();
        fs::write(desk.run(&again).join("preferences.jsonl"), begun).unwrap();
        finish(&mut desk.train(&again, preset, &small(preset, &half))).with(0);
        assert_same_outcome(&desk.run(&straight), &desk.run(&again));
    }
}

#[test]
fn where_nobody_can_tell_anything_the_run_says_so_and_keeps_what_was_asked() {
    let desk = Desk::with_dataset();
    for preset in ["steer", "oprl-i+ted", "pt", "oppo"] {
        let sets = small(preset, &["teacher.cannot_tell=1"]);
        for _ in 0..2 {
            finish(&mut desk.train(preset, preset, &sets))
                .with(3)
                .telling("10 of 10 questions got no answer")
                .telling("teacher.cannot_tell");
            assert_eq!(lines(&desk.run(preset).join("preferences.jsonl")), 10);
        }
    }
}

/// Episodes whose true rewards are all the same.
fn without_rewards(count: u64) -> Vec<EpisodeRecord> {
    let mut records = episodes(count, 30);
    records.iter_mut().for_each(|it| it.rewards.fill(0.0));
    records
}

#[test]
fn rewards_that_are_all_the_same_are_refused_where_a_run_needs_them() {
    let desk = Desk::new();
    let dataset = write(desk.folder.path(), "zero", &without_rewards(6));
    let looks = ["true", "negative", "otr", "bc10"];
    for preset in ["steer", "oprl-i+ted", "pt", "oppo"]
        .into_iter()
        .chain(looks)
    {
        finish(&mut desk.train_on(&dataset, "run", preset, &small(preset, &[])))
            .with(3)
            .telling("the true rewards of ted/zero-v0 are all 0")
            .telling("--preferences");
    }
    assert!(!desk.run("run").exists(), "nothing was begun");
    // Who does not look at rewards can answer, and nothing is compared with rewards that do not exist.
    let coin = ["teacher.says=random"];
    let ended = sane(&desk, &dataset, "coin", "steer", &coin);
    ended.telling("reward from 3 answers: the logs have no rewards to compare it with");
    let report = fs::read(desk.run("coin/reward.json")).unwrap();
    let report: Value = serde_json::from_slice(&report).unwrap();
    assert!(report["quality"].is_null() && report["held_out"].is_null());
    let mut inspect = ted();
    inspect.current_dir(desk.folder.path()).arg("inspect");
    let run = finish(inspect.arg("coin")).with(0).said;
    assert!(
        run.contains("Pearson -, Spearman -: the logs have no rewards"),
        "{run}"
    );
    let page = fs::read_to_string(desk.run("coin/report.html")).unwrap();
    assert!(!page.contains("Spearman") && !page.contains("pairs that were not asked"));
    let mut study = ted();
    study.current_dir(desk.folder.path());
    study.args(["study", "reward", "--out", "study", "--datasets"]);
    finish(study.arg(&dataset))
        .with(3)
        .telling("the true rewards of ted/zero-v0 are all 0");
    assert!(!desk.run("study").exists(), "nothing was begun");
}

#[test]
fn where_no_teacher_can_answer_a_person_answers_what_the_command_asks_line_by_line() {
    let desk = Desk::new();
    let dataset = write(desk.folder.path(), "zero", &without_rewards(6));
    let file = desk.run("answers.jsonl");
    fs::write(&file, "").unwrap();
    let sets = small("steer", &[]);
    let train = || {
        let mut train = desk.train_on(&dataset, "run", "steer", &sets);
        finish(train.args(["--preferences", "answers.jsonl"]))
    };
    // The second one cannot be told, so four questions are asked for three answers, and no clips twice.
    for (number, answer) in (1..).zip(["1", "null", "0.5", "0"]) {
        let asked = train().with(3).telling(&format!(
            "answers.jsonl does not answer question {number} ("
        ));
        let line = asked.told.lines().find_map(|it| it.split_once("tell: "));
        let line = line.unwrap().1;
        let answered = line.replace("\"answer\":null", &format!("\"answer\":{answer}"));
        let log = fs::read_to_string(&file).unwrap();
        // The same command without a new answer asks the same.
        train().with(3).telling(line);
        fs::write(&file, format!("{log}{answered}\n")).unwrap();
    }
    train().with(0).telling("4 of 4 lines are used");
    let log = fs::read_to_string(desk.run("run").join("preferences.jsonl")).unwrap();
    assert_eq!(log, fs::read_to_string(&file).unwrap());
}

#[test]
fn logs_in_which_little_or_nothing_differs_end_in_a_policy_or_in_a_word_about_it() {
    let desk = Desk::new();
    let root = desk.folder.path();
    let alike = vec![episodes(1, 30).remove(0); 6];
    let mut still = episodes(6, 30);
    still.iter_mut().for_each(|it| it.actions.fill(0.25));
    let mut nowhere = episodes(6, 30);
    nowhere.iter_mut().for_each(|it| it.observations.fill(0.5));
    for preset in ASKING {
        for (name, records) in [("alike", &alike), ("still", &still), ("nowhere", &nowhere)] {
            let name = format!("{name}-{preset}").replace('+', "-");
            let dataset = write(root, &name, records);
            sane(&desk, &dataset, &format!("run-{name}"), preset, &[]);
        }
    }
    let alone = write(root, "alone", &episodes(1, 30));
    finish(&mut desk.train_on(&alone, "alone", "steer", &small("steer", &[])))
        .with(3)
        .telling("fewer than two episodes");
    assert!(!desk.run("alone").exists(), "nothing was begun");
    sane(&desk, &alone, "alone", "oprl-i+ted", &[]);
}

#[test]
fn a_run_ends_with_how_sure_it_is_in_words_and_in_numbers() {
    let desk = Desk::with_dataset();
    let sets = small("steer", &["reward.sure=1.0", "reward.competence=0.0"]);
    let said = finish(&mut desk.train("run", "steer", &sets)).with(0).said;
    let last = said.lines().last().unwrap();
    assert!(last.starts_with("by 3 answers, "), "{said}");
    // A finished run says it again.
    let mut train = desk.train("run", "steer", &sets);
    let json = finish(train.arg("--json")).with(0).said;
    let json: Value = serde_json::from_str(&json).unwrap();
    assert_eq!(json["statement"], last);
    assert_eq!(json["confidence"]["answers"], 3);
    assert!(json["artefact"].is_string(), "{json}");

    let fleet = |more: &[&str]| {
        let mut train = ted();
        train
            .current_dir(desk.folder.path())
            .arg("train")
            .arg(desk.dataset());
        train.args(["--preset", "steer,zero", "--out", "fleet"]);
        for set in &sets {
            train.args(["--set", &format!("steer:{set}")]);
        }
        for set in ["algorithm.steps=20", "schedule.evaluation_episodes=0"] {
            train.args(["--set", set]);
        }
        finish(train.args(more)).with(0).said
    };
    let said = fleet(&[]);
    let last = said.lines().last().unwrap();
    assert!(last.contains("steer/seed-0: by 3 answers, "), "{said}");
    let json: Value = serde_json::from_str(&fleet(&["--json"])).unwrap();
    let [steer, zero] = [0, 1].map(|run| &json["runs"][run]);
    assert!(last.ends_with(steer["statement"].as_str().unwrap()));
    assert!(zero["statement"].is_null() && zero["confidence"].is_null());
}
