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
}

impl ObservationStatistics {
    /// Two passes in row order, so that the result does not depend on the number of threads.
    pub(super) fn of(observations: &[f32], width: usize) -> Self {
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
        Self {
            mean: mean.iter().map(|&mean| mean as f32).collect(),
            std: squares
                .iter()
                .map(|squares| (squares / rows).sqrt() as f32)
                .collect(),
            min,
            max,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn statistics_are_those_of_the_columns() {
        let statistics = ObservationStatistics::of(&[1.0, -2.0, 3.0, -2.0, 5.0, -2.0], 2);
        assert_eq!(statistics.mean, [3.0, -2.0]);
        assert_eq!(statistics.std, [(8.0_f64 / 3.0).sqrt() as f32, 0.0]);
        assert_eq!(
            (statistics.min, statistics.max),
            (vec![1.0, -2.0], vec![5.0, -2.0])
        );
    }
}
