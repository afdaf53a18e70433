//! `ted study policies`: every combination of task, preset and seed, and the table of `docs/results.md`.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::Args;
use firmware_sim::counts::at_a_time;
use firmware_sim::exit::ExitCode;
use firmware_sim::failure::Failure;
use firmware_sim::output::OutputArgs;

use super::page;
use crate::cli::failures::end;
use crate::cli::locate::dataset_path;
use crate::cli::presets::{self, PresetArg};
use crate::cli::seeds::Seeds;
use crate::config::Preset;
use crate::report;
use crate::study::fill::Making;
use crate::study::policies;
use crate::study::table::table;

const EXAMPLES: &str = "\
Examples:
  ted study policies --set algorithm.steps=50000
  ted study policies --presets true --seeds 0..3 --set algorithm.steps=100000 --out runs/study/true-100k
  ted study policies --presets zero,oprl-atac --set algorithm.steps=60000 --set oprl-atac:algorithm.warm_start=10000
  ted study policies --set algorithm.steps=50000 --scores kept.jsonl      goes on from this file on any machine
  ted study policies --set algorithm.steps=50000 --table     what is finished so far";

/// Train and fly every combination of task, preset and seed, and print the table of docs/results.md
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct PoliciesArgs {
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
    #[arg(long, value_parser = at_a_time)]
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
    /// A file for the same as a page [default: report.html in --out, but none with --table]
    #[arg(long, value_name = "FILE")]
    page: Option<PathBuf>,
    #[command(flatten)]
    output: OutputArgs,
}

pub(super) fn run(args: &PoliciesArgs) -> Result<(), Failure> {
    if args.presets.contains(&PresetArg::List) {
        let all = presets::compositions();
        return args.output.print(&all, || presets::text(&all));
    }
    let presets: Vec<Preset> = args.presets.iter().filter_map(|one| one.preset()).collect();
    let (seeds, sets) = (&args.seeds.0, &args.sets);
    let runs = policies::runs(
        &args.datasets,
        &presets,
        seeds,
        sets,
        &args.out,
        dataset_path,
    );
    let runs = runs.map_err(end)?;
    let in_out = || args.out.join("scores.jsonl");
    let file = args.scores.clone().unwrap_or_else(in_out);
    let page = page(args.page.as_deref(), args.table, &args.out)?;
    if !args.table {
        let making = Making {
            scores: &file,
            jobs: args.jobs,
            audience: args.output.audience(),
        };
        policies::fill(making, &runs).map_err(end)?;
    }
    let scores = policies::scores(&file, &runs).map_err(end)?;
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
    let table = table(&scores);
    if let Some(page) = page {
        report::study::policies(&table, &page).map_err(end)?;
    }
    args.output.print(&scores, || table.markdown())
}
