//! `ted ask`: a person answers the questions of a run, and nothing is trained.

use std::path::{Path, PathBuf};

use clap::Args;
use firmware_sim::exit::ExitCode;
use firmware_sim::failure::Failure;
use firmware_sim::output::OutputArgs;
use serde::Serialize;

use super::door::{DoorArgs, Errand, door};
use super::failures::end;
use super::locate::{dataset_path, no_dataset, run_folder};
use crate::config::Overrides;
use crate::fleet::{Datasets, Lane};
use crate::preferences::PreferenceLog;
use crate::train::check;

const EXAMPLES: &str = "\
Examples:
  ted ask drawer-open-v3                         ten questions of our method, steer, on a web page
  ted ask drawer-open-v3 --by anna --answers 20  twenty of them, with a name in every line of the log
  ted ask drawer-open-v3 --text                  the same in the terminal
  ted ask drawer-open-v3 --listen 127.0.0.1:8021 at a port of your own, such as for ssh -L 8021:127.0.0.1:8021

The page is for this machine alone, and only for whoever has the address that the command prints. Every answer is in preferences.jsonl \
of the run's folder before the next question is shown: stop at any time, and the same command goes on. \
At the end it says the `ted train` command that learns from the answers. `ted train --ask` does both.";

/// Answer the questions of a run yourself, on a web page or in the terminal
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct AskArgs {
    /// Dataset folder, Minari id, or a task that `ted collect` has collected
    dataset: String,
    /// The run's folder; runs/<task>/steer/seed-<seed> if not given
    #[arg(long)]
    out: Option<PathBuf>,
    /// How many answers; 10 if not given. A folder in which more were wished for keeps its number
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1000))]
    answers: Option<u32>,
    /// Root of all randomness; 0 if not given
    #[arg(long, value_parser = clap::value_parser!(u64).range(..=i64::MAX as u64))]
    seed: Option<u64>,
    /// One field of the run's configuration, key=value; may be given several times
    #[arg(long = "set", value_name = "KEY=VALUE")]
    sets: Vec<String>,
    #[command(flatten)]
    door: DoorArgs,
    #[command(flatten)]
    output: OutputArgs,
}

/// What came of it.
#[derive(Debug, Serialize)]
struct AskReport<'a> {
    run: &'a Path,
    preferences: &'a Path,
    answers: usize,
    next: &'a str,
}

pub(super) fn run(args: &AskArgs) -> Result<(), Failure> {
    args.door.check(true)?;
    let mut overrides = Overrides::default();
    for set in &args.sets(args.answers.map(|answers| answers as usize)) {
        overrides = overrides.set(set).map_err(end)?;
    }
    let config = overrides.resolve(None, args.seed).map_err(end)?;
    overrides.meant_for(&[config.preset]).map_err(end)?;
    if !config.asks() || !config.teacher.is_default() {
        let message = "ted ask asks a person: leave out the settings of the simulated teacher";
        return Err(Failure::new(ExitCode::Usage, message));
    }
    let datasets = Datasets::default();
    let path = dataset_path(&args.dataset);
    let dataset = datasets
        .open(&path)
        .map_err(|error| no_dataset(&args.dataset, error))?;
    check(&dataset, &config).map_err(end)?;
    let folder = args.out.clone().unwrap_or_else(|| {
        let task = dataset.task().unwrap_or("unknown");
        run_folder(None, task, config.preset.name(), config.seed)
    });
    let mut lane = Lane {
        dataset: path,
        config,
        folder,
        answers: None,
        siblings: Vec::new(),
    };
    let audience = args.output.audience();
    let (wanted, out) = (lane.config.answers(), lane.folder.clone());
    let next = |answers: usize| args.next(&out, (answers != wanted).then_some(answers));
    let errand = Errand::Ask(&next);
    let log = door(&mut lane, &datasets, &args.door, errand, audience)?;
    let next = next(lane.config.answers());
    let said = PreferenceLog::read(&log, &dataset).map_err(end)?;
    let report = AskReport {
        run: &lane.folder,
        preferences: &log,
        answers: said
            .iter()
            .filter(|entry| entry.said.answer.is_some())
            .count(),
        next: &next,
    };
    args.output.print(&report, || report.text())
}

impl AskArgs {
    /// Everything that was set, with this number of answers, if there is one, in place of any other.
    fn sets(&self, answers: Option<usize>) -> Vec<String> {
        const ANSWERS: &str = "reward.queries";
        let names = |set: &str| set.split('=').next().map(str::trim) == Some(ANSWERS);
        let others = self
            .sets
            .iter()
            .filter(|set| answers.is_none() || !names(set));
        let answers = answers.map(|answers| format!("{ANSWERS}={answers}"));
        others.cloned().chain(answers).collect()
    }

    /// The command that learns from the answers, of which there are so many if it is not the number that was asked for.
    fn next(&self, folder: &Path, answers: Option<usize>) -> String {
        let asked_for = self.answers.map(|answers| answers as usize);
        let sets = self.sets(answers.or(asked_for));
        let mut words = vec!["ted".to_owned(), "train".to_owned(), self.dataset.clone()];
        if let Some(seed) = self.seed {
            words.extend(["--seed".to_owned(), seed.to_string()]);
        }
        for set in &sets {
            words.extend(["--set".to_owned(), set.clone()]);
        }
        let log = folder.join(crate::run::PREFERENCES);
        for (option, path) in [("--preferences", log.as_path()), ("--out", folder)] {
            words.extend([option.to_owned(), path.display().to_string()]);
        }
        let words: Vec<String> = words.iter().map(|word| quoted(word)).collect();
        words.join(" ")
    }
}

impl AskReport<'_> {
    fn text(&self) -> String {
        let Self {
            preferences,
            answers,
            next,
            ..
        } = self;
        format!(
            "{answers} answers in {}\nnext: {next}",
            preferences.display()
        )
    }
}

/// A word as a shell takes it.
fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "-_./=,:+@".contains(c);
    match !word.is_empty() && word.chars().all(plain) {
        true => word.to_owned(),
        false => format!("'{}'", word.replace('\'', r"'\''")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_word_that_a_shell_would_split_or_expand_is_quoted() {
        assert_eq!(quoted("runs/a-b.c"), "runs/a-b.c");
        assert_eq!(
            quoted("reward.clone={hidden=[4]}"),
            "'reward.clone={hidden=[4]}'"
        );
        assert_eq!(quoted("it's"), r"'it'\''s'");
        assert_eq!(quoted(""), "''");
    }

    #[test]
    fn the_command_that_learns_from_the_answers_says_how_many_there_are_once() {
        #[derive(clap::Parser)]
        struct Line {
            #[command(flatten)]
            args: AskArgs,
        }
        let next = |line: &str, answers: Option<usize>| {
            let words = ["ask", "x"].into_iter().chain(line.split_whitespace());
            let Line { args } = clap::Parser::parse_from(words);
            args.next(Path::new("run"), answers)
        };
        let end = "--preferences run/preferences.jsonl --out run";
        assert_eq!(next("", None), format!("ted train x {end}"));
        let set = |answers| format!("ted train x --set reward.queries={answers} {end}");
        assert_eq!(next("--answers 8", None), set(8));
        assert_eq!(next("--set reward.queries=4", None), set(4));
        for line in ["", "--answers 8", "--set reward.queries=4 --answers 8"] {
            assert_eq!(next(line, Some(13)), set(13), "{line}");
        }
    }
}
