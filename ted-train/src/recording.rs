//! One flight of a policy, step by step: what was seen, what was done, and what there is to draw of it.

use std::path::Path;

use firmware_sim::bridge::State;
use firmware_sim::controller::{Controller, Numeric};
use firmware_sim::plant::{Observed, Plant, PlantError, StepOutcome};
use firmware_sim::rollout::{EpisodeError, EpisodeReport, FlyError, fly_episode};
use firmware_sim::worlds::{AnyPlant, Ready};
use ted_policy::{Artifact, ArtifactBytes};

use crate::evaluate::EvaluateError;

/// A flight that was recorded.
#[derive(Clone, Debug, PartialEq)]
pub struct Recording {
    /// How it went.
    pub report: EpisodeReport,
    /// What happened before each of its steps, and at it.
    pub moments: Vec<Moment>,
}

/// A step of a flight.
#[derive(Clone, Debug, PartialEq)]
pub struct Moment {
    /// What the policy saw.
    pub observation: Vec<f32>,
    /// What the controller did.
    pub action: Vec<f32>,
    /// What there is to draw; none where nothing is simulated.
    pub state: Option<State>,
}

/// Flies the episode of this seed with the controller, and keeps all of it. It is the episode of that seed of every other flight.
///
/// # Errors
/// When the artefact is broken, or the flight cannot be finished.
pub fn record(
    artefact: &Path,
    numeric: Numeric,
    world: &Ready,
    seed: u64,
) -> Result<Recording, EvaluateError> {
    let bytes = ArtifactBytes::read(artefact)?;
    let artifact = Artifact::parse(&bytes).map_err(EvaluateError::Artifact)?;
    let mut controller = Controller::load(&artifact, numeric).map_err(FlyError::Load)?;
    let period_us = artifact.contract().control_period_us;
    let mut plants = world.plants(1, period_us).map_err(FlyError::NoPlant)?;
    match plants.pop() {
        Some(plant) => fly(&mut controller, plant, seed),
        None => Err(FlyError::NoPlant(PlantError::NoEpisode).into()),
    }
}

fn fly(
    controller: &mut Controller<'_>,
    plant: AnyPlant,
    seed: u64,
) -> Result<Recording, EvaluateError> {
    let mut recorder = Recorder {
        plant,
        seen: Vec::new(),
        moments: Vec::new(),
    };
    let failed = |source: EpisodeError| FlyError::Episode { seed, source };
    let (report, _) = fly_episode(controller, &mut recorder, seed).map_err(failed)?;
    Ok(Recording {
        report,
        moments: recorder.moments,
    })
}

/// A plant that keeps what happens to it.
struct Recorder {
    plant: AnyPlant,
    /// The latest observation.
    seen: Vec<f32>,
    moments: Vec<Moment>,
}

impl Plant for Recorder {
    fn reset(&mut self, seed: u64) -> Result<(), PlantError> {
        self.moments.clear();
        self.plant.reset(seed)
    }

    fn now_us(&self) -> u64 {
        self.plant.now_us()
    }

    fn observe(&mut self) -> Result<Observed, PlantError> {
        let observed = self.plant.observe()?;
        self.seen.clone_from(&observed.values);
        Ok(observed)
    }

    fn apply(&mut self, action_env: &[f32]) -> Result<StepOutcome, PlantError> {
        self.moments.push(Moment {
            observation: self.seen.clone(),
            action: action_env.to_vec(),
            state: self.plant.state()?,
        });
        self.plant.apply(action_env)
    }
}
