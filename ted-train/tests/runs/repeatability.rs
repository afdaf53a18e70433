//! The same configuration and seed give the same bytes; sigma = 1 gives plain IQL.

use std::path::Path;

use ted_policy::{Artifact, ArtifactBytes};

use crate::command::{Desk, assert_same_outcome, checkpoints, finish, ted};
use crate::presets::EPISODES;

#[test]
fn the_number_of_threads_does_not_show_in_any_byte() {
    let desk = Desk::with_dataset();
    // The widths of real runs, so that the work is split between threads where it ever is.
    let perceptrons = ["algorithm.hidden=[256, 256]", "algorithm.batch=256"];
    let clips = ["reward.segment=30", "reward.steps=3", "reward.held_out=20"];
    for (preset, sets) in [
        ("oprl-i+ted", &["reward.hidden=[256, 256]"][..]),
        ("oprl", &["algorithm.critic_steps=4"]),
        ("oprl-atac+ted", &["algorithm.warm_start=6"]),
        ("pt", &clips),
        ("otr", &["reward.experts=2"]),
        ("oppo", &["algorithm.segment=30", "algorithm.steps=3"]),
        ("bc", &[]),
        ("true+conditioned", &["algorithm.best=2"]),
    ] {
        let shared: &[&str] = match preset {
            "oppo" => &[],
            _ => &perceptrons,
        };
        let sets = [&["algorithm.steps=12"], shared, sets].concat();
        let run = |threads| {
            let out = format!("{preset}-{threads}");
            let mut train = desk.train(&out, preset, &sets);
            finish(train.env("RAYON_NUM_THREADS", threads)).with(0);
            desk.run(&out)
        };
        let alone = run("1");
        assert_same_outcome(&alone, &run("2"));
        assert_same_outcome(&alone, &run("5"));
    }
}

#[test]
fn another_seed_gives_other_questions_and_other_weights() {
    let desk = Desk::with_dataset();
    for seed in ["0", "1"] {
        finish(desk.train(seed, "oprl-i", &[]).args(["--seed", seed])).with(0);
    }
    for file in ["preferences.jsonl", "metrics.jsonl", "policy.ted"] {
        let read = |run: &str| std::fs::read(desk.run(run).join(file)).unwrap();
        assert!(read("0") != read("1"), "{file}");
    }
}

#[test]
fn ted_with_sigma_one_is_plain_iql_to_the_bit() {
    let desk = Desk::with_dataset();
    for backend in ["fused", "flex", "ndarray"] {
        let set = format!("backend={backend}");
        let run = |name: &str, preset: &str, sets: &[&str]| {
            let out = format!("{backend}-{name}");
            let sets = [sets, &[set.as_str()]].concat();
            finish(&mut desk.train(&out, preset, &sets)).with(0);
            let run = desk.run(&out);
            (
                learned(&run),
                std::fs::read(run.join("metrics.jsonl")).unwrap(),
            )
        };
        let plain = run("plain", "oprl-i", &[]);
        let neutral = run("neutral", "oprl-i+ted", &["discount.sigma=1.0"]);
        assert!(neutral == plain, "{backend}");
        let lowered = run("lowered", "oprl-i+ted", &[]);
        assert!(lowered != plain, "{backend}: sigma = 0.7 does something");
    }
}

#[test]
fn the_border_of_steer_is_in_its_artefact_and_in_no_bit_of_what_is_learned() {
    let desk = Desk::with_dataset();
    let run = |out: &str, more: &[&str]| {
        let small = ["algorithm.steps=20", "algorithm.best=2"];
        let sets = [&small, &EPISODES[..], more].concat();
        finish(&mut desk.train(out, "steer", &sets)).with(0);
        let run = desk.run(out);
        let bytes = ArtifactBytes::read(run.join("policy.ted")).unwrap();
        let artifact = Artifact::parse(&bytes).unwrap();
        let integers = artifact.integers().unwrap();
        let borders = [artifact.ted().is_some(), integers.threshold.is_some()];
        assert!(artifact.reward().is_some());
        (learned(&run), borders)
    };
    let (with, borders) = run("with", &[]);
    assert_eq!(borders, [true; 2]);
    let constant = "discount={rule=\"constant\", gamma=0.99}";
    let (without, borders) = run("without", &[constant]);
    assert_eq!(borders, [false; 2]);
    assert!(with == without);
}

/// What the last checkpoint holds behind the digest of the configuration: the step and every tensor.
fn learned(run: &Path) -> Vec<u8> {
    const MAGIC_AND_CRC: usize = 12;
    const DIGEST: usize = 32;
    let newest = checkpoints(run).pop().unwrap();
    std::fs::read(newest)
        .unwrap()
        .split_off(MAGIC_AND_CRC + DIGEST)
}

#[test]
fn ted_on_rewards_that_nobody_learned_is_exported_without_a_border_in_integers() {
    let desk = Desk::with_dataset();
    let ted_rule = "discount={rule=\"ted\", gamma=0.99, k=70.0, sigma=0.7}";
    let mut train = desk.train("run", "true", &[ted_rule]);
    finish(&mut train).with(0);
    let run = desk.run("run");
    let bytes = ArtifactBytes::read(run.join("policy.ted")).unwrap();
    let artifact = Artifact::parse(&bytes).unwrap();
    assert!(artifact.ted().is_some() && artifact.reward().is_none());
    assert!(artifact.integers().unwrap().threshold.is_none());

    // The report stands beside the artefact, also when that is made again.
    let report = run.join("quantisation.json");
    let before = std::fs::read(&report).unwrap();
    std::fs::remove_file(&report).unwrap();
    finish(ted().arg("export").arg(&run)).with(0);
    assert!(std::fs::read(&report).unwrap() == before);
}

#[test]
fn the_artefact_says_where_it_comes_from_and_replays_its_golden_vectors() {
    let desk = Desk::with_dataset();
    finish(desk.train("run", "oprl-i+ted", &[]).args(["--seed", "4"])).with(0);
    let bytes = ArtifactBytes::read(desk.run("run").join("policy.ted")).unwrap();
    let artifact = Artifact::parse(&bytes).unwrap();
    artifact
        .verify_golden(&mut ted_core::Scratch::new())
        .unwrap();
    assert!(artifact.golden().cases().count() > 0);
    let provenance = artifact.provenance();
    assert_eq!(
        (provenance.preset, provenance.seed, provenance.steps),
        ("oprl-i+ted", 4, 60)
    );
    assert_eq!(provenance.dataset_id, "ted/plain-v0");
    let digest =
        |file: &str| *blake3::hash(&std::fs::read(desk.run("run").join(file)).unwrap()).as_bytes();
    assert_eq!(provenance.config_digest.0, digest("config.toml"));
    assert_eq!(
        provenance.preferences_digest.unwrap().0,
        digest("preferences.jsonl")
    );
    assert_eq!(artifact.contract().task, "reach-v3");
    assert!(artifact.reward().is_some() && artifact.ted().is_some());
}

#[test]
fn what_flies_is_what_was_trained_with_rewards_that_a_controller_can_repeat_and_without() {
    let desk = Desk::with_dataset();
    for unit in ["true", "false"] {
        let set = format!("unit_rewards={unit}");
        finish(&mut desk.train(unit, "oprl-i+ted", &[&set])).with(0);
        let checked = ["crosscheck", unit, "--episodes", "0"];
        finish(ted().current_dir(desk.folder.path()).args(checked)).with(0);
        let bytes = ArtifactBytes::read(desk.run(unit).join("policy.ted")).unwrap();
        let artifact = Artifact::parse(&bytes).unwrap();
        let parts = (artifact.reward().is_some(), artifact.ted().is_some());
        assert_eq!(parts, (unit == "true", unit == "true"));
    }
}

#[test]
fn a_policy_that_aims_out_of_range_is_checked_exported_again_and_limited_in_floats_and_in_integers()
{
    let desk = Desk::with_dataset();
    let far = ["algorithm.best=2", "algorithm.aim=50.0"];
    finish(&mut desk.train("run", "true+conditioned", &far)).with(0);
    let run = desk.run("run");
    let bytes = ArtifactBytes::read(run.join("policy.ted")).unwrap();
    let artifact = Artifact::parse(&bytes).unwrap();
    assert_eq!(artifact.policy().mlp().output(), ted_core::Output::Linear);
    finish(ted().arg("crosscheck").arg(&run).args(["--episodes", "0"])).with(0);

    let before = std::fs::read(run.join("policy.ted")).unwrap();
    std::fs::remove_file(run.join("policy.ted")).unwrap();
    finish(ted().arg("export").arg(&run)).with(0);
    assert!(std::fs::read(run.join("policy.ted")).unwrap() == before);

    for numeric in ["f32", "integer"] {
        let replay = ["--replay", "--json", "--numeric", numeric];
        let flown = finish(ted().arg("eval").arg(&run).args(replay)).with(0);
        let report: serde_json::Value = serde_json::from_str(&flown.said).unwrap();
        assert!(report["clamped_ticks"].as_u64().unwrap() > 0, "{report}");
        assert!(report["faults"].as_array().unwrap().is_empty(), "{report}");
    }
}

#[test]
fn a_run_says_when_no_episode_is_left_to_be_better_than_the_average() {
    let desk = Desk::with_dataset();
    let said = "the policy imitates the average";
    // Six episodes, of which ten are the best.
    let all = finish(&mut desk.train("all", "true+conditioned", &[])).with(0);
    let some = finish(&mut desk.train("some", "true+conditioned", &["algorithm.best=5"])).with(0);
    assert!(all.told.contains(said) && !some.told.contains(said));
}
