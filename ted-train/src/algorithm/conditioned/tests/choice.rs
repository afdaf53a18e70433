//! What it learns from a log whose episodes are good or bad, and from one in which none is better.

use crate::dataset::Dataset;
use crate::dataset::fixtures::{SHAPE, records};
use crate::filter::{FilterConfig, Kept};

use super::*;
use crate::algorithm::{AlgorithmConfig, Conditions, Policy, Replay};

/// What the good and the bad episodes of the log do; the log's average is halfway where half of its episodes are good.
fn good(s: &[f32]) -> Vec<f64> {
    let s = f64::from(s[0]);
    vec![0.6 * s, 0.5, -0.4, 0.0]
}

fn bad(s: &[f32]) -> Vec<f64> {
    let s = f64::from(s[0]);
    vec![-0.2 * s, -0.1, -0.4, 0.3]
}

const EPISODES: usize = 20;
const STEPS: usize = 40;

/// Every second episode is good, and the one after it saw the same and was bad: nothing but the return tells them apart.
fn log() -> Dataset {
    let mut records = records(&[STEPS; EPISODES]);
    for index in 0..EPISODES {
        records[index].observations = records[index / 2 * 2].observations.clone();
        let record = &mut records[index];
        let act = if index % 2 == 0 { good } else { bad };
        let observed = record.observations.chunks(SHAPE.observation);
        let actions = observed.take(STEPS).flat_map(act).map(|a| a as f32);
        record.actions = actions.collect();
    }
    Dataset::from_records("ted/x-v0", SHAPE, &records).unwrap()
}

/// The policy learned from returns of 3 for good episodes and 1 for bad ones, or as given, flown at `aim * advance`, on
/// observations of its log, and these.
fn flown(returns_hat: &[f32], aim: f64, advance: f32) -> (Vec<f32>, Vec<Vec<f32>>) {
    let dataset = log();
    let config = AlgorithmConfig::Conditioned(ConditionedConfig {
        steps: 1500,
        batch: 64,
        hidden: vec![32],
        learning_rate: 5e-3,
        best: 5,
        aim,
        haste: 1.0,
        ..ConditionedConfig::default()
    });
    let kept = Kept::all(&dataset);
    let conditions = config.conditions(&dataset, &kept, returns_hat).unwrap();
    let nothing = vec![0.0; dataset.step_count()];
    let replay =
        Replay::new(&dataset, nothing.clone(), nothing).conditioned(conditions.advanced(advance));
    let mut learner = config.learner(&[&replay], &[Seed::root(1)], Backend::Fused);
    (0..config.steps()).for_each(|_| drop(learner.update(&[&replay])));
    let Policy::Mlp(actor) = learner.policies().remove(0) else {
        panic!("a network flies");
    };
    // Of the first episode; after its last step there is an observation that nobody acted on.
    let rows = STEPS;
    let s = tensor(
        &replay.standardised(0..rows),
        [1, rows, SHAPE.observation],
        Backend::Fused,
    );
    let acted = values(Mlp::from_exported(&actor, Backend::Fused).forward(s));
    let raw = (0..rows).map(|step| dataset.observation(step).to_vec());
    (acted, raw.collect())
}

fn returns() -> Vec<f32> {
    (0..EPISODES)
        .map(|i| if i % 2 == 0 { 3.0 } else { 1.0 })
        .collect()
}

/// The average is 0.15 and 0.3 from the good ones in two of the actions, wherever it is.
const CLOSE: f64 = 0.05;

#[test]
fn flown_at_one_it_acts_as_the_good_episodes_and_at_zero_as_the_average() {
    let (acted, observed) = flown(&returns(), 1.0, 1.0);
    let expected: Vec<f64> = observed.iter().flat_map(|s| good(s)).collect();
    assert_close(&acted, &expected, CLOSE, "at 1");
    let average = |s: &Vec<f32>| -> Vec<f64> {
        let both = good(s).into_iter().zip(bad(s));
        both.map(|(good, bad)| (good + bad) / 2.0).collect()
    };
    let expected: Vec<f64> = observed.iter().flat_map(average).collect();
    let aimed = flown(&returns(), 0.0, 1.0).0;
    assert_close(&aimed, &expected, CLOSE, "at 0");
    // A reward that is not trusted is not flown by, whatever the aim.
    let distrusted = flown(&returns(), 1.0, 0.0).0;
    assert_eq!(bits(&distrusted), bits(&aimed));
}

#[test]
fn without_a_better_episode_it_is_plain_cloning_wherever_it_aims() {
    let (acted, observed) = flown(&[2.5; EPISODES], 1.0, 1.0);
    let halfway = |s: &Vec<f32>| good(s).into_iter().zip(bad(s));
    let expected: Vec<f64> = observed
        .iter()
        .flat_map(|s| {
            halfway(s)
                .map(|(good, bad)| (good + bad) / 2.0)
                .collect::<Vec<_>>()
        })
        .collect();
    // Gain and h have learned nothing, so only where nothing is added of it is there the average.
    let cloned = flown(&[2.5; EPISODES], 0.0, 1.0).0;
    assert_close(&cloned, &expected, CLOSE, "cloned");
    assert_eq!(bits(&acted), bits(&cloned));
}

#[test]
fn a_condition_is_the_way_from_the_average_of_the_kept_episodes_to_the_best() {
    let dataset = Dataset::from_records("ted/x-v0", SHAPE, &records(&[2, 3, 2, 2])).unwrap();
    let of = |returns: &[f32], kept: &Kept, best| {
        let conditions = Conditions::new(&dataset, kept, returns, best);
        let steps = (0..9).map(|step| conditions.of(step).unwrap());
        (steps.collect::<Vec<_>>(), conditions.are_equal())
    };
    let every = Kept::all(&dataset);
    // Mean 4, of the best two 7: 0 is 4 and 1 is 7.
    let returns = [1.0, 8.0, 6.0, 1.0];
    let (down, up, right) = (-1.0, 4.0 / 3.0, 2.0 / 3.0);
    let expected = [down, down, up, up, up, right, right, down, down].map(|c: f64| c as f32);
    assert_eq!(of(&returns, &every, 2), (expected.to_vec(), false));

    // Of the best three episodes, by prediction, the mean is 5 and the best is 8.
    let best_three = FilterConfig::TopPredicted { k: 75.0 };
    let kept = best_three.kept(&dataset, &returns).unwrap();
    let (conditions, _) = of(&returns, &kept, 1);
    assert_eq!(conditions[2], 1.0);
    assert_eq!(conditions[5], (1.0f64 / 3.0) as f32);
}

#[test]
fn nothing_to_choose_from_is_a_condition_of_zero_and_never_not_a_number() {
    let dataset = Dataset::from_records("ted/x-v0", SHAPE, &records(&[2, 3, 2])).unwrap();
    let every = Kept::all(&dataset);
    for (returns, best) in [
        ([0.0; 3], 1),
        // Sums whose mean is not the number itself.
        ([0.1; 3], 2),
        ([f32::MAX; 3], 1),
        ([f32::NAN, 1.0, 2.0], 1),
        // All are the best.
        ([1.0, 2.0, 3.0], 3),
        ([1.0, 2.0, 3.0], 10),
    ] {
        let conditions = Conditions::new(&dataset, &every, &returns, best);
        assert!(conditions.are_equal(), "{returns:?}");
        assert!((0..7).all(|step| conditions.of(step) == Some(0.0)));
    }
}

#[test]
fn a_policy_flies_at_a_share_of_its_aim_and_at_all_of_it_if_nobody_says_another() {
    let dataset = Dataset::from_records("ted/x-v0", SHAPE, &records(&[2, 3])).unwrap();
    let of = |returns: [f32; 2]| Conditions::new(&dataset, &Kept::all(&dataset), &returns, 1);
    let (choice, none) = (of([1.0, 2.0]), of([1.0, 1.0]));
    assert_eq!(choice.advance(), 1.0);
    for (said, flown) in [
        (0.3, 0.3),
        (1.0, 1.0),
        (7.0, 1.0),
        (-1.0, 0.0),
        (f32::NAN, 0.0),
    ] {
        assert_eq!(choice.clone().advanced(said).advance(), flown);
        assert_eq!(none.clone().advanced(said).advance(), 0.0);
    }
}
