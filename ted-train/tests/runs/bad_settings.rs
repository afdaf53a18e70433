//! Configurations that cannot be: each named with its field, code 3, and nothing begun.

use crate::command::{Desk, finish};

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
        ("iql.tau=0.0", "iql.tau is 0, but must be in (0, 1)"),
        ("iql.tau=1.0", "iql.tau is 1, but must be in (0, 1)"),
        ("iql.hidden=[300]", "iql.hidden is [300]"),
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
        "iql.stepz=5",
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
    std::fs::write(&file, "[iql]\nstepz = 5\n").unwrap();
    finish(
        desk.train("run", "true", &[])
            .args(["--config", "mine.toml"]),
    )
    .with(3)
    .telling("mine.toml")
    .telling("unknown field `stepz`");
    std::fs::write(&file, "[iql\n").unwrap();
    finish(
        desk.train("run", "true", &[])
            .args(["--config", "mine.toml"]),
    )
    .with(3)
    .telling("mine.toml");
    assert!(!desk.run("run").exists(), "nothing was begun");
}

#[test]
fn a_config_that_was_edited_by_hand_into_nonsense_is_named() {
    let desk = Desk::with_dataset();
    finish(&mut desk.train("run", "true", &[])).with(0);
    let path = desk.run("run").join("config.toml");
    let config = std::fs::read_to_string(&path).unwrap();
    std::fs::write(&path, config.replace("tau = 0.7", "tau = 7.0")).unwrap();
    finish(&mut desk.train("run", "true", &[]))
        .with(3)
        .telling("iql.tau is 7");
}

#[test]
fn rewards_that_make_the_losses_overflow_are_named_and_not_exported() {
    let desk = Desk::with_dataset();
    let sets = ["iql.learning_rate=1e30"];
    finish(&mut desk.train("run", "true", &sets))
        .with(1)
        .telling("loss is not finite after");
    assert!(!desk.run("run").join("policy.ted").exists());
}
