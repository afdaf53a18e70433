//! `ted study d4rl`: the paper's Section 4.3 on a person's own copy of D4RL's files.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::Args;
use firmware_sim::exit::ExitCode;
use firmware_sim::failure::Failure;
use firmware_sim::output::OutputArgs;

use super::page;
use crate::cli::failures::end;
use crate::cli::locate::datasets_root;
use crate::cli::presets::PresetArg;
use crate::cli::seeds::Seeds;
use crate::config::Preset;
use crate::dataset::minari;
use crate::import::{ImportConfig, import};
use crate::report;
use crate::study::d4rl::{PRESETS, Source, sources};
use crate::study::fill::Making;
use crate::study::policies;
use crate::study::run::StudyRun;
use crate::study::table::table;

const EXAMPLES: &str = "\
Examples:
  ted study d4rl ~/.d4rl/datasets
  ted study d4rl ~/.d4rl/datasets --datasets hopper-medium-v2,ant-expert-v2 --seeds 0
  ted study d4rl ~/.d4rl/datasets --set algorithm.steps=100000        a tenth of the updates
  ted study d4rl ~/.d4rl/datasets --table                             what is finished so far

The folder holds D4RL's files of version 2 by the names that D4RL gives them, such as hopper_medium-v2.hdf5, or by those of the \
datasets, hopper-medium-v2.hdf5. Each is imported once, as d4rl/hopper-medium-v2. What is not there is named and left out. \
IQL's constants are those it was published with, for the maze its own. A run makes a million updates, as IQL was published.";

/// Run the paper's 26 tasks of D4RL on your own copy of its files, and print its Table 15 beside yours
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct D4rlArgs {
    /// The folder with D4RL's files
    folder: PathBuf,
    /// Some of the 26 datasets, by name; all that are there if not given
    #[arg(long, value_delimiter = ',', value_parser = named)]
    datasets: Vec<String>,
    /// Compositions; the paper's true, random and oprl-i if not given
    #[arg(long, value_enum, value_delimiter = ',', hide_possible_values = true)]
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
    #[arg(long, default_value = "runs/study/d4rl")]
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

fn named(name: &str) -> Result<String, String> {
    let names: Vec<String> = sources().into_iter().map(|source| source.name).collect();
    match names.iter().any(|it| it == name) {
        true => Ok(name.to_owned()),
        false => Err(format!("it is none of {}", names.join(", "))),
    }
}

pub(super) fn run(args: &D4rlArgs) -> Result<(), Failure> {
    if !args.folder.is_dir() {
        return Err(Failure::new(
            ExitCode::BadInput,
            format_args!("there is no folder {}", args.folder.display()),
        ));
    }
    let wanted = |source: &Source| args.datasets.is_empty() || args.datasets.contains(&source.name);
    let wanted = sources().into_iter().filter(wanted);
    let (there, missing): (Vec<_>, Vec<_>) = wanted.partition(|it| args.has(it));
    if there.is_empty() {
        let files: Vec<_> = missing.iter().map(|it| it.files[0].as_str()).collect();
        return Err(Failure::new(
            ExitCode::BadInput,
            format_args!(
                "{} has none of D4RL's files: they are called {}",
                args.folder.display(),
                files.join(", ")
            ),
        ));
    }
    let audience = args.output.audience();
    if !missing.is_empty() {
        let names: Vec<_> = missing.iter().map(|it| it.name.as_str()).collect();
        audience.note(&format!("not there, and left out: {}", names.join(", ")));
    }
    let runs = args.runs(&there)?;
    let in_out = || args.out.join("scores.jsonl");
    let file = args.scores.clone().unwrap_or_else(in_out);
    let page = page(args.page.as_deref(), args.table, &args.out)?;
    if !args.table {
        for source in &there {
            args.imported(source)?;
        }
        let making = Making {
            scores: &file,
            jobs: args.jobs,
            audience,
        };
        policies::fill(making, &runs).map_err(end)?;
    }
    let scores = policies::scores(&file, &runs).map_err(end)?;
    let table = table(&scores);
    if let Some(page) = page {
        report::study::policies(&table, &page).map_err(end)?;
    }
    args.output.print(&scores, || table.markdown())
}

impl D4rlArgs {
    /// Whether a dataset can be had: from its file, or because it was imported before.
    fn has(&self, source: &Source) -> bool {
        let imported = || source.id().is_ok_and(|id| imported_before(&id));
        source.file(&self.folder).is_some() || imported()
    }

    /// Imports a dataset, or goes on with it, unless it is there.
    fn imported(&self, source: &Source) -> Result<(), Failure> {
        let id = source.id().map_err(end)?;
        let Some(file) = source.file(&self.folder).filter(|_| !imported_before(&id)) else {
            return Ok(());
        };
        let config = ImportConfig {
            source: file,
            options: source.options.clone(),
            robot: None,
            task: Some(source.task),
            clip: false,
            id,
            root: datasets_root(),
        };
        import(&config, self.output.audience()).map_err(end)?;
        Ok(())
    }

    /// Every combination, seed by seed, so that an unfinished study has something of every row.
    fn runs(&self, sources: &[Source]) -> Result<Vec<StudyRun>, Failure> {
        let presets: Vec<Preset> = match self.presets.as_slice() {
            [] => PRESETS.to_vec(),
            some => some.iter().filter_map(|one| one.preset()).collect(),
        };
        let mut runs = Vec::new();
        for &seed in &self.seeds.0 {
            for source in sources {
                let id = source.id().map_err(end)?;
                let place = |_: &str| id.folder(&datasets_root());
                let own = source.sets.iter().map(|&set| set.to_owned());
                let sets: Vec<String> = own.chain(self.sets.iter().cloned()).collect();
                let names = [id.to_string()];
                let made = policies::runs(&names, &presets, &[seed], &sets, &self.out, place);
                runs.extend(made.map_err(end)?);
            }
        }
        Ok(runs)
    }
}

fn imported_before(id: &minari::DatasetId) -> bool {
    minari::finished_origin(&id.folder(&datasets_root())).is_some()
}
