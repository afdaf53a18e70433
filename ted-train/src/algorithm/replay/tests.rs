//! Batches: the right rows joined, standardised, and a function of the step alone.

use crate::algorithm::{ObservationScaling, Replay};
use crate::dataset::Dataset;
use crate::dataset::fixtures::{SHAPE, records};
use crate::nn::fixtures::{assert_close, wide};
use crate::reward::{InputMap, InputScaling, RewardInputs};
use crate::rng::Seed;

#[test]
fn a_batch_joins_each_step_with_what_followed_and_its_own_labels() {
    let mut records = records(&[6, 5, 7]);
    records[0].actions[0] = 1.0;
    records[0].actions[1] = -1.0;
    let dataset = Dataset::from_records("ted/x-v0", SHAPE, &records).unwrap();
    let steps = dataset.step_count();
    // Labels that name their step.
    let rewards: Vec<f32> = (0..steps).map(|i| i as f32).collect();
    let discounts: Vec<f32> = (0..steps).map(|i| i as f32 / 100.0).collect();
    let replay = Replay::new(&dataset, rewards, discounts);
    let statistics = dataset.observation_statistics();
    let standard = |raw: &[f32]| -> Vec<f64> {
        let ends = statistics.min.iter().zip(&statistics.max);
        let moments = (statistics.mean.iter().zip(&statistics.std)).zip(ends);
        raw.iter()
            .zip(moments)
            .map(|(x, ((mean, std), (low, high)))| {
                let floor = 1e-3 * (f64::from(*high) - f64::from(*low));
                (f64::from(*x) - f64::from(*mean)) / (f64::from(*std) + floor)
            })
            .collect()
    };
    let mut seen = vec![false; steps];
    let batch = replay.batch(Seed::root(3), 0, 200);
    for row in 0..200 {
        let step = batch.rewards[row] as usize;
        seen[step] = true;
        assert_eq!(batch.transitions[row] as usize, step);
        assert_eq!(batch.discounts[row], step as f32 / 100.0);
        let own = |all: &[f32], width: usize| all[row * width..(row + 1) * width].to_vec();
        let (now, next) = (
            own(&batch.observations, SHAPE.observation),
            own(&batch.next_observations, SHAPE.observation),
        );
        assert_close(&now, &standard(dataset.observation(step)), 1e-5, "now");
        assert_close(
            &next,
            &standard(dataset.next_observation(step)),
            1e-5,
            "next",
        );
        let limit = 1.0 - 1e-5f32;
        let clipped: Vec<f32> = dataset
            .action(step)
            .iter()
            .map(|a| a.clamp(-limit, limit))
            .collect();
        assert_eq!(own(&batch.actions, SHAPE.action), clipped);
    }
    assert!(seen.iter().all(|&s| s), "200 draws of {steps} miss none");
    assert!(batch.actions.iter().all(|a| a.abs() < 1.0));
    assert!(wide(&batch.observations).iter().all(|x| x.is_finite()));
}

#[test]
fn a_batch_is_a_function_of_the_stream_and_the_step() {
    let dataset = Dataset::from_records("ted/x-v0", SHAPE, &records(&[6, 5])).unwrap();
    let steps = dataset.step_count();
    let replay = Replay::new(
        &dataset,
        (0..steps).map(|i| i as f32).collect(),
        vec![0.9; steps],
    );
    let stream = Seed::root(3).child("iql/batch");
    let rows = |stream, step| replay.batch(stream, step, 32).rewards;
    let seventh = rows(stream, 7);
    rows(stream, 8);
    assert_eq!(rows(stream, 7), seventh);
    assert_ne!(rows(stream, 8), seventh);
    assert_ne!(rows(Seed::root(4), 7), seventh);
}

#[test]
fn raw_observations_are_those_of_the_dataset_and_the_policy_is_told() {
    let dataset = Dataset::from_records("ted/x-v0", SHAPE, &records(&[6, 5])).unwrap();
    let steps = dataset.step_count();
    let replay = Replay::new(&dataset, vec![0.0; steps], vec![0.9; steps]);
    let replay = replay.seen(ObservationScaling::Raw);
    let batch = replay.batch(Seed::root(3), 0, 20);
    let rows = batch.observations.chunks(SHAPE.observation);
    for (row, step) in rows.zip(&batch.transitions) {
        assert_eq!(row, dataset.observation(*step as usize));
    }
    assert_eq!(replay.shift(), [0.0; SHAPE.observation]);
    assert_eq!(replay.scale(), [1.0; SHAPE.observation]);
}

/// The same logs in a unit that is `larger` times as large.
fn in_a_larger_unit(larger: f32) -> Dataset {
    let mut records = records(&[30, 20]);
    for record in &mut records {
        record.observations.iter_mut().for_each(|x| *x /= larger);
    }
    Dataset::from_records("ted/x-v0", SHAPE, &records).unwrap()
}

/// What a policy and a reward see of a batch.
fn seen(dataset: &Dataset) -> [Vec<f32>; 2] {
    let steps = dataset.step_count();
    let replay = Replay::new(dataset, vec![0.0; steps], vec![0.9; steps]);
    let map = InputMap::new(
        RewardInputs::ObservationAction,
        InputScaling::Standard { floor: 0.05 },
        &dataset.observation_statistics(),
        dataset.action_dim(),
    );
    let mut rewards = Vec::new();
    (0..steps).for_each(|step| map.push(dataset, step, &mut rewards));
    [replay.batch(Seed::root(3), 0, 64).observations, rewards]
}

#[test]
fn the_unit_of_the_logs_shows_in_nothing_that_a_network_sees() {
    let metres = seen(&in_a_larger_unit(1.0));
    assert_eq!(seen(&in_a_larger_unit(131_072.0)), metres, "to the bit");
    let rounded = seen(&in_a_larger_unit(1e5));
    for (rounded, metres) in rounded.iter().zip(&metres) {
        assert_close(rounded, &wide(metres), 1e-5, "a factor of 100,000");
    }
}

#[test]
fn one_frame_that_is_a_glitch_changes_neither_shift_nor_scale() {
    let (clean, mut broken) = (records(&[30, 20]), records(&[30, 20]));
    broken[1].observations[7 * SHAPE.observation + 2] = 1e6;
    let dataset = |records: &[_]| Dataset::from_records("ted/x-v0", SHAPE, records).unwrap();
    let (clean, broken) = (dataset(&clean), dataset(&broken));
    assert_eq!(broken.glitches().len(), 1);
    let scaling = |dataset: &Dataset| {
        let steps = dataset.step_count();
        let replay = Replay::new(dataset, vec![0.0; steps], vec![0.9; steps]);
        [replay.shift().to_vec(), replay.scale().to_vec()]
    };
    let ([shift, scale], [clean_shift, clean_scale]) = (scaling(&broken), scaling(&clean));
    // One frame of 52 counts as its neighbours do.
    assert_close(&shift, &wide(&clean_shift), 0.05, "shift");
    assert_close(&scale, &wide(&clean_scale), 0.05, "scale");
    let others = |of: &[f32]| [&of[..2], &of[3..]].concat();
    assert_eq!(others(&scale), others(&clean_scale));
}
