//! The tables of the benchmark: each family's rows, and what they come to together.

use super::{AnswerScore, Estimate, Family, Method, Planned};
use crate::statistics::{interquartile_mean, mean};
use crate::study::grid::Grid;
use crate::study::run::RunScore;

/// What is known of a family.
#[derive(Clone, Debug, PartialEq)]
pub struct Section {
    /// Which one.
    pub family: Family,
    /// Finished runs, and how many there will be.
    pub runs: [usize; 2],
    /// Mean score and mean success of each row and method.
    pub rows: Grid,
    /// What they come to together.
    pub aggregates: Vec<Aggregate>,
}

/// What the runs of a method come to.
#[derive(Clone, Debug, PartialEq)]
pub struct Aggregate {
    /// On which logs and with which teacher.
    pub variant: &'static str,
    /// The method.
    pub method: Method,
    /// Finished runs.
    pub runs: usize,
    /// Mean score over the tasks.
    pub score: Option<Estimate>,
    /// The mean of the middle half of the runs.
    pub iqm: Option<Estimate>,
    /// Mean success over the tasks.
    pub success: Option<Estimate>,
}

/// Each family that has a score, in the order of the plan.
#[must_use]
pub fn sections(planned: &[Planned], lines: &[AnswerScore]) -> Vec<Section> {
    let section = |family: Family| {
        let of_family = planned.iter().filter(|one| one.family == family);
        let runs: Vec<Shown<'_>> = of_family
            .map(|one| Shown {
                planned: one,
                score: one.score(lines),
            })
            .collect();
        let made = runs.iter().filter(|one| one.score.is_some()).count();
        (made > 0).then(|| Section {
            family,
            runs: [made, runs.len()],
            rows: rows(&runs),
            aggregates: aggregates(&runs),
        })
    };
    Family::ALL.into_iter().filter_map(section).collect()
}

/// All of them in Markdown.
#[must_use]
pub fn markdown(sections: &[Section]) -> String {
    let text = |section: &Section| {
        let (heading, rows) = (section.heading(), section.rows.markdown());
        format!(
            "**{}** (`{}`), {heading}\n\n{rows}\n\n{}",
            section.family.title(),
            section.family.name(),
            section.together().markdown()
        )
    };
    sections.iter().map(text).collect::<Vec<_>>().join("\n\n")
}

impl Section {
    /// How much of it is there.
    #[must_use]
    pub fn heading(&self) -> String {
        let [made, all] = self.runs;
        format!("{made} of {all} runs")
    }

    /// The aggregates as a table.
    #[must_use]
    pub fn together(&self) -> Grid {
        let row = |it: &Aggregate| {
            vec![
                it.variant.to_owned(),
                it.method.name().to_owned(),
                it.runs.to_string(),
                estimate(it.score),
                estimate(it.iqm),
                estimate(it.success),
            ]
        };
        let head = [
            "logs and teacher",
            "method",
            "runs",
            "mean score",
            "IQM",
            "success",
        ];
        Grid {
            head: head.map(str::to_owned).to_vec(),
            words: 2,
            rows: self.aggregates.iter().map(row).collect(),
        }
    }
}

/// A run, and what it came to if it is finished.
struct Shown<'a> {
    planned: &'a Planned,
    score: Option<&'a RunScore>,
}

/// Mean score and mean success of each row and method.
fn rows(runs: &[Shown<'_>]) -> Grid {
    let methods = in_order(runs, |one| one.method);
    let mut head = vec!["logs and teacher", "task"];
    head.extend(methods.iter().map(|method| method.name()));
    let mut rows = Vec::new();
    for (variant, task) in in_order(runs, |one| (one.variant, one.task)) {
        let mut cells = vec![variant.to_owned(), task.to_owned()];
        cells.extend(methods.iter().map(|method| {
            let of_cell = |one: &&Shown<'_>| {
                (one.planned.variant, one.planned.task) == (variant, task)
                    && one.planned.method == *method
            };
            cell(&runs.iter().filter(of_cell).collect::<Vec<_>>())
        }));
        rows.push(cells);
    }
    Grid {
        head: head.into_iter().map(str::to_owned).collect(),
        words: 2,
        rows,
    }
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
fn aggregates(runs: &[Shown<'_>]) -> Vec<Aggregate> {
    let mut all = Vec::new();
    let variants = in_order(runs, |one| one.variant);
    let has = |variant: &str, method: Method| {
        let of_variant = |one: &&Shown<'_>| one.planned.variant == variant;
        let mut runs = runs.iter().filter(of_variant);
        runs.any(|one| one.planned.method == method && one.score.is_some())
    };
    let mut add = |variant: &'static str, method: Method, of: &dyn Fn(&Planned) -> bool| {
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
            all.push(Aggregate {
                variant,
                method,
                runs: made,
                score: Estimate::of(&scores, mean),
                iqm: Estimate::of(&scores, interquartile_mean),
                success: Estimate::of(&successes, mean),
            });
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
    all
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
