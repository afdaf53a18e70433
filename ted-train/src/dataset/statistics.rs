//! Per-dimension statistics of the observations: what the networks are standardised with.

/// Statistics of every observation dimension, accumulated in double precision.
#[derive(Clone, Debug, PartialEq)]
pub struct ObservationStatistics {
    /// Arithmetic mean.
    pub mean: Vec<f32>,
    /// Population standard deviation.
    pub std: Vec<f32>,
    /// Smallest value.
    pub min: Vec<f32>,
    /// Largest value.
    pub max: Vec<f32>,
    /// The smallest deviation that is more than rest: the declared resolution, or a share of the channel itself, so that a unit a
    /// thousand times larger changes nothing. Always above 0.
    pub floor: Vec<f32>,
}

/// The floor that constants which ask for a multiple of it are written for.
const REFERENCE: f32 = 1e-3;

/// Share of its range that a channel without a declared resolution has as floor ...
const OF_RANGE: f32 = 1e-3;

/// ... and share of its largest value, of which single precision tells some ten apart.
const OF_VALUE: f32 = 1e-6;

/// The floor of a channel that is 0 throughout: it has no unit to go by.
const OF_NOTHING: f32 = 1.0;

impl ObservationStatistics {
    /// Two passes in row order, so that the result does not depend on the number of threads. `resolution` is what is declared of a
    /// channel.
    pub(super) fn of(
        observations: &[f32],
        width: usize,
        resolution: impl Fn(usize) -> Option<f32>,
    ) -> Self {
        let rows = (observations.len() / width) as f64;
        let mut sum = vec![0.0; width];
        let mut min = vec![f32::INFINITY; width];
        let mut max = vec![f32::NEG_INFINITY; width];
        for row in observations.chunks_exact(width) {
            for (column, &value) in row.iter().enumerate() {
                sum[column] += f64::from(value);
                min[column] = min[column].min(value);
                max[column] = max[column].max(value);
            }
        }
        let mean: Vec<f64> = sum.iter().map(|sum| sum / rows).collect();
        let mut squares = vec![0.0; width];
        for row in observations.chunks_exact(width) {
            for (column, &value) in row.iter().enumerate() {
                let deviation = f64::from(value) - mean[column];
                squares[column] += deviation * deviation;
            }
        }
        let floor = |column| {
            let (low, high): (f32, f32) = (min[column], max[column]);
            resolution(column).unwrap_or_else(|| relative_floor(low, high))
        };
        Self {
            floor: (0..width).map(floor).collect(),
            mean: mean.iter().map(|&mean| mean as f32).collect(),
            std: squares
                .iter()
                .map(|squares| (squares / rows).sqrt() as f32)
                .collect(),
            min,
            max,
        }
    }

    /// For each channel, `floor` as far as its own floor is 0.001, and in proportion where that is another one.
    pub fn at_least(&self, floor: f32) -> impl Iterator<Item = f32> {
        self.floor.iter().map(move |own| floor * (own / REFERENCE))
    }
}

/// The floor of a channel of which nothing is declared.
fn relative_floor(low: f32, high: f32) -> f32 {
    // Each end by itself: their difference may be too large for single precision.
    let of_range = OF_RANGE * high - OF_RANGE * low;
    let floor = of_range.max(OF_VALUE * low.abs().max(high.abs()));
    if floor > 0.0 { floor } else { OF_NOTHING }
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNDECLARED: fn(usize) -> Option<f32> = |_| None;

    #[test]
    fn statistics_are_those_of_the_columns() {
        let statistics =
            ObservationStatistics::of(&[1.0, -2.0, 3.0, -2.0, 5.0, -2.0], 2, UNDECLARED);
        assert_eq!(statistics.mean, [3.0, -2.0]);
        assert_eq!(statistics.std, [(8.0_f64 / 3.0).sqrt() as f32, 0.0]);
        assert_eq!(
            (&statistics.min, &statistics.max),
            (&vec![1.0, -2.0], &vec![5.0, -2.0])
        );
    }

    #[test]
    fn a_floor_is_what_is_declared_or_a_share_of_the_channel_or_one() {
        // Moves, rests away from 0, rests at 0.
        let observations = [0.0, -2.0, 0.0, 4.0, -2.0, 0.0];
        let floor = |resolution: fn(usize) -> Option<f32>| {
            ObservationStatistics::of(&observations, 3, resolution).floor
        };
        assert_eq!(floor(UNDECLARED), [4e-3, 2e-6, 1.0]);
        assert_eq!(
            floor(|channel| (channel == 1).then_some(0.5)),
            [4e-3, 0.5, 1.0]
        );
        let declared = ObservationStatistics::of(&observations, 3, |_| Some(1e-3));
        let floors: Vec<f32> = declared.at_least(0.05).collect();
        assert_eq!(floors, [0.05; 3], "to the bit");
    }
}
