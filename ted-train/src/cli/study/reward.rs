//! `ted study reward`: designs of the reward ensemble, and the table of `docs/rewards.md`.

use std::path::PathBuf;

use clap::Args;
use firmware_sim::exit::ExitCode;
use firmware_sim::failure::Failure;
use firmware_sim::output::OutputArgs;

use crate::cli::failures::end;
use crate::cli::locate::open_dataset;
use crate::cli::seeds::Seeds;
use crate::preferences::ScriptedTeacher;
use crate::study::reward::{DESIGNS, StudyLog, design_config};

const EXAMPLES: &str = "\
Examples:
  ted study reward                                     the table of docs/rewards.md
  ted study reward --design default --set reward.epochs=400 --seeds 0..3";

/// Compare designs of the ten-query reward ensemble, without training policies
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct RewardArgs {
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

pub(super) fn run(args: &RewardArgs) -> Result<(), Failure> {
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
    // A teacher answers here, and nothing is begun that it cannot end.
    let mut datasets = Vec::new();
    for name in &args.datasets {
        let (dataset, _) = open_dataset(name)?;
        let teacher = ScriptedTeacher::truthful();
        teacher.check(&dataset).map_err(end)?;
        datasets.push(dataset);
    }
    let mut log = StudyLog::open(&args.out).map_err(end)?;
    let total = designs.len() * args.seeds.0.len() * args.datasets.len();
    let progress =
        args.output
            .audience()
            .start("measure reward designs", total as u64, "ensembles");
    for dataset in &datasets {
        log.fill(&designs, dataset, &args.seeds.0, &progress)
            .map_err(end)?;
    }
    progress.finish();
    args.output.print(&log.cells, || log.table(&designs))
}
