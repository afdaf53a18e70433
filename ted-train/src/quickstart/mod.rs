//! The whole pipeline at reduced size: from nothing, or from a person's own logs, to a policy that has flown, and beside it the clone of
//! the same logs, which is what they give without a look and without an answer.
//!
//! Every stage is the one that the other commands run, with smaller numbers, and every stage goes on where it was stopped.

mod narrator;

use std::path::{Path, PathBuf};

use firmware_sim::bridge::Engine;
use firmware_sim::bridge::environment::SetupError;
use firmware_sim::controller::Numeric;
use firmware_sim::progress::Audience;
use firmware_sim::worlds::{Ready, Task, World};
use serde::Serialize;

use crate::collect::{self, CollectConfig, CollectError, CollectReport, PartReport, Recipe};
use crate::config::{Config, ConfigError, Preset};
use crate::crosscheck::{Crosscheck, CrosscheckConfig, CrosscheckError, crosscheck};
use crate::dataset::{Dataset, DatasetError};
use crate::evaluate::{EvaluateError, Evaluation, FlightPlan, Flyer, evaluate_once};
use crate::fleet::Lane;
use crate::preferences::{ScriptedTeacher, Teacher};
use crate::report::report;
use crate::reward::episodes::Confidence;
use crate::run::{DatasetReference, EVALUATION, PREFERENCES, REPORT, RunError, RunFolder};
use crate::train::{RewardReport, TrainError, check_teacher, train};
use firmware_sim::disk::WriteError;

use narrator::Narrator;

/// Episodes that show what the scripted policy reaches.
const SCRIPTED_EPISODES: u32 = 5;
/// Episodes that the trained policy flies.
const FLOWN_EPISODES: u32 = 10;
/// Of these, how many the cross-check flies again.
const CHECKED_EPISODES: u32 = 2;
/// Updates between two checkpoints: a few seconds.
const CHECKPOINT_EVERY: u64 = 2_000;

/// How large, and where.
#[derive(Clone, Debug)]
pub struct QuickstartConfig {
    /// Where its logs come from, and where it flies.
    pub setting: Setting,
    /// The folder that everything is written to.
    pub out: PathBuf,
    /// Updates of the policy, and of the clone.
    pub steps: u64,
    /// Root of all randomness.
    pub seed: u64,
    /// Simulator processes.
    pub workers: usize,
    /// How many answers a person gives; none where the simulated teacher answers.
    pub asked: Option<usize>,
}

/// Where the logs of a quickstart come from, and where it flies.
#[derive(Clone, Debug)]
pub enum Setting {
    /// So many episodes of a task are collected, and it flies there.
    Collected(Task, u32),
    /// A person's logs, in this folder, and a world to fly in.
    Own(PathBuf, World),
}

/// What a quickstart learns from.
#[derive(Debug)]
pub struct Logs {
    world: Ready,
    /// The scripted policy, if there is one.
    scripted: Option<CollectReport>,
    /// The folder of the logs.
    folder: PathBuf,
}

/// What came of it.
#[derive(Clone, Debug, Serialize)]
pub struct Quickstart {
    /// The task.
    pub task: String,
    /// The dataset that the policy was learned from.
    pub dataset: PartReport,
    /// Whether the logs have rewards, and with them returns.
    pub rewarded: bool,
    /// The scripted policy without noise, if there is one.
    pub scripted: Option<PartReport>,
    /// The clone of the dataset, which nobody was asked for.
    pub cloned: Evaluation,
    /// The trained policy.
    pub trained: Evaluation,
    /// How sure the model is that the episodes that the policy imitates are better than the others.
    pub confidence: Option<Confidence>,
    /// Whether the trained policy's mean return is larger than that of its dataset; none where that has none.
    pub beats_dataset: Option<bool>,
    /// Whether it is larger than that of the clone.
    pub beats_clone: bool,
    /// Whether what flew is what was trained.
    pub crosscheck: Crosscheck,
    /// What was written.
    pub written: Vec<Written>,
}

/// A file or folder that was written.
#[derive(Clone, Debug, Serialize)]
pub struct Written {
    /// What it is.
    pub what: &'static str,
    /// Where it is.
    pub path: PathBuf,
}

/// The stage that failed.
#[derive(Debug, thiserror::Error)]
#[error(transparent)]
pub enum QuickstartError {
    /// Setting up the simulator.
    Setup(#[from] SetupError),
    /// Collecting.
    Collect(#[from] CollectError),
    /// Reading what was collected.
    Dataset(#[from] DatasetError),
    /// The numbers asked for.
    Config(#[from] ConfigError),
    /// The run's folder.
    Run(#[from] RunError),
    /// Writing results.
    Write(#[from] WriteError),
    /// Training.
    Train(#[from] TrainError),
    /// Flying.
    Evaluate(#[from] EvaluateError),
    /// Cross-checking.
    Crosscheck(#[from] CrosscheckError),
}

impl QuickstartConfig {
    /// The training configuration: the method, with fewer updates.
    ///
    /// # Errors
    /// When the number of updates is zero.
    pub fn training(&self) -> Result<Config, ConfigError> {
        let config = self.reduced(Preset::default())?;
        Ok(match self.asked {
            Some(answers) => config.asking(answers),
            None => config,
        })
    }

    /// The run, for who asks its questions.
    ///
    /// # Errors
    /// When the number of updates is zero.
    pub fn lane(&self, logs: &Logs) -> Result<Lane, ConfigError> {
        Ok(Lane {
            dataset: logs.folder.clone(),
            config: self.training()?,
            folder: self.run_folder(Preset::default()),
            answers: None,
            siblings: Vec::new(),
        })
    }

    fn reduced(&self, preset: Preset) -> Result<Config, ConfigError> {
        let mut config = Config {
            seed: self.seed,
            ..preset.config()
        };
        config.algorithm.set_steps(self.steps);
        config.schedule.checkpoint_every = CHECKPOINT_EVERY;
        config.schedule.evaluation_episodes = FLOWN_EPISODES;
        config.check()?;
        Ok(config)
    }

    fn collection(&self, task: Task, recipe: Recipe, episodes: u32) -> CollectConfig {
        CollectConfig {
            task: task.name().to_owned(),
            recipe,
            episodes: Some(episodes),
            good: None,
            seed: self.seed,
            workers: self.workers,
            root: self.out.join("datasets"),
        }
    }

    /// One folder for each choice, so that another size is another run.
    fn run_folder(&self, preset: Preset) -> PathBuf {
        let (steps, seed) = (self.steps, self.seed);
        let asked = if self.asked.is_some() && preset != Preset::Bc {
            "-asked"
        } else {
            ""
        };
        let logs = match &self.setting {
            Setting::Collected(_, episodes) => format!("-n{episodes}"),
            Setting::Own(..) => String::new(),
        };
        let name = format!("{}{logs}-u{steps}-s{seed}{asked}", preset.name());
        self.out.join(self.setting.name()).join(name)
    }
}

impl Setting {
    fn name(&self) -> String {
        match self {
            Self::Collected(task, _) => task.name().to_owned(),
            Self::Own(logs, _) => logs
                .file_name()
                .unwrap_or_default()
                .to_string_lossy()
                .into_owned(),
        }
    }
}

/// Sets up the simulator and records the logs: the first two of six stages.
///
/// # Errors
/// When a stage fails or is interrupted; what is complete is kept, and the same call goes on.
pub fn record(config: &QuickstartConfig, audience: Audience) -> Result<Logs, QuickstartError> {
    stage(audience, 1, "set up the simulator");
    let engine = Engine::default();
    match &config.setting {
        Setting::Own(logs, world) => {
            let world = world.clone().ready(engine, audience)?;
            stage(audience, 2, &format!("read the logs in {}", logs.display()));
            Ok(Logs {
                world,
                scripted: None,
                folder: logs.clone(),
            })
        }
        Setting::Collected(task, episodes) => {
            collect::check_room(&config.collection(*task, Recipe::Paper, *episodes))?;
            let world = World::Listed(*task).ready(engine, audience)?;
            stage(
                audience,
                2,
                "record the scripted policy, and what a bad robot would do",
            );
            let collected = |recipe, episodes| {
                let collection = config.collection(*task, recipe, episodes);
                collect::run_anywhere(&collection, engine, audience)
            };
            let scripted = collected(Recipe::Expert, SCRIPTED_EPISODES)?;
            let folder = collected(Recipe::Paper, *episodes)?.folder;
            Ok(Logs {
                world,
                scripted: Some(scripted),
                folder,
            })
        }
    }
}

fn stage(audience: Audience, number: u32, what: &str) {
    audience.note(&format!("\n[{number}/6] {what}"));
}

/// Asks, learns, exports, flies and cross-checks: the other four stages. What a person has answered in the run's folder is not asked.
///
/// # Errors
/// When a stage fails or is interrupted; what is complete is kept, and the same call goes on.
pub fn quickstart(
    config: &QuickstartConfig,
    logs: &Logs,
    audience: Audience,
) -> Result<Quickstart, QuickstartError> {
    let Logs {
        world,
        scripted,
        folder: logs,
    } = logs;
    let training = config.training()?;
    let dataset = Dataset::open(logs)?;
    if config.asked.is_none() {
        check_teacher(&dataset, &training)?;
    }

    stage(
        audience,
        3,
        match config.asked {
            None => {
                "look at the logs, ask ten questions, and learn a policy that the answers steer"
            }
            Some(_) => "learn a policy that your answers steer",
        },
    );
    let reference = DatasetReference {
        id: dataset.id().to_owned(),
        digest: dataset.digest().to_owned(),
        path: logs.clone(),
    };
    let learned = |training: &Config, teacher: &mut dyn Teacher| {
        let path = config.run_folder(training.preset);
        let folder = RunFolder::begin(&path, training, &reference)?;
        train(&dataset, training, &folder, teacher, audience.into())?;
        Ok::<_, QuickstartError>(folder)
    };
    let mut teacher = Narrator::new(ScriptedTeacher::truthful(), audience);
    let folder = learned(&training, &mut teacher)?;
    if config.asked.is_none() && teacher.asked() == 0 {
        let log = folder.file(PREFERENCES);
        audience.note(&format!(
            "  the questions were asked before: {}",
            log.display()
        ));
    }

    stage(
        audience,
        4,
        "clone the same logs without asking, for comparison",
    );
    let clone = learned(&config.reduced(Preset::Bc)?, &mut teacher)?;

    stage(audience, 5, "fly both");
    let plan = FlightPlan {
        episodes: FLOWN_EPISODES,
        seed: config.seed,
        workers: config.workers,
        engine: Engine::default(),
    };
    let flown = |folder: &RunFolder| {
        let artefact = folder.artefact_path();
        let flyer = Flyer::Artefact(&artefact, Numeric::F32);
        evaluate_once(folder, flyer, Some(world.world().clone()), &plan, audience)
    };
    let (trained, cloned) = (flown(&folder)?, flown(&clone)?);

    stage(audience, 6, "is what flew what was trained?");
    let check = CrosscheckConfig {
        sample: None,
        episodes: CHECKED_EPISODES,
        workers: config.workers,
    };
    let crosscheck = crosscheck(&folder, &dataset, &check, audience)?;
    folder.write_json("crosscheck.json", &crosscheck)?;
    // The run is what it is without its page.
    if let Err(error) = report(&folder, &dataset, logs, &folder.file(REPORT), audience) {
        audience.note(&format!("there is no report: {error}"));
    }

    let rewarded = dataset.only_reward().is_none();
    let reward: RewardReport = folder.read_json("reward.json")?;
    Ok(Quickstart {
        task: config.setting.name(),
        beats_dataset: rewarded.then(|| trained.return_mean > dataset.mean_return_true()),
        rewarded,
        beats_clone: trained.return_mean > cloned.return_mean,
        dataset: PartReport::of_logs(&dataset),
        scripted: scripted.as_ref().map(|it| it.mix.clone()),
        cloned,
        trained,
        confidence: reward.confidence,
        crosscheck,
        written: written(logs, scripted.as_ref(), &clone, &folder),
    })
}

fn written(
    dataset: &Path,
    scripted: Option<&CollectReport>,
    clone: &RunFolder,
    folder: &RunFolder,
) -> Vec<Written> {
    let entry = |what, path: PathBuf| Written { what, path };
    let scripted = scripted.map(|it| entry("scripted policy", it.folder.clone()));
    let all = [
        entry("dataset", dataset.to_path_buf()),
        entry("clone", clone.path().to_path_buf()),
        entry("questions", folder.file(PREFERENCES)),
        entry("reward quality", folder.file("reward.json")),
        entry("configuration", folder.config_path()),
        entry("metrics", folder.file("metrics.jsonl")),
        entry("artefact", folder.artefact_path()),
        entry("evaluation", folder.file(EVALUATION)),
        entry("cross-check", folder.file("crosscheck.json")),
        entry("report, to look at", folder.file(REPORT)),
    ];
    let all = all.into_iter().chain(scripted);
    all.filter(|it| it.path.exists()).collect()
}

#[cfg(test)]
mod tests {
    use firmware_sim::worlds;

    use super::*;

    fn task() -> Task {
        worlds::single("box-close-v3").unwrap()
    }

    fn config() -> QuickstartConfig {
        QuickstartConfig {
            setting: Setting::Collected(task(), 3),
            out: PathBuf::from("out"),
            steps: 7,
            seed: 5,
            workers: 1,
            asked: None,
        }
    }

    #[test]
    fn the_quickstart_differs_from_the_method_in_size_only() {
        let mut training = config().training().unwrap();
        assert_eq!((training.seed, training.algorithm.steps()), (5, 7));
        let method = Preset::default().config();
        training.seed = method.seed;
        training.algorithm.set_steps(method.algorithm.steps());
        training.schedule = method.schedule.clone();
        assert_eq!(training, method);
    }

    #[test]
    fn who_answers_more_questions_gets_a_run_that_wants_as_many() {
        let asked = QuickstartConfig {
            asked: Some(15),
            ..config()
        };
        let training = asked.training().unwrap();
        assert_eq!(training.answers(), 15);
        assert_eq!(training.asking(10), config().training().unwrap());
    }

    #[test]
    fn everything_is_written_below_one_folder() {
        let config = config();
        let [own, clone] = [Preset::default(), Preset::Bc].map(|it| config.run_folder(it));
        assert!(own.starts_with("out") && clone.starts_with("out") && own != clone);
        assert!(
            config
                .collection(task(), Recipe::Paper, 3)
                .root
                .starts_with("out")
        );
        assert!(config.training().is_ok());
        assert!(QuickstartConfig { steps: 0, ..config }.training().is_err());
    }
}
