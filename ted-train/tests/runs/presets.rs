//! Every composition by the command: listed, trained, gone on with, and refused where it cannot hold.

use std::fs;
use std::path::Path;

use serde_json::Value;
use ted_policy::{Artifact, ArtifactBytes};

use crate::command::{Desk, assert_same_outcome, checkpoints, finish, ted};

/// A Preference Transformer that learns in a moment.
pub const TRANSFORMER: [&str; 7] = [
    "reward.queries=3",
    "reward.segment=10",
    "reward.width=8",
    "reward.heads=2",
    "reward.steps=6",
    "reward.held_out=20",
    "reward.head=per-step",
];

/// A model of episodes that learns in a moment.
pub const EPISODES: [&str; 5] = [
    "reward.queries=3",
    "reward.clone.steps=6",
    "reward.network.steps=6",
    "reward.samples=20",
    "reward.held_out=20",
];

/// A sequence policy that learns in a moment.
pub const SEQUENCE: [&str; 7] = [
    "algorithm.queries=3",
    "algorithm.segment=10",
    "algorithm.width=8",
    "algorithm.layers=1",
    "algorithm.latent=2",
    "algorithm.batch=4",
    "algorithm.warmup=5",
];

fn listed() -> Vec<Value> {
    let list = finish(ted().args(["train", "--preset", "list", "--json"])).with(0);
    serde_json::from_str(&list.said).unwrap()
}

#[test]
fn the_list_says_of_every_preset_what_it_is_for_and_where_it_comes_from() {
    let rows = listed();
    let table = finish(ted().args(["train", "--preset", "list"]))
        .with(0)
        .said;
    for row in &rows {
        for part in [
            "preset",
            "reward",
            "filter",
            "discount",
            "algorithm",
            "purpose",
            "source",
        ] {
            let text = row[part].as_str().unwrap();
            assert!(!text.is_empty() && table.contains(text), "{row}");
        }
    }
    assert_eq!(table.lines().count(), rows.len() + 1);
    let study = finish(ted().args(["study", "policies", "--presets", "list"])).with(0);
    assert_eq!(study.said, table);
}

#[test]
fn every_preset_trains_and_goes_on_to_the_same_bytes_and_what_a_controller_can_fly_leaves_an_artefact()
 {
    let desk = Desk::with_dataset();
    for row in listed() {
        let preset = row["preset"].as_str().unwrap();
        let mut sets = vec!["algorithm.steps=20"];
        // Both halves of what these learn in turns, within the twenty.
        match row["algorithm"].as_str().unwrap() {
            "atac" => sets.push("algorithm.warm_start=10"),
            "awr" => sets.extend(["algorithm.critic_steps=5", "algorithm.actor_steps=5"]),
            "oppo" => sets.extend(SEQUENCE),
            // Fewer than all six episodes, or none would be better than the average.
            "conditioned" => sets.push("algorithm.best=2"),
            _ => {}
        }
        match row["reward"].as_str().unwrap() {
            "transport" => sets.push("reward.experts=2"),
            "transformer" => sets.extend(TRANSFORMER),
            "episodes" => sets.extend(EPISODES),
            _ => {}
        }
        let straight = desk.run(&format!("{preset}-straight"));
        let resumed = desk.run(&format!("{preset}-resumed"));
        let train = |run: &Path| {
            finish(&mut desk.train(run.to_str().unwrap(), preset, &sets)).with(0);
        };
        train(&straight);
        train(&resumed);
        // As if it had been killed between its last two checkpoints.
        fs::remove_file(checkpoints(&resumed).pop().unwrap()).unwrap();
        let flies = row["algorithm"] != "oppo";
        assert_eq!(resumed.join("policy.ted").exists(), flies, "{preset}");
        if flies {
            fs::remove_file(resumed.join("policy.ted")).unwrap();
        }
        train(&resumed);
        assert_same_outcome(&straight, &resumed);
        if !flies {
            continue;
        }
        let bytes = ArtifactBytes::read(straight.join("policy.ted")).unwrap();
        Artifact::parse(&bytes).unwrap();
    }
}

#[test]
fn a_policy_that_no_controller_can_fly_is_refused_where_an_artefact_is_asked_for() {
    let desk = Desk::with_dataset();
    let trained = finish(&mut desk.train("run", "oppo", &SEQUENCE)).with(0);
    assert_eq!(trained.said.lines().next(), Some("run"), "{trained:?}");
    let said = finish(desk.train("run", "oppo", &SEQUENCE).arg("--json")).with(0);
    let said: Value = serde_json::from_str(&said.said).unwrap();
    assert!(said["artefact"].is_null() && said["run"] == "run", "{said}");
    let run = desk.run("run");
    for arguments in [
        &["export"][..],
        &["export", "--to", "onnx"],
        &["crosscheck"],
        &["eval", "--replay"],
        &["inspect"],
    ] {
        let (command, flags) = arguments.split_first().unwrap();
        let ended = finish(ted().arg(command).arg(&run).args(flags));
        match *command {
            "inspect" => ended.with(0),
            _ => ended
                .with(3)
                .telling("there is no artefact to export or to fly"),
        };
    }
    finish(ted().arg("eval").arg(&run).args(["--numeric", "integer"]))
        .with(2)
        .telling("no integer networks");
    // Nobody is sent to finish what can never be exported.
    fs::remove_dir_all(run.join("checkpoints")).unwrap();
    finish(ted().arg("export").arg(&run))
        .with(3)
        .telling("there is no artefact to export or to fly");
    // Nor does a policy go on without anybody knowing from which answers.
    finish(&mut desk.train("run", "oppo", &SEQUENCE)).with(0);
    fs::remove_file(run.join("answers.state")).unwrap();
    finish(&mut desk.train("run", "oppo", &SEQUENCE))
        .with(2)
        .telling("answers.state is gone");
}

#[test]
fn choices_that_do_not_go_together_are_refused_with_the_reason() {
    let desk = Desk::with_dataset();
    for (preset, set, reason) in [
        (
            "true",
            "reward={source=\"none\"}",
            "iql needs a reward for each transition",
        ),
        (
            "oprl-atac",
            "reward={source=\"none\"}",
            "atac needs a reward for each transition",
        ),
        (
            "bc",
            "filter={keep=\"top-predicted\", k=10.0}",
            "predicts none",
        ),
        (
            "bc10",
            "discount={rule=\"ted\", gamma=0.99, k=70.0, sigma=0.7}",
            "bc looks at no discount",
        ),
        (
            "bc10",
            "filter.k=0.0",
            "filter.k is 0, but must be in (0, 100]",
        ),
        ("bc10", "filter.k=1.0", "which is none: raise filter.k"),
        (
            "otr",
            "reward.experts=7",
            "expected 1 to 6, the episodes of the dataset",
        ),
        ("bc", "reward={source=\"true\"}", "bc looks at no reward"),
        (
            "steer",
            "reward.lapse=1.0",
            "reward.lapse is 1, but must be in [0, 1)",
        ),
        (
            "steer",
            "reward.clone.steps=0",
            "reward.clone.steps is 0, but must be at least 1",
        ),
        (
            "true+conditioned",
            "reward={source=\"none\"}",
            "conditioned needs a reward for each transition",
        ),
        (
            "true+conditioned",
            "discount={rule=\"ted\", gamma=0.99, k=70.0, sigma=0.7}",
            "conditioned looks at no discount",
        ),
        (
            "true+conditioned",
            "discount={rule=\"ted\", gamma=0.99, k=70.0, sigma=1.0}",
            "conditioned looks at no discount",
        ),
        (
            "steer",
            "discount.sigma=0.7",
            "conditioned looks at no discount, so nothing would come of a lower one",
        ),
        (
            "true+conditioned",
            "algorithm.best=0",
            "algorithm.best is 0, but must be at least 1",
        ),
        (
            "true+conditioned",
            "algorithm.aim=-1.0",
            "algorithm.aim is -1, but must be in [0, inf)",
        ),
        (
            "true+conditioned",
            "algorithm.haste=-1.0",
            "algorithm.haste is -1, but must be in [0, inf)",
        ),
        (
            "true+conditioned",
            "algorithm.final_rate=0.1",
            "must be in [0, algorithm.learning_rate]",
        ),
        (
            "true+conditioned",
            "algorithm.average_rate=0.0",
            "algorithm.average_rate is 0, but must be in (0, 1]",
        ),
        (
            "pt+truncate",
            "discount={rule=\"ted\", gamma=0.99, k=70.0, sigma=0.7}",
            "the filter draws from the top 70 % only",
        ),
        (
            "oprl",
            "algorithm.critic_steps=60",
            "less than algorithm.steps",
        ),
        (
            "oppo",
            "filter={keep=\"top-true\", k=50.0}",
            "oppo looks at clips of all episodes",
        ),
        (
            "oppo",
            "discount={rule=\"ted\", gamma=0.99, k=70.0, sigma=0.7}",
            "oppo looks at no discount",
        ),
        (
            "oppo",
            "reward={source=\"zero\"}",
            "oppo looks at no reward",
        ),
        ("oppo", "algorithm.width=9", "a multiple of algorithm.heads"),
        ("oppo", "algorithm.segment=31", "ask for shorter segments"),
        (
            "pt",
            "reward.width=9",
            "at least 2 and a multiple of reward.heads",
        ),
        (
            "oprl-atac",
            "algorithm.warm_start=60",
            "less than algorithm.steps",
        ),
    ] {
        let mut command = ted();
        command
            .current_dir(desk.folder.path())
            .arg("train")
            .arg(desk.dataset());
        command.args([
            "--preset",
            preset,
            "--out",
            "run",
            "--set",
            "algorithm.steps=60",
        ]);
        // What is refused is the last thing set.
        let before: &[&str] = match preset {
            "oprl-atac" => &["--set", "algorithm.warm_start=10"],
            _ => &[],
        };
        let told = finish(command.args(before).args(["--set", set])).telling(reason);
        assert!([Some(2), Some(3)].contains(&told.code), "{told:?}");
        assert!(!desk.run("run").exists(), "nothing is begun: {set}");
    }
}

/// The log with another first answer.
fn contrary(log: &str) -> String {
    let at = log.find("\"answer\":").unwrap() + "\"answer\":".len();
    let end = at + log[at..].find(',').unwrap();
    let other = match log[at..end].parse::<f64>().unwrap() {
        0.0 => "1",
        _ => "0",
    };
    format!("{}{other}{}", &log[..at], &log[end..])
}

#[test]
fn answers_are_neither_passed_over_nor_changed_behind_a_learned_reward() {
    let desk = Desk::with_dataset();
    for preset in ["oprl-i", "pt", "oppo"] {
        let sets: &[&str] = match preset {
            "pt" => &TRANSFORMER,
            "oppo" => &SEQUENCE,
            _ => &[],
        };
        let sets = [&["algorithm.steps=20"], sets].concat();
        let train = || desk.train(preset, preset, &sets);
        finish(&mut train()).with(0);
        let answers = desk.run(preset).join("preferences.jsonl");
        let given = fs::read_to_string(&answers).unwrap();
        fs::write(&answers, contrary(&given)).unwrap();
        let refused = finish(&mut train()).telling("learned from other answers");
        assert_ne!(refused.code, Some(0));
        fs::write(&answers, &given).unwrap();
        finish(&mut train()).with(0);

        let mut deaf = desk.train("deaf", "bc", &[]);
        finish(deaf.arg("--preferences").arg(&answers))
            .with(2)
            .telling("the preset bc asks nothing");
    }
}
