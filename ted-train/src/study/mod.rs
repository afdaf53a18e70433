//! Studies: the measurements behind the defaults, each a command that prints the table in the docs.

pub mod answers;
pub mod cells;
pub mod d4rl;
pub mod fill;
pub mod grid;
pub mod paper;
pub mod policies;
pub mod reward;
pub mod run;
pub mod slurm;
pub mod table;

/// Mean and sample standard deviation of the seeds, each number as `text` writes it; one seed has no deviation.
fn spread(values: &[f64], text: impl Fn(f64) -> String) -> String {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    if values.len() < 2 {
        return text(mean);
    }
    let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0);
    format!(
        "{} ± {}",
        text(mean),
        text(variance.sqrt()).trim_start_matches('+')
    )
}

#[cfg(test)]
mod tests {
    #[test]
    fn a_spread_is_mean_and_sample_deviation_and_one_seed_has_none() {
        let text = |value: f64| format!("{value:+.2}");
        assert_eq!(super::spread(&[1.0, 2.0, 3.0], text), "+2.00 ± 1.00");
        assert_eq!(super::spread(&[-1.5], text), "-1.50");
    }
}
