//! Episodes of the toy: logs that are no Meta-World, and need no Python.
//!
//! The scripted policy goes to the goal and closes the gripper. It is made worse as Meta-World's are: noise in every dimension, and
//! with probability epsilon a uniformly random action instead. Three streams of the episode's seed, one draw each a step.

use super::source::OnEpisode;
use super::{CollectConfig, EpisodeSource};
use crate::rng::{Seed, standard_normal};
use firmware_sim::bridge::{BridgeError, Episode, EpisodeJob, Shape as BridgeShape};
use firmware_sim::interrupt;
use firmware_sim::plant::{Plant, PlantError};
use firmware_sim::plants::toy::{ACTION_DIM, EPISODE_STEPS, OBSERVATION_DIM, ToyPlant, Units};
use rand::RngExt;

/// A full action moves by a twentieth, so that whatever is nearer is reached in one step.
const GAIN: f32 = 20.0;

/// The toy, in the units of a task.
#[derive(Clone, Copy, Debug)]
pub struct ToySource(Units);

impl ToySource {
    /// The source for a configuration whose task is a toy; none for another one.
    #[must_use]
    pub fn of(config: &CollectConfig) -> Option<Self> {
        Units::of_task(&config.task).map(Self)
    }
}

impl EpisodeSource for ToySource {
    fn versions(&mut self) -> Result<String, BridgeError> {
        let machine = std::env::consts::ARCH;
        Ok(format!(
            "toy={} machine={machine}",
            env!("CARGO_PKG_VERSION")
        ))
    }

    fn run(&mut self, jobs: &[EpisodeJob], on_episode: OnEpisode) -> Result<(), BridgeError> {
        for (index, job) in jobs.iter().enumerate() {
            if interrupt::requested() {
                return Err(BridgeError::Interrupted);
            }
            // A toy that was reset takes as many actions as it has steps. If one did not, its episode would be missed at the end.
            let Ok(episode) = play(self.0, job) else {
                continue;
            };
            if on_episode(index, episode).is_break() {
                break;
            }
        }
        Ok(())
    }
}

fn play(units: Units, job: &EpisodeJob) -> Result<Episode, PlantError> {
    let seed = Seed::root(job.seed);
    let [mut noise, mut choices, mut uniform] =
        ["noise", "choice", "uniform"].map(|name| seed.child(name).rng());
    let mut plant = ToyPlant::in_units(units);
    plant.reset(job.seed)?;
    let mut episode = Episode {
        shape: BridgeShape {
            observation: OBSERVATION_DIM,
            action: ACTION_DIM,
            qpos: 0,
            qvel: 0,
            mocap: 0,
            goal: 0,
            horizon: EPISODE_STEPS,
        },
        observations: plant.observe()?.values,
        actions: Vec::new(),
        rewards: Vec::new(),
        success: Vec::new(),
        terminations: Vec::new(),
        truncations: Vec::new(),
        qpos: Vec::new(),
        qvel: Vec::new(),
        mocap_pos: Vec::new(),
        mocap_quat: Vec::new(),
        goal: Vec::new(),
    };
    for step in 1..=job.steps {
        let seen = plant.observe()?.values;
        let normals = [(); ACTION_DIM].map(|()| standard_normal(&mut noise));
        let random = [(); ACTION_DIM].map(|()| uniform.random::<f64>() * 2.0 - 1.0);
        let scripted = scripted(units, &seen);
        let action: [f32; ACTION_DIM] = match choices.random::<f64>() < job.behaviour.epsilon {
            true => random.map(|value| value as f32),
            false => std::array::from_fn(|i| {
                let noisy = f64::from(scripted[i]) + job.behaviour.noise_std * normals[i];
                noisy.clamp(-1.0, 1.0) as f32
            }),
        };
        let outcome = plant.apply(&action)?;
        episode.observations.extend(plant.observe()?.values);
        episode.actions.extend(action);
        episode.rewards.push(outcome.reward_true);
        episode.success.push(outcome.success);
        episode.terminations.push(false);
        episode.truncations.push(step == job.steps);
    }
    Ok(episode)
}

/// Straight to the goal, with a closed gripper.
fn scripted(units: Units, seen: &[f32]) -> [f32; ACTION_DIM] {
    let scale = units.scale();
    let place = |i: usize| seen.get(i).map_or(0.0, |value| value / scale[i]);
    let go = |i: usize| (GAIN * (place(i + 2) - place(i))).clamp(-1.0, 1.0);
    [go(0), go(1), 1.0]
}

#[cfg(test)]
mod tests {
    use super::*;
    use firmware_sim::bridge::Behaviour;

    fn episode(units: Units, behaviour: Behaviour) -> Episode {
        let job = EpisodeJob {
            task: units.task().to_owned(),
            behaviour,
            seed: 5,
            steps: EPISODE_STEPS,
        };
        play(units, &job).unwrap()
    }

    #[test]
    fn the_scripted_policy_reaches_the_goal_and_noise_makes_it_worse() {
        let returned = |behaviour| episode(Units::Micrometres, behaviour).return_true();
        let [expert, noisy, epsilon] = [
            Behaviour::EXPERT,
            Behaviour::PAPER_NOISY,
            Behaviour::PAPER_EPSILON,
        ]
        .map(returned);
        assert!(
            expert > noisy && noisy > epsilon,
            "{expert} {noisy} {epsilon}"
        );
        assert!(episode(Units::Table, Behaviour::EXPERT).solved());
    }

    #[test]
    fn other_units_are_the_same_episodes_in_other_numbers() {
        let [table, micrometres] = Units::ALL.map(|units| episode(units, Behaviour::EXPERT));
        assert_eq!(table.rewards.len(), micrometres.rewards.len());
        let scale = Units::Micrometres.scale();
        for (i, (plain, scaled)) in table
            .observations
            .iter()
            .zip(&micrometres.observations)
            .enumerate()
        {
            let expected = plain * scale[i % OBSERVATION_DIM];
            assert!(
                (scaled - expected).abs() <= 1e-3 * scale[0],
                "{scaled} {expected}"
            );
        }
        assert!(
            micrometres
                .observations
                .iter()
                .any(|value| value.abs() > 1e5)
        );
    }
}
