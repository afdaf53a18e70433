//! What is said of episodes before anybody is asked.

use firmware_sim::progress::Audience;
use nalgebra::DVector;

use crate::dataset::{Dataset, EpisodeRecord};
use crate::nn::Backend;
use crate::reward::Material;
use crate::reward::episodes::Look;
use crate::reward::episodes::descriptors::{Descriptors, Steps};
use crate::rng::Seed;

use super::{KNOWING, config, logs, mixed};

pub(super) fn material(dataset: &Dataset) -> Material<'_> {
    Material {
        dataset,
        seed: Seed::root(1),
        backend: Backend::Fused,
        audience: Audience::Nobody,
    }
}

#[test]
fn episodes_that_know_the_way_are_the_competent_ones_and_both_halves_say_so() {
    let dataset = mixed();
    let look = Look::at(&config(), material(&dataset)).unwrap();
    let competence = look.descriptors().values.column(0);
    let least = competence.rows(0, KNOWING).min();
    let most = competence
        .rows(KNOWING, dataset.episodes().len() - KNOWING)
        .max();
    assert!(least > most, "{least} {most}");
    let reliability = look.descriptors().reliability[0];
    assert!(reliability > 0.8, "{reliability}");
}

#[test]
fn of_episodes_that_are_all_alike_competence_is_not_trusted() {
    let dataset = logs(&[0.15; 60]);
    let look = Look::at(&config(), material(&dataset)).unwrap();
    let reliability = look.descriptors().reliability[0];
    assert!(reliability < 0.6, "{reliability}");
}

#[test]
fn descriptors_have_one_size_and_say_nothing_of_the_place_that_was_given() {
    let dataset = mixed();
    let look = Look::at(&config(), material(&dataset)).unwrap();
    let values = &look.descriptors().values;
    let places = DVector::from_fn(values.nrows(), |episode, _| {
        let first = dataset.episodes()[episode].first_step;
        f64::from(dataset.observation(first)[1])
    });
    let places = places.add_scalar(-places.mean());
    for column in values.column_iter() {
        assert!(column.mean().abs() < 1e-4, "mean {}", column.mean());
        let variance = column.variance();
        assert!(
            variance == 0.0 || (variance - 1.0).abs() < 0.02,
            "{variance}"
        );
    }
    for column in values.columns(1, values.ncols() - 1).column_iter() {
        if column.norm() == 0.0 {
            continue;
        }
        let correlation = column.dot(&places) / (column.norm() * places.norm());
        assert!(correlation.abs() < 1e-3, "{correlation}");
    }
}

#[test]
fn the_mean_share_of_an_episode_s_steps_is_its_quality_also_where_it_is_cut_off() {
    let dataset = mixed();
    let cloned: Vec<f32> = (0..dataset.step_count())
        .map(|step| dataset.observation(step)[1] - dataset.observation(step)[0])
        .collect();
    let weights = DVector::from_vec(vec![1.5, -0.5, 0.25]);
    for clip in [4.0, 1.0] {
        let steps = Steps::new(&dataset, &cloned, clip);
        let descriptors = Descriptors::of(&steps, 2, 10);
        assert!(descriptors.values.amax() <= clip);
        let shares = descriptors.shares(&steps, &weights);
        let quality = &descriptors.values * &weights;
        for (episode, quality) in dataset.episodes().iter().zip(quality.iter()) {
            let own = &shares[episode.first_step..episode.first_step + episode.len];
            let mean = own.iter().map(|&share| f64::from(share)).sum::<f64>() / own.len() as f64;
            assert!((mean - quality).abs() < 1e-5, "{mean} {quality}");
        }
    }
}

#[test]
fn one_episode_in_which_a_resting_channel_moves_does_not_decide_what_is_looked_at() {
    let steps = 11;
    let mut episodes: Vec<EpisodeRecord> = (0..100)
        .map(|episode| EpisodeRecord {
            // Two of a kind go up, two go down; the other channel rests.
            observations: (0..steps)
                .flat_map(|step| {
                    [
                        step as f32 * if episode % 4 < 2 { 0.1 } else { -0.1 },
                        0.5,
                        0.0,
                    ]
                })
                .collect(),
            actions: vec![0.0; steps - 1],
            rewards: vec![0.0; steps - 1],
            terminations: vec![false; steps - 1],
            truncations: (1..steps).map(|step| step == steps - 1).collect(),
            success: vec![false; steps - 1],
            ..EpisodeRecord::default()
        })
        .collect();
    // Something falls over in one of them after its first step.
    for step in 1..steps {
        episodes[7].observations[3 * step + 2] = 1e3;
    }
    let dataset = Dataset::from_records("ted/odd-v0", super::SHAPE, &episodes).unwrap();
    let cloned = vec![0.0; dataset.step_count()];
    let most_moving = |clip| {
        let look = Descriptors::of(&Steps::new(&dataset, &cloned, clip), 1, 1);
        look.channels(0)[0].0
    };
    assert_eq!(most_moving(1e9), 2, "without a limit, what fell over");
    assert_eq!(most_moving(4.0), 0, "what tells the two kinds apart");
}

#[test]
fn logs_without_anything_to_tell_apart_give_zeros_and_no_nan() {
    // Every action is the same, so every episode is the way it began.
    let episodes = [(); 4].map(|()| EpisodeRecord {
        observations: vec![0.25; 3 * 11],
        actions: vec![0.0; 10],
        rewards: vec![0.0; 10],
        terminations: vec![false; 10],
        truncations: (1..=10).map(|step| step == 10).collect(),
        success: vec![false; 10],
        ..EpisodeRecord::default()
    });
    let dataset = Dataset::from_records("ted/still-v0", super::SHAPE, &episodes).unwrap();
    let look = Look::at(&config(), material(&dataset)).unwrap();
    let descriptors = look.descriptors();
    assert!(descriptors.values.iter().all(|&x| x == 0.0));
    assert!(descriptors.reliability.iter().all(|&r| r == 0.0));
}
