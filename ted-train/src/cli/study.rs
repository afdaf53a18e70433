//! `ted study`: the measurements behind the defaults.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::{Args, Subcommand};
use firmware_sim::exit::ExitCode;
use firmware_sim::failure::Failure;
use firmware_sim::output::OutputArgs;

use crate::config::Preset;
use crate::study::policies;
use crate::study::reward::{DESIGNS, StudyLog, design_config};
use crate::study::table::table;

use super::failures::end;
use super::locate::{dataset_path, open_dataset};
use super::presets::{self, PresetArg};
use super::seeds::Seeds;

const EXAMPLES: &str = "\
Examples:
  ted study reward                                     the table of docs/rewards.md
  ted study reward --design default --set reward.epochs=400 --seeds 0..3";

const POLICIES_EXAMPLES: &str = "\
Examples:
  ted study policies --set algorithm.steps=50000
  ted study policies --presets true --seeds 0..3 --set algorithm.steps=100000 --out runs/study/true-100k
  ted study policies --presets zero,oprl-atac --set algorithm.steps=60000 --set oprl-atac:algorithm.warm_start=10000
  ted study policies --set algorithm.steps=50000 --scores kept.jsonl      goes on from this file on any machine
  ted study policies --set algorithm.steps=50000 --table     what is finished so far";

const STUDY_EXAMPLES: &str = "\
Examples:
  ted study reward
  ted study policies --presets true,oprl-i+ted --set algorithm.steps=50000";

/// Measure what the defaults were chosen by
#[derive(Debug, Args)]
#[command(after_help = STUDY_EXAMPLES)]
pub(super) struct StudyArgs {
    #[command(subcommand)]
    study: Study,
}

#[derive(Debug, Subcommand)]
enum Study {
    Reward(RewardArgs),
    Policies(PoliciesArgs),
}

/// Train and fly every combination of task, preset and seed, and print the table of docs/results.md
#[derive(Debug, Args)]
#[command(after_help = POLICIES_EXAMPLES)]
struct PoliciesArgs {
    /// Datasets: folders, Minari ids, or tasks that were collected
    #[arg(
        long,
        value_delimiter = ',',
        default_value = "drawer-open-v3,box-close-v3"
    )]
    datasets: Vec<String>,
    /// Compositions; `list` prints those there are
    #[arg(
        long,
        value_enum,
        value_delimiter = ',',
        default_value = "true,oprl-i,oprl-i+ted,steer",
        hide_possible_values = true
    )]
    presets: Vec<PresetArg>,
    /// Seeds, such as 0..3 or 1,2
    #[arg(long, default_value = "0..3")]
    seeds: Seeds,
    /// A field to change in every run, key=value, or preset,preset:key=value in the runs of these; may be given several times
    #[arg(long = "set", value_name = "KEY=VALUE")]
    sets: Vec<String>,
    /// Runs at a time; one for each core if not given
    #[arg(long)]
    jobs: Option<NonZeroUsize>,
    /// Where the runs are kept; a stopped study goes on from there
    #[arg(long, default_value = "runs/study/policies")]
    out: PathBuf,
    /// A file with a line for each finished run, which is then not made again, whatever has become of its folder [default:
    /// scores.jsonl in --out]
    #[arg(long)]
    scores: Option<PathBuf>,
    /// Print the table of what is finished and train nothing
    #[arg(long)]
    table: bool,
    #[command(flatten)]
    output: OutputArgs,
}

/// Compare designs of the ten-query reward ensemble, without training policies
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
struct RewardArgs {
    /// Datasets: folders, Minari ids, or tasks that were collected
    #[arg(
        long,
        value_delimiter = ',',
        default_value = "drawer-open-v3,box-close-v3,sweep-into-v3"
    )]
    datasets: Vec<String>,
    /// Seeds, such as 0..5 or 1,2
    #[arg(long, default_value = "0..5")]
    seeds: Seeds,
    /// Only the designs whose name contains this
    #[arg(long)]
    design: Option<String>,
    /// A field to change in every design, key=value; may be given several times
    #[arg(long = "set", value_name = "KEY=VALUE")]
    sets: Vec<String>,
    /// Where the cells are kept; a stopped study goes on from there
    #[arg(long, default_value = "runs/study/reward")]
    out: PathBuf,
    #[command(flatten)]
    output: OutputArgs,
}

pub(super) fn run(args: &StudyArgs) -> Result<(), Failure> {
    match &args.study {
        Study::Reward(args) => reward(args),
        Study::Policies(args) => policies(args),
    }
}

fn policies(args: &PoliciesArgs) -> Result<(), Failure> {
    if args.presets.contains(&PresetArg::List) {
        let all = presets::compositions();
        return args.output.print(&all, || presets::text(&all));
    }
    let presets: Vec<Preset> = args.presets.iter().filter_map(|one| one.preset()).collect();
    let runs = policies::runs(&args.datasets, &presets, &args.seeds.0, &args.sets).map_err(end)?;
    let in_out = || args.out.join("scores.jsonl");
    let file = args.scores.clone().unwrap_or_else(in_out);
    if !args.table {
        let (jobs, audience) = (args.jobs, args.output.audience());
        policies::fill(&args.out, &file, &runs, jobs, dataset_path, audience).map_err(end)?;
    }
    let scores = policies::scores(&args.out, &file, &runs).map_err(end)?;
    // An empty table would look like a study that has only begun.
    if args.table && scores.is_empty() {
        return Err(Failure::new(
            ExitCode::Usage,
            format_args!(
                "no run of those asked for ({} in all) has a score in {} or is finished under {}: a run is known by all of its settings, so \
                 give the --datasets, --set, --scores and --out of the study, or make them, without --table",
                runs.len(),
                file.display(),
                args.out.display()
            ),
        ));
    }
    args.output.print(&scores, || table(&scores))
}

fn reward(args: &RewardArgs) -> Result<(), Failure> {
    let wanted = |name: &str| {
        args.design
            .as_deref()
            .is_none_or(|part| name.contains(part))
    };
    let designs = DESIGNS
        .iter()
        .filter(|(name, _)| wanted(name))
        .map(|(name, changes)| Ok(((*name).to_owned(), design_config(changes, &args.sets)?)))
        .collect::<Result<Vec<_>, _>>()
        .map_err(|e: crate::config::ConfigError| end(e))?;
    if designs.is_empty() {
        let names: Vec<_> = DESIGNS.iter().map(|(name, _)| *name).collect();
        return Err(Failure::new(
            ExitCode::Usage,
            format_args!(
                "no design has that in its name; the designs are: {}",
                names.join("; ")
            ),
        ));
    }
    let mut log = StudyLog::open(&args.out).map_err(end)?;
    let total = designs.len() * args.seeds.0.len() * args.datasets.len();
    let progress =
        args.output
            .audience()
            .start("measure reward designs", total as u64, "ensembles");
    for name in &args.datasets {
        let (dataset, _) = open_dataset(name)?;
        log.fill(&designs, &dataset, &args.seeds.0, &progress)
            .map_err(end)?;
    }
    progress.finish();
    args.output.print(&log.cells, || log.table(&designs))
}
