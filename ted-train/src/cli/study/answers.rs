//! `ted study answers`: the benchmark of what answers are worth.

use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use firmware_sim::counts::at_a_time;
use firmware_sim::exit::ExitCode;
use firmware_sim::failure::Failure;
use firmware_sim::output::OutputArgs;

use super::page;
use crate::cli::failures::end;
use crate::cli::locate::datasets_root;
use crate::report;
use crate::study::answers::{
    self, AnswerScore, Desk, Family, Method, Planned, Shard, markdown, sections,
};
use crate::study::cells;
use crate::study::fill::Making;
use crate::study::slurm::{Submission, Submitted};

const EXAMPLES: &str = "\
Examples:
  ted study answers --table                            what docs/answers.jsonl says, as tables
  ted study answers --table --page answers.html        the same as a page with pictures, too
  ted study answers --families ten,few --methods clone,steer
  ted study answers --shard 2/8                        the second of eight parts, for one of eight machines
  ted study merge docs/answers.*-of-8.jsonl --into docs/answers.jsonl
  ted study answers --slurm 8 --slurm-option=--time=8:00:00 --slurm-option=--cpus-per-task=4

What is cheap is made first, seed by seed, and then what learns values: stop it when you have seen enough, and the same command \
goes on. Datasets that are missing are collected, each before its first run. What is cheap is some twenty-one core-hours, and the rest \
twenty-five.";

/// Measure what answers are worth: on ten tasks, hard logs, teachers that err; beside imitation, no reward and true rewards
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct AnswersArgs {
    /// The questions to look at; all if not given
    #[arg(long, value_enum, value_delimiter = ',')]
    families: Vec<Family>,
    /// The methods to compare; all if not given
    #[arg(long, value_enum, value_delimiter = ',')]
    methods: Vec<Method>,
    /// A field to change in every run, key=value, or preset,preset:key=value in the runs of these; may be given several times
    #[arg(long = "set", value_name = "KEY=VALUE")]
    sets: Vec<String>,
    /// Runs at a time; one for each core if not given
    #[arg(long, value_parser = at_a_time)]
    jobs: Option<NonZeroUsize>,
    /// Where the runs are kept; a stopped study goes on from there
    #[arg(long, default_value = "runs/study/answers")]
    out: PathBuf,
    /// A file with a line for each finished run, which is then not made again, whatever has become of its folder
    #[arg(long, default_value = "docs/answers.jsonl")]
    scores: PathBuf,
    /// Make only the k-th of n parts of the study, from 1/n to n/n; its scores go to a file of its own beside --scores
    #[arg(long, value_name = "K/N", conflicts_with = "table")]
    shard: Option<Shard>,
    /// Hand the study to Slurm as an array of so many parts, and make nothing here
    #[arg(long, value_name = "N", value_parser = at_a_time, conflicts_with_all = ["shard", "table"])]
    slurm: Option<NonZeroUsize>,
    /// An option for sbatch, such as --slurm-option=--partition=short; may be given several times
    #[arg(
        long,
        value_name = "OPTION",
        requires = "slurm",
        allow_hyphen_values = true
    )]
    slurm_option: Vec<String>,
    /// Print the tables of what is finished and train nothing
    #[arg(long)]
    table: bool,
    /// A file for the same as a page with pictures [default: report.html in --out, but none with --table]
    #[arg(long, value_name = "FILE", conflicts_with_all = ["shard", "slurm"])]
    page: Option<PathBuf>,
    #[command(flatten)]
    output: OutputArgs,
}

pub(super) fn run(args: &AnswersArgs) -> Result<(), Failure> {
    if let Some(parts) = args.slurm {
        return submit(args, parts);
    }
    let planned = args.plan()?;
    let page = match args.shard {
        Some(_) => None,
        None => page(args.page.as_deref(), args.table, &args.out)?,
    };
    if !args.table {
        make(args, &planned)?;
        if let Some(shard) = args.shard {
            let file = part(&args.scores, &shard.suffix());
            let lines: Vec<AnswerScore> = cells::read(&file).map_err(end)?;
            return args.output.print(&lines, || {
                format!("{} scores in {}", lines.len(), file.display())
            });
        }
    }
    let lines: Vec<AnswerScore> = cells::read(&args.scores).map_err(end)?;
    let shown = |line: &&AnswerScore| planned.iter().any(|one| one.run.came_to(&line.run));
    let shown: Vec<&AnswerScore> = lines.iter().filter(shown).collect();
    // Empty tables would look like a study that has only begun.
    if shown.is_empty() {
        return Err(Failure::new(
            ExitCode::Usage,
            format_args!(
                "no run of those asked for ({} in all) has a score in {}: a run is known by all of its settings, so give the --families, \
                 --methods, --set and --scores of the study, or make them, without --table",
                planned.len(),
                args.scores.display()
            ),
        ));
    }
    let sections = sections(&planned, &lines);
    if let Some(page) = page {
        report::study::answers(&sections, &page).map_err(end)?;
    }
    args.output.print(&shown, || markdown(&sections))
}

fn make(args: &AnswersArgs, planned: &[Planned]) -> Result<(), Failure> {
    let mut runs = answers::to_make(planned);
    let mut scores = args.scores.clone();
    let mut kept = None;
    if let Some(shard) = args.shard {
        runs = shard.of(runs);
        scores = part(&args.scores, &shard.suffix());
        kept = Some(args.scores.as_path());
    }
    let making = Making {
        scores: &scores,
        jobs: args.jobs,
        audience: args.output.audience(),
    };
    answers::fill(making, kept, &runs).map_err(end)
}

/// Hands the same command to Slurm, part by part.
fn submit(args: &AnswersArgs, parts: NonZeroUsize) -> Result<(), Failure> {
    // What cannot be planned is better refused here than by every job.
    args.plan()?;
    let submission = Submission {
        command: &args.words()?,
        parts,
        options: &args.slurm_option,
        logs: &args.out.join("slurm"),
    };
    let submitted = submission.submit().map_err(end)?;
    args.output.print(&submitted, || args.what_now(&submitted))
}

impl AnswersArgs {
    fn plan(&self) -> Result<Vec<Planned>, Failure> {
        let root = datasets_root();
        let desk = Desk {
            datasets: &root,
            out: &self.out,
            sets: &self.sets,
        };
        let families = all_unless(&self.families);
        answers::plan(&families, &all_unless(&self.methods), desk).map_err(end)
    }

    /// This command without what is for Slurm.
    fn words(&self) -> Result<Vec<String>, Failure> {
        let program = std::env::current_exe().map_err(|error| {
            let message = format!("cannot find this program for the jobs to run: {error}");
            Failure::new(ExitCode::Failure, message)
        })?;
        let mut words = vec![program.display().to_string()];
        words.extend(["study", "answers"].map(str::to_owned));
        let mut add = |name: &str, value: String| words.extend([name.to_owned(), value]);
        for family in &self.families {
            add("--families", name(family));
        }
        for method in &self.methods {
            add("--methods", name(method));
        }
        for set in &self.sets {
            add("--set", set.clone());
        }
        if let Some(jobs) = self.jobs {
            add("--jobs", jobs.to_string());
        }
        add("--out", self.out.display().to_string());
        add("--scores", self.scores.display().to_string());
        Ok(words)
    }

    fn what_now(&self, submitted: &Submitted) -> String {
        let Submitted { job, parts, logs } = submitted;
        format!(
            "submitted as job {job}: {parts} parts, whose output goes to {}\n\
             when none is left in `squeue --job {job}`:\n  ted study merge {} --into {}",
            logs.display(),
            part(&self.scores, &format!("*-of-{parts}")).display(),
            self.scores.display()
        )
    }
}

/// The file of scores of a part.
fn part(scores: &Path, suffix: &str) -> PathBuf {
    scores.with_extension(format!("{suffix}.jsonl"))
}

/// What a person chose, or everything.
fn all_unless<T: ValueEnum>(chosen: &[T]) -> Vec<T> {
    let all = || T::value_variants().to_vec();
    match chosen {
        [] => all(),
        some => some.to_vec(),
    }
}

fn name<T: ValueEnum>(value: &T) -> String {
    let value = value.to_possible_value();
    value.map_or_else(String::new, |it| it.get_name().to_owned())
}
