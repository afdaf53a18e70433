//! Episodes flown on a device are the host's.

use std::num::NonZeroUsize;

use firmware_sim::bench::{Disturbed, HostDevice};
use firmware_sim::controller::{Controller, Numeric};
use firmware_sim::device::message::Start;
use firmware_sim::plants::fault::FaultInjector;
use firmware_sim::plants::toy::{self, ToyPlant};
use firmware_sim::remote::{Connection, LinkOptions, RemoteController, RemoteError};
use firmware_sim::rollout::{Flight, FlyError, episode_seeds, fly, fly_with};
use firmware_sim::scorer::EpisodeScorer;
use firmware_sim::{plant::Plant, safety::ObservationFrame};
use ted_policy::{Artifact, ArtifactBytes};

use super::artefacts::{FLASH_BYTES, QUICK, toy_artefact, toy_device};
use firmware_sim::bench::MemoryFlash;

const EPISODES: usize = 12;

fn faulty_toy() -> FaultInjector<ToyPlant> {
    let plans = ["nan~0.005", "late~0.05", "dropped~0.005"];
    let plans = plans.map(|plan| plan.parse().unwrap()).to_vec();
    FaultInjector::new(ToyPlant::new(), plans, 5)
}

fn on_the_host() -> Flight {
    let bytes = ArtifactBytes::from_vec(toy_artefact());
    let artifact = Artifact::parse(&bytes).unwrap();
    fly(
        &artifact,
        Numeric::F32,
        || Ok(faulty_toy()),
        &episode_seeds(3, EPISODES),
        NonZeroUsize::MIN,
        || false,
        |_| {},
    )
    .unwrap()
}

fn on_devices<S: std::io::Read + std::io::Write>(
    workers: usize,
    device: impl Fn() -> S + Sync,
) -> Flight {
    let make_pilot = || {
        let connection = Connection::open(device(), QUICK)?;
        Ok(RemoteController::new(connection, Start::default()))
    };
    fly_with(
        make_pilot,
        || Ok(faulty_toy()),
        &episode_seeds(3, EPISODES),
        NonZeroUsize::new(workers).unwrap(),
        || false,
        |_| {},
    )
    .unwrap()
}

#[test]
fn a_flight_on_a_device_is_the_host_s_flight() {
    let host = on_the_host();
    assert!(host.episodes.iter().any(|episode| episode.fault.is_some()));
    assert!(host.episodes.iter().any(|episode| episode.fault.is_none()));
    assert!(
        host.episodes
            .iter()
            .any(|episode| episode.deadlines_missed > 0)
    );
    for workers in [1, 2] {
        let flight = on_devices(workers, toy_device);
        assert_eq!(flight.episodes, host.episodes);
        let summary = flight.device.unwrap();
        assert_eq!(
            summary.work.times,
            EPISODES as u64 * u64::from(toy::EPISODE_STEPS)
        );
        assert_eq!(summary.scores.len(), EPISODES);
    }
    assert_eq!(host.device, None);
}

#[test]
fn a_flight_over_a_noisy_line_is_the_host_s_flight() {
    let host = on_the_host();
    for seed in 0..3 {
        let flight = on_devices(1, || Disturbed::by_chance(toy_device(), 0.02, seed));
        assert_eq!(flight.episodes, host.episodes, "seed {seed}");
        let link = flight.device.unwrap().link;
        assert!(!link.is_clean(), "{link:?}");
    }
}

#[test]
fn a_device_thinks_of_an_episode_what_the_host_s_scorer_thinks() {
    let bytes = ArtifactBytes::from_vec(toy_artefact());
    let artifact = Artifact::parse(&bytes).unwrap();
    let mut scorer = EpisodeScorer::load(&artifact, Numeric::F32).unwrap();
    let mut controller = Controller::load(&artifact, Numeric::F32).unwrap();
    let connection = Connection::open(toy_device(), QUICK).unwrap();
    let mut remote = RemoteController::new(connection, Start::default());
    firmware_sim::rollout::Pilot::reset(&mut remote).unwrap();
    let mut plant = ToyPlant::new();
    plant.reset(1).unwrap();
    for _ in 0..toy::EPISODE_STEPS {
        let observed = plant.observe().unwrap();
        let frame = ObservationFrame {
            sequence: observed.sequence,
            stamp_us: observed.stamp_us,
            values: &observed.values,
        };
        let (action, status) = controller.tick(plant.now_us(), &frame);
        scorer.push(&observed.values, &action).unwrap();
        let acted = remote.act(plant.now_us(), &frame).unwrap();
        assert_eq!((&acted.action, acted.status), (&action, status));
        let score = acted.score.unwrap();
        assert_eq!(score.return_hat.to_bits(), scorer.return_hat().to_bits());
        assert_eq!(
            score.top_k,
            scorer.class(ted_core::NEW_EPISODE) == ted_core::DiscountClass::TopK
        );
        plant.apply(&action).unwrap();
    }
}

#[test]
fn a_device_without_a_policy_says_so_and_flies_nothing() {
    let make_pilot = || {
        let device = HostDevice::power_on(MemoryFlash::erased(FLASH_BYTES));
        let connection = Connection::open(device, QUICK)?;
        assert_eq!(connection.hello().active, None);
        Ok(RemoteController::new(connection, Start::default()))
    };
    let flown = fly_with(
        make_pilot,
        || Ok(ToyPlant::new()),
        &[1],
        NonZeroUsize::MIN,
        || false,
        |_| {},
    );
    let error = flown.unwrap_err().to_string();
    assert_eq!(
        error,
        "fly the episode of seed 1: start an episode on the device: the device refused, no slot holds a policy that flies: \
         flash one"
    );
}

#[test]
fn integers_are_not_flown_where_there_are_none() {
    let connection = Connection::open(toy_device(), QUICK).unwrap();
    let start = Start {
        numeric: Numeric::Integer,
        silence_us: 0,
    };
    let mut remote = RemoteController::new(connection, start);
    let error = firmware_sim::rollout::Pilot::reset(&mut remote).unwrap_err();
    assert!(
        error.to_string().contains("no networks in integers"),
        "{error}"
    );
}

#[test]
fn nobody_at_the_other_end_is_an_error_that_says_what_was_asked() {
    let (near, _far) = firmware_sim::bench::cable();
    let options = LinkOptions {
        timeout: std::time::Duration::from_millis(5),
        tries: 3,
        ..QUICK
    };
    let error = Connection::open(near, options).unwrap_err();
    assert!(matches!(error, RemoteError::Silent { tries: 3, .. }));
    assert!(error.to_string().starts_with("greet the device: no answer"));
}

#[test]
fn a_device_that_goes_away_ends_the_flight_with_its_own_words() {
    let made = std::sync::atomic::AtomicBool::new(false);
    let make_pilot = || {
        made.store(true, std::sync::atomic::Ordering::SeqCst);
        let (near, far) = firmware_sim::bench::cable();
        drop(far);
        let connection = Connection::open(near, QUICK)?;
        Ok(RemoteController::new(connection, Start::default()))
    };
    let flown = fly_with(
        make_pilot,
        || Ok(ToyPlant::new()),
        &[1],
        NonZeroUsize::MIN,
        || false,
        |_| {},
    );
    assert!(made.into_inner());
    assert!(matches!(
        flown,
        Err(FlyError::NoPilot(RemoteError::Link(_)))
    ));
}
