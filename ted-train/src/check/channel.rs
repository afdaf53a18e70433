//! What a channel does, what the networks see of it, and what a guard will accept.

use rayon::prelude::*;
use serde::Serialize;
use ted_policy::Contract;

use crate::dataset::{Dataset, ObservationStatistics};

/// How a channel moves, whatever it is one of.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Moves {
    /// Smallest value.
    pub low: f32,
    /// Largest value.
    pub high: f32,
    /// Smallest change from one step to the next that is one; none of a channel that rests.
    pub resolution: Option<f32>,
    /// Share of the steps from one to the next that change nothing.
    pub constant: f64,
    /// Share of the values at either end of the range, for longer than a moment; 0 of a channel that rests.
    pub saturated: f64,
    /// The range of all but the lowest and the highest thousandth of the values.
    pub bulk: [f32; 2],
}

/// What decides a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Decides {
    /// How the channel varies.
    Deviation,
    /// Its floor, because it hardly varies: the declared resolution, or a share of the channel.
    Floor,
    /// Less than two values in a thousand, which are far from all others.
    Outliers,
    /// What the robot declares that the channel can read at all.
    Declared,
}

impl Decides {
    /// In a word.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Deviation => "deviation",
            Self::Floor => "floor",
            Self::Outliers => "outliers",
            Self::Declared => "declared",
        }
    }
}

/// A channel of an observation.
#[derive(Clone, Debug, Serialize)]
pub struct ObservationCheck {
    /// Its name.
    pub name: String,
    /// Its unit; empty where nobody declared one.
    pub unit: String,
    /// How it moves, without glitches.
    #[serde(flatten)]
    pub moves: Moves,
    /// Values that nothing is learned from.
    pub glitches: usize,
    /// What the networks have subtracted first.
    pub shift: f32,
    /// What they have it divided by then.
    pub divisor: f32,
    /// What decides that.
    pub divisor_by: Decides,
    /// What a guard will accept; none where no controller can fly on this dataset.
    pub guard: Option<[f32; 2]>,
    /// What decides that.
    pub guard_by: Decides,
}

/// A channel of an action.
#[derive(Clone, Debug, Serialize)]
pub struct ActionCheck {
    /// Its name.
    pub name: String,
    /// Its unit; empty where nobody declared one.
    pub unit: String,
    /// How it moves.
    #[serde(flatten)]
    pub moves: Moves,
}

/// Share of the values at each end that are not its bulk.
const TAIL: f64 = 1e-3;

/// So many times as wide as its bulk, the range of a channel is that of its outliers.
const OUTLYING: f32 = 5.0;

/// All channels of observations and actions.
pub(super) fn channels(
    dataset: &Dataset,
    statistics: &ObservationStatistics,
    contract: Option<&Contract<'_>>,
) -> (Vec<ObservationCheck>, Vec<ActionCheck>) {
    let (width, actions) = (dataset.observation_dim(), dataset.action_dim());
    let lengths = |more: usize| {
        let lengths = dataset.episodes().iter().map(move |it| it.len + more);
        lengths.collect::<Vec<_>>()
    };
    let (rows, steps) = (lengths(1), lengths(0));
    let robot = dataset.robot();
    let observed = robot.observation.par_iter().enumerate();
    let observed = observed.map(|(channel, sensor)| {
        let guard = contract.and_then(|it| it.observation.get(channel));
        let guard = guard.map(|it| [it.low, it.high]);
        let moves = Moves::of(dataset.observations(), width, channel, &rows);
        let (std, floor) = (statistics.std[channel], statistics.floor[channel]);
        let varies = match moves.outlying() {
            true => Decides::Outliers,
            false => Decides::Deviation,
        };
        let ends = guard.zip(sensor.range);
        let cut = ends.is_some_and(|(guard, range)| guard[0] == range[0] || guard[1] == range[1]);
        let own = dataset.glitches().iter().filter(|it| it.channel == channel);
        ObservationCheck {
            name: sensor.name.clone(),
            unit: sensor.unit.clone(),
            glitches: own.count(),
            shift: statistics.mean[channel],
            divisor: std + floor,
            divisor_by: if std > floor { varies } else { Decides::Floor },
            guard,
            guard_by: match moves.resolution {
                _ if cut => Decides::Declared,
                Some(_) => varies,
                None => Decides::Floor,
            },
            moves,
        }
    });
    let acted = robot.action.iter().enumerate();
    let acted = acted.map(|(channel, actuator)| ActionCheck {
        name: actuator.name.clone(),
        unit: actuator.unit.clone(),
        moves: Moves::of(dataset.actions_env(), actions, channel, &steps),
    });
    (observed.collect(), acted.collect())
}

impl Moves {
    /// Of a column of row-major values, whose episodes have so many rows each.
    fn of(values: &[f32], width: usize, channel: usize, rows: &[usize]) -> Self {
        let column: Vec<f32> = values
            .iter()
            .skip(channel)
            .step_by(width)
            .copied()
            .collect();
        let low = column.iter().copied().fold(f32::INFINITY, f32::min);
        let high = column.iter().copied().fold(f32::NEG_INFINITY, f32::max);
        let at_an_end = |x: &f32| *x == low || *x == high;
        let (mut still, mut moments, mut saturated) = (0, 0, 0);
        let mut resolution: Option<f32> = None;
        let mut rest = column.as_slice();
        for &rows in rows {
            let (episode, after) = rest.split_at(rows);
            rest = after;
            for pair in episode.windows(2) {
                let change = (pair[1] - pair[0]).abs();
                moments += 1;
                match change == 0.0 {
                    true => still += 1,
                    false => resolution = Some(resolution.map_or(change, |it| it.min(change))),
                }
            }
            let runs = episode.chunk_by(|a, b| a == b);
            let ends = runs.filter(|run| run.len() > 1 && run.iter().all(at_an_end));
            saturated += ends.map(<[f32]>::len).sum::<usize>();
        }
        let share = |part: usize, of: usize| part as f64 / of.max(1) as f64;
        Self {
            low,
            high,
            resolution,
            constant: share(still, moments),
            saturated: match resolution {
                Some(_) => share(saturated, column.len()),
                None => 0.0,
            },
            bulk: bulk(column),
        }
    }

    /// Whether a few values are so far from all others that they decide the range.
    pub(super) fn outlying(&self) -> bool {
        let [low, high] = self.bulk;
        // A channel that hardly ever moves has no bulk to be far from.
        high > low && self.high - self.low > OUTLYING * (high - low)
    }
}

/// The range of all but the lowest and the highest thousandth.
fn bulk(mut column: Vec<f32>) -> [f32; 2] {
    let last = column.len() - 1;
    let tail = (last as f64 * TAIL) as usize;
    [tail, last - tail].map(|place| {
        let (_, value, _) = column.select_nth_unstable_by(place, f32::total_cmp);
        *value
    })
}
