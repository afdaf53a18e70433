//! `ted train`: datasets and ten answers in, artefacts out.

use std::collections::HashSet;
use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::Args;
use firmware_sim::counts::at_a_time;
use firmware_sim::exit::ExitCode;
use firmware_sim::failure::Failure;
use firmware_sim::output::OutputArgs;

use crate::config::Overrides;
use crate::fleet::{self, Crew, Datasets, Lane, introduce};
use crate::need;
use crate::run::RunFolder;
use crate::train::{Watch, check, check_teacher};

use super::door::{DoorArgs, Errand, door};
use super::failures::end;
use super::fleet_report::FleetReport;
use super::locate::{dataset_path, no_dataset, run_folder};
use super::presets::{self, PresetArg};
use super::report;
use super::run_report::RunReport;
use super::seeds::Seeds;

const EXAMPLES: &str = "\
Examples:
  ted train drawer-open-v3                                   our method, steer
  ted train drawer-open-v3 --preset oprl-i+ted               the paper's, with its constants
  ted train drawer-open-v3 --preset true --seed 2            true rewards, another seed
  ted train --preset list                                    every preset, what it is for and where it comes from
  ted train drawer-open-v3 --set algorithm.steps=40000 --set reward.queries=20
  ted train drawer-open-v3 --ask                             you answer, on a web page, and then it trains
  ted train data/ted/mine-v0 --preferences answers.jsonl     with answers given before
  ted train drawer-open-v3,box-close-v3 --preset oprl-i,oprl-i+ted --seeds 0..6      a fleet of 24 runs
  ted train drawer-open-v3 --seeds 0..6 --device cuda        six runs as one batch on a GPU

Any field of config.toml can be set, except preset and seed, which have flags of their own.
Several datasets, presets or seeds make a fleet: every combination is a run with a folder of its own, runs go side by side \
on all cores, or as one batch on a GPU, and one that fails does not stop the others. What a run learns does not depend on its company.
A stopped run goes on with the same command; a fleet does what is missing.";

/// Where training is done.
#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum Device {
    /// The default engine for processors
    Cpu,
    /// burn's CUDA backend; needs a `ted` that was built with `--features cuda`
    Cuda,
}

/// Learn a reward from preferences, set discounts, learn a policy, export and fly it
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct TrainArgs {
    /// Dataset folders, Minari ids, or tasks that `ted collect` has collected
    #[arg(value_delimiter = ',')]
    datasets: Vec<String>,
    /// Tasks that were collected: another way to name their datasets
    #[arg(long, value_delimiter = ',', value_name = "TASK")]
    task: Vec<String>,
    /// The compositions of reward source, filter, discount and algorithm; that of --config, or steer, if not given
    #[arg(long, value_enum, value_delimiter = ',', hide_possible_values = true)]
    preset: Vec<PresetArg>,
    /// Root of all randomness; that of --config, or 0, if not given
    #[arg(long, value_parser = clap::value_parser!(u64).range(..=i64::MAX as u64))]
    seed: Option<u64>,
    /// Several of them, 0..6 for 0 to 5 or a list
    #[arg(long, conflicts_with = "seed")]
    seeds: Option<Seeds>,
    /// The run's folder; runs/<task>/<preset>/seed-<seed> if not given. Of a fleet, the folder that holds those
    #[arg(long)]
    out: Option<PathBuf>,
    /// A TOML file over the preset
    #[arg(long)]
    config: Option<PathBuf>,
    /// What trains: this machine's processor, or its NVIDIA GPU, where all runs of a fleet are one batch. That of --config, or
    /// cpu, if not given
    #[arg(long, value_enum)]
    device: Option<Device>,
    /// One field over the preset and the file, key=value, or preset,preset:key=value for these presets; may be given several times
    #[arg(long = "set", value_name = "KEY=VALUE")]
    sets: Vec<String>,
    /// Answer from this preference log instead of asking the simulated teacher, who knows the true returns
    #[arg(long, value_name = "FILE")]
    preferences: Option<PathBuf>,
    /// Answer the questions yourself before anything is trained, on a web page or with --text in the terminal
    #[arg(long, conflicts_with = "preferences")]
    ask: bool,
    #[command(flatten)]
    door: DoorArgs,
    /// Simulator processes for the evaluation of a single run; all cores if not given
    #[arg(long, value_parser = at_a_time)]
    workers: Option<NonZeroUsize>,
    /// Runs of a fleet at a time; one for each core if not given. Changes nothing but the time
    #[arg(long, value_parser = at_a_time)]
    jobs: Option<NonZeroUsize>,
    #[command(flatten)]
    output: OutputArgs,
}

pub(super) fn run(args: &TrainArgs) -> Result<(), Failure> {
    if args.preset.contains(&PresetArg::List) {
        let all = presets::compositions();
        return args.output.print(&all, || presets::text(&all));
    }
    let datasets = Datasets::default();
    let mut lanes = plan(args, &datasets)?;
    let audience = args.output.audience();
    if let ([lane], true) = (lanes.as_mut_slice(), args.ask) {
        let log = door(lane, &datasets, &args.door, Errand::Train, audience)?;
        lane.answers = Some(log);
    }
    if let [lane] = lanes.as_slice() {
        let simulators = args.workers.unwrap_or(Crew::of(1, None).threads);
        let watch = Watch::Alone(audience);
        let mut ends = fleet::together(&[lane], &datasets, simulators, watch);
        let trained = ends.swap_remove(0).map_err(end)?;
        let page = report::of_a_run(lane, &datasets, audience);
        let report = RunReport::of(&lane.folder, &trained, page.as_deref());
        return args.output.print(&report, || report.text());
    }
    let ends = fleet::run(&lanes, &datasets, args.jobs, audience, |_| ());
    let report = FleetReport::of(&lanes, &ends);
    args.output.print(&report, || report.text())?;
    match fleet::first_failure(&lanes, ends) {
        None => Ok(()),
        Some(error) => Err(end(error)),
    }
}

impl Device {
    fn setting(self) -> &'static str {
        match self {
            Self::Cpu => "backend=fused",
            Self::Cuda => "backend=cuda",
        }
    }
}

/// Every combination, seed by seed, so that an unfinished fleet has something of each, but for those that wait for the reward of
/// another. Nothing is begun that cannot be ended.
fn plan(args: &TrainArgs, datasets: &Datasets) -> Result<Vec<Lane>, Failure> {
    let mut overrides = Overrides::default();
    if let Some(path) = &args.config {
        overrides = overrides.file(path).map_err(end)?;
    }
    if let Some(device) = args.device {
        overrides = overrides.set(device.setting()).map_err(end)?;
    }
    for set in &args.sets {
        overrides = overrides.set(set).map_err(end)?;
    }
    let presets = match args.preset.as_slice() {
        [] => vec![None],
        some => some
            .iter()
            .filter_map(|one| one.preset())
            .map(Some)
            .collect(),
    };
    let seeds = match &args.seeds {
        Some(Seeds(seeds)) => seeds.iter().copied().map(Some).collect(),
        None => vec![args.seed],
    };
    let names: Vec<&String> = args.datasets.iter().chain(&args.task).collect();
    if names.is_empty() {
        return Err(Failure::new(
            ExitCode::Usage,
            "train on what? name a dataset's folder, its Minari id, or a task that `ted collect` has collected",
        ));
    }
    args.door.check(args.ask)?;
    if args.preferences.is_some() && names.len() > 1 {
        return Err(Failure::new(
            ExitCode::Usage,
            "--preferences are answers about one dataset: name one, or leave them out",
        ));
    }
    let mut configs = Vec::new();
    for seed in seeds {
        for preset in &presets {
            configs.push(overrides.resolve(*preset, seed).map_err(end)?);
        }
    }
    let trained: Vec<_> = configs.iter().map(|config| config.preset).collect();
    overrides.meant_for(&trained).map_err(end)?;
    let answered = args.preferences.is_some() || args.ask;
    let given = match args.ask {
        true => "what --ask asks for",
        false => "--preferences",
    };
    let deaf = configs.iter().find(|config| !config.asks());
    if let (true, Some(config)) = (answered, deaf) {
        return Err(Failure::new(
            ExitCode::Usage,
            format_args!(
                "{given} are answers, and the preset {} asks nothing: leave them out, or choose one of steer, oprl*, pt* or oppo",
                config.preset.name()
            ),
        ));
    }
    let taught = configs.iter().find(|config| !config.teacher.is_default());
    if let (true, Some(config)) = (answered, taught) {
        return Err(Failure::new(
            ExitCode::Usage,
            format_args!(
                "{given} are answers, and so are those of {}: leave out either those or the settings of the teacher",
                config.teacher.name()
            ),
        ));
    }
    let alone = names.len() * configs.len() == 1;
    if args.ask && !alone {
        return Err(Failure::new(
            ExitCode::Usage,
            "--ask asks a person about one run: name one dataset, one preset and one seed",
        ));
    }
    let at_a_time = Crew::of(names.len() * configs.len(), args.jobs)
        .batches
        .get();
    let mut tasks = Vec::new();
    for name in names {
        let path = dataset_path(name);
        let dataset = datasets.open(&path).map_err(|it| no_dataset(name, it))?;
        for config in &configs {
            check(&dataset, config).map_err(end)?;
            need::check(&dataset, config, at_a_time).map_err(end)?;
            if !answered {
                check_teacher(&dataset, config).map_err(end)?;
            }
        }
        tasks.push((path, dataset.task().unwrap_or("unknown").to_owned()));
    }
    let mut lanes = Vec::new();
    for config in &configs {
        for (dataset, task) in &tasks {
            let root = args.out.as_deref();
            let folder = match root {
                Some(folder) if alone => folder.to_path_buf(),
                _ => run_folder(root, task, config.preset.name(), config.seed),
            };
            lanes.push(Lane {
                dataset: dataset.clone(),
                config: config.clone(),
                folder,
                answers: args.preferences.clone(),
                siblings: Vec::new(),
            });
        }
    }
    // A single one finds out by itself, and first of all whether another process is at work there.
    if !alone {
        distinct(&lanes)?;
    }
    introduce(&mut lanes);
    Ok(lanes)
}

/// Refuses lanes that would share a folder, and folders that hold other runs.
fn distinct(lanes: &[Lane]) -> Result<(), Failure> {
    let mut folders = HashSet::new();
    for lane in lanes {
        if !folders.insert(&lane.folder) {
            return Err(Failure::new(
                ExitCode::Usage,
                format_args!(
                    "two runs would share {}: name each dataset and preset once, and give datasets of one task a command and \
                     an --out each",
                    lane.folder.display()
                ),
            ));
        }
        RunFolder::holds(&lane.folder, &lane.config).map_err(end)?;
    }
    Ok(())
}
