//! Runs that are made as one batch, as a fleet on a GPU is. Here it is computed by the processor, where each can be compared
//! to the bit with what it is alone.

use std::fs;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

use firmware_sim::progress::Audience;
use ted_train::config::{Overrides, Preset};
use ted_train::fleet::{Datasets, Lane, LaneError, Trained, introduce, together};
use ted_train::train::TrainError;

use crate::command::{Desk, SMALL, assert_same_outcome, checkpoints};
use crate::dataset;
use crate::presets::SEQUENCE;

fn lane(desk: &Desk, folder: &str, preset: Preset, seed: u64, sets: &[&str]) -> Lane {
    let learns = preset.name().starts_with("oprl");
    let sets = SMALL.iter().chain(sets);
    let sets = sets.filter(|set| learns || !set.starts_with("reward."));
    let layers = preset != Preset::Oppo;
    let sets = sets.filter(|set| layers || !set.contains(".hidden="));
    let changes = sets.fold(Overrides::default(), |all, set| all.set(set).unwrap());
    Lane {
        dataset: desk.dataset(),
        config: changes.resolve(Some(preset), Some(seed)).unwrap(),
        folder: desk.run(folder),
        answers: None,
        siblings: Vec::new(),
    }
}

fn on(dataset: PathBuf, lane: Lane) -> Lane {
    Lane { dataset, ..lane }
}

fn batch(lanes: &[&Lane]) -> Vec<Result<Trained, LaneError>> {
    let watch = Audience::Nobody.into();
    together(lanes, &Datasets::default(), NonZeroUsize::MIN, watch)
}

/// Makes the run alone, in another folder.
fn alone(desk: &Desk, lane: &Lane) -> PathBuf {
    let name = lane.folder.file_name().unwrap().to_str().unwrap();
    let folder = desk.run(&format!("{name}-alone"));
    let lane = Lane {
        folder: folder.clone(),
        ..lane.clone()
    };
    batch(&[&lane]).swap_remove(0).unwrap();
    folder
}

/// What a run that was stopped after its last checkpoint but one would have left.
fn take_back(folder: &Path) {
    fs::remove_file(folder.join("policy.ted")).unwrap();
    fs::remove_file(checkpoints(folder).pop().unwrap()).unwrap();
}

#[test]
fn runs_of_one_batch_leave_the_files_that_each_leaves_alone() {
    let desk = Desk::with_dataset();
    let other = dataset::write(desk.folder.path(), "other", &dataset::episodes(4, 45));
    for backend in ["fused", "flex", "ndarray"] {
        let set = format!("backend={backend}");
        let set = set.as_str();
        let name = |run: &str| format!("{backend}-{run}");
        let lanes = [
            lane(&desk, &name("ted"), Preset::OprlITed, 0, &[set]),
            on(
                other.clone(),
                lane(&desk, &name("true"), Preset::True, 1, &[set]),
            ),
            lane(
                &desk,
                &name("zero"),
                Preset::Zero,
                2,
                &[set, "schedule.log_every=2", "schedule.checkpoint_every=11"],
            ),
            lane(
                &desk,
                &name("oppo"),
                Preset::Oppo,
                4,
                &[&SEQUENCE[..], &[set, "algorithm.steps=20"]].concat(),
            ),
            lane(
                &desk,
                &name("oppo-too"),
                Preset::Oppo,
                5,
                &[&SEQUENCE[..], &[set, "algorithm.steps=20"]].concat(),
            ),
            lane(
                &desk,
                &name("conditioned"),
                Preset::TrueConditioned,
                6,
                &[set, "algorithm.best=2"],
            ),
            on(
                other.clone(),
                lane(
                    &desk,
                    &name("conditioned-too"),
                    Preset::TrueConditioned,
                    7,
                    &[set, "algorithm.best=2"],
                ),
            ),
            // Cannot be a lane of the same learner, and need not be.
            lane(
                &desk,
                &name("steps"),
                Preset::True,
                3,
                &[set, "algorithm.steps=40"],
            ),
        ];
        for end in batch(&lanes.each_ref()) {
            end.unwrap();
        }
        for lane in &lanes {
            assert_same_outcome(&lane.folder, &alone(&desk, lane));
        }
    }
}

#[test]
fn a_run_that_fails_is_left_behind_and_the_others_keep_their_bytes() {
    let desk = Desk::with_dataset();
    let flex = "backend=flex";
    let mut records = dataset::episodes(4, 45);
    records[0].rewards[0] = 1e30;
    let huge = dataset::write(desk.folder.path(), "huge", &records);
    let lanes = [
        lane(&desk, "first", Preset::True, 0, &[flex]),
        on(
            desk.run("nowhere"),
            lane(&desk, "no-dataset", Preset::True, 1, &[flex]),
        ),
        on(
            huge,
            lane(
                &desk,
                "diverges",
                Preset::True,
                2,
                &[flex, "unit_rewards=false"],
            ),
        ),
        lane(&desk, "no-disk", Preset::True, 3, &[flex]),
        lane(&desk, "last", Preset::Zero, 4, &[flex]),
    ];
    // A folder where its first checkpoint has to be.
    let first = "checkpoints/000000000007.checkpoint";
    fs::create_dir_all(lanes[3].folder.join(first)).unwrap();
    let mut ends = batch(&lanes.each_ref()).into_iter();
    let mut next = || ends.next().unwrap();
    next().unwrap();
    let (no_dataset, diverged, no_disk) = (next(), next(), next());
    next().unwrap();
    assert!(matches!(no_dataset, Err(LaneError::Dataset(_))));
    let diverged = diverged.unwrap_err();
    let told = matches!(diverged, LaneError::Train(TrainError::Diverged { .. }));
    assert!(told, "{diverged}");
    let no_disk = no_disk.unwrap_err().to_string();
    assert!(no_disk.contains(first), "{no_disk}");
    for lane in [&lanes[0], &lanes[4]] {
        assert_same_outcome(&lane.folder, &alone(&desk, lane));
    }
    // What stood in the way is gone: the same call goes on.
    fs::remove_dir(lanes[3].folder.join(first)).unwrap();
    batch(&[&lanes[3]]).swap_remove(0).unwrap();
    assert_same_outcome(&lanes[3].folder, &alone(&desk, &lanes[3]));
}

#[test]
fn a_run_goes_on_alone_or_in_other_company_than_it_began_in() {
    let desk = Desk::with_dataset();
    let flex = "backend=flex";
    let [first, second, third] = [("a", 0), ("b", 1), ("c", 2)]
        .map(|(name, seed)| lane(&desk, name, Preset::True, seed, &[flex]));
    for end in batch(&[&first, &second]) {
        end.unwrap();
    }
    take_back(&first.folder);
    take_back(&second.folder);
    batch(&[&first]).swap_remove(0).unwrap();
    // One of them is fifty-six updates ahead.
    for end in batch(&[&second, &third]) {
        end.unwrap();
    }
    for lane in [first, second, third] {
        assert_same_outcome(&lane.folder, &alone(&desk, &lane));
    }
}

#[test]
fn a_reward_that_takes_long_is_taken_from_a_run_that_has_learned_the_same_and_from_no_other() {
    let desk = Desk::with_dataset();
    let sets = [
        "algorithm.steps=5",
        "reward.queries=3",
        "reward.segment=10",
        "reward.width=8",
        "reward.heads=2",
        "reward.held_out=20",
    ];
    let lane = |folder: &str, preset, seed, steps: &str| {
        let plain = lane(&desk, folder, preset, seed, &[]);
        let all = sets.iter().copied().chain([steps]);
        let small = SMALL.into_iter().filter(|set| !set.starts_with("reward."));
        let changes = small.chain(all);
        let changes = changes.fold(Overrides::default(), |all, set| all.set(set).unwrap());
        Lane {
            config: changes.resolve(Some(preset), Some(seed)).unwrap(),
            ..plain
        }
    };
    let state = |folder: &Path| fs::read(folder.join("reward.state")).unwrap();
    let make = |lane: &Lane| batch(&[lane]).swap_remove(0).unwrap();

    let first = lane("pt", Preset::Pt, 0, "reward.steps=6");
    make(&first);
    // So that what is taken from there can be told from what is learned here.
    let marked = lane("marked", Preset::Pt, 0, "reward.steps=7");
    make(&marked);
    let honest = state(&first.folder);
    fs::copy(
        marked.folder.join("reward.state"),
        first.folder.join("reward.state"),
    )
    .unwrap();
    assert_ne!(state(&first.folder), honest);

    let of_family = |folder: &str, seed, steps| {
        let plain = lane(folder, Preset::PtTed, seed, steps);
        let mut family = [first.clone(), plain];
        introduce(&mut family);
        let [_, lane] = family;
        lane
    };
    let same = of_family("same", 0, "reward.steps=6");
    assert_eq!(same.siblings, std::slice::from_ref(&first.folder));
    make(&same);
    assert_eq!(state(&same.folder), state(&marked.folder));
    let time = fs::read_to_string(same.folder.join("time.json")).unwrap();
    assert!(time.contains(first.folder.to_str().unwrap()), "{time}");
    for (folder, seed, steps) in [
        ("seed", 1, "reward.steps=6"),
        ("steps", 0, "reward.steps=8"),
    ] {
        let mut other = of_family(folder, seed, steps);
        assert!(other.siblings.is_empty());
        // Even if somebody says that they are.
        other.siblings = vec![first.folder.clone()];
        make(&other);
        assert_eq!(
            state(&other.folder),
            state(&alone(
                &desk,
                &Lane {
                    siblings: Vec::new(),
                    ..other.clone()
                }
            ))
        );
    }
}

#[test]
fn a_lane_is_told_of_those_before_it_that_learn_the_same_and_take_long() {
    let desk = Desk::with_dataset();
    let lanes = [
        ("a", Preset::Pt, 0),
        ("b", Preset::PtTed, 0),
        ("c", Preset::True, 0),
        ("d", Preset::Pt, 1),
        ("e", Preset::OprlI, 0),
        ("f", Preset::OprlITed, 0),
    ];
    let lanes = lanes.map(|(folder, preset, seed)| Lane {
        dataset: desk.dataset(),
        config: Overrides::default()
            .resolve(Some(preset), Some(seed))
            .unwrap(),
        folder: desk.run(folder),
        answers: None,
        siblings: Vec::new(),
    });
    let mut lanes = lanes;
    introduce(&mut lanes);
    for (place, lane) in lanes.iter().enumerate() {
        let expected: &[PathBuf] = if place == 1 { &[desk.run("a")] } else { &[] };
        assert_eq!(lane.siblings, expected, "{place}");
    }
}
