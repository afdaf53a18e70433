//! Why rewards are mapped to [0, 1] first: a chain in which TED does the opposite of what it is for when they are not.
//!
//! From state 0 one step leads into a good region or into a poor one, and both go on for ever. Every reward is negative, as
//! with a cost. What a planner would do is found by value iteration with the transitions' own discounts, exactly.

use crate::dataset::{Dataset, EpisodeRecord, Shape};
use crate::reward::Labels;

use super::DiscountConfig;

/// State 0, then the good region, then the poor one.
const GOOD: usize = 1;
const POOR: usize = 2;
const STATES: usize = 3;

/// The poor region is poor, yet not the worst that was seen: one recording begins with a step that cost more.
const REWARD_GOOD: f64 = -0.5;
const REWARD_POOR: f64 = -0.9;
const REWARD_WORST: f64 = -1.0;

/// Seven recordings of the good region and three of the poor one, 20 steps each: k = 70 separates them.
fn dataset() -> Dataset {
    let episodes: Vec<_> = (0..10)
        .map(|index| {
            const STEPS: usize = 20;
            let (region, reward) = if index < 7 {
                (GOOD, REWARD_GOOD)
            } else {
                (POOR, REWARD_POOR)
            };
            let mut rewards = vec![reward; STEPS];
            if index == 9 {
                rewards[0] = REWARD_WORST;
            }
            EpisodeRecord {
                seed: None,
                observations: (0..=STEPS)
                    .map(|step| if step == 0 { 0.0 } else { region as f32 })
                    .collect(),
                actions: vec![if region == GOOD { 1.0 } else { -1.0 }; STEPS],
                rewards,
                terminations: vec![false; STEPS],
                truncations: (1..=STEPS).map(|step| step == STEPS).collect(),
                success: vec![false; STEPS],
                infos: vec![],
            }
        })
        .collect();
    let shape = Shape {
        observation: 1,
        action: 1,
    };
    Dataset::from_records("ted/chain-v0", shape, &episodes).unwrap()
}

/// What it is worth to enter each region, and to be in it.
#[derive(Debug)]
struct Values {
    enter_good: f64,
    enter_poor: f64,
    in_poor: f64,
}

/// Value iteration over the transitions of the dataset.
fn values(dataset: &Dataset, labels: &Labels, discount: &DiscountConfig) -> Values {
    let discounts = discount.apply(dataset, labels).unwrap().discounts;
    let state = |observation: &[f32]| observation[0] as usize;
    let mut v = [0.0; STATES];
    let worth = |step: usize, v: &[f64; STATES]| {
        let next = state(dataset.next_observation(step));
        f64::from(labels.rewards[step]) + f64::from(discounts[step]) * v[next]
    };
    let best = |v: &[f64; STATES], from: usize, to: Option<usize>| {
        (0..dataset.step_count())
            .filter(|&step| state(dataset.observation(step)) == from)
            .filter(|&step| to.is_none_or(|to| state(dataset.next_observation(step)) == to))
            .map(|step| worth(step, v))
            .fold(f64::NEG_INFINITY, f64::max)
    };
    // 0.99^5000 is below 1e-21: the values do not move any more.
    for _ in 0..5000 {
        v = [0, GOOD, POOR].map(|s| best(&v, s, None));
    }
    Values {
        enter_good: best(&v, 0, Some(GOOD)),
        enter_poor: best(&v, 0, Some(POOR)),
        in_poor: v[POOR],
    }
}

#[test]
fn with_negative_rewards_a_lower_discount_makes_the_poor_region_look_the_best() {
    let dataset = dataset();
    let labels = Labels::raw(&dataset, dataset.rewards_true().to_vec());
    let plain = values(&dataset, &labels, &DiscountConfig::CONSTANT);
    let ted = values(&dataset, &labels, &DiscountConfig::TED);
    assert!(plain.enter_good > plain.enter_poor, "{plain:?}");
    // -0.9 / (1 - 0.99) against -0.9 / (1 - 0.7 * 0.99): what should be avoided costs 31 times less.
    assert!((plain.in_poor + 90.0).abs() < 1e-3, "{plain:?}");
    assert!((ted.in_poor + 0.9 / 0.307).abs() < 1e-5, "{ted:?}");
    assert!(ted.enter_poor > ted.enter_good, "the inversion: {ted:?}");
}

#[test]
fn mapped_to_the_unit_interval_a_lower_discount_lowers_the_poor_region_and_nothing_else() {
    let dataset = dataset();
    let labels = Labels::unit(&dataset, dataset.rewards_true().to_vec());
    let plain = values(&dataset, &labels, &DiscountConfig::CONSTANT);
    let ted = values(&dataset, &labels, &DiscountConfig::TED);
    // The poor reward is mapped to 0.2: 0.2 / (1 - 0.99) and 0.2 / (1 - 0.7 * 0.99).
    assert!((plain.in_poor - 20.0).abs() < 1e-3, "{plain:?}");
    assert!((ted.in_poor - 0.2 / 0.307).abs() < 1e-5, "{ted:?}");
    assert!(plain.enter_good > plain.enter_poor, "{plain:?}");
    assert!(ted.enter_good - ted.enter_poor > plain.enter_good - plain.enter_poor);
    assert_eq!(ted.enter_good, plain.enter_good);
}
