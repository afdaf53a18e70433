//! The table that a study of policies prints.

use std::collections::BTreeMap;

use crate::reward::quality::RewardQuality;

use super::grid::Grid;
use super::run::RunScore;

/// What the columns are.
const HEAD: [&str; 13] = [
    "task",
    "preset",
    "seeds",
    "return",
    "normalised score",
    "each seed",
    "success",
    "the paper's score",
    "minutes",
    "Spearman",
    "low third",
    "high third",
    "transition Pearson",
];

/// A row for each task and preset, mean and sample standard deviation over seeds.
#[must_use]
pub fn table(scores: &[RunScore]) -> Grid {
    let mut groups: BTreeMap<(&str, &str), Vec<&RunScore>> = BTreeMap::new();
    for score in scores {
        groups
            .entry((&score.dataset, score.config.preset.name()))
            .or_default()
            .push(score);
    }
    let mut rows = Vec::new();
    for ((dataset, preset), group) in groups {
        let column = |digits: usize, value: &dyn Fn(&RunScore) -> f64| {
            let values: Vec<_> = group.iter().map(|s| value(s)).collect();
            super::spread(&values, |value| format!("{value:.digits$}"))
        };
        let each: Vec<String> = group
            .iter()
            .map(|s| format!("{:.3}", s.evaluation.score.unwrap_or(f64::NAN)))
            .collect();
        let quality = |value: fn(&RewardQuality) -> f64| {
            if group.iter().any(|s| s.quality.is_none()) {
                return "-".to_owned();
            }
            column(2, &|s| s.quality.as_ref().map_or(f64::NAN, value))
        };
        rows.push(vec![
            dataset.to_owned(),
            preset.to_owned(),
            group.len().to_string(),
            column(0, &|s| s.evaluation.return_mean),
            column(3, &|s| s.evaluation.score.unwrap_or(f64::NAN)),
            each.join(", "),
            column(2, &|s| s.evaluation.success),
            paper_score(group[0]),
            minutes(&group),
            quality(|it| it.spearman),
            quality(|it| it.spearman_low_third),
            quality(|it| it.spearman_high_third),
            quality(|it| it.transition_pearson),
        ]);
    }
    Grid {
        head: HEAD.map(str::to_owned).to_vec(),
        words: HEAD.len(),
        rows,
    }
}

fn paper_score(of: &RunScore) -> String {
    let by = |name: &str| super::paper::score(name, of.config.preset);
    let known = by(&of.evaluation.task).or_else(|| by(&of.dataset));
    known.map_or_else(
        || "-".to_owned(),
        |[mean, spread]| format!("{mean:.2} ± {spread:.2}"),
    )
}

/// Mean wall time of those whose time is known.
fn minutes(group: &[&RunScore]) -> String {
    let known: Vec<f64> = group.iter().filter_map(|score| score.minutes).collect();
    match known.len() {
        0 => "-".to_owned(),
        count => format!("{:.1}", known.iter().sum::<f64>() / count as f64),
    }
}
