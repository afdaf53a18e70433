//! Mean and interquartile mean of runs with an interval, as rliable has them (Agarwal et al. 2021, "Deep Reinforcement Learning
//! at the Edge of the Statistical Precipice").

use rand::{Rng, RngExt};

use crate::rng::Seed;

/// Resamples of an interval.
const RESAMPLES: usize = 2_000;
/// What lies outside an interval, half of it on each side.
const OUTSIDE: f64 = 0.05;
/// What an interquartile mean leaves out on each side.
const TRIMMED: f64 = 0.25;

/// A number, and how far chance may have moved it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Of the runs themselves.
    pub value: f64,
    /// Both ends of the 95 % interval; none where a task has a single run, which says nothing about chance.
    pub interval: Option<[f64; 2]>,
}

impl Estimate {
    /// A statistic of runs with its stratified bootstrap percentile interval: the seeds of each task are drawn again among
    /// themselves, with replacement, because the tasks are the benchmark and only the seeds are chance. None without a run.
    #[must_use]
    pub fn of(tasks: &[Vec<f64>], statistic: fn(&[Vec<f64>]) -> f64) -> Option<Self> {
        let tasks: Vec<Vec<f64>> = tasks
            .iter()
            .filter(|runs| !runs.is_empty())
            .cloned()
            .collect();
        if tasks.is_empty() {
            return None;
        }
        let several = tasks.iter().all(|runs| runs.len() > 1);
        Some(Self {
            value: statistic(&tasks),
            interval: several.then(|| interval(&tasks, statistic)),
        })
    }
}

/// What all but [`OUTSIDE`] of the resamples lie in.
fn interval(tasks: &[Vec<f64>], statistic: fn(&[Vec<f64>]) -> f64) -> [f64; 2] {
    let mut rng = Seed::root(0).child("study/answers/bootstrap").rng();
    let mut values: Vec<f64> = (0..RESAMPLES)
        .map(|_| statistic(&resampled(tasks, &mut rng)))
        .collect();
    values.sort_by(f64::total_cmp);
    [OUTSIDE / 2.0, 1.0 - OUTSIDE / 2.0].map(|share| quantile(&values, share))
}

/// The mean over the tasks of each one's mean: a task with fewer runs counts as much as another.
#[must_use]
pub fn mean(tasks: &[Vec<f64>]) -> f64 {
    let means: Vec<f64> = tasks.iter().map(|runs| average(runs)).collect();
    average(&means)
}

/// The mean of the middle half of all runs of all tasks: a quarter of them, rounded down, is left out on each side.
#[must_use]
pub fn interquartile_mean(tasks: &[Vec<f64>]) -> f64 {
    let mut runs = tasks.concat();
    runs.sort_by(f64::total_cmp);
    let cut = (TRIMMED * runs.len() as f64) as usize;
    average(&runs[cut..runs.len() - cut])
}

fn average(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

fn resampled(tasks: &[Vec<f64>], rng: &mut impl Rng) -> Vec<Vec<f64>> {
    let draw = |runs: &Vec<f64>| {
        let again = runs.iter().map(|_| runs[rng.random_range(0..runs.len())]);
        again.collect()
    };
    tasks.iter().map(draw).collect()
}

/// Of sorted values, with a straight line between neighbours, as NumPy's percentile.
fn quantile(sorted: &[f64], share: f64) -> f64 {
    let place = share * (sorted.len() - 1) as f64;
    let (below, above) = (place.floor() as usize, place.ceil() as usize);
    let weight = place - place.floor();
    sorted[below] + weight * (sorted[above] - sorted[below])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// As many runs of one task, of which these succeed.
    fn task(runs: usize, ones: usize) -> Vec<f64> {
        let values = (0..runs).map(|run| f64::from(u8::from(run < ones)));
        values.collect()
    }

    #[test]
    fn means_are_those_of_a_calculation_by_hand() {
        let tasks = [vec![0.0, 0.2, 0.4], vec![1.0]];
        // Of 0.2 and 1.0; of all four runs it would be 0.4.
        assert!((mean(&tasks) - 0.6).abs() < 1e-12);
        // 0.2 and 0.4 are in the middle.
        assert!((interquartile_mean(&tasks) - 0.3).abs() < 1e-12);
        // A quarter of six is one and a half: one is left out, as scipy's trim_mean does.
        let six = [vec![9.0, 1.0, 2.0], vec![3.0, 4.0, -7.0]];
        assert!((interquartile_mean(&six) - 2.5).abs() < 1e-12);
        assert_eq!(interquartile_mean(&[vec![5.0]]), 5.0);
    }

    #[test]
    fn a_quantile_lies_between_its_neighbours() {
        let sorted = [0.0, 10.0, 20.0, 30.0];
        assert_eq!(quantile(&sorted, 0.0), 0.0);
        assert_eq!(quantile(&sorted, 0.5), 15.0);
        // 0.975 of the way along three gaps is 2.925.
        assert!((quantile(&sorted, 0.975) - 29.25).abs() < 1e-9);
        assert_eq!(quantile(&[7.0], 0.975), 7.0);
    }

    #[test]
    fn the_interval_of_a_coin_is_the_binomial_one() {
        // Of 10 fair draws at most 1 is a one in 1.1 % of all cases, and at most 2 in 5.5 %.
        let coin = Estimate::of(&[task(10, 5)], mean).unwrap();
        let expected = Estimate {
            value: 0.5,
            interval: Some([0.2, 0.8]),
        };
        assert_eq!(coin, expected);
    }

    #[test]
    fn seeds_are_drawn_within_their_task_and_tasks_are_not_drawn() {
        // Over all twenty runs the interval would be that of a coin.
        let certain = Estimate::of(&[task(10, 0), task(10, 10)], mean).unwrap();
        assert_eq!((certain.value, certain.interval), (0.5, Some([0.5, 0.5])));
    }

    #[test]
    fn a_task_with_one_seed_leaves_no_interval() {
        let one_seed = Estimate::of(&[vec![0.3], vec![0.5, 0.7]], mean).unwrap();
        assert_eq!(one_seed.interval, None);
        assert!((one_seed.value - 0.45).abs() < 1e-12);
    }

    #[test]
    fn an_interval_is_the_same_every_time_and_of_no_runs_there_is_none() {
        let tasks = [vec![0.1, 0.9, 0.4], vec![0.2, 0.7, 0.3]];
        let one = Estimate::of(&tasks, interquartile_mean).unwrap();
        assert_eq!(Some(one), Estimate::of(&tasks, interquartile_mean));
        let [low, high] = one.interval.unwrap();
        assert!(low < one.value && one.value < high, "{one:?}");
        assert_eq!(Estimate::of(&[vec![], vec![]], mean), None);
    }
}
