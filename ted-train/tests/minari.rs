//! Datasets against the real `minari` package: what we write it opens, what it writes we read, and every array is compared.
//!
//! The package is installed at locked versions into a virtual environment of its own, once, under the target folder;
//! `TED_MINARI_VENV` names another place for it. In `minari/`, `requirements.lock` is made from `requirements.in` by
//!
//! ```sh
//! uv pip compile --universal --python-version 3.11 --generate-hashes --no-emit-index-url \
//!     --only-binary :all: --no-header -o requirements.lock requirements.in
//! ```

mod venv;

use firmware_sim::robot::Robot;
use serde_json::Value;
use std::path::Path;
use std::process::Command;
use ted_train::dataset::minari::{Behaviour, DatasetId, DatasetWriter, MINARI_VERSION, Origin};
use ted_train::dataset::{Dataset, EpisodeRecord, InfoColumn, Shape};

const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/minari");

#[test]
fn the_real_package_opens_what_is_written_and_sees_every_array_to_the_bit() {
    const SHAPE: Shape = Shape {
        observation: 39,
        action: 4,
    };
    let root = tempfile::tempdir().unwrap();
    let records: Vec<_> = [12, 7, 9]
        .into_iter()
        .enumerate()
        .map(|(i, steps)| record(i, steps, SHAPE))
        .collect();
    let id = DatasetId::new("ted", "drawer-open-v3-paper-s3", 0).unwrap();
    let origin = Origin {
        task: "drawer-open-v3".into(),
        recipe: "paper".into(),
        seed: 3,
        episodes: 3,
        goal: "visible".into(),
        reward: "v2".into(),
        engine: [("metaworld".to_string(), "3.1.1".to_string())].into(),
    };
    let robot = Robot::draft(SHAPE.observation, &[[-1.0, 1.0]; SHAPE.action]);
    let writer = DatasetWriter::open(root.path(), id.clone(), origin, robot).unwrap();
    for (index, record) in records.iter().enumerate() {
        let behaviour = Behaviour {
            part: "noisy".into(),
            noise_std: 0.8,
            epsilon: 0.0,
            ..Behaviour::default()
        };
        writer.write(index as u32, behaviour, record).unwrap();
    }
    writer.finish().unwrap();

    let seen = arrays(root.path(), "read", &id.to_string());
    assert_eq!(seen["listed"], serde_json::json!([id.to_string()]));
    assert_eq!(seen["id"], id.to_string());
    assert_eq!(seen["minari_version"], MINARI_VERSION);
    assert_eq!(seen["total_steps"], 28);
    assert_eq!(seen["observation_space"], "(39,)float32");
    assert_eq!(seen["action_space"], "(4,)float32");
    assert_eq!(seen["sampled"], 2);
    let episodes = seen["episodes"].as_array().unwrap();
    assert_eq!(episodes.len(), records.len());
    for (index, (episode, record)) in episodes.iter().zip(&records).enumerate() {
        let steps = record.steps();
        assert_eq!(episode["id"], index);
        assert_eq!(episode["seed"].as_u64(), record.seed);
        assert_eq!(episode["in_space"], true);
        let arrays = &episode["arrays"];
        assert_eq!(
            arrays["observations"],
            floats32(&record.observations, &[steps + 1, 39])
        );
        assert_eq!(arrays["actions"], floats32(&record.actions, &[steps, 4]));
        assert_eq!(arrays["rewards"], floats64(&record.rewards, &[steps]));
        assert_eq!(arrays["terminations"], flags(&record.terminations));
        assert_eq!(arrays["truncations"], flags(&record.truncations));
        let infos = episode["infos"].as_object().unwrap();
        assert_eq!(infos.len(), record.infos.len() + 1);
        let from_reset: Vec<_> = std::iter::once(false)
            .chain(record.success.iter().copied())
            .collect();
        assert_eq!(infos["success"], flags(&from_reset));
        for info in &record.infos {
            assert_eq!(
                infos[&info.name],
                floats64(&info.values, &[steps + 1, info.width]),
                "{}",
                info.name
            );
        }
    }
}

#[test]
fn what_the_real_package_writes_is_read_with_every_array_to_the_bit() {
    let root = tempfile::tempdir().unwrap();
    let seen = arrays(root.path(), "write", "minari/own-v1");
    let dataset = Dataset::open(root.path().join("minari/own-v1")).unwrap();
    assert_eq!((dataset.id(), dataset.task()), ("minari/own-v1", None));
    assert_eq!((dataset.observation_dim(), dataset.action_dim()), (6, 2));
    assert_eq!(
        dataset.step_count() as u64,
        seen["total_steps"].as_u64().unwrap()
    );
    let episodes = seen["episodes"].as_array().unwrap();
    assert_eq!(dataset.episodes().len(), episodes.len());
    for (index, (ours, theirs)) in dataset.episodes().iter().zip(episodes).enumerate() {
        let steps = ours.first_step..ours.first_step + ours.len;
        let rows = ours.first_step + index..ours.first_step + index + ours.len + 1;
        let arrays = &theirs["arrays"];
        assert_eq!(ours.seed, theirs["seed"].as_u64());
        let observations: Vec<f32> = numbers(&arrays["observations"])
            .iter()
            .map(|&value| value as f32)
            .collect();
        assert_eq!(
            dataset.observations()[rows.start * 6..rows.end * 6],
            observations
        );
        let actions = floats32(
            &dataset.actions()[steps.start * 2..steps.end * 2],
            &[ours.len, 2],
        );
        assert_eq!(arrays["actions"], actions);
        let rewards = numbers(&arrays["rewards"]);
        assert_eq!(ours.return_true, rewards.iter().sum::<f64>());
        let rewards: Vec<f32> = rewards.iter().map(|&value| value as f32).collect();
        assert_eq!(dataset.rewards_true()[steps.clone()], rewards);
        assert_eq!(
            arrays["terminations"],
            flags(&dataset.terminations()[steps.clone()])
        );
        assert_eq!(
            arrays["truncations"],
            flags(&dataset.truncations()[steps.clone()])
        );
        let from_reset: Vec<_> = std::iter::once(false)
            .chain(dataset.success()[steps].iter().copied())
            .collect();
        assert_eq!(theirs["infos"]["success"], flags(&from_reset));
    }
    let solved: Vec<_> = dataset
        .episodes()
        .iter()
        .map(|episode| episode.success)
        .collect();
    assert_eq!(solved, [true, true, false]);
}

/// An episode of numbers with full mantissas, extreme magnitudes and signed zeros among them.
fn record(index: usize, steps: usize, shape: Shape) -> EpisodeRecord {
    let number = |at: usize| match at % 11 {
        0 => -0.0,
        1 => 1e-30,
        _ => ((at * 7919 + index * 104_729) as f64).sin(),
    };
    let floats = |from: usize, count: usize| (from..from + count).map(number).collect::<Vec<_>>();
    let narrow = |values: Vec<f64>| values.into_iter().map(|value| value as f32).collect();
    let rows = steps + 1;
    let info = |name: &str, width: usize| InfoColumn {
        name: name.into(),
        width,
        values: floats(width, rows * width),
    };
    EpisodeRecord {
        seed: Some(u64::MAX - index as u64),
        observations: narrow(floats(0, rows * shape.observation)),
        actions: narrow(floats(3, steps * shape.action)),
        rewards: floats(5, steps),
        terminations: (0..steps)
            .map(|step| index == 1 && step + 1 == steps)
            .collect(),
        truncations: (0..steps)
            .map(|step| index != 1 && step + 1 == steps)
            .collect(),
        success: (0..steps).map(|step| step % 3 == index).collect(),
        infos: vec![
            info("qpos", 16),
            info("qvel", 15),
            info("mocap_pos", 3),
            info("mocap_quat", 4),
            info("goal", 6),
        ],
    }
}

fn encoded(dtype: &str, shape: &[usize], bytes: impl Iterator<Item = u8>) -> Value {
    let hex: String = bytes.map(|byte| format!("{byte:02x}")).collect();
    serde_json::json!({ "dtype": dtype, "shape": shape, "hex": hex })
}

fn floats32(values: &[f32], shape: &[usize]) -> Value {
    encoded(
        "<f4",
        shape,
        values.iter().flat_map(|value| value.to_le_bytes()),
    )
}

fn floats64(values: &[f64], shape: &[usize]) -> Value {
    encoded(
        "<f8",
        shape,
        values.iter().flat_map(|value| value.to_le_bytes()),
    )
}

fn flags(values: &[bool]) -> Value {
    encoded(
        "|b1",
        &[values.len()],
        values.iter().map(|&value| u8::from(value)),
    )
}

/// The float64 values of a printed array.
fn numbers(array: &Value) -> Vec<f64> {
    assert_eq!(array["dtype"], "<f8");
    let hex = array["hex"].as_str().unwrap().as_bytes();
    hex.chunks(16)
        .map(|digits| {
            let digits = std::str::from_utf8(digits).unwrap();
            f64::from_bits(u64::from_str_radix(digits, 16).unwrap().swap_bytes())
        })
        .collect()
}

/// Runs the script beside this file in the real package's environment.
fn arrays(root: &Path, command: &str, id: &str) -> Value {
    let folder = Path::new(FOLDER);
    let python = venv::python("minari", &folder.join("requirements.lock"));
    let output = Command::new(python)
        .env("MINARI_DATASETS_PATH", root)
        .arg(folder.join("arrays.py"))
        .args([command, id])
        .output()
        .unwrap();
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    serde_json::from_slice(&output.stdout).unwrap()
}
