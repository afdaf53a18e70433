//! Batches: the right rows joined, standardised, and a function of the step alone.

use crate::algorithm::{ObservationScaling, Replay};
use crate::dataset::Dataset;
use crate::dataset::fixtures::{SHAPE, records};
use crate::nn::fixtures::{assert_close, wide};
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
        let moments = statistics.mean.iter().zip(&statistics.std);
        raw.iter()
            .zip(moments)
            .map(|(x, (m, s))| (f64::from(*x) - f64::from(*m)) / (f64::from(*s) + 1e-3))
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
