//! What training does, and that a stopped one goes on to the bit.

use crate::algorithm::oppo::{Oppo, OppoConfig, Player};
use crate::algorithm::{AlgorithmConfig, Learner, Policy, Replay};
use crate::checkpoint::{Checkpoint, ForeignCheckpoint};
use crate::dataset::{Clip, Dataset, SegmentSampler};
use crate::nn::Backend;
use crate::nn::fixtures::numbers;
use crate::preferences::LabelledPair;
use crate::rng::Seed;

use super::{SEGMENT, config, dataset};

/// Ten answers of somebody who prefers larger returns, or smaller ones.
fn answers(dataset: &Dataset, larger: bool) -> Vec<LabelledPair> {
    let sampler = SegmentSampler::new(dataset, Clip::Steps(SEGMENT)).unwrap();
    let mut rng = Seed::root(4).rng();
    let mut ask = |_| {
        let segments = [(); 2].map(|()| sampler.sample(&mut rng));
        let [first, second] = segments.map(|segment| segment.return_true(dataset));
        let label = f32::from((second > first) == larger);
        LabelledPair { segments, label }
    };
    (0..10).map(&mut ask).collect()
}

fn learner(config: &OppoConfig, lanes: &[&Replay<'_>], seeds: &[u64]) -> Box<dyn Learner> {
    let roots: Vec<_> = seeds.iter().copied().map(Seed::root).collect();
    AlgorithmConfig::Oppo(config.clone()).learner(lanes, &roots, Backend::Flex)
}

fn replay(dataset: &Dataset, larger: bool) -> Replay<'_> {
    Replay::new(dataset, Vec::new(), Vec::new()).answered(answers(dataset, larger))
}

#[test]
fn the_policy_goes_the_way_that_is_preferred() {
    let dataset = dataset();
    let config = OppoConfig {
        width: 16,
        layers: 1,
        steps: 300,
        learning_rate: 3e-3,
        latent_rate: 3e-2,
        ..config()
    };
    let mean_action = |larger| {
        let replay = replay(&dataset, larger);
        let mut learner = learner(&config, &[&replay], &[1]);
        while learner.step() < config.steps {
            learner.update(&[&replay]);
        }
        let Policy::Sequence(oppo) = learner.policies().swap_remove(0) else {
            panic!("a policy for sequences");
        };
        let mut player = Player::new(&oppo);
        // Longer than a clip, and than the longest episode.
        let episode = |player: &mut Player<'_>| {
            let actions = (0..9).map(|i| player.act(&numbers(2, &format!("seen/{i}")))[0]);
            actions.sum::<f32>() / 9.0
        };
        let first = episode(&mut player);
        player.reset();
        assert_eq!(episode(&mut player), first, "nothing is left of an episode");
        first
    };
    let (up, down) = (mean_action(true), mean_action(false));
    assert!(up > 0.25 && down < -0.25, "{up} and {down}");
}

#[test]
fn a_lane_goes_on_alone_to_the_bit_and_sees_nothing_of_the_others() {
    let dataset = dataset();
    let [up, down] = [true, false].map(|larger| replay(&dataset, larger));
    let mut whole = learner(&config(), &[&up], &[3]);
    (0..14).for_each(|_| drop(whole.update(&[&up])));
    // After an odd and an even number of updates.
    for updates in [7, 12] {
        let mut begun = learner(&config(), &[&down, &up], &[5, 3]);
        (0..updates).for_each(|_| drop(begun.update(&[&down, &up])));
        let saved = begun.checkpoint(1, [9; 32]);
        assert_eq!((saved.step, saved.config_digest), (updates, [9; 32]));
        let mut alone = learner(&config(), &[&up], &[3]);
        alone.restore(&[&saved]).unwrap();
        (updates..14).for_each(|_| drop(alone.update(&[&up])));
        let (whole, alone) = (whole.checkpoint(0, [9; 32]), alone.checkpoint(0, [9; 32]));
        assert!(alone == whole, "after {updates} updates");
    }
}

#[test]
fn every_number_of_an_update_is_told() {
    let dataset = dataset();
    let replay = replay(&dataset, true);
    let mut learner = learner(&config(), &[&replay], &[3]);
    for _ in 0..2 {
        let metrics = learner.update(&[&replay]).read().swap_remove(0);
        for name in ["reconstruction_loss", "preference_loss", "norm_loss"] {
            assert!(metrics[name].as_f64().is_some_and(f64::is_finite), "{name}");
        }
    }
}

#[test]
fn a_saved_state_of_another_learner_is_refused() {
    let dataset = dataset();
    let replay = replay(&dataset, true);
    let saved = learner(&config(), &[&replay], &[3]).checkpoint(0, [0; 32]);
    let other = OppoConfig {
        latent: 4,
        ..config()
    };
    let refused = learner(&other, &[&replay], &[3]).restore(&[&saved]);
    assert!(matches!(refused, Err(ForeignCheckpoint::Tensor { .. })));
    let later = Checkpoint {
        step: 1,
        ..saved.clone()
    };
    let refused = learner(&config(), &[&replay; 2], &[3, 4]).restore(&[&saved, &later]);
    assert!(matches!(refused, Err(ForeignCheckpoint::Lanes { .. })));
}

#[test]
fn a_dataset_without_a_clip_as_long_is_refused() {
    let config = OppoConfig {
        segment: 7,
        ..config()
    };
    assert!(Oppo::new(&config, &dataset(), Seed::root(0), Backend::Flex).is_err());
}
