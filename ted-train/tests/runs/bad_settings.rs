//! Configurations that cannot be: each named with its field, code 3, and nothing begun.

use std::fs;

use crate::command::{Desk, assert_same_outcome, finish, lines, ted};

#[test]
fn values_out_of_range_are_named_by_field_and_range() {
    let desk = Desk::with_dataset();
    let cases = [
        (
            "discount.k=100.5",
            "discount.k is 100.5, but must be in [0, 100]",
        ),
        (
            "discount.k=-1.0",
            "discount.k is -1, but must be in [0, 100]",
        ),
        (
            "discount.sigma=1.5",
            "discount.sigma is 1.5, but must be in [0, 1]",
        ),
        ("discount.sigma=-0.1", "discount.sigma is -0.1"),
        (
            "discount.sigma=nan",
            "discount.sigma is NaN, but must be in [0, 1]",
        ),
        ("discount.gamma=1.01", "discount.gamma is 1.01"),
        (
            "algorithm.tau=0.0",
            "algorithm.tau is 0, but must be in (0, 1)",
        ),
        (
            "algorithm.tau=1.0",
            "algorithm.tau is 1, but must be in (0, 1)",
        ),
        ("algorithm.hidden=[300]", "algorithm.hidden is [300]"),
        (
            "algorithm.log_std=[2.0, -5.0]",
            "algorithm.log_std[0] is 2, but must be in (-inf, algorithm.log_std[1]]",
        ),
        (
            "algorithm.log_std=[-5.0, nan]",
            "algorithm.log_std[1] is NaN",
        ),
        (
            "algorithm.learning_rate=inf",
            "algorithm.learning_rate is inf, but must be in (0, inf)",
        ),
        (
            "algorithm.adam.beta1=1.0",
            "algorithm.adam.beta1 is 1, but must be in [0, 1)",
        ),
        ("algorithm.adam.epsilon=0.0", "algorithm.adam.epsilon is 0"),
        ("reward.adam.beta2=-0.1", "reward.adam.beta2 is -0.1"),
        ("reward.learning_rate=inf", "reward.learning_rate is inf"),
        (
            "reward.scaling.floor=0.0",
            "reward.scaling.floor is 0, but must be in [1e-30, inf)",
        ),
    ];
    for (set, told) in cases {
        finish(&mut desk.train("run", "oprl-i+ted", &[set]))
            .with(3)
            .telling(told);
    }
    assert!(!desk.run("run").exists(), "nothing was begun");
}

#[test]
fn unknown_keys_are_named_wherever_they_stand() {
    let desk = Desk::with_dataset();
    for set in [
        "algorithm.stepz=5",
        "stepz=5",
        "discount.stepz=5",
        "reward.stepz=5",
        "schedule.stepz=5",
    ] {
        finish(&mut desk.train("run", "oprl-i+ted", &[set]))
            .with(3)
            .telling("unknown field `stepz`")
            .telling(set);
    }
    let file = desk.folder.path().join("mine.toml");
    fs::write(&file, "[algorithm]\nstepz = 5\n").unwrap();
    finish(
        desk.train("run", "true", &[])
            .args(["--config", "mine.toml"]),
    )
    .with(3)
    .telling("mine.toml")
    .telling("unknown field `stepz`");
    fs::write(&file, "[algorithm\n").unwrap();
    finish(
        desk.train("run", "true", &[])
            .args(["--config", "mine.toml"]),
    )
    .with(3)
    .telling("mine.toml");
    assert!(!desk.run("run").exists(), "nothing was begun");
}

#[test]
fn what_names_a_run_comes_from_its_flag_or_the_file_and_not_from_set() {
    let desk = Desk::with_dataset();
    for (set, flag) in [("seed=5", "--seed"), ("preset=true", "--preset")] {
        finish(&mut desk.train("run", "oprl-i+ted", &[set]))
            .with(3)
            .telling(set)
            .telling(flag);
        let study = [
            "study",
            "policies",
            "--datasets",
            "x",
            "--out",
            "run",
            "--set",
            set,
        ];
        finish(ted().current_dir(desk.folder.path()).args(study))
            .with(3)
            .telling(flag);
    }
    assert!(!desk.run("run").exists(), "nothing was begun");

    finish(desk.train("run", "zero", &[]).args(["--seed", "3"])).with(0);
    let train = |flags: &[&str], folder: &str| {
        let mut train = ted();
        train.current_dir(desk.folder.path()).arg("train");
        train
            .arg(desk.dataset())
            .args(["--config", "run/config.toml"]);
        finish(train.args(flags)).with(0);
        desk.run("runs/reach-v3").join(folder)
    };
    assert_same_outcome(&desk.run("run"), &train(&[], "zero/seed-3"));
    let other = fs::read_to_string(train(&["--seed", "4"], "zero/seed-4").join("config.toml"));
    assert!(other.unwrap().contains("seed = 4"));
}

#[test]
fn a_config_that_was_edited_by_hand_into_nonsense_is_named() {
    let desk = Desk::with_dataset();
    finish(&mut desk.train("run", "true", &[])).with(0);
    let path = desk.run("run").join("config.toml");
    let config = fs::read_to_string(&path).unwrap();
    fs::write(&path, config.replace("tau = 0.7", "tau = 7.0")).unwrap();
    finish(&mut desk.train("run", "true", &[]))
        .with(3)
        .telling("algorithm.tau is 7");
}

#[test]
fn rewards_that_make_the_losses_overflow_are_named_and_not_exported() {
    let desk = Desk::with_dataset();
    let sets = ["algorithm.learning_rate=1e30"];
    finish(&mut desk.train("run", "true", &sets))
        .with(1)
        .telling("loss is not finite after");
    assert!(!desk.run("run").join("policy.ted").exists());
}

#[test]
fn a_learning_rate_that_makes_the_reward_overflow_is_named_and_the_answers_are_kept() {
    let desk = Desk::with_dataset();
    let sets = ["reward.learning_rate=1e30"];
    finish(&mut desk.train("run", "oprl-i", &sets))
        .with(1)
        .telling("the reward loss is not finite after round 0");
    let run = desk.run("run");
    assert_eq!(lines(&run.join("preferences.jsonl")), 7);
    assert!(!run.join("reward.state").exists());
}
