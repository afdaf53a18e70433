//! The model of episodes on logs with a purpose that is known, and on logs that say nothing.

mod beliefs;
mod learning;
mod looks;
mod standing;

use rand::{Rng, RngExt};

use crate::dataset::{Dataset, EpisodeRecord, Shape};
use crate::rng::{Seed, standard_normal};

use super::{EpisodesConfig, Fitting};

/// A point on a line that is to come to a place: where it is, the place, and a channel that never moves.
pub(super) const SHAPE: Shape = Shape {
    observation: 3,
    action: 1,
};

/// Steps of an episode.
pub(super) const STEPS: usize = 60;

/// Networks that learn in a moment.
pub(super) fn config() -> EpisodesConfig {
    let small = Fitting {
        hidden: vec![16],
        steps: 600,
        batch: 64,
        ..EpisodesConfig::default().clone
    };
    EpisodesConfig {
        directions: 2,
        pool: 200,
        candidates: 3,
        network: Fitting {
            hidden: vec![32, 32],
            steps: 3000,
            ..small.clone()
        },
        clone: small,
        held_out: 200,
        ..EpisodesConfig::default()
    }
}

/// Episodes of which each goes to its place with this share of its actions, and anywhere with the others. The reward is the
/// closeness to the place.
pub(super) fn logs(shares: &[f64]) -> Dataset {
    let episodes: Vec<EpisodeRecord> = (0..).zip(shares).map(episode).collect();
    Dataset::from_records("ted/line-v0", SHAPE, &episodes).unwrap()
}

fn episode((index, &share): (u64, &f64)) -> EpisodeRecord {
    let mut rng = Seed::root(index).child("line").rng();
    let place: f32 = rng.random_range(-1.0..1.0);
    // Everybody has equally far to go.
    let mut at: f32 = if rng.random() {
        place - 1.0
    } else {
        place + 1.0
    };
    let mut record = EpisodeRecord {
        observations: vec![at, place, 0.5],
        terminations: vec![false; STEPS],
        truncations: (1..=STEPS).map(|step| step == STEPS).collect(),
        success: vec![false; STEPS],
        ..EpisodeRecord::default()
    };
    for _ in 0..STEPS {
        let action = action(place - at, share, &mut rng);
        at += 0.03 * action;
        record.actions.push(action);
        record.rewards.push(f64::from(-(place - at).abs()));
        record.observations.extend([at, place, 0.5]);
    }
    record
}

fn action(way: f32, share: f64, rng: &mut impl Rng) -> f32 {
    let noise = standard_normal(rng) as f32;
    let aimed = (3.0 * way).clamp(-1.0, 1.0) + 0.3 * noise;
    let anywhere: f32 = rng.random_range(-1.0..1.0);
    let action = if rng.random::<f64>() < share {
        aimed
    } else {
        anywhere
    };
    action.clamp(-1.0, 1.0)
}

/// Six episodes that know the way, and many that hardly do.
pub(super) fn mixed() -> Dataset {
    logs(&[[1.0; 6].as_slice(), &[0.15; 54]].concat())
}

/// The first so many of them are those that know the way.
pub(super) const KNOWING: usize = 6;
