//! The tables of the benchmark: each family's rows, and what they come to together.

use super::{AnswerScore, Estimate, Family, Method, Planned};
use crate::statistics::{interquartile_mean, mean};
use crate::study::run::RunScore;

/// The Markdown tables of each family that has a score, in the order of the plan.
#[must_use]
pub fn tables(planned: &[Planned], lines: &[AnswerScore]) -> String {
    let families = Family::ALL.into_iter().filter_map(|family| {
        let of_family = planned.iter().filter(|one| one.family == family);
        let runs: Vec<Shown<'_>> = of_family
            .map(|one| Shown {
                planned: one,
                score: one.score(lines),
            })
            .collect();
        let made = runs.iter().filter(|one| one.score.is_some()).count();
        let heading = || {
            format!(
                "**{}** (`{}`), {made} of {} runs\n\n{}\n\n{}",
                family.title(),
                family.name(),
                runs.len(),
                rows(&runs),
                aggregates(&runs)
            )
        };
        (made > 0).then(heading)
    });
    families.collect::<Vec<_>>().join("\n\n")
}

/// A run, and what it came to if it is finished.
struct Shown<'a> {
    planned: &'a Planned,
    score: Option<&'a RunScore>,
}

/// Mean score and mean success of each row and method.
fn rows(runs: &[Shown<'_>]) -> String {
    let methods = in_order(runs, |one| one.method);
    let mut head = vec!["logs and teacher", "task"];
    head.extend(methods.iter().map(|method| method.name()));
    let mut lines = vec![row(head.iter()), rule(2, methods.len())];
    for (variant, task) in in_order(runs, |one| (one.variant, one.task)) {
        let mut cells = vec![variant.to_owned(), task.to_owned()];
        cells.extend(methods.iter().map(|method| {
            let of_cell = |one: &&Shown<'_>| {
                (one.planned.variant, one.planned.task) == (variant, task)
                    && one.planned.method == *method
            };
            cell(&runs.iter().filter(of_cell).collect::<Vec<_>>())
        }));
        lines.push(row(cells.iter()));
    }
    lines.join("\n")
}

/// Score and success beside each other, with the number of seeds where some are still missing.
fn cell(runs: &[&Shown<'_>]) -> String {
    let made: Vec<&RunScore> = runs.iter().filter_map(|one| one.score).collect();
    let average = |values: Vec<f64>| values.iter().sum::<f64>() / values.len() as f64;
    let scores = made.iter().filter_map(|it| it.evaluation.score).collect();
    let successes = made.iter().map(|it| it.evaluation.success).collect();
    match (runs.len(), made.len()) {
        (0, _) => String::new(),
        (_, 0) => "-".to_owned(),
        (all, made) => {
            let seeds = match made == all {
                true => String::new(),
                false => format!(" ({made} of {all})"),
            };
            format!("{:.2} / {:.2}{seeds}", average(scores), average(successes))
        }
    }
}

/// What each variant comes to for each method, and all of them for a method that has something of every variant.
fn aggregates(runs: &[Shown<'_>]) -> String {
    let head = [
        "logs and teacher",
        "method",
        "runs",
        "mean score",
        "IQM",
        "success",
    ];
    let mut lines = vec![row(head.iter()), rule(2, 4)];
    let variants = in_order(runs, |one| one.variant);
    let has = |variant: &str, method: Method| {
        let of_variant = |one: &&Shown<'_>| one.planned.variant == variant;
        let mut runs = runs.iter().filter(of_variant);
        runs.any(|one| one.planned.method == method && one.score.is_some())
    };
    let mut add = |name: &str, method: Method, of: &dyn Fn(&Planned) -> bool| {
        let of_method = |one: &&Shown<'_>| one.planned.method == method && of(one.planned);
        let of_method: Vec<&Shown<'_>> = runs.iter().filter(of_method).collect();
        let strata = |value: fn(&RunScore) -> Option<f64>| {
            let tasks = in_order_of(&of_method, |one| (one.variant, one.task));
            let of_task = |task| {
                let runs = of_method.iter();
                let runs = runs.filter(|one| (one.planned.variant, one.planned.task) == task);
                runs.filter_map(|one| value(one.score?)).collect()
            };
            tasks.into_iter().map(of_task).collect::<Vec<Vec<f64>>>()
        };
        let scores = strata(|it| it.evaluation.score);
        let successes = strata(|it| Some(it.evaluation.success));
        let made = of_method.iter().filter(|one| one.score.is_some()).count();
        if made > 0 {
            let cells = [
                name.to_owned(),
                method.name().to_owned(),
                made.to_string(),
                estimate(Estimate::of(&scores, mean)),
                estimate(Estimate::of(&scores, interquartile_mean)),
                estimate(Estimate::of(&successes, mean)),
            ];
            lines.push(row(cells.iter()));
        }
    };
    for variant in &variants {
        for method in Method::ALL {
            add(variant, method, &|one| one.variant == *variant);
        }
    }
    if variants.len() > 1 {
        for method in Method::ALL {
            if variants.iter().all(|variant| has(variant, method)) {
                add("all of these", method, &|_| true);
            }
        }
    }
    lines.join("\n")
}

fn estimate(it: Option<Estimate>) -> String {
    let text = |it: Estimate| match it.interval {
        Some([low, high]) => format!("{:.2} [{low:.2}, {high:.2}]", it.value),
        None => format!("{:.2}", it.value),
    };
    it.map_or_else(|| "-".to_owned(), text)
}

/// What these runs have, each once, in the order in which it comes first; methods in that of the columns.
fn in_order<K: PartialEq>(runs: &[Shown<'_>], key: impl Fn(&Planned) -> K) -> Vec<K> {
    in_order_of(&runs.iter().collect::<Vec<_>>(), key)
}

fn in_order_of<K: PartialEq>(runs: &[&Shown<'_>], key: impl Fn(&Planned) -> K) -> Vec<K> {
    let mut keys = Vec::new();
    for one in runs {
        let key = key(one.planned);
        if !keys.contains(&key) {
            keys.push(key);
        }
    }
    keys
}

fn row(cells: impl Iterator<Item = impl AsRef<str>>) -> String {
    let cells: Vec<String> = cells.map(|cell| cell.as_ref().to_owned()).collect();
    format!("| {} |", cells.join(" | "))
}

fn rule(words: usize, numbers: usize) -> String {
    format!("|{}{}", "---|".repeat(words), "---:|".repeat(numbers))
}
