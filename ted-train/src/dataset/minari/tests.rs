//! The writer and the reader against each other, against killed and failing writers, and against damaged files.

use super::*;
use crate::dataset::fixtures::{SHAPE, records};
use crate::dataset::{Dataset, EpisodeRecord, Shape};
use firmware_sim::disk::{Disk, WriteError};
use firmware_sim::robot::Robot;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use tempfile::TempDir;

const LENGTHS: [usize; 4] = [6, 4, 5, 7];

pub(super) fn origin() -> Origin {
    Origin {
        task: "drawer-open-v3".into(),
        recipe: "paper".into(),
        seed: 3,
        episodes: LENGTHS.len() as u32,
        goal: "visible, drawn per episode".into(),
        reward: "v2".into(),
        engine: [("metaworld".to_string(), "3.1.1".to_string())].into(),
    }
}

fn id() -> DatasetId {
    DatasetId::new("ted", "drawer-open-v3-paper-s3", 0).unwrap()
}

fn behaviour() -> Behaviour {
    Behaviour {
        part: "noisy".into(),
        noise_std: 0.8,
        epsilon: 0.0,
        ..Behaviour::default()
    }
}

fn robot() -> Robot {
    Robot::draft(SHAPE.observation, &[[-1.0, 1.0]; SHAPE.action])
}

fn writer(root: &Path) -> DatasetWriter {
    DatasetWriter::open(root, id(), origin(), robot()).unwrap()
}

fn write(root: &Path, order: &[usize]) -> PathBuf {
    let writer = writer(root);
    let records = records(&LENGTHS);
    for &episode in order {
        writer
            .write(episode as u32, behaviour(), &records[episode])
            .unwrap();
    }
    writer.finish().unwrap()
}

pub(super) fn complete() -> (TempDir, PathBuf) {
    let root = tempfile::tempdir().unwrap();
    let folder = write(root.path(), &[0, 1, 2, 3]);
    (root, folder)
}

fn refusal(folder: &Path) -> String {
    Dataset::open(folder)
        .map(|_| ())
        .expect_err("must be refused")
        .to_string()
}

/// Every file below a folder with its bytes, in order of the names; the lock file has none.
fn tree(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let mut files = Vec::new();
    let mut folders = vec![folder.to_path_buf()];
    while let Some(next) = folders.pop() {
        for entry in fs::read_dir(next).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else {
                files.push((
                    path.strip_prefix(folder).unwrap().to_path_buf(),
                    fs::read(&path).unwrap(),
                ));
            }
        }
    }
    files.sort();
    files
}

/// Rewrites a JSON file.
pub(super) fn edit(path: &Path, change: impl FnOnce(&mut serde_json::Value)) {
    let mut value = serde_json::from_slice(&fs::read(path).unwrap()).unwrap();
    change(&mut value);
    fs::write(path, serde_json::to_vec(&value).unwrap()).unwrap();
}

/// Replaces an episode by one whose file and metadata agree with each other.
pub(super) fn replace_episode(data: &Path, episode: u32, record: &EpisodeRecord, shape: Shape) {
    let bytes = encode::episode_file(record, shape).unwrap();
    let folder = data.join(episode.to_string());
    edit(&folder.join(METADATA), |value| {
        value["ted"]["blake3"] = blake3::hash(&bytes).to_hex().to_string().into();
    });
    fs::write(folder.join(PART), bytes).unwrap();
}

#[test]
fn what_is_written_is_read_back_to_the_bit() {
    let (_root, folder) = complete();
    let dataset = Dataset::open(&folder).unwrap();
    let expected =
        Dataset::from_records("ted/drawer-open-v3-paper-s3-v0", SHAPE, &records(&LENGTHS)).unwrap();
    assert_eq!(dataset.id(), expected.id());
    assert_eq!(dataset.digest(), expected.digest());
    assert_eq!(dataset.episodes(), expected.episodes());
    assert_eq!(dataset.observations(), expected.observations());
    assert_eq!(dataset.actions(), expected.actions());
    assert_eq!(dataset.rewards_true(), expected.rewards_true());
    assert_eq!(dataset.terminations(), expected.terminations());
    assert_eq!(dataset.truncations(), expected.truncations());
    assert_eq!(dataset.success(), expected.success());
    assert_eq!(dataset.origin(), Some(&origin()));
    assert_eq!(
        Dataset::open(folder.join("data")).unwrap().digest(),
        expected.digest()
    );
}

#[test]
fn the_order_in_which_episodes_arrive_leaves_no_trace() {
    let (_one, in_order) = complete();
    let other = tempfile::tempdir().unwrap();
    let out_of_order = write(other.path(), &[2, 0, 3, 1]);
    assert_eq!(tree(&in_order), tree(&out_of_order));
}

#[test]
fn a_killed_writer_goes_on_with_what_is_complete() {
    let (_whole, uninterrupted) = complete();
    let root = tempfile::tempdir().unwrap();
    let all = records(&LENGTHS);
    {
        let writer = writer(root.path());
        writer.write(0, behaviour(), &all[0]).unwrap();
        writer.write(2, behaviour(), &all[2]).unwrap();
        let half = writer.folder().join("data/.writing-1");
        fs::create_dir(&half).unwrap();
        fs::write(half.join(PART), b"ARROW1").unwrap();
        assert!(writer.finish().is_err(), "two episodes are missing");
        assert!(refusal(writer.folder()).contains("its collection has not finished"));
    }
    let writer = writer(root.path());
    let kept: Vec<_> = (0..4)
        .map(|i| writer.kept(i, 1000 + u64::from(i), &behaviour()).is_some())
        .collect();
    assert_eq!(kept, [true, false, true, false]);
    writer.write(1, behaviour(), &all[1]).unwrap();
    writer.write(3, behaviour(), &all[3]).unwrap();
    assert_eq!(tree(&writer.finish().unwrap()), tree(&uninterrupted));
}

#[test]
fn an_episode_is_not_kept_when_its_seed_behaviour_or_bytes_differ() {
    let (root, folder) = complete();
    let writer = writer(root.path());
    let note = writer.kept(0, 1000, &behaviour()).unwrap();
    assert_eq!(note.return_true, records(&LENGTHS)[0].return_true());
    assert!(writer.kept(0, 1001, &behaviour()).is_none());
    assert!(
        writer
            .kept(
                0,
                1000,
                &Behaviour {
                    epsilon: 0.8,
                    ..behaviour()
                }
            )
            .is_none()
    );
    let part = folder.join("data/0").join(PART);
    let mut bytes = fs::read(&part).unwrap();
    *bytes.last_mut().unwrap() ^= 1;
    fs::write(&part, bytes).unwrap();
    assert!(writer.kept(0, 1000, &behaviour()).is_none());
    writer.write(0, behaviour(), &records(&LENGTHS)[0]).unwrap();
    assert!(writer.kept(0, 1000, &behaviour()).is_some());
}

#[test]
fn a_second_writer_and_another_plan_are_refused() {
    let root = tempfile::tempdir().unwrap();
    let first = writer(root.path());
    let second = DatasetWriter::open(root.path(), id(), origin(), robot()).unwrap_err();
    assert!(matches!(second, WriteError::Busy { .. }), "{second}");
    drop(first);
    let engine = [("metaworld".to_string(), "3.2.0".to_string())].into();
    let other = Origin { engine, ..origin() };
    let other = DatasetWriter::open(root.path(), id(), other, robot()).unwrap_err();
    assert!(matches!(other, WriteError::Different { .. }));
    assert!(
        other.to_string().contains("with metaworld 3.1.1, now"),
        "{other}"
    );
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_named_and_what_is_there_stays_good() {
    let root = tempfile::tempdir().unwrap();
    let full_at_episode_2 = Disk::with_create(|path| {
        let full = path.to_string_lossy().contains(".writing-2") && path.ends_with(PART);
        if full {
            File::create("/dev/full")
        } else {
            File::create(path)
        }
    });
    let all = records(&LENGTHS);
    {
        let writer =
            DatasetWriter::open_on(full_at_episode_2, root.path(), id(), origin(), robot())
                .unwrap();
        writer.write(0, behaviour(), &all[0]).unwrap();
        writer.write(1, behaviour(), &all[1]).unwrap();
        let error = writer.write(2, behaviour(), &all[2]).unwrap_err();
        assert!(
            matches!(error, EpisodeError::Write(WriteError::DiskFull { .. })),
            "{error}"
        );
        assert!(
            error.to_string().starts_with("no space left while writing"),
            "{error}"
        );
    }
    let writer = writer(root.path());
    assert!(writer.kept(1, 1001, &behaviour()).is_some());
    assert!(writer.kept(2, 1002, &behaviour()).is_none());
    writer.write(2, behaviour(), &all[2]).unwrap();
    writer.write(3, behaviour(), &all[3]).unwrap();
    assert_eq!(tree(&writer.finish().unwrap()), tree(&complete().1));
}

#[cfg(target_os = "linux")]
#[test]
fn a_disk_that_fills_up_while_finishing_keeps_the_previous_metadata() {
    let (root, folder) = complete();
    let before = tree(&folder);
    fs::write(folder.join("data").join(METADATA), b"{}").unwrap();
    let full_for_metadata = Disk::with_create(|path| {
        let full = path.ends_with("data/.metadata.json.tmp");
        if full {
            File::create("/dev/full")
        } else {
            File::create(path)
        }
    });
    {
        let writer =
            DatasetWriter::open_on(full_for_metadata, root.path(), id(), origin(), robot())
                .unwrap();
        assert!(matches!(writer.finish(), Err(WriteError::DiskFull { .. })));
        assert_eq!(fs::read(folder.join("data").join(METADATA)).unwrap(), b"{}");
    }
    writer(root.path()).finish().unwrap();
    assert_eq!(tree(&folder), before);
}

#[test]
fn a_record_that_is_inconsistent_is_not_written() {
    let root = tempfile::tempdir().unwrap();
    let writer = writer(root.path());
    let mut record = records(&LENGTHS).remove(0);
    record.infos[0].values.pop();
    let error = writer.write(0, behaviour(), &record).unwrap_err();
    assert!(
        error
            .to_string()
            .starts_with("qpos of episode 0: expected 21 values"),
        "{error}"
    );
    let mut record = records(&LENGTHS).remove(0);
    record.rewards[1] = f64::NAN;
    let error = writer.write(0, behaviour(), &record).unwrap_err();
    assert!(
        error
            .to_string()
            .starts_with("rewards of episode 0 holds NaN at row 1"),
        "{error}"
    );
    assert!(!writer.folder().join("data/0").exists());
}

#[test]
fn missing_things_are_named() {
    let (root, folder) = complete();
    assert!(refusal(&root.path().join("nowhere")).starts_with("no dataset at "));
    assert!(refusal(root.path()).starts_with("no metadata.json in "));
    fs::remove_file(folder.join("data/1").join(PART)).unwrap();
    assert!(refusal(&folder).starts_with("episode 1 of 4 is missing"));
    fs::remove_dir_all(folder.join("data/1")).unwrap();
    assert!(refusal(&folder).starts_with("episode 1 of 4 is missing"));
}

#[test]
fn metadata_that_does_not_fit_is_named() {
    let with = |change: &dyn Fn(&mut serde_json::Value)| {
        let (_root, folder) = complete();
        edit(&folder.join("data").join(METADATA), change);
        refusal(&folder)
    };
    let hdf5 = with(&|value| value["data_format"] = "hdf5".into());
    assert!(
        hdf5.contains("is stored as hdf5") && hdf5.contains("`ted import "),
        "{hdf5}"
    );
    assert!(
        with(&|value| value["total_steps"] = 23.into())
            .contains("promises 23 steps, and its episodes have 22")
    );
    assert!(
        with(&|value| value["total_episodes"] = 5.into()).starts_with("episode 4 of 5 is missing")
    );
    assert!(
        with(&|value| value["total_episodes"] = 4_000_000_000_u32.into())
            .starts_with("episode 4 of 4000000000 is missing"),
        "told from the number of files, without a list of four thousand million"
    );
    assert!(
        with(&|value| value["total_episodes"] = (-1).into())
            .contains("is not valid Minari metadata")
    );
    assert!(
        with(&|value| value["observation_space"] = serde_json::Value::Null).contains("is absent")
    );
    let discrete = r#"{"type": "Discrete", "dtype": "int64", "start": 0, "n": 4}"#;
    assert!(
        with(&|value| value["action_space"] = discrete.into())
            .contains("is a Discrete, expected a Box")
    );
}

#[test]
fn an_episode_whose_metadata_lies_is_named() {
    let with = |change: &dyn Fn(&mut serde_json::Value)| {
        let (_root, folder) = complete();
        edit(&folder.join("data/1").join(METADATA), change);
        let total = &folder.join("data").join(METADATA);
        let steps: u64 = (0..4)
            .map(|i| {
                let path = folder.join("data").join(i.to_string()).join(METADATA);
                let value: serde_json::Value =
                    serde_json::from_slice(&fs::read(path).unwrap()).unwrap();
                value["total_steps"].as_u64().unwrap()
            })
            .sum();
        edit(total, |value| value["total_steps"] = steps.into());
        refusal(&folder)
    };
    assert!(with(&|value| value["id"] = 2.into()).contains("it is the metadata of episode 2"));
    assert!(with(&|value| value["total_steps"] = 0.into()).contains("has no steps"));
    assert!(
        with(&|value| value["total_steps"] = 9.into()).contains("expected 10 rows for the 9 steps")
    );
    assert!(
        with(&|value| value["total_steps"] = 1_000_000_000_000_u64.into()).contains("a file of")
    );
}

#[test]
fn columns_of_the_wrong_width_or_with_nan_are_named() {
    let (_root, folder) = complete();
    let data = folder.join("data");
    let narrow = Shape {
        observation: 7,
        action: 2,
    };
    let mut record = records(&LENGTHS).remove(2);
    let whole = record.clone();
    record.actions.truncate(record.steps() * 2);
    replace_episode(&data, 2, &record, narrow);
    let text = refusal(&folder);
    assert!(
        text.contains("data/2/part-0.arrow: expected lists of 4 numbers"),
        "{text}"
    );

    let mut record = whole.clone();
    record.observations[8] = f32::NAN;
    replace_episode(&data, 2, &record, SHAPE);
    let text = refusal(&folder);
    assert!(
        text.contains("data/2/part-0.arrow holds NaN at row 1, column 1"),
        "{text}"
    );

    let mut record = whole;
    record.rewards[4] = f64::NEG_INFINITY;
    replace_episode(&data, 2, &record, SHAPE);
    assert!(refusal(&folder).contains("rewards of"));
}

#[test]
fn a_file_without_rewards_is_named() {
    let (_root, folder) = complete();
    let part = folder.join("data/1").join(PART);
    // Same length and layout: only the column's name differs, in the schema and in the footer.
    let text = fs::read(&part).unwrap();
    let renamed = replace_all(&text, b"rewards", b"regards");
    fs::write(&part, &renamed).unwrap();
    edit(&folder.join("data/1").join(METADATA), |value| {
        value["ted"]["blake3"] = blake3::hash(&renamed).to_hex().to_string().into();
    });
    assert!(refusal(&folder).contains("has no column `rewards`"));
}

fn replace_all(bytes: &[u8], from: &[u8], to: &[u8]) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    for at in 0..=bytes.len() - from.len() {
        if bytes[at..].starts_with(from) {
            bytes[at..at + to.len()].copy_from_slice(to);
        }
    }
    bytes
}

#[test]
fn a_changed_byte_is_found_before_anything_is_parsed() {
    let (_root, folder) = complete();
    let part = folder.join("data/3").join(PART);
    let mut bytes = fs::read(&part).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 0x10;
    fs::write(&part, bytes).unwrap();
    let text = refusal(&folder);
    assert!(
        text.contains("data/3/part-0.arrow is damaged: its bytes are not those that were written"),
        "{text}"
    );
}

/// Files of other writers carry no hash, so the decoder itself must stand any bytes.
#[test]
fn no_truncation_and_no_flipped_bit_makes_the_decoder_panic() {
    let record = records(&[3]).remove(0);
    let bytes = encode::episode_file(&record, SHAPE).unwrap();
    let columns = [
        "observations",
        "actions",
        "rewards",
        "terminations",
        "truncations",
        "infos",
    ];
    for len in 0..bytes.len() {
        assert!(
            arrow_file::record_batches(bytes[..len].to_vec(), &columns).is_err(),
            "cut at {len}"
        );
    }
    for bit in 0..bytes.len() * 8 {
        let mut flipped = bytes.clone();
        flipped[bit / 8] ^= 1 << (bit % 8);
        decode_without_panic(flipped);
    }
}

proptest::proptest! {
    #[test]
    fn no_damage_to_several_bytes_makes_the_decoder_panic(
        damage in proptest::collection::vec((proptest::prelude::any::<proptest::sample::Index>(), proptest::prelude::any::<u8>()), 1..6)
    ) {
        let mut bytes = encode::episode_file(&records(&[3])[0], SHAPE).unwrap();
        for (place, value) in damage {
            let place = place.index(bytes.len());
            bytes[place] = value;
        }
        decode_without_panic(bytes);
    }
}

fn decode_without_panic(bytes: Vec<u8>) {
    let mut observations = vec![0.0; 4 * SHAPE.observation];
    let mut actions = vec![0.0; 3 * SHAPE.action];
    let [mut terminations, mut truncations, mut success] = [[false; 3]; 3];
    let mut slots = crate::dataset::assemble::EpisodeSlots {
        observations: &mut observations,
        actions: &mut actions,
        terminations: &mut terminations,
        truncations: &mut truncations,
        success: &mut success,
    };
    // Whether it is an error or values that only look plausible, it returns.
    let _ = decode::episode(bytes, "file", SHAPE, &mut slots);
}
