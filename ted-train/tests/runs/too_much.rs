//! Numbers that ask for more than the machine has: each refused with its name and the way out, before anything is begun; and every
//! number of a configuration, whatever is written there, is refused or trained on, and never the end of the process.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use firmware_sim::progress::Audience;
use ted_train::config::{Config, Overrides, Preset};
use ted_train::dataset::Dataset;
use ted_train::run::{DatasetReference, RunFolder};
use ted_train::train::{check, check_teacher, train};

use crate::command::{Desk, finish, ted};
use crate::dataset::{SHAPE, episodes};

#[test]
fn a_number_that_needs_more_memory_than_there_is_is_named_with_what_it_needs_and_what_would_do() {
    let desk = Desk::with_dataset();
    let cases = [
        ("true", "algorithm.batch=4000000000"),
        ("bc", "algorithm.batch=4000000000"),
        ("oprl-i", "reward.pool=400000000000"),
        ("oprl-i+ted", "reward.held_out=9000000000000000000"),
        ("oppo", "algorithm.latent=4000000000"),
    ];
    for (preset, set) in cases {
        let (field, number) = set.split_once('=').unwrap();
        let sets = match preset {
            "oppo" => vec!["algorithm.segment=10", set],
            _ => vec![set],
        };
        finish(&mut desk.train("run", preset, &sets))
            .with(2)
            .telling(&format!("{field} is {number}, which needs about "))
            .telling("B of memory, and ")
            .telling(" are free: at most ");
    }
    assert!(!desk.run("run").exists(), "nothing was begun");

    // Where somebody is to be asked first, too.
    let mut ask = ted();
    ask.current_dir(desk.folder.path())
        .arg("ask")
        .arg(desk.dataset())
        .args(["--out", "run", "--set", "reward.clone.batch=4000000000"]);
    finish(&mut ask)
        .with(2)
        .telling("reward.clone.batch is 4000000000");
    assert!(!desk.run("run").exists(), "nothing was begun");
}

#[test]
fn numbers_that_name_more_work_than_anybody_means_are_refused_with_their_range() {
    let desk = Desk::with_dataset();
    for (preset, set, range) in [
        ("true", "algorithm.steps=4000000000", "at most 1000000000"),
        (
            "true",
            "schedule.evaluation_episodes=4000000000",
            "at most 1000000",
        ),
        ("oprl-i", "reward.rounds=4294967295", "at most 100000"),
        ("oprl-i", "reward.epochs=4294967295", "at most 1000000"),
    ] {
        finish(&mut desk.train("run", preset, &[set]))
            .with(3)
            .telling(&format!("but must be {range}"));
    }
    let cases: [&[&str]; 13] = [
        &["collect", "--task", "toy", "--episodes", "4000000000"],
        &["collect", "--task", "reach-v3", "--episodes", "4000000000"],
        &["collect", "--task", "reach-v3", "--workers", "4000000000"],
        &["quickstart", "--episodes", "4000000000"],
        &["quickstart", "--steps", "4000000000"],
        &["quickstart", "--workers", "4000000000"],
        &["eval", "run", "--episodes", "4000000000"],
        &["eval", "run", "--workers", "4000000000"],
        &["train", "reach-v3", "--jobs", "4000000000"],
        &["train", "reach-v3", "--seeds", "0..4000000000"],
        &["train", "reach-v3", "--seed", "18446744073709551615"],
        &["bench", "--repetitions", "4000000000"],
        &["study", "answers", "--shard", "1/4000000000"],
    ];
    for case in cases {
        let mut command = ted();
        command
            .current_dir(desk.folder.path())
            .env("MINARI_DATASETS_PATH", desk.folder.path().join("data"))
            .env("TED_METAWORLD_VENV", desk.folder.path().join("venv"))
            .env("TED_PYTHON", "/nowhere/python3")
            .args(case);
        finish(&mut command).with(2);
    }
    assert!(!desk.run("data").exists(), "nothing was begun");
}

/// What stands in the place of every number: too large for one type or the other, infinite in single precision, below zero.
const NUMBERS: [&str; 8] = [
    "4294967295",
    "4294967296",
    "9223372036854775807",
    "18446744073709551615",
    "1e300",
    "-1e300",
    "-1",
    "0",
];

/// As little as possible of everything, where a preset has it.
const LITTLE: [&str; 24] = [
    // Parts of the steps before the steps.
    "algorithm.warm_start=1",
    "algorithm.critic_steps=1",
    "algorithm.actor_steps=1",
    "algorithm.steps=3",
    "algorithm.batch=4",
    "algorithm.hidden=[4]",
    "algorithm.segment=5",
    "algorithm.width=4",
    "algorithm.layers=1",
    "reward.queries=2",
    "reward.rounds=1",
    "reward.epochs=2",
    "reward.segment=5",
    "reward.pool=5",
    "reward.hidden=[4]",
    "reward.held_out=5",
    "reward.width=4",
    "reward.steps=3",
    "reward.clone.steps=3",
    "reward.network.steps=3",
    "reward.samples=5",
    "reward.iterations=3",
    "reward.experts=2",
    "filter.k=50",
];

/// A preset at its smallest.
fn smallest(preset: Preset) -> Overrides {
    let mut all = Overrides::default();
    for set in LITTLE {
        let with = all.clone().set(set).unwrap();
        if with.resolve(Some(preset), Some(0)).is_ok() {
            all = with;
        }
    }
    all
}

/// The path of every number of a configuration; of a list, the list with its first number left out.
fn numbers(table: &toml::Table, path: &str, found: &mut Vec<(String, Option<Vec<String>>)>) {
    for (key, value) in table {
        let path = match path {
            "" => key.clone(),
            _ => format!("{path}.{key}"),
        };
        match value {
            toml::Value::Integer(_) | toml::Value::Float(_) => found.push((path, None)),
            toml::Value::Array(list) if list.iter().all(|it| !it.is_table()) => {
                let rest = list.iter().skip(1).map(ToString::to_string);
                found.push((path, Some(rest.collect())));
            }
            toml::Value::Table(table) => numbers(table, &path, found),
            _ => {}
        }
    }
}

/// Trains if nothing is against it. Gives the refusal.
fn tried(dataset: &Dataset, config: &Config, place: &Path) -> Result<(), String> {
    let text = |error: &dyn ToString| error.to_string();
    check(dataset, config).map_err(|it| text(&it))?;
    check_teacher(dataset, config).map_err(|it| text(&it))?;
    let reference = DatasetReference {
        id: dataset.id().to_owned(),
        digest: dataset.digest().to_owned(),
        path: place.to_path_buf(),
    };
    let run = RunFolder::begin(place, config, &reference).map_err(|it| text(&it))?;
    let mut teacher = config.simulated_teacher();
    train(dataset, config, &run, &mut teacher, Audience::Nobody.into()).map_err(|it| text(&it))
}

#[test]
fn whatever_number_stands_in_a_configuration_it_is_refused_in_words_or_trained_on() {
    let dataset = Dataset::from_records("ted/x-v0", SHAPE, &episodes(4, 12)).unwrap();
    let place = tempfile::tempdir().unwrap();
    let (mut refused, mut trained) = (0, 0);
    for preset in [
        Preset::Steer,
        Preset::TrueTed,
        Preset::OprlITed,
        Preset::OprlIPenalty,
        Preset::Oprl,
        Preset::OprlAtac,
        Preset::Pt,
        Preset::Otr,
        Preset::Oppo,
        Preset::Bc10,
    ] {
        let smallest = smallest(preset);
        let config = smallest.resolve(Some(preset), Some(0)).unwrap();
        let small = tried(&dataset, &config, &place.path().join(preset.name()));
        assert_eq!(small, Ok(()), "{}", preset.name());
        let mut all = Vec::new();
        numbers(&config.to_toml().parse().unwrap(), "", &mut all);
        assert!(all.len() > 5, "{all:?}");
        for (path, rest) in all.iter().filter(|(path, _)| path != "seed") {
            for number in NUMBERS {
                let value = match rest {
                    None => number.to_owned(),
                    Some(rest) => format!("[{number}, {}]", rest.join(", ")),
                };
                let set = format!("{path}={value}");
                let mark = format!("{} {set}", preset.name());
                let resolved = smallest
                    .clone()
                    .set(&set)
                    .and_then(|it| it.resolve(Some(preset), Some(0)));
                let folder = tempfile::tempdir_in(place.path()).unwrap();
                let came = catch_unwind(AssertUnwindSafe(|| match resolved {
                    Ok(config) => tried(&dataset, &config, &folder.path().join("run")),
                    Err(error) => Err(error.to_string()),
                }));
                match came.unwrap_or_else(|_| panic!("{mark} panics")) {
                    Ok(()) => trained += 1,
                    Err(words) => {
                        assert!(words.len() > 20, "{mark}: {words}");
                        refused += 1;
                    }
                }
            }
        }
    }
    assert!(
        refused > 500 && trained > 50,
        "{refused} refused, {trained} trained"
    );
}
