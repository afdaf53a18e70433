//! Plans against arithmetic by hand and in double precision, and rewards that are what they are said to be.

use crate::dataset::fixtures::{SHAPE, records};
use crate::dataset::{Dataset, EpisodeRecord};
use crate::reward::InputScaling;
use crate::rng::Seed;
use rand::RngExt;

use super::sinkhorn::{Plan, plan};
use super::*;

fn random_costs(rows: usize, columns: usize, largest: f32) -> Vec<f32> {
    let mut rng = Seed::root(5).child("costs").rng();
    let draw = |_| largest * rng.random::<f32>();
    (0..rows * columns).map(draw).collect()
}

fn row_sums(plan: &Plan) -> Vec<f64> {
    let sum = |row: &[f32]| row.iter().map(|&p| f64::from(p)).sum();
    plan.mass.chunks_exact(plan.columns).map(sum).collect()
}

/// What the column sums are off in all.
fn column_error(plan: &Plan) -> f64 {
    let sum = |column: usize| -> f64 {
        let column = plan.mass.iter().skip(column).step_by(plan.columns);
        column.map(|&p| f64::from(p)).sum()
    };
    let wanted = 1.0 / plan.columns as f64;
    (0..plan.columns).map(|c| (sum(c) - wanted).abs()).sum()
}

/// Sinkhorn's algorithm in logarithms and double precision, from the same start.
fn reference(costs: &[f32], columns: usize, epsilon: f64, iterations: usize) -> Vec<f64> {
    let rows = costs.len() / columns;
    let cost = |i: usize, j: usize| f64::from(costs[i * columns + j]);
    let least = |values: Vec<f64>| values.into_iter().fold(f64::INFINITY, f64::min);
    // Minus epsilon times the logarithm of a sum of exponentials, plus that of the marginal.
    let soft = |values: Vec<f64>, others: usize| {
        let smallest = least(values.clone());
        let sum: f64 = values
            .iter()
            .map(|x| (-(x - smallest) / epsilon).exp())
            .sum();
        smallest - epsilon * sum.ln() - epsilon * (others as f64).ln()
    };
    let mut f: Vec<f64> = (0..rows)
        .map(|i| least((0..columns).map(|j| cost(i, j)).collect()))
        .collect();
    let mut g = vec![0.0; columns];
    for _ in 0..iterations {
        g = (0..columns)
            .map(|j| soft((0..rows).map(|i| cost(i, j) - f[i]).collect(), columns))
            .collect();
        f = (0..rows)
            .map(|i| soft((0..columns).map(|j| cost(i, j) - g[j]).collect(), rows))
            .collect();
    }
    (0..rows * columns)
        .map(|ij| {
            let (i, j) = (ij / columns, ij % columns);
            ((f[i] + g[j] - cost(i, j)) / epsilon).exp()
        })
        .collect()
}

#[test]
fn a_plan_between_two_steps_and_two_is_what_a_hand_computes() {
    // With row and column sums of 1/2 the plan is [[p, 1/2 - p], [1/2 - p, p]], and p / (1/2 - p) is
    // exp((C_12 + C_21 - C_11 - C_22) / (2 epsilon)).
    let (costs, epsilon) = ([0.1, 0.9, 0.7, 0.3], 0.8);
    let ratio = (1.2_f64 / 1.6).exp();
    let p = 0.5 * ratio / (1.0 + ratio);
    let plan = plan(&costs, 2, epsilon, 100);
    for (actual, expected) in plan.mass.iter().zip([p, 0.5 - p, 0.5 - p, p]) {
        assert!(
            (f64::from(*actual) - expected).abs() < 1e-6,
            "{:?}",
            plan.mass
        );
    }
    let first = 2.0 * (0.1 * p + 0.9 * (0.5 - p));
    assert!((plan.mean_costs(&costs).next().unwrap() - first).abs() < 1e-6);
}

#[test]
fn a_plan_is_that_of_logarithms_in_double_precision_after_each_number_of_iterations() {
    let (rows, columns) = (40, 57);
    let costs = random_costs(rows, columns, 2.0);
    // At 0.002 an exponential of the cost alone would be as small as exp(-1000).
    for epsilon in [0.5, 0.01, 0.002] {
        for iterations in [1, 3, 100] {
            let actual = plan(&costs, columns, epsilon, iterations as u32);
            let expected = reference(&costs, columns, f64::from(epsilon), iterations);
            // Entries in proportion to the mean one.
            let off = actual
                .mass
                .iter()
                .zip(&expected)
                .map(|(a, e)| (f64::from(*a) - e).abs());
            let off = off.fold(0.0, f64::max) * (rows * columns) as f64;
            assert!(
                off < 2e-4,
                "epsilon {epsilon}, {iterations} iterations: {off:e}"
            );
        }
    }
}

#[test]
fn rows_have_their_sums_after_any_iteration_and_columns_when_it_has_converged() {
    for (rows, columns, epsilon, iterations, columns_within) in [
        (60, 47, 0.01, 1, 0.5),
        (60, 47, 0.01, 100, 3e-3),
        (60, 47, 0.01, 5_000, 2e-6),
        (500, 500, 0.01, 100, 2e-6),
        (500, 500, 0.5, 100, 2e-6),
    ] {
        let costs = random_costs(rows, columns, 2.0);
        let plan = plan(&costs, columns, epsilon, iterations);
        let sums = row_sums(&plan).into_iter();
        let of_rows = sums.map(|sum| (sum * rows as f64 - 1.0).abs());
        let of_rows = of_rows.fold(0.0, f64::max);
        let of_columns = column_error(&plan);
        let case =
            format!("{rows} x {columns}, {epsilon}, {iterations}: {of_rows:e}, {of_columns:e}");
        assert!(of_rows < 1e-6, "{case}");
        assert!(of_columns < columns_within, "{case}");
    }
}

#[test]
fn a_plan_whose_scalings_leave_single_precision_is_still_found() {
    // The cheapest assignment is the one from corner to corner. The rows' favourite is the first column, and potentials have
    // to move by more than 50 epsilons to take it from them: exp(50) is far outside the limits.
    let costs = [0.0, 1.0, 3.0, 0.0, 2.0, 6.0, 0.0, 5.0, 10.0];
    for iterations in [20, 100, 1_000] {
        let actual = plan(&costs, 3, 0.01, iterations as u32).mass;
        let expected = reference(&costs, 3, 0.01, iterations);
        for (a, e) in actual.iter().zip(&expected) {
            let off = (f64::from(*a) - e).abs();
            assert!(off < 1e-5, "{iterations}: {actual:?}, {expected:?}");
        }
    }
    let mass = plan(&costs, 3, 0.01, 1_000).mass;
    let corner_to_corner: f32 = [mass[2], mass[4], mass[6]].iter().sum();
    assert!(corner_to_corner > 0.999, "{mass:?}");
}

/// Episodes that walk in the same way from different places, the later the further off; the first has the highest return.
fn walks(lengths: &[usize]) -> Vec<EpisodeRecord> {
    let mut records = records(lengths);
    for (index, record) in records.iter_mut().enumerate() {
        let rows = record.observations.chunks_exact_mut(SHAPE.observation);
        for (step, row) in rows.enumerate() {
            for (channel, x) in row.iter_mut().enumerate() {
                let phase = step as f32 * 0.3 + channel as f32;
                *x = 1.0 + 0.1 * *x + phase.sin() + 0.3 * index as f32 * (phase * 1.7).cos();
            }
        }
        record.rewards.fill(-(index as f64));
    }
    records
}

fn dataset(records: &[EpisodeRecord]) -> Dataset {
    Dataset::from_records("ted/x-v0", SHAPE, records).unwrap()
}

fn sums(dataset: &Dataset, rewards: &[f32]) -> Vec<f32> {
    let sum = |e: &Episode| rewards[e.first_step..e.first_step + e.len].iter().sum();
    dataset.episodes().iter().map(sum).collect()
}

fn one_expert() -> TransportConfig {
    TransportConfig {
        experts: 1,
        ..TransportConfig::default()
    }
}

#[test]
fn the_expert_s_own_episode_has_the_highest_reward() {
    let dataset = dataset(&walks(&[40; 6]));
    for (cost, scaling) in [
        (Cost::Cosine, InputScaling::Raw {}),
        (Cost::Cosine, InputScaling::Standard { floor: 0.05 }),
        (Cost::Euclidean, InputScaling::Raw {}),
    ] {
        let config = TransportConfig {
            cost,
            scaling,
            ..one_expert()
        };
        let sums = sums(
            &dataset,
            &transport_labels(&dataset, &config, Audience::Nobody).unwrap(),
        );
        let others = sums[1..].iter().copied().fold(f32::MIN, f32::max);
        assert!(sums[0] > others, "{cost:?}, {scaling:?}: {sums:?}");
        assert!(sums[0] <= 40.0 * 5.0);
    }
}

#[test]
fn a_reward_is_alpha_times_the_exponential_of_beta_times_the_mean_cost_of_a_channel() {
    let dataset = dataset(&walks(&[20, 30]));
    let config = TransportConfig {
        alpha: 3.0,
        beta: 2.0,
        ..one_expert()
    };
    let actual = transport_labels(&dataset, &config, Audience::Nobody).unwrap();
    let cosine = |a: &[f32], b: &[f32]| -> f64 {
        let dot = |a: &[f32], b: &[f32]| -> f64 {
            let terms = a.iter().zip(b);
            terms.map(|(&x, &y)| f64::from(x) * f64::from(y)).sum()
        };
        1.0 - dot(a, b) / (dot(a, a) * dot(b, b)).sqrt()
    };
    // The second episode's 30 steps against the first's 20.
    let costs: Vec<f32> = (20..50)
        .flat_map(|t| (0..20).map(move |j| (t, j)))
        .map(|(t, j)| cosine(dataset.observation(t), dataset.observation(j)) as f32)
        .collect();
    let plan = reference(&costs, 20, 0.01, 100);
    for t in 0..30 {
        let of_step = t * 20..(t + 1) * 20;
        let terms = plan[of_step.clone()].iter().zip(&costs[of_step]);
        let cost = 30.0 * terms.map(|(p, &c)| p * f64::from(c)).sum::<f64>();
        let expected = 3.0 * (-2.0 * cost / SHAPE.observation as f64).exp();
        assert!((f64::from(actual[20 + t]) - expected).abs() < 1e-5);
    }
}

#[test]
fn the_length_of_an_episode_does_not_matter_to_its_rewards() {
    let mut records = walks(&[12, 24]);
    // The second episode makes each step of the first twice.
    let width = SHAPE.observation;
    for step in 0..24 {
        let from = step / 2 * width..(step / 2 + 1) * width;
        let row = records[0].observations[from].to_vec();
        records[1].observations[step * width..(step + 1) * width].copy_from_slice(&row);
    }
    let rewards = transport_labels(&dataset(&records), &one_expert(), Audience::Nobody).unwrap();
    for step in 0..24 {
        assert!((rewards[12 + step] - rewards[step / 2]).abs() < 1e-5);
    }
}

#[test]
fn of_several_experts_the_one_counts_that_the_episode_is_closest_to() {
    let dataset = dataset(&walks(&[20; 5]));
    let labels = |experts| {
        let config = TransportConfig {
            experts,
            ..TransportConfig::default()
        };
        transport_labels(&dataset, &config, Audience::Nobody).unwrap()
    };
    let (one, three) = (labels(1), labels(3));
    let (of_one, of_three) = (sums(&dataset, &one), sums(&dataset, &three));
    assert_eq!(one[..20], three[..20], "the first expert is its own");
    assert!(of_three[1] > of_one[1] && of_three[2] > of_one[2]);
    assert!((3..5).all(|i| of_three[i] >= of_one[i]));
}

#[test]
fn the_number_of_threads_shows_in_no_reward() {
    let dataset = dataset(&walks(&[20, 31, 7, 16, 40]));
    let config = TransportConfig {
        experts: 2,
        ..TransportConfig::default()
    };
    let bits = |threads| -> Vec<u32> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let labels = pool
            .unwrap()
            .install(|| transport_labels(&dataset, &config, Audience::Nobody));
        labels.unwrap().iter().map(|r| r.to_bits()).collect()
    };
    assert_eq!(bits(1), bits(4));
}

#[test]
fn more_experts_than_episodes_and_none_are_refused_with_both_numbers() {
    let dataset = dataset(&walks(&[5, 5]));
    for experts in [0, 3] {
        let config = TransportConfig {
            experts,
            ..TransportConfig::default()
        };
        let refused = transport_labels(&dataset, &config, Audience::Nobody).unwrap_err();
        let episodes = 2;
        assert_eq!(refused, TransportError::Experts { experts, episodes });
    }
}

#[test]
fn a_cost_that_single_precision_cannot_hold_is_an_error_that_names_the_episode() {
    let mut records = walks(&[5, 5, 5]);
    records[2].observations.fill(1e30);
    let config = TransportConfig {
        cost: Cost::Euclidean,
        ..one_expert()
    };
    let refused = transport_labels(&dataset(&records), &config, Audience::Nobody).unwrap_err();
    assert_eq!(refused, TransportError::NotFinite { episode: 2 });
}
