//! What Python tools write and this project does not: other types of numbers, metadata that is no JSON, rows in disorder.

use super::tests::{complete, replace_episode};
use super::*;
use crate::dataset::fixtures::{SHAPE, records};
use crate::dataset::{Dataset, EpisodeRecord};
use arrow_array::types::{Float16Type, Int64Type, UInt8Type};
use arrow_array::{
    Array, ArrayRef, ArrowPrimitiveType, BooleanArray, FixedSizeListArray, Float32Array,
    Float64Array, Int64Array, PrimitiveArray, RecordBatch, StructArray, UInt8Array,
};
use arrow_ipc::writer::FileWriter;
use arrow_schema::{Field, Schema};
use firmware_sim::robot::{ROBOT_FILE, Robot};
use std::fs;
use std::path::Path;
use std::sync::Arc;

/// Steps of the episode that is written here, the third of [`complete`].
const STEPS: usize = 5;

/// A file with these columns, by name.
fn file(columns: Vec<(&str, ArrayRef)>) -> Vec<u8> {
    let field =
        |(name, column): &(&str, ArrayRef)| Field::new(*name, column.data_type().clone(), true);
    let schema = Arc::new(Schema::new(columns.iter().map(field).collect::<Vec<_>>()));
    let columns = columns.into_iter().map(|(_, column)| column).collect();
    let batch = RecordBatch::try_new(schema.clone(), columns).unwrap();
    let mut writer = FileWriter::try_new(Vec::new(), &schema).unwrap();
    writer.write(&batch).unwrap();
    writer.into_inner().unwrap()
}

/// Lists of numbers of a type, from what each of them is.
fn lists<T: ArrowPrimitiveType>(width: usize, value: impl Fn(usize) -> T::Native) -> ArrayRef {
    let values = (0..(STEPS + 1) * width).map(value);
    let values = Arc::new(PrimitiveArray::<T>::from_iter_values(values));
    let item = Arc::new(Field::new("item", T::DATA_TYPE, true));
    Arc::new(FixedSizeListArray::new(item, width as i32, values, None))
}

fn one_info(name: &str, column: ArrayRef) -> ArrayRef {
    let field = Arc::new(Field::new(name, column.data_type().clone(), true));
    Arc::new(StructArray::from(vec![(field, column)]))
}

/// An episode in types that this project does not write: halves, bytes, whole numbers and floats for flags.
fn foreign() -> Vec<(&'static str, ArrayRef)> {
    let ends = [0, 0, 0, 0, 1, 0];
    let half = <Float16Type as ArrowPrimitiveType>::Native::from_f32;
    vec![
        (
            "observations",
            lists::<Float16Type>(SHAPE.observation, |i| half(i as f32 / 8.0)),
        ),
        (
            "actions",
            lists::<UInt8Type>(SHAPE.action, |i| (i % 2) as u8),
        ),
        (
            "rewards",
            Arc::new(Int64Array::from(vec![3, -1, 0, 0, 7, 0])),
        ),
        (
            "terminations",
            Arc::new(BooleanArray::from(vec![false; STEPS + 1])),
        ),
        ("truncations", Arc::new(UInt8Array::from(ends.to_vec()))),
        (
            "infos",
            // What is said of the reset may be anything.
            one_info(
                "success",
                Arc::new(Float32Array::from(vec![f32::NAN, 0.0, 0.0, 1.0, 0.0, 1.0])),
            ),
        ),
    ]
}

/// Puts a file in the place of an episode's.
fn put(data: &Path, bytes: &[u8]) {
    let folder = data.join("2");
    super::tests::edit(&folder.join(METADATA), |value| {
        value["ted"]["blake3"] = blake3::hash(bytes).to_hex().to_string().into();
    });
    fs::write(folder.join(PART), bytes).unwrap();
}

/// What is said of the dataset when that episode has another column.
fn refusal(name: &str, column: ArrayRef) -> String {
    let (_root, folder) = complete();
    let mut columns = foreign();
    columns.iter_mut().find(|(it, _)| *it == name).unwrap().1 = column;
    put(&folder.join("data"), &file(columns));
    Dataset::open(&folder).map(|_| ()).unwrap_err().to_string()
}

#[test]
fn numbers_and_flags_of_any_type_are_read_for_what_they_are() {
    let (_root, folder) = complete();
    put(&folder.join("data"), &file(foreign()));
    let dataset = Dataset::open(&folder).unwrap();
    let episode = dataset.episodes()[2];
    let steps = episode.first_step..episode.first_step + STEPS;
    let first = dataset.observations_row(episode.first_step) * SHAPE.observation;
    let observations = &dataset.observations()[first..first + (STEPS + 1) * SHAPE.observation];
    assert!(
        observations
            .iter()
            .enumerate()
            .all(|(i, &x)| x == i as f32 / 8.0)
    );
    assert_eq!(dataset.action(steps.start), [0.0, 1.0, 0.0, 1.0]);
    assert_eq!(
        dataset.rewards_true()[steps.clone()],
        [3.0, -1.0, 0.0, 0.0, 7.0]
    );
    assert_eq!(
        dataset.truncations()[steps.clone()],
        [false, false, false, false, true]
    );
    assert_eq!(
        dataset.success()[steps],
        [false, false, true, false, true],
        "row t + 1 belongs to step t"
    );
}

#[test]
fn numbers_that_would_change_and_flags_that_are_none_are_named_with_their_place() {
    let place = "data/2/part-0.arrow";
    let large = lists::<Int64Type>(SHAPE.observation, |i| (1 << 53) + i as i64);
    let text = refusal("observations", large);
    assert!(text.starts_with("observations of episode 2, "), "{text}");
    let found = format!(
        "{place}: expected numbers that double precision holds, got 9007199254740993 as value 1"
    );
    assert!(text.contains(&found), "{text}");

    let half = Arc::new(Float64Array::from(vec![0.0, 0.5, 0.0, 0.0, 1.0, 0.0]));
    let text = refusal("terminations", half.clone());
    let found = "expected true or false, or 0 or 1, got 0.5 in row 1";
    assert!(text.contains(found), "{text}");
    let text = refusal("infos", one_info("success", half));
    let found = "infos/success of episode 2, ";
    assert!(
        text.starts_with(found) && text.contains("got 0.5 in row 0"),
        "{text}"
    );

    let text = refusal(
        "rewards",
        Arc::new(arrow_array::StringArray::from(vec!["1"; STEPS + 1])),
    );
    assert!(text.contains("expected numbers, got Utf8"), "{text}");
}

#[test]
fn a_box_of_any_type_is_a_space_and_its_bounds_may_be_infinite() {
    let (_root, folder) = complete();
    super::tests::edit(&folder.join("data").join(METADATA), |value| {
        value["observation_space"] =
            r#"{"type": "Box", "dtype": "int16", "shape": [7], "low": [-Infinity], "high": [NaN]}"#
                .into();
    });
    assert_eq!(Dataset::open(&folder).unwrap().observation_dim(), 7);
}

/// The robot of whoever wrote no file for it.
#[test]
fn the_bounds_of_an_action_space_are_a_robot_s_ranges_and_what_is_outside_of_them_is_refused() {
    let root = tempfile::tempdir().unwrap();
    let mut record = records(&[STEPS]).remove(0);
    for (i, action) in record.actions.iter_mut().enumerate() {
        *action = (i % 5) as f32 / 4.0;
    }
    let origin = Origin {
        episodes: 1,
        ..super::tests::origin()
    };
    let robot = Robot::draft(SHAPE.observation, &[[0.0, 1.0]; SHAPE.action]);
    let id = DatasetId::new("mine", "box01", 0).unwrap();
    let writer = DatasetWriter::open(root.path(), id, origin, robot).unwrap();
    writer.write(0, Behaviour::default(), &record).unwrap();
    let folder = writer.finish().unwrap();
    let metadata = folder.join("data").join(METADATA);
    fs::remove_file(folder.join("data").join(ROBOT_FILE)).unwrap();
    super::tests::edit(&metadata, |value| {
        value.as_object_mut().unwrap().remove("ted").unwrap();
    });

    let dataset = Dataset::open(&folder).unwrap();
    assert!(!dataset.robot().declared());
    assert!(
        dataset
            .robot()
            .action
            .iter()
            .all(|it| it.range == [0.0, 1.0])
    );
    assert_eq!(dataset.actions_env(), record.actions);
    let learned: Vec<f32> = record.actions.iter().map(|it| 2.0 * it - 1.0).collect();
    assert_eq!(dataset.actions(), learned);

    super::tests::edit(&metadata, |value| {
        let space = value["action_space"].as_str().unwrap();
        value["action_space"] = space.replacen("1.0", "0.5", 1).into();
    });
    let text = Dataset::open(&folder).map(|_| ()).unwrap_err().to_string();
    assert!(text.contains("holds 1 at row 1, "), "{text}");
    assert!(
        text.contains("channel action_0, whose range is [0, 0.5]"),
        "{text}"
    );
}

#[test]
fn a_reward_that_is_no_number_is_blamed_on_the_reward_and_not_on_the_metadata_that_sums_it_up() {
    let (_root, folder) = complete();
    let data = folder.join("data");
    let mut record = records(&[STEPS]).remove(0);
    record.rewards[3] = f64::NAN;
    replace_episode(&data, 2, &record, SHAPE);
    let path = data.join("2").join(METADATA);
    let text = fs::read_to_string(&path).unwrap();
    let sums = text.replacen(
        '{',
        "{\"rewards_sum\": NaN, \"rewards_max\": -Infinity, ",
        1,
    );
    fs::write(&path, sums).unwrap();
    let text = Dataset::open(&folder).map(|_| ()).unwrap_err().to_string();
    assert!(text.starts_with("rewards of episode 2, "), "{text}");
    assert!(text.contains("holds NaN at row 3"), "{text}");
}

/// As a writer with threads leaves an episode: its blocks in another order.
#[test]
fn blocks_in_another_order_than_that_of_time_are_named_with_episode_and_step() {
    let (_root, folder) = complete();
    let whole = records(&[STEPS]).remove(0);
    let turned = |flags: &[bool]| [&flags[3..], &flags[..3]].concat();
    let scrambled = EpisodeRecord {
        truncations: turned(&whole.truncations),
        ..whole
    };
    replace_episode(&folder.join("data"), 2, &scrambled, SHAPE);
    let text = Dataset::open(&folder).map(|_| ()).unwrap_err().to_string();
    assert!(text.starts_with("episode 2, "), "{text}");
    let found = "part-0.arrow has a truncation at step 1 of 5, and goes on; its last step has none";
    assert!(text.contains(found), "{text}");
}
