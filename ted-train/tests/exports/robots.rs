//! Artefacts to export: the toy's, and two that have what the toy has not.

use firmware_sim::plants::toy;
use rand::RngExt;
use ted_core::{Dense, Mlp, Normaliser, Output, Policy};
use ted_policy::{
    ActionChannel, ArtifactBytes, ArtifactSpec, Contract, Digest, ObservationChannel, Provenance,
    SafeAction, write,
};
use ted_train::rng::Seed;

/// Golden observations of the two.
const GOLDEN: usize = 5;

/// Texts that a careless writer of C or JSON breaks on.
const NAMES: [&str; 4] = ["joint \"a\" \\ */", "??=??/", "\u{398}_dot\n", "x"];
const UNITS: [&str; 4] = ["\u{b0}/s", "", "m%d", "\t"];

/// All of them, by name.
pub fn all() -> [(&'static str, ArtifactBytes); 3] {
    let toy = ArtifactBytes::from_vec(toy::artifact_bytes().unwrap());
    [("toy", toy), ("deep", deep()), ("aiming", aiming())]
}

/// One with as many layers as fit, no width a multiple of four, and a range of its own for each channel.
pub fn deep() -> ArtifactBytes {
    let ranges = [(0.0, 1.0), (-0.4, 0.4), (2.0, 10.0), (-1e3, 250.0)];
    robot(&[7, 33, 18, 6, 4], Output::Tanh, &ranges)
}

/// One without tanh, whose network aims beyond its ranges.
pub fn aiming() -> ArtifactBytes {
    robot(&[5, 9, 2], Output::Linear, &[(0.0, 1.0), (-3.0, -1.0)])
}

fn robot(widths: &[usize], output: Output, ranges: &[(f32, f32)]) -> ArtifactBytes {
    let mut rng = Seed::root(5).child("robot").rng();
    let mut numbers = |count: usize, size: f32| -> Vec<f32> {
        (0..count)
            .map(|_| size * (2.0 * rng.random::<f32>() - 1.0))
            .collect()
    };
    let sides: Vec<_> = widths.windows(2).map(|pair| (pair[0], pair[1])).collect();
    let parameters: Vec<_> = sides
        .iter()
        .map(|&(inputs, outputs)| {
            let size = 2.0 / (inputs as f32).sqrt();
            (numbers(inputs * outputs, size), numbers(outputs, 0.5))
        })
        .collect();
    let layers: Vec<_> = sides
        .iter()
        .zip(&parameters)
        .map(|(&(inputs, outputs), (weights, bias))| {
            Dense::new(inputs, outputs, weights, bias).unwrap()
        })
        .collect();
    let shift = numbers(widths[0], 3.0);
    let scale: Vec<f32> = numbers(widths[0], 0.9).iter().map(|it| 1.0 + it).collect();
    let observation: Vec<_> = (0..widths[0])
        .map(|i| ObservationChannel {
            name: NAMES[i % 4].into(),
            unit: UNITS[i % 4].into(),
            low: shift[i] - 2.5,
            high: shift[i] + 2.0,
        })
        .collect();
    let action: Vec<_> = ranges
        .iter()
        .enumerate()
        .map(|(i, &(low, high))| ActionChannel {
            name: NAMES[3 - i].into(),
            unit: UNITS[3 - i].into(),
            low,
            high,
            slew_per_tick: 0.1 + i as f32,
            on_fault: match i {
                0 => SafeAction::HoldLast,
                _ if low <= 0.0 && high >= 0.0 => SafeAction::Zero,
                _ => SafeAction::Value(low),
            },
        })
        .collect();
    let golden: Vec<f32> = (0..GOLDEN).flat_map(|_| numbers(widths[0], 3.0)).collect();
    let spec = ArtifactSpec {
        contract: Contract::new("a \"task\"", &observation, &action, 33_333, 70_000).unwrap(),
        provenance: Provenance {
            trainer_version: "0.1.0",
            preset: "none",
            seed: u64::MAX,
            steps: 0,
            config_digest: Digest([0x11; 32]),
            dataset_id: "own/robot-v0",
            dataset_digest: Digest([0x22; 32]),
            preferences_digest: None,
            dataset_return_mean: 0.0,
            dataset_return_max: 0.0,
        },
        policy: Policy::new(
            Normaliser::new(&shift, &scale).unwrap(),
            Mlp::new(&layers, output).unwrap(),
        )
        .unwrap(),
        reward: None,
        ted: None,
        integers: None,
        golden_obs_raw: &golden,
    };
    ArtifactBytes::from_vec(write(&spec).unwrap())
}
