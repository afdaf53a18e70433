//! Flying many episodes: the same reports from any number of workers, and from plants that break on the way.

use std::io;
use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicU32, Ordering};

use firmware_sim::controller::{Controller, Numeric};
use firmware_sim::plant::{Observed, Plant, PlantError, StepOutcome};
use firmware_sim::plants::fault::FaultInjector;
use firmware_sim::plants::recorder::{Recorder, Shelf};
use firmware_sim::plants::recording::RecordingShape;
use firmware_sim::plants::replay::ReplayPlant;
use firmware_sim::plants::toy::{self, ToyPlant};
use firmware_sim::rollout::{
    Flight, FlyError, Summary, abreast, episode_seed, episode_seeds, fly, fly_episode,
};
use firmware_sim::safety::Fault;
use ted_policy::{Artifact, ArtifactBytes};

fn artifact_bytes() -> ArtifactBytes {
    ArtifactBytes::from_vec(toy::artifact_bytes().unwrap())
}

fn flown<P: Plant>(
    make_plant: impl Fn() -> Result<P, PlantError> + Sync,
    episodes: usize,
    workers: usize,
) -> Result<Flight, FlyError> {
    flown_abreast(make_plant, 1, episodes, workers)
}

fn flown_abreast<P: Plant>(
    make_plant: impl Fn() -> Result<P, PlantError> + Sync,
    plants: usize,
    episodes: usize,
    workers: usize,
) -> Result<Flight, FlyError> {
    let bytes = artifact_bytes();
    let artifact = Artifact::parse(&bytes).unwrap();
    let seeds = episode_seeds(7, episodes);
    fly(
        &artifact,
        Numeric::F32,
        || (0..plants).map(|_| make_plant()).collect(),
        &seeds,
        NonZeroUsize::new(workers).unwrap(),
        || false,
        |_| {},
    )
}

#[test]
fn the_written_down_policy_solves_the_toy() {
    let flight = flown(|| Ok(ToyPlant::new()), 20, 2).unwrap();
    let summary = Summary::of(&flight.episodes);
    assert_eq!((summary.success_rate, summary.faulted), (1.0, 0));
    assert!(summary.return_mean > 60.0, "{summary:?}");
    let ticks = flight.tick_times.percentiles_us(&[0.0, 0.5, 1.0]);
    assert!(ticks[0] <= ticks[1] && ticks[1] <= ticks[2]);
}

#[test]
fn the_reports_do_not_depend_on_the_number_of_workers() {
    let lying = || {
        Ok(FaultInjector::new(
            ToyPlant::new(),
            vec!["nan~0.01".parse().unwrap()],
            5,
        ))
    };
    let alone = flown(lying, 23, 1).unwrap().episodes;
    assert!(alone.iter().any(|episode| episode.fault.is_some()));
    assert!(alone.iter().any(|episode| episode.fault.is_none()));
    for workers in [2, 3, 8, 40] {
        assert_eq!(flown(lying, 23, workers).unwrap().episodes, alone);
    }
}

#[test]
fn the_reports_do_not_depend_on_how_many_plants_fly_abreast() {
    // Episodes of different lengths, so that berths get free at different times.
    let lying = || {
        Ok(FaultInjector::new(
            ToyPlant::new(),
            vec!["nan~0.01".parse().unwrap()],
            5,
        ))
    };
    let alone = flown(lying, 23, 1).unwrap().episodes;
    for (plants, workers) in [(2, 1), (5, 1), (8, 2), (40, 3)] {
        let abreast = flown_abreast(lying, plants, 23, workers).unwrap();
        assert_eq!(abreast.episodes, alone);
    }
    let each = |episodes, workers| abreast(episodes, NonZeroUsize::new(workers).unwrap());
    assert_eq!(
        [each(50, 2), each(5, 2), each(1, 4), each(0, 1)],
        [8, 3, 1, 1]
    );
}

#[test]
fn evaluation_seeds_are_fixed_for_ever() {
    assert_eq!(
        episode_seeds(0, 2),
        [episode_seed(0, 0), episode_seed(0, 1)]
    );
    assert_eq!(episode_seed(0, 0), 994_147_714_640_291_583);
    assert_eq!(episode_seed(1, 49), 8_145_008_767_430_335_125);
}

/// A toy whose link breaks in the middle of chosen episodes, counted over all of its incarnations.
struct Brittle<'a> {
    toy: ToyPlant,
    breaks_left: &'a AtomicU32,
}

impl Plant for Brittle<'_> {
    fn reset(&mut self, seed: u64) -> Result<(), PlantError> {
        self.toy.reset(seed)
    }

    fn now_us(&self) -> u64 {
        self.toy.now_us()
    }

    fn observe(&mut self) -> Result<Observed, PlantError> {
        self.toy.observe()
    }

    fn apply(&mut self, action_env: &[f32]) -> Result<StepOutcome, PlantError> {
        let broken = |left: u32| left.checked_sub(1);
        if self.toy.now_us() == 300_000
            && self
                .breaks_left
                .fetch_update(Ordering::SeqCst, Ordering::SeqCst, broken)
                .is_ok()
        {
            return Err(PlantError::link(io::Error::other("the cable fell out")));
        }
        self.toy.apply(action_env)
    }
}

#[test]
fn an_episode_whose_link_breaks_once_is_flown_again_with_the_same_result() {
    let breaks_left = AtomicU32::new(1);
    let brittle = || {
        Ok(Brittle {
            toy: ToyPlant::new(),
            breaks_left: &breaks_left,
        })
    };
    let flight = flown(brittle, 6, 2).unwrap();
    assert_eq!(
        flight.episodes,
        flown(|| Ok(ToyPlant::new()), 6, 1).unwrap().episodes
    );
    assert_eq!(breaks_left.into_inner(), 0);
}

#[test]
fn all_that_fly_abreast_are_flown_again_when_one_link_breaks() {
    let breaks_left = AtomicU32::new(1);
    let made = AtomicU32::new(0);
    let brittle = || {
        made.fetch_add(1, Ordering::SeqCst);
        Ok(Brittle {
            toy: ToyPlant::new(),
            breaks_left: &breaks_left,
        })
    };
    let flight = flown_abreast(brittle, 4, 9, 1).unwrap();
    assert_eq!(
        flight.episodes,
        flown(|| Ok(ToyPlant::new()), 9, 1).unwrap().episodes
    );
    assert_eq!(
        (breaks_left.into_inner(), made.into_inner()),
        (0, 8),
        "four plants, and four more"
    );
}

#[test]
fn a_link_that_breaks_twice_ends_the_flight_with_its_own_words() {
    let breaks_left = AtomicU32::new(2);
    let brittle = || {
        Ok(Brittle {
            toy: ToyPlant::new(),
            breaks_left: &breaks_left,
        })
    };
    let error = flown(brittle, 6, 1).unwrap_err().to_string();
    let seed = episode_seed(7, 0);
    assert_eq!(
        error,
        format!("fly the episode of seed {seed}: the cable fell out")
    );
}

#[test]
fn a_plant_that_cannot_be_made_is_the_error() {
    let none = || Err::<ToyPlant, _>(PlantError::link(io::Error::other("no such port")));
    assert!(matches!(flown(none, 3, 2), Err(FlyError::NoPlant(_))));
}

#[test]
fn a_request_to_stop_is_heard_between_episodes() {
    let bytes = artifact_bytes();
    let artifact = Artifact::parse(&bytes).unwrap();
    let landed = AtomicU32::new(0);
    let stop = || landed.load(Ordering::SeqCst) >= 2;
    let count = |_: &_| {
        landed.fetch_add(1, Ordering::SeqCst);
    };
    let seeds = episode_seeds(0, 10_000);
    let stopped = fly(
        &artifact,
        Numeric::F32,
        || Ok(vec![ToyPlant::new()]),
        &seeds,
        NonZeroUsize::MIN,
        stop,
        count,
    );
    assert!(
        matches!(stopped, Err(FlyError::Interrupted { flown }) if (2..10_000).contains(&flown))
    );
}

#[test]
fn a_fault_ends_the_flying_and_not_the_episode() {
    let lying = || {
        Ok(FaultInjector::new(
            ToyPlant::new(),
            vec!["stale@3".parse().unwrap()],
            0,
        ))
    };
    let report = flown(lying, 1, 1).unwrap().episodes.remove(0);
    let latched = report.fault.unwrap();
    assert_eq!(
        (latched.tick, report.ticks, report.success),
        (3, toy::EPISODE_STEPS, false)
    );
    assert!(matches!(latched.fault, Fault::Stale { .. }));
}

#[test]
fn a_replayed_flight_differs_by_nothing_from_its_recording() {
    let bytes = artifact_bytes();
    let mut controller = Controller::load(&Artifact::parse(&bytes).unwrap(), Numeric::F32).unwrap();
    let seeds = episode_seeds(3, 4);
    let shelf = Shelf::default();
    let mut recorder = Recorder::new(ToyPlant::new(), shelf.clone());
    for &seed in &seeds {
        fly_episode(&mut controller, &mut recorder, seed).unwrap();
    }
    let recordings = shelf.take();
    let shape = RecordingShape {
        observation_dim: toy::OBSERVATION_DIM,
        action_dim: toy::ACTION_DIM,
        control_period_us: toy::CONTROL_PERIOD_US,
    };
    let mut altered = recordings.clone();
    let mut plant = ReplayPlant::new(shape, recordings).unwrap();
    for &seed in &seeds {
        let (replayed, _) = fly_episode(&mut controller, &mut plant, seed).unwrap();
        let (flown, _) = fly_episode(&mut controller, &mut ToyPlant::new(), seed).unwrap();
        assert_eq!(replayed, flown);
    }
    assert_eq!(plant.largest_difference().unwrap().absolute, 0.0);

    altered[2].actions[7] += 0.25;
    let mut plant = ReplayPlant::new(shape, altered).unwrap();
    for &seed in &seeds {
        fly_episode(&mut controller, &mut plant, seed).unwrap();
    }
    let worst = plant.largest_difference().unwrap();
    assert_eq!((worst.seed, worst.step, worst.dimension), (seeds[2], 2, 1));
}
