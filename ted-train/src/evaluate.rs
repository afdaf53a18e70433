//! Evaluation: the policy, flown in the world of its task, or in a person's own. What a controller can fly is
//! flown by the controller from its artefact; there is no second way for it to act. A sequence policy acts from this machine, behind the same checks.

use std::num::NonZeroUsize;
use std::path::Path;

use firmware_sim::bridge::Engine;
use firmware_sim::bridge::environment::SetupError;
use firmware_sim::controller::{Controller, Numeric};
use firmware_sim::device::message::Refusal;
use firmware_sim::disk::WriteError;
use firmware_sim::interrupt;
use firmware_sim::progress::Audience;
use firmware_sim::remote::RemoteError;
use firmware_sim::rollout::{
    EpisodeReport, FlyError, Pilot, Summary, abreast, episode_seeds, fly_with,
};
use firmware_sim::worlds::{TaskError, World};
use serde::{Deserialize, Serialize};
use ted_policy::{Artifact, ArtifactBytes, ArtifactError, ContractFault, LoadError};

use crate::algorithm::oppo::{Oppo, SequencePilot};
use crate::contract::contract;
use crate::dataset::Dataset;
use crate::run::{EVALUATION, RunFolder};

/// How a policy flew.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Evaluation {
    /// The task.
    pub task: String,
    /// The world, where it is a person's own: its file, or `gym:` and an id.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub world: Option<String>,
    /// In which numbers the policy computed.
    #[serde(default)]
    pub numeric: Numeric,
    /// How the task was simulated; reports from before there was a choice are the reference's.
    #[serde(default = "reference")]
    pub engine: Engine,
    /// Root of the episodes' seeds.
    pub seed: u64,
    /// True return of each episode.
    pub returns: Vec<f64>,
    /// Their mean.
    pub return_mean: f64,
    /// Their standard deviation.
    pub return_sd: f64,
    /// Mean return over the largest return of the dataset, the paper's score, or in a world with a yardstick of its own by that; none on
    /// another task than the dataset's.
    pub score: Option<f64>,
    /// Share of episodes with success at some step.
    pub success: f64,
    /// Episodes in which the controller latched a fault.
    pub faulted: usize,
    /// The faults.
    pub faults: Vec<EpisodeFault>,
    /// Mean true return of the dataset.
    pub dataset_mean: f64,
    /// Largest true return of the dataset.
    pub dataset_max: f64,
}

/// The fault that ended the policy's part in an episode.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct EpisodeFault {
    /// The episode's place among those that were flown.
    pub episode: usize,
    /// Ticks that the policy had flown before.
    pub tick: u32,
    /// The reason's number.
    pub code: u8,
    /// The reason.
    pub reason: String,
}

impl EpisodeFault {
    /// The fault of an episode, if it had one.
    #[must_use]
    pub fn of(episode: usize, report: &EpisodeReport) -> Option<Self> {
        let latched = report.fault?;
        Some(Self {
            episode,
            tick: latched.tick,
            code: latched.fault.code(),
            reason: latched.fault.to_string(),
        })
    }
}

impl Evaluation {
    /// The world that it flew in; none if that is there no more.
    #[must_use]
    pub fn world(&self) -> Option<World> {
        match &self.world {
            Some(own) => own.parse().ok().map(World::Own),
            None => World::of_task(&self.task).ok(),
        }
    }

    /// What a score is, in words; none where there is none.
    #[must_use]
    pub fn measure(&self) -> Option<String> {
        self.score?;
        Some(match self.world()?.yardstick() {
            Some([zero, one]) => format!("0 is a return of {zero:.1}, 1 is {one:.1}"),
            None => format!(
                "mean return over the largest return in the logs, {:.0}",
                self.dataset_max
            ),
        })
    }

    /// The score that another mean return would have here; none where the policy's has none.
    #[must_use]
    pub fn score_of(&self, return_mean: f64) -> Option<f64> {
        self.score?;
        self.world()?
            .score(return_mean, self.dataset_max, &self.task)
    }

    /// Whether a fault kept the policy from flying a single tick of any episode.
    #[must_use]
    pub fn never_flew(&self) -> bool {
        self.faults.len() == self.returns.len() && self.faults.iter().all(|fault| fault.tick == 0)
    }
}

/// Why a policy could not be flown.
#[derive(Debug, thiserror::Error)]
pub enum EvaluateError {
    /// The artefact cannot be read.
    #[error(transparent)]
    Load(#[from] LoadError),
    /// The dataset of a sequence policy promises nothing that could be checked.
    #[error("the dataset makes no valid contract: {0}")]
    Contract(ContractFault),
    /// The artefact is broken.
    #[error("the artefact is not valid: {0}")]
    Artifact(ArtifactError),
    /// Nobody declared the robot.
    #[error("fly the policy: {}", Refusal::Undeclared)]
    Undeclared,
    /// The simulator has no such task.
    #[error(transparent)]
    Task(#[from] TaskError),
    /// Its logs are of no world that is known here.
    #[error(
        "the policy was learned from logs of {task:?}, which is no world that is known here: fly it in one of your own with --world FILE, \
         which docs/own-world.md explains, or show it the logs with --replay"
    )]
    NoWorld {
        /// What the logs are of.
        task: String,
    },
    /// There is no simulator.
    #[error(transparent)]
    Setup(#[from] SetupError),
    /// The flight.
    #[error(transparent)]
    Fly(#[from] FlyError),
    /// The disk.
    #[error(transparent)]
    Write(#[from] WriteError),
}

const fn reference() -> Engine {
    Engine::Reference
}

/// Which episodes to fly, and on what.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FlightPlan {
    /// How many episodes.
    pub episodes: u32,
    /// Root of their seeds.
    pub seed: u64,
    /// Simulator processes; changes nothing but the time.
    pub workers: usize,
    /// How they simulate; changes nothing but the time either.
    pub engine: Engine,
}

/// What flies.
#[derive(Clone, Copy)]
pub enum Flyer<'a> {
    /// The controller, with this artefact and in these numbers.
    Artefact(&'a Path, Numeric),
    /// A sequence policy that was learned from this dataset.
    Sequence(&'a Oppo, &'a Dataset),
}

/// Flies the episodes of a plan, in this world or, if none is named, in that of the task that the policy was learned for.
///
/// # Errors
/// When the artefact is broken, there is no simulator, or a flight cannot be finished.
pub fn evaluate(
    flyer: Flyer<'_>,
    world: Option<World>,
    plan: &FlightPlan,
    audience: Audience,
) -> Result<Evaluation, EvaluateError> {
    match flyer {
        Flyer::Artefact(path, numeric) => {
            let bytes = ArtifactBytes::read(path)?;
            let artifact = Artifact::parse(&bytes).map_err(EvaluateError::Artifact)?;
            let (contract, provenance) = (artifact.contract(), artifact.provenance());
            let origin = Origin {
                task: contract.task,
                period_us: contract.control_period_us,
                declared: contract.declared,
                return_mean: provenance.dataset_return_mean,
                return_max: provenance.dataset_return_max,
            };
            let controller = Controller::load(&artifact, numeric).map_err(FlyError::Load)?;
            let pilot = || Ok(controller.clone());
            fly_all(pilot, &origin, numeric, world, plan, audience)
        }
        Flyer::Sequence(oppo, dataset) => {
            let contract = contract(dataset).map_err(EvaluateError::Contract)?;
            let origin = Origin {
                task: contract.task,
                period_us: contract.control_period_us,
                declared: contract.declared,
                return_mean: dataset.mean_return_true(),
                return_max: dataset.max_return_true(),
            };
            let pilot = || Ok(SequencePilot::new(oppo, &contract));
            fly_all(pilot, &origin, Numeric::F32, world, plan, audience)
        }
    }
}

/// Where a policy comes from, and what its score is measured by.
struct Origin<'a> {
    task: &'a str,
    period_us: u32,
    declared: bool,
    return_mean: f64,
    return_max: f64,
}

fn fly_all<Q: Pilot>(
    make_pilot: impl Fn() -> Result<Q, RemoteError> + Sync,
    origin: &Origin<'_>,
    numeric: Numeric,
    world: Option<World>,
    plan: &FlightPlan,
    audience: Audience,
) -> Result<Evaluation, EvaluateError> {
    let FlightPlan {
        episodes,
        seed,
        engine,
        ..
    } = *plan;
    let workers = NonZeroUsize::new(plan.workers).unwrap_or(NonZeroUsize::MIN);
    if !origin.declared {
        return Err(EvaluateError::Undeclared);
    }
    let world = match world {
        Some(world) => world,
        None => World::of_task(origin.task).map_err(|_| EvaluateError::NoWorld {
            task: origin.task.to_owned(),
        })?,
    };
    let task = world.task();
    let world = world.ready(engine, audience)?;
    let progress = audience.start(&format!("fly {task}"), u64::from(episodes), "episodes");
    let seeds = episode_seeds(seed, episodes as usize);
    let landed = |_: &EpisodeReport| progress.advance(1);
    let plants = abreast(episodes as usize, workers);
    let flight = fly_with(
        make_pilot,
        || world.plants(plants, origin.period_us),
        &seeds,
        workers,
        interrupt::requested,
        landed,
    )?;
    progress.finish();
    let summary = Summary::of(&flight.episodes);
    Ok(Evaluation {
        score: world
            .world()
            .score(summary.return_mean, origin.return_max, origin.task),
        task,
        world: match world.world() {
            World::Own(own) => Some(own.source()),
            World::Listed(_) => None,
        },
        numeric,
        engine,
        seed,
        returns: flight.episodes.iter().map(|e| e.return_true).collect(),
        return_mean: summary.return_mean,
        return_sd: summary.return_sd,
        success: summary.success_rate,
        faulted: summary.faulted,
        faults: flight
            .episodes
            .iter()
            .enumerate()
            .filter_map(|(episode, report)| EpisodeFault::of(episode, report))
            .collect(),
        dataset_mean: origin.return_mean,
        dataset_max: origin.return_max,
    })
}

/// The evaluation that a run's folder holds if these episodes were flown, or else a new one, which it then holds. The world is that of
/// the run's task if none is named.
///
/// # Errors
/// When the policy cannot be flown, or the disk is full or fails.
pub fn evaluate_once(
    folder: &RunFolder,
    flyer: Flyer<'_>,
    world: Option<World>,
    plan: &FlightPlan,
    audience: Audience,
) -> Result<Evaluation, EvaluateError> {
    // One that cannot be read is flown again. What it flew is the artefact (`RunFolder::write_artefact`), or else what is
    // learned at the end of the run's configuration.
    if let Ok(held) = folder.read_json::<Evaluation>(EVALUATION)
        && (held.seed, held.returns.len()) == (plan.seed, plan.episodes as usize)
    {
        return Ok(held);
    }
    let evaluation = evaluate(flyer, world, plan, audience)?;
    folder.write_json(EVALUATION, &evaluation)?;
    Ok(evaluation)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::Preset;
    use crate::run::DatasetReference;

    #[test]
    fn an_evaluation_is_used_again_for_the_same_episodes_only() {
        let temporary = tempfile::tempdir().unwrap();
        let dataset = DatasetReference {
            id: "ted/x-v0".to_owned(),
            digest: String::new(),
            path: "x".into(),
        };
        let config = Preset::True.config();
        let folder = RunFolder::begin(temporary.path(), &config, &dataset).unwrap();
        let held = Evaluation {
            task: "reach-v3".to_owned(),
            world: None,
            numeric: Numeric::F32,
            engine: Engine::Fast,
            seed: 3,
            returns: vec![1.0, 2.0],
            return_mean: 1.5,
            return_sd: 0.5,
            score: None,
            success: 1.0,
            faulted: 0,
            faults: Vec::new(),
            dataset_mean: 0.0,
            dataset_max: 0.0,
        };
        folder.write_json(EVALUATION, &held).unwrap();
        let fly = |episodes, seed| {
            let plan = FlightPlan {
                episodes,
                seed,
                workers: 1,
                engine: Engine::Fast,
            };
            let artefact = folder.artefact_path();
            let flyer = Flyer::Artefact(&artefact, Numeric::F32);
            evaluate_once(&folder, flyer, None, &plan, Audience::Nobody)
        };
        assert_eq!(fly(2, 3).unwrap(), held);
        // There is no artefact: whoever wants to fly finds that out.
        for (episodes, seed) in [(3, 3), (2, 4)] {
            assert!(matches!(fly(episodes, seed), Err(EvaluateError::Load(_))));
        }
    }
}
