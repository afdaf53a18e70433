//! Datasets that cannot be trained on: each named with its place, code 3, and no run begun.

use std::fs::{self, File};
use std::path::Path;

use arrow_ipc::reader::FileReader;
use arrow_ipc::writer::FileWriter;
use serde_json::Value;

use crate::command::{Desk, finish, ted};
use crate::dataset::{SHAPE, episodes, write};

/// Writes good episodes, damages them on the disk, and expects the command to say so.
#[track_caller]
fn refused(damage: impl Fn(&Path), told: &[&str]) {
    let desk = Desk::with_dataset();
    let data = desk.dataset().join("data");
    damage(&data);
    let mut ended = finish(&mut desk.train("run", "oprl-i+ted", &[])).with(3);
    for part in told {
        ended = ended.telling(part);
    }
    assert!(!desk.run("run").exists(), "nothing was begun");
}

#[test]
fn numbers_that_nothing_can_be_learned_from_are_named_with_their_place() {
    /// A number that occurs nowhere else, to be found in the file: the writer would refuse the bad one.
    const MARK: f32 = 0.123_456_7;
    let desk = Desk::new();
    for (name, array, value, way_out) in [
        (
            "nan",
            "observations",
            f32::NAN,
            "every value must be finite",
        ),
        (
            "inf",
            "actions",
            f32::INFINITY,
            "every value must be finite",
        ),
        ("wide", "actions", 1.5, "[-1, 1]"),
    ] {
        let mut records = episodes(3, 30);
        match array {
            "observations" => records[1].observations[SHAPE.observation * 12 + 3] = MARK,
            _ => records[1].actions[SHAPE.action * 12 + 3] = MARK,
        }
        let dataset = write(desk.folder.path(), name, &records);
        let part = dataset.join("data/1/part-0.arrow");
        let mut bytes = fs::read(&part).unwrap();
        let at = bytes.windows(4).position(|four| four == MARK.to_le_bytes());
        bytes[at.unwrap()..][..4].copy_from_slice(&value.to_le_bytes());
        fs::write(&part, bytes).unwrap();
        forget_note(&dataset.join("data/1/metadata.json"));
        let channel = match value.is_finite() {
            true => "channel action_3",
            false => "column 3",
        };
        finish(&mut desk.train_on(&dataset, "run", "true", &[]))
            .with(3)
            .telling(array)
            .telling(&format!(
                "/1/part-0.arrow holds {value} at row 12, {channel}"
            ))
            .telling(way_out);
    }
    assert!(!desk.run("run").exists(), "nothing was begun");
}

#[test]
fn a_missing_episode_is_named() {
    refused(
        |data| fs::remove_dir_all(data.join("2")).unwrap(),
        &["episode 2 of 6 is missing", "ted collect"],
    );
}

#[test]
fn a_file_without_rewards_is_named() {
    refused(
        |data| {
            let part = data.join("1/part-0.arrow");
            let reader = FileReader::try_new(File::open(&part).unwrap(), None).unwrap();
            let schema = reader.schema();
            let batches: Vec<_> = reader.map(Result::unwrap).collect();
            let kept: Vec<usize> = (0..schema.fields().len())
                .filter(|&i| schema.field(i).name() != "rewards")
                .collect();
            let schema = schema.project(&kept).unwrap();
            let mut writer = FileWriter::try_new(File::create(&part).unwrap(), &schema).unwrap();
            for batch in batches {
                writer.write(&batch.project(&kept).unwrap()).unwrap();
            }
            writer.finish().unwrap();
            forget_note(&data.join("1/metadata.json"));
        },
        &["no column `rewards`", "1/part-0.arrow", "--preferences"],
    );
}

/// Without our own note an episode is what another program might have written, and its checksum is not known.
fn forget_note(metadata: &Path) {
    let mut json: Value = serde_json::from_slice(&fs::read(metadata).unwrap()).unwrap();
    json.as_object_mut().unwrap().remove("ted").unwrap();
    fs::write(metadata, json.to_string()).unwrap();
}

#[test]
fn damaged_and_missing_files_are_named() {
    refused(
        |data| {
            let part = data.join("0/part-0.arrow");
            let mut bytes = fs::read(&part).unwrap();
            let middle = bytes.len() / 2;
            bytes[middle] ^= 1;
            fs::write(part, bytes).unwrap();
        },
        &["0/part-0.arrow is damaged"],
    );
    refused(
        |data| fs::remove_file(data.join("metadata.json")).unwrap(),
        &["no metadata.json in", "ted collect"],
    );
    refused(
        |data| fs::remove_dir_all(data.parent().unwrap()).unwrap(),
        &["no dataset at", "ted collect"],
    );
}

#[test]
fn an_episode_shorter_than_a_segment_is_not_asked_about_and_logs_of_such_ones_are_refused() {
    let desk = Desk::new();
    let mut records = episodes(3, 30);
    records[2] = episodes(1, 9).remove(0);
    let dataset = write(desk.folder.path(), "one-short", &records);
    finish(&mut desk.train_on(&dataset, "one-short-run", "oprl-i", &[])).with(0);
    let asked = fs::read_to_string(desk.folder.path().join("one-short-run/preferences.jsonl"));
    assert!(!asked.unwrap().contains("\"episode\":2,"));
    let dataset = write(desk.folder.path(), "short", &episodes(3, 9));
    finish(&mut desk.train_on(&dataset, "run", "oprl-i", &[]))
        .with(3)
        .telling("no episode has the 10 steps of a segment: the longest has 9");
    // Whoever does not ask about segments does not mind.
    finish(&mut desk.train_on(&dataset, "plain", "true", &[])).with(0);
}

#[test]
fn rewards_that_are_all_zero_are_trained_on_by_who_does_not_look_and_inspected() {
    let desk = Desk::new();
    let mut records = episodes(3, 30);
    records.iter_mut().for_each(|r| r.rewards.fill(0.0));
    let dataset = write(desk.folder.path(), "zero", &records);
    finish(&mut desk.train_on(&dataset, "run", "zero", &[])).with(0);
    finish(ted().arg("inspect").arg(desk.run("run"))).with(0);
}
