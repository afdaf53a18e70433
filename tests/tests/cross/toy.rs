//! The whole way without Python: recordings of a bad pilot on the toy, a policy learned from them, the policy flown.

use std::num::NonZeroUsize;

use firmware_sim::controller::{Controller, Numeric};
use firmware_sim::plant::Plant;
use firmware_sim::plants::recorder::{Recorder, Shelf};
use firmware_sim::plants::recording::RecordingShape;
use firmware_sim::plants::replay::ReplayPlant;
use firmware_sim::plants::toy::{
    ACTION_DIM, CONTROL_PERIOD_US, EPISODE_STEPS, OBSERVATION_DIM, ToyPlant, artifact_bytes,
};
use firmware_sim::progress::Audience;
use firmware_sim::rollout::{Summary, episode_seeds, fly, fly_episode};
use rand::RngExt;
use ted_core::Scratch;
use ted_policy::{Artifact, ArtifactBytes};
use ted_train::algorithm::AlgorithmConfig;
use ted_train::algorithm::iql::IqlConfig;
use ted_train::config::{Config, Preset, Schedule};
use ted_train::dataset::{Dataset, EpisodeRecord, Shape};
use ted_train::preferences::ScriptedTeacher;
use ted_train::rng::Seed;
use ted_train::run::{DatasetReference, RunFolder};
use ted_train::train::train;

const SHAPE: Shape = Shape {
    observation: OBSERVATION_DIM,
    action: ACTION_DIM,
};

/// One episode of the written-down policy that often does something random instead.
fn recording(seed: u64) -> EpisodeRecord {
    let bytes = artifact_bytes().unwrap();
    let bytes = ArtifactBytes::from_vec(bytes);
    let artifact = Artifact::parse(&bytes).unwrap();
    let (policy, mut scratch) = (artifact.policy(), Scratch::new());
    let mut rng = Seed::root(seed).child("pilot").rng();
    let mut plant = ToyPlant::new();
    plant.reset(seed).unwrap();
    let mut record = EpisodeRecord {
        seed: Some(seed),
        observations: plant.observe().unwrap().values,
        ..EpisodeRecord::default()
    };
    for step in 1..=EPISODE_STEPS {
        let observation = plant.observe().unwrap().values;
        let mut action = [0.0; ACTION_DIM];
        policy.act(&observation, &mut scratch, &mut action).unwrap();
        if rng.random_bool(0.5) {
            action = std::array::from_fn(|_| rng.random_range(-1.0..=1.0));
        }
        let outcome = plant.apply(&action).unwrap();
        record.actions.extend(action);
        record.rewards.push(outcome.reward_true);
        record.success.push(outcome.success);
        record.terminations.push(false);
        record.truncations.push(step == EPISODE_STEPS);
        record.observations.extend(plant.observe().unwrap().values);
    }
    record
}

fn config() -> Config {
    Config {
        algorithm: AlgorithmConfig::Iql(IqlConfig {
            steps: 4000,
            batch: 128,
            hidden: vec![64, 64],
            learning_rate: 1e-3,
            ..IqlConfig::default()
        }),
        schedule: Schedule {
            evaluation_episodes: 0,
            ..Schedule::default()
        },
        ..Preset::True.config()
    }
}

#[test]
fn a_policy_learned_from_a_bad_pilot_flies_better_than_it_and_replays_without_a_difference() {
    let records: Vec<_> = (100..200).map(recording).collect();
    let dataset = Dataset::from_records("ted/toy-v0", SHAPE, &records).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let reference = DatasetReference {
        id: dataset.id().to_owned(),
        digest: dataset.digest().to_owned(),
        path: folder.path().to_path_buf(),
    };
    let run = RunFolder::begin(&folder.path().join("run"), &config(), &reference).unwrap();
    let mut teacher = ScriptedTeacher::truthful();
    let watch = Audience::Nobody.into();
    train(&dataset, &config(), &run, &mut teacher, watch).unwrap();

    let bytes = ArtifactBytes::read(run.artefact_path()).unwrap();
    let artifact = Artifact::parse(&bytes).unwrap();
    let seeds = episode_seeds(3, 20);
    let shelf = Shelf::default();
    let flight = fly(
        &artifact,
        Numeric::F32,
        || Ok(vec![Recorder::new(ToyPlant::new(), shelf.clone())]),
        &seeds,
        NonZeroUsize::MIN,
        || false,
        |_| {},
    )
    .unwrap();
    let summary = Summary::of(&flight.episodes);
    assert_eq!(summary.faulted, 0, "{:?}", flight.episodes);
    let pilot = dataset.mean_return_true();
    assert!(
        summary.return_mean > 1.1 * pilot,
        "{} from {pilot}",
        summary.return_mean
    );
    assert_eq!(artifact.provenance().dataset_return_mean, pilot);

    let shape = RecordingShape {
        observation_dim: OBSERVATION_DIM,
        action_dim: ACTION_DIM,
        control_period_us: CONTROL_PERIOD_US,
    };
    let mut replay = ReplayPlant::new(shape, shelf.take()).unwrap();
    let mut controller = Controller::load(&artifact, Numeric::F32).unwrap();
    for (seed, flown) in seeds.into_iter().zip(&flight.episodes) {
        let (replayed, _) = fly_episode(&mut controller, &mut replay, seed).unwrap();
        assert_eq!(replayed, *flown);
    }
    assert_eq!(replay.largest_difference().unwrap().absolute, 0.0);
}
