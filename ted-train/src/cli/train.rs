//! `ted train`: a dataset and ten answers in, an artefact out.

use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

use clap::Args;
use firmware_sim::failure::Failure;
use firmware_sim::output::OutputArgs;
use firmware_sim::tasks;
use serde::Serialize;

use crate::config::{Overrides, Preset};
use crate::dataset::Dataset;
use crate::evaluate::evaluate_once;
use crate::preferences::{PreferenceLog, ReplayTeacher, ScriptedTeacher, Teacher};
use crate::run::{DatasetReference, PREFERENCES, RunFolder};
use crate::train::{check, train};

use super::collect::workers;
use super::eval::text;
use super::failures::end;
use super::locate::{open_dataset, run_folder};

const EXAMPLES: &str = "\
Examples:
  ted train drawer-open-v3                                   the method, with the paper's constants
  ted train drawer-open-v3 --preset true --seed 2            true rewards, another seed
  ted train drawer-open-v3 --set iql.steps=50000 --set discount.sigma=0.5
  ted train data/ted/mine-v0 --preferences answers.jsonl     with answers given before

Any field of config.toml can be set, except preset and seed, which have flags of their own.
A stopped run goes on with the same command.";

/// Learn a reward from preferences, set discounts, learn a policy, export and fly it
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct TrainArgs {
    /// A dataset folder, a Minari id, or a task that `ted collect` has collected
    dataset: String,
    /// The composition of reward source, discount and algorithm; that of --config, or oprl-i+ted, if not given
    #[arg(long, value_enum)]
    preset: Option<Preset>,
    /// Root of all randomness; that of --config, or 0, if not given
    #[arg(long)]
    seed: Option<u64>,
    /// The run's folder; runs/<task>/<preset>/seed-<seed> if not given
    #[arg(long)]
    out: Option<PathBuf>,
    /// A TOML file over the preset
    #[arg(long)]
    config: Option<PathBuf>,
    /// One field over the preset and the file, key=value; may be given several times
    #[arg(long = "set", value_name = "KEY=VALUE")]
    sets: Vec<String>,
    /// Answer from this preference log instead of from true returns
    #[arg(long, value_name = "FILE")]
    preferences: Option<PathBuf>,
    /// Simulator processes for the evaluation; all cores if not given
    #[arg(long)]
    workers: Option<NonZeroUsize>,
    #[command(flatten)]
    output: OutputArgs,
}

pub(super) fn run(args: &TrainArgs) -> Result<(), Failure> {
    let mut overrides = Overrides::default();
    if let Some(path) = &args.config {
        overrides = overrides.file(path).map_err(end)?;
    }
    for set in &args.sets {
        overrides = overrides.set(set).map_err(end)?;
    }
    let config = overrides.resolve(args.preset, args.seed).map_err(end)?;
    let audience = args.output.audience();

    let (dataset, path) = open_dataset(&args.dataset)?;
    let reference = DatasetReference {
        id: dataset.id().to_owned(),
        digest: dataset.digest().to_owned(),
        path,
    };
    // Nothing is begun that cannot be ended.
    check(&dataset, &config).map_err(end)?;
    let answers = match &args.preferences {
        Some(log) => Some((log, ReplayTeacher::open(log, &dataset).map_err(end)?)),
        None => None,
    };
    let task = dataset.task().unwrap_or("unknown");
    let out = args
        .out
        .clone()
        .unwrap_or_else(|| run_folder(task, config.preset.name(), config.seed));
    let folder = RunFolder::begin(&out, &config, &reference).map_err(end)?;
    let mut teacher: Box<dyn Teacher> = match answers {
        Some((log, answers)) => {
            same_answers(&answers, log, &folder, &dataset)?;
            Box::new(answers)
        }
        None => Box::new(ScriptedTeacher::new(0.0).map_err(end)?),
    };
    train(&dataset, &config, &folder, teacher.as_mut(), audience).map_err(end)?;
    audience.note(&format!("wrote {}", folder.artefact_path().display()));

    let episodes = config.schedule.evaluation_episodes;
    let simulated = tasks::single(task).is_ok();
    if episodes > 0 && !simulated {
        audience.note("not flown: the dataset is of no Meta-World task");
    }
    if episodes == 0 || !simulated {
        let trained = Trained {
            artefact: folder.artefact_path(),
        };
        return args
            .output
            .print(&trained, || trained.artefact.display().to_string());
    }
    let workers = workers(args.workers);
    let report = evaluate_once(&folder, episodes, config.seed, workers, audience).map_err(end)?;
    args.output.print(&report, || text(&report))
}

/// What a run without an evaluation has to say.
#[derive(Debug, Serialize)]
struct Trained {
    artefact: PathBuf,
}

/// Refuses to go on in a folder that holds answers of anybody else.
fn same_answers(
    answers: &ReplayTeacher,
    log: &Path,
    folder: &RunFolder,
    dataset: &Dataset,
) -> Result<(), Failure> {
    let held = folder.file(PREFERENCES);
    if !held.exists() {
        return Ok(());
    }
    let held = PreferenceLog::read(&held, dataset).map_err(end)?;
    match answers.first_other_answer(&held) {
        None => Ok(()),
        Some(number) => {
            let difference = format!("its answer {number} is not one of {}", log.display());
            Err(end(folder.other(difference)))
        }
    }
}
