//! The cost of carrying every observation of an episode to every one of an expert.

use pulp::Arch;

use crate::dataset::{Dataset, Episode};

use super::config::{Cost, TransportConfig};

/// The map from observations to the points between which the cost is a distance.
pub(super) struct Metric {
    cost: Cost,
    shift: Vec<f32>,
    scale: Vec<f32>,
}

/// An episode that others are compared with.
pub(super) struct Expert {
    /// Its steps.
    pub len: usize,
    /// Its points, one row for each channel, so that a loop over steps is a loop over neighbours in memory.
    channels: Vec<f32>,
}

impl Metric {
    pub fn new(dataset: &Dataset, config: &TransportConfig) -> Self {
        let statistics = dataset.observation_statistics();
        let [shift, scale] = config.scaling.shift_and_scale(&statistics);
        Self {
            cost: config.cost,
            shift,
            scale,
        }
    }

    /// The points of an episode's steps, row by row: scaled observations, for the cosine of length 1.
    pub fn points(&self, dataset: &Dataset, episode: &Episode) -> Vec<f32> {
        let mut points = Vec::with_capacity(episode.len * self.shift.len());
        for step in episode.first_step..episode.first_step + episode.len {
            let start = points.len();
            let raw = dataset.observation(step).iter();
            let channels = raw.zip(&self.shift).zip(&self.scale);
            points.extend(channels.map(|((x, shift), scale)| (x - shift) * scale));
            if self.cost == Cost::Cosine {
                normalise(&mut points[start..]);
            }
        }
        points
    }

    pub fn expert(&self, dataset: &Dataset, episode: &Episode) -> Expert {
        let points = self.points(dataset, episode);
        let width = self.shift.len();
        let channel = |c| points.iter().skip(c).step_by(width).copied();
        Expert {
            len: episode.len,
            channels: (0..width).flat_map(channel).collect(),
        }
    }

    /// Costs from each point, one row each, to each step of the expert.
    ///
    /// `1 - cos` of two vectors is half the squared distance of their directions, which is exactly 0 between equal ones.
    pub fn costs(&self, points: &[f32], expert: &Expert) -> Vec<f32> {
        let width = self.shift.len();
        let mut costs = vec![0.0; points.len() / width * expert.len];
        Arch::new().dispatch(|| {
            let rows = costs.chunks_exact_mut(expert.len);
            for (row, point) in rows.zip(points.chunks_exact(width)) {
                squared_distances(point, expert, row);
                match self.cost {
                    Cost::Cosine => row.iter_mut().for_each(|cost| *cost *= 0.5),
                    Cost::Euclidean => row.iter_mut().for_each(|cost| *cost = cost.sqrt()),
                }
            }
        });
        costs
    }
}

/// One chain of additions for each cost, in the order of the channels: the same bits on every machine.
#[inline(always)]
fn squared_distances(point: &[f32], expert: &Expert, out: &mut [f32]) {
    for (x, channel) in point.iter().zip(expert.channels.chunks_exact(out.len())) {
        for (sum, y) in out.iter_mut().zip(channel) {
            let difference = x - y;
            *sum += difference * difference;
        }
    }
}

/// Scales a vector to length 1; one of zeros has no direction and stays what it is.
fn normalise(point: &mut [f32]) {
    let square: f64 = point.iter().map(|&x| f64::from(x) * f64::from(x)).sum();
    if square > 0.0 {
        let scale = 1.0 / square.sqrt();
        point
            .iter_mut()
            .for_each(|x| *x = (f64::from(*x) * scale) as f32);
    }
}
