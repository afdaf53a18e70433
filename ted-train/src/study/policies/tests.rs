//! What a study of policies makes, keeps and refuses.

use std::collections::BTreeMap;

use firmware_sim::bridge::Engine;
use firmware_sim::controller::Numeric;
use firmware_sim::progress::Audience;
use firmware_sim::robot::Robot;

use super::*;
use crate::dataset::fixtures;
use crate::dataset::minari::{Behaviour, DatasetId, DatasetWriter, Origin};
use crate::evaluate::Evaluation;
use crate::run::{DatasetReference, EVALUATION, RunFolder};
use crate::train::RewardReport;

/// Two seeds of a run on the dataset in this place, under `out`.
fn two_on(place: &Path, out: &Path, sets: &[&str]) -> Vec<StudyRun> {
    let one_flight = ["schedule.evaluation_episodes=1"];
    let sets = one_flight.iter().chain(sets);
    let sets: Vec<String> = sets.map(|&set| set.to_owned()).collect();
    let locate = |_: &str| place.to_path_buf();
    let tasks = ["reach-v3".to_owned()];
    runs(&tasks, &[Preset::True], &[0, 1], &sets, out, locate).unwrap()
}

fn two(out: &Path, sets: &[&str]) -> Vec<StudyRun> {
    two_on(Path::new("/nowhere"), out, sets)
}

/// A run as it is when it has flown.
fn finish(run: &StudyRun, dataset_digest: &str) {
    let dataset = DatasetReference {
        id: "ted/x-v0".to_owned(),
        digest: dataset_digest.to_owned(),
        path: PathBuf::new(),
    };
    let folder = RunFolder::begin(&run.folder, &run.config, &dataset).unwrap();
    let reward = RewardReport {
        queries: 0,
        fits: Vec::new(),
        held_out: None,
        preferences_digest: None,
        low: 0.0,
        high: 1.0,
        quality: None,
        confidence: None,
    };
    folder.write_json("reward.json", &reward).unwrap();
    let evaluation = Evaluation {
        task: "reach-v3".to_owned(),
        world: None,
        numeric: Numeric::F32,
        engine: Engine::default(),
        seed: run.config.seed,
        returns: vec![1.5],
        return_mean: 1.5,
        return_sd: 0.0,
        score: Some(0.25),
        success: 1.0,
        faulted: 0,
        faults: Vec::new(),
        dataset_mean: 1.0,
        dataset_max: 6.0,
    };
    folder.write_json(EVALUATION, &evaluation).unwrap();
}

fn dataset_in(root: &Path) -> PathBuf {
    let origin = Origin {
        task: "reach-v3".to_owned(),
        recipe: "none".to_owned(),
        seed: 0,
        episodes: 1,
        goal: String::new(),
        reward: String::new(),
        engine: BTreeMap::new(),
    };
    let behaviour = Behaviour {
        part: "all".to_owned(),
        noise_std: 0.0,
        epsilon: 0.0,
        ..Behaviour::default()
    };
    let id = DatasetId::new("ted", "x", 0).unwrap();
    let robot = Robot::draft(
        fixtures::SHAPE.observation,
        &[[-1.0, 1.0]; fixtures::SHAPE.action],
    );
    let writer = DatasetWriter::open(root, id, origin, robot).unwrap();
    let episode = &fixtures::records(&[9])[0];
    writer.write(0, behaviour, episode).unwrap();
    writer.finish().unwrap()
}

fn fill_in(out: &Path, runs: &[StudyRun]) -> Result<(), StudyError> {
    let scores = out.join("scores.jsonl");
    let making = Making {
        scores: &scores,
        jobs: None,
        audience: Audience::Nobody,
    };
    fill(making, runs)
}

fn written(out: &Path) -> String {
    std::fs::read_to_string(out.join("scores.jsonl")).unwrap_or_default()
}

#[test]
fn a_study_with_other_settings_is_refused_where_a_run_was_begun() {
    let out = tempfile::tempdir().unwrap();
    let short = two(out.path(), &["algorithm.steps=50"]);
    let begun = &short[1].folder;
    std::fs::create_dir_all(begun).unwrap();
    std::fs::write(begun.join("config.toml"), short[1].config.to_toml()).unwrap();
    let error = fill_in(out.path(), &short).unwrap_err();
    assert!(matches!(error, StudyError::Fleet(_)), "{error}");

    let long = two(out.path(), &[]);
    let error = fill_in(out.path(), &long).unwrap_err();
    let error = error.to_string();
    for part in ["seed-1", "`steps = 50` there", "--out"] {
        assert!(error.contains(part), "{error}");
    }
    // What is in the folder of a run that has its score is of no interest.
    let elsewhere = tempfile::tempdir().unwrap();
    let there = &two(elsewhere.path(), &[])[1];
    finish(there, "d");
    let score = there.read().unwrap();
    cells::append(&out.path().join("scores.jsonl"), &score).unwrap();
    fill_in(out.path(), &long[1..]).unwrap();
}

#[test]
fn a_score_outlives_the_folder_of_its_run_and_belongs_to_one_configuration() {
    let out = tempfile::tempdir().unwrap();
    let out = out.path();
    let scores = |runs: &[StudyRun]| scores(&out.join("scores.jsonl"), runs).unwrap();
    let runs = two(out, &[]);
    finish(&runs[0], "d");
    // Nothing is missing of the first one, so the dataset is not looked for.
    fill_in(out, &runs[..1]).unwrap();
    assert_eq!(written(out).lines().count(), 1);
    finish(&runs[1], "d");
    assert_eq!(scores(&runs).len(), 2, "also before it is written down");
    fill_in(out, &runs).unwrap();
    let both = written(out);
    assert_eq!(both.lines().count(), 2);
    std::fs::remove_dir_all(out.join("reach-v3")).unwrap();
    fill_in(out, &runs).unwrap();
    assert_eq!(written(out), both);

    let found = scores(&runs);
    assert_eq!(found.len(), 2);
    assert_eq!(found[1].config.seed, 1);
    let table = crate::study::table::table(&found).markdown();
    let row = table.lines().last().unwrap();
    assert!(row.starts_with("| reach-v3 | true | 2 |"), "{row}");
    assert!(row.contains("0.250, 0.250"), "{row}");
    assert_eq!(scores(&two(out, &["algorithm.steps=50"])), []);
}

#[test]
fn a_place_where_no_score_can_be_written_is_told_before_anything_is_begun() {
    let out = tempfile::tempdir().unwrap();
    let making = Making {
        scores: Path::new("/proc/no-such-folder/scores.jsonl"),
        jobs: None,
        audience: Audience::Nobody,
    };
    let error = fill(making, &two(out.path(), &[])).unwrap_err();
    assert!(matches!(error, StudyError::Scores(_)), "{error}");
    assert!(error.to_string().contains("cannot write"), "{error}");
}

#[test]
fn what_is_named_twice_is_one_run() {
    let (tasks, presets) = (["a", "b", "a"].map(str::to_owned), [Preset::Bc, Preset::Bc]);
    let out = Path::new("out");
    let runs = runs(&tasks, &presets, &[1, 0], &[], out, |name| {
        PathBuf::from(name)
    })
    .unwrap();
    let named = runs
        .iter()
        .map(|run| (run.dataset.as_str(), run.config.seed));
    assert!(named.eq([("a", 1), ("b", 1), ("a", 0), ("b", 0)]));
}

#[test]
fn a_flight_of_another_number_of_episodes_is_no_score() {
    let out = tempfile::tempdir().unwrap();
    let runs = two(out.path(), &["schedule.evaluation_episodes=2"]);
    finish(&runs[0], "d");
    assert_eq!(runs[0].read(), None);
}

#[test]
fn scores_of_another_dataset_of_the_same_name_are_no_company() {
    let out = tempfile::tempdir().unwrap();
    let out = out.path();
    let dataset = dataset_in(out);
    let runs = two_on(&dataset, out, &["algorithm.steps=1"]);
    finish(&runs[0], "another");
    // Of a run that is to be made, and of one that is finished.
    let to_make = fill_in(out, &runs).unwrap_err();
    assert!(!runs[1].folder.exists());
    finish(&runs[1], "third");
    let finished = fill_in(out, &two(out, &["algorithm.steps=1"])).unwrap_err();
    for error in [to_make, finished] {
        let error = error.to_string();
        for part in ["reach-v3", "digest another", "--scores"] {
            assert!(error.contains(part), "{error}");
        }
    }
    assert_eq!(written(out), "");
}

#[test]
fn the_scores_of_the_documents_are_read_and_written_as_they_are() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/methods.jsonl");
    let text = std::fs::read_to_string(&path).unwrap();
    let scores: Vec<RunScore> = cells::read(&path).unwrap();
    assert!(!scores.is_empty());
    let lines = scores
        .iter()
        .map(|it| serde_json::to_string(it).unwrap() + "\n");
    assert_eq!(lines.collect::<String>(), text);
}
