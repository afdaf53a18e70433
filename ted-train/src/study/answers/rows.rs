//! The rows of the benchmark: which logs, which teacher, which methods, how many seeds.

use std::path::Path;

use clap::ValueEnum;
use firmware_sim::plants::toy::Units;
use firmware_sim::worlds::metaworld::tasks;
use serde::{Deserialize, Serialize};

use super::Method;
use crate::collect::{CollectConfig, Recipe};

/// A question that the benchmark asks.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, ValueEnum,
)]
#[serde(rename_all = "kebab-case")]
pub enum Family {
    /// The paper's ten tasks.
    Ten,
    /// Noise whose mean is not zero.
    Biased,
    /// Two intentions in one log.
    Intentions,
    /// Few good episodes, and small logs.
    Few,
    /// Teachers that err.
    Teachers,
    /// More answers, or fewer.
    Number,
    /// What each part of ours gives.
    Parts,
    /// Logs that are no Meta-World.
    Other,
    /// The other forty tasks.
    Forty,
}

impl Family {
    /// All of them, in the order of the tables.
    pub const ALL: [Self; 9] = [
        Self::Ten,
        Self::Biased,
        Self::Intentions,
        Self::Few,
        Self::Teachers,
        Self::Number,
        Self::Parts,
        Self::Other,
        Self::Forty,
    ];

    /// Its name on the command line and in the file of scores.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Ten => "ten",
            Self::Biased => "biased",
            Self::Intentions => "intentions",
            Self::Few => "few",
            Self::Teachers => "teachers",
            Self::Number => "number",
            Self::Parts => "parts",
            Self::Other => "other",
            Self::Forty => "forty",
        }
    }

    /// What its table is about.
    #[must_use]
    pub const fn title(self) -> &'static str {
        match self {
            Self::Ten => "The paper's ten tasks",
            Self::Biased => "Biased logs",
            Self::Intentions => "Two intentions in one log",
            Self::Few => "Few good episodes, and small logs",
            Self::Teachers => "Teachers that err",
            Self::Number => "Number of answers",
            Self::Parts => "What each part of ours gives",
            Self::Other => "Logs that are no Meta-World",
            Self::Forty => "The other forty tasks",
        }
    }
}

/// Logs that `ted collect` makes with root seed 0.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Log {
    /// The task.
    pub task: &'static str,
    /// The recipe.
    pub recipe: Recipe,
    /// Good episodes; none for the recipe's own number.
    pub good: Option<u32>,
    /// Episodes; none for the recipe's own number.
    pub episodes: Option<u32>,
}

impl Log {
    const fn paper(task: &'static str) -> Self {
        Self {
            task,
            recipe: Recipe::Paper,
            good: None,
            episodes: None,
        }
    }

    /// How it is collected under this folder; all cores work on it.
    #[must_use]
    pub fn collect(&self, root: &Path) -> CollectConfig {
        let cores = std::thread::available_parallelism();
        CollectConfig {
            task: self.task.to_owned(),
            recipe: self.recipe,
            episodes: self.episodes,
            good: self.good,
            seed: 0,
            workers: cores.map_or(1, usize::from),
            root: root.to_path_buf(),
        }
    }
}

/// A row of a table: logs and a teacher, and who learns from them.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// The question that it belongs to.
    pub family: Family,
    /// What is special about it.
    pub variant: &'static str,
    /// The logs.
    pub log: Log,
    /// What is changed for the methods here, `--set` by `--set`: the teacher, or how often it is asked.
    pub sets: &'static [&'static str],
    /// The methods, each with its number of seeds.
    pub methods: Vec<(Method, u64)>,
}

/// Seeds of a method where nothing else is said.
const SEEDS: u64 = 3;
/// Seeds of ours on the paper's tasks.
const SEEDS_OF_OURS: u64 = 5;
/// Seeds of what learns values, which takes most of the time, on other logs than the paper's ten.
const SEEDS_OF_VALUES: u64 = 1;
/// The tasks of what is not measured on all ten: one where true rewards and ten answers both do well, one where ten answers do
/// badly, and one whose successful episodes may still have a low return.
const THREE: [&str; 3] = ["box-close-v3", "drawer-open-v3", "sweep-into-v3"];
/// Both sides of three scenes of two intentions.
const SIDES: [(&str, &str); 6] = [
    ("the first one's answers", "reach-left_reach-right_first"),
    ("the first one's answers", "push-left_push-right_first"),
    (
        "the first one's answers",
        "plate-slide-side_plate-slide_first",
    ),
    ("the second one's answers", "reach-left_reach-right_second"),
    ("the second one's answers", "push-left_push-right_second"),
    (
        "the second one's answers",
        "plate-slide-side_plate-slide_second",
    ),
];
/// Episodes of these.
const EPISODES_OF_SIDES: u32 = 400;
/// How the logs of ten tasks are called where there are others beside them.
const FULL: &str = "50 good of 1,000";
/// Variants of few good episodes and of small logs.
const FEW: [(&str, Option<u32>, Option<u32>); 5] = [
    ("20 good of 1,000", Some(20), None),
    ("5 good of 1,000", Some(5), None),
    ("0 good of 1,000", Some(0), None),
    ("300 episodes", None, Some(300)),
    ("100 episodes", None, Some(100)),
];
/// Teachers, beside the one who knows the true returns.
const TEACHERS: [(&str, &[&str]); 6] = [
    ("errs 0.1", &["teacher.errs=0.1"]),
    ("errs 0.2", &["teacher.errs=0.2"]),
    ("tolerance 0.5", &["teacher.tolerance=0.5"]),
    ("cannot tell 0.5", &["teacher.cannot_tell=0.5"]),
    ("all equal", &["teacher.says=equal"]),
    ("all first", &["teacher.says=first"]),
];
/// Numbers of answers, beside ten.
const NUMBERS: [(&str, &[&str]); 6] = [
    ("0 answers", &["reward.queries=0"]),
    ("3 answers", &["reward.queries=3"]),
    ("5 answers", &["reward.queries=5"]),
    ("20 answers", &["reward.queries=20"]),
    ("50 answers", &["reward.queries=50"]),
    ("100 answers", &["reward.queries=100"]),
];

/// Ours without one part each.
const PARTS: [(&str, &[&str]); 10] = [
    ("all of it", &[]),
    ("no answers", &["reward.queries=0"]),
    ("questions not chosen", &["reward.pool=1"]),
    (
        "no competence",
        &["reward.competence=0", "reward.competence_std=0"],
    ),
    ("competence not believed in", &["reward.competence=0"]),
    ("no whereabouts", &["reward.direction_std=0"]),
    ("no slips", &["reward.lapse=0"]),
    ("no decay", &["algorithm.weight_decay=0"]),
    ("the whole gain", &["algorithm.haste=1"]),
    ("no averaged weights", &["algorithm.average_rate=1"]),
];

/// Every row. What two of them have in common is one run.
#[must_use]
pub fn rows() -> Vec<Row> {
    let mut rows = Vec::new();
    let every = |seeds_of_ours, seeds_of_values| {
        Method::ALL.map(|method| match method {
            Method::Steer => (method, seeds_of_ours),
            slow if slow.is_slow() => (slow, seeds_of_values),
            other => (other, SEEDS),
        })
    };
    let mut add = |family, variant, log, sets, methods: &[(Method, u64)]| {
        rows.push(Row {
            family,
            variant,
            log,
            sets,
            methods: methods.to_vec(),
        });
    };
    let all = every(SEEDS, SEEDS_OF_VALUES);
    let ours = [(Method::Steer, SEEDS)];
    for task in tasks::EXAMPLE_10 {
        add(
            Family::Ten,
            "paper",
            Log::paper(task),
            &[],
            &every(SEEDS_OF_OURS, SEEDS),
        );
    }
    for (variant, recipe) in [("biased", Recipe::Biased), ("drift", Recipe::Drift)] {
        for task in THREE {
            let log = Log {
                recipe,
                ..Log::paper(task)
            };
            add(Family::Biased, variant, log, &[], &all);
        }
    }
    let side = |task| Log {
        episodes: Some(EPISODES_OF_SIDES),
        ..Log::paper(task)
    };
    for (variant, task) in SIDES {
        add(Family::Intentions, variant, side(task), &[], &all);
    }
    for (variant, good, episodes) in [(FULL, None, None)].into_iter().chain(FEW) {
        for task in THREE {
            let log = Log {
                good,
                episodes,
                ..Log::paper(task)
            };
            add(Family::Few, variant, log, &[], &all);
        }
    }
    for task in THREE {
        add(Family::Teachers, "never errs", Log::paper(task), &[], &all);
    }
    for (variant, sets) in TEACHERS {
        for task in THREE {
            add(Family::Teachers, variant, Log::paper(task), sets, &ours);
        }
    }
    let asked = || {
        let pair = SIDES
            .into_iter()
            .filter(|(_, task)| task.starts_with("reach-"));
        THREE
            .map(Log::paper)
            .into_iter()
            .chain(pair.map(|(_, task)| side(task)))
    };
    for log in asked() {
        add(Family::Number, "10 answers", log, &[], &all);
    }
    for (variant, sets) in NUMBERS {
        for log in asked() {
            add(Family::Number, variant, log, sets, &ours);
        }
    }
    for (variant, sets) in PARTS {
        for log in asked() {
            add(Family::Parts, variant, log, sets, &ours);
        }
    }
    for units in Units::ALL {
        add(Family::Other, "paper", Log::paper(units.task()), &[], &all);
    }
    for task in tasks::ALL {
        if !tasks::EXAMPLE_10.contains(&task) {
            add(
                Family::Forty,
                "paper",
                Log::paper(task),
                &[],
                &[(Method::Steer, 1)],
            );
        }
    }
    rows
}
