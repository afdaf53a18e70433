//! Episodes flown on a device are the host's.

use std::num::NonZeroUsize;

use firmware_sim::bench::{Disturbed, HostDevice, MemoryFlash};
use firmware_sim::controller::{Controller, Numeric};
use firmware_sim::device::message::Start;
use firmware_sim::plant::Plant;
use firmware_sim::plants::fault::FaultInjector;
use firmware_sim::plants::toy::{self, ToyPlant};
use firmware_sim::remote::{Connection, LinkOptions, RemoteController, RemoteError};
use firmware_sim::rollout::{EpisodeReport, Flight, FlyError, Pilot, episode_seeds, fly, fly_with};
use firmware_sim::safety::ObservationFrame;
use firmware_sim::scorer::EpisodeScorer;
use ted_policy::{Artifact, ArtifactBytes};

use super::artefacts::{
    FLASH_BYTES, QUICK, artefact_without_integers, flash_with, toy_artefact, toy_device,
};

const EPISODES: usize = 12;

fn faulty_toy() -> FaultInjector<ToyPlant> {
    let plans = ["nan~0.005", "late~0.05", "dropped~0.005"];
    let plans = plans.map(|plan| plan.parse().unwrap()).to_vec();
    FaultInjector::new(ToyPlant::new(), plans, 5)
}

fn on_the_host(numeric: Numeric) -> Flight {
    let bytes = ArtifactBytes::from_vec(toy_artefact());
    let artifact = Artifact::parse(&bytes).unwrap();
    fly(
        &artifact,
        numeric,
        || Ok(vec![faulty_toy()]),
        &episode_seeds(3, EPISODES),
        NonZeroUsize::MIN,
        || false,
        |_| {},
    )
    .unwrap()
}

fn start(numeric: Numeric) -> Start {
    Start {
        numeric,
        silence_us: 0,
    }
}

fn on_devices<S: std::io::Read + std::io::Write>(
    numeric: Numeric,
    workers: usize,
    device: impl Fn() -> S + Sync,
) -> Flight {
    let make_pilot = || {
        let connection = Connection::open(device(), QUICK)?;
        Ok(RemoteController::new(connection, start(numeric)))
    };
    fly_with(
        make_pilot,
        || Ok(vec![faulty_toy()]),
        &episode_seeds(3, EPISODES),
        NonZeroUsize::new(workers).unwrap(),
        || false,
        |_| {},
    )
    .unwrap()
}

#[test]
fn a_flight_on_a_device_is_the_host_s_flight() {
    let flights = [Numeric::F32, Numeric::Integer].map(|numeric| {
        let host = on_the_host(numeric);
        let any = |what: fn(&EpisodeReport) -> bool| host.episodes.iter().any(what);
        assert!(any(|episode| episode.fault.is_some()));
        assert!(any(|episode| episode.fault.is_none()));
        assert!(any(|episode| episode.deadlines_missed > 0));
        for workers in [1, 2] {
            let flight = on_devices(numeric, workers, toy_device);
            assert_eq!(flight.episodes, host.episodes);
            let summary = flight.device.unwrap();
            let ticks = EPISODES as u64 * u64::from(toy::EPISODE_STEPS);
            assert_eq!((summary.work.times, summary.scoring.times), (ticks, ticks));
            assert_eq!(summary.scores.len(), EPISODES);
        }
        assert_eq!(host.device, None);
        host.episodes
    });
    assert_ne!(flights[0], flights[1], "the numbers make a difference");
}

#[test]
fn a_flight_over_a_noisy_line_is_the_host_s_flight() {
    let host = on_the_host(Numeric::F32);
    for seed in 0..3 {
        let device = || Disturbed::by_chance(toy_device(), 0.02, seed);
        let flight = on_devices(Numeric::F32, 1, device);
        assert_eq!(flight.episodes, host.episodes, "seed {seed}");
        let link = flight.device.unwrap().link;
        assert!(!link.is_clean(), "{link:?}");
    }
}

#[test]
fn a_device_thinks_of_an_episode_what_the_host_s_scorer_thinks() {
    let bytes = ArtifactBytes::from_vec(toy_artefact());
    let artifact = Artifact::parse(&bytes).unwrap();
    let connection = Connection::open(toy_device(), QUICK).unwrap();
    let mut connection = Some(connection);
    for numeric in [Numeric::F32, Numeric::Integer] {
        let mut scorer = EpisodeScorer::load(&artifact, numeric).unwrap();
        let mut controller = Controller::load(&artifact, numeric).unwrap();
        let mut remote = RemoteController::new(connection.take().unwrap(), start(numeric));
        remote.reset().unwrap();
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
            let top_k = scorer.class(ted_core::NEW_EPISODE) == ted_core::DiscountClass::TopK;
            assert_eq!(score.top_k, top_k);
            plant.apply(&action).unwrap();
        }
        assert!(scorer.return_hat() > 60.0, "{}", scorer.return_hat());
        connection = Some(remote.into_connection());
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
        || Ok(vec![ToyPlant::new()]),
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
    let device = HostDevice::power_on(flash_with(&[&artefact_without_integers()]));
    let connection = Connection::open(device, QUICK).unwrap();
    let mut remote = RemoteController::new(connection, start(Numeric::Integer));
    let error = remote.reset().unwrap_err().to_string();
    assert!(error.contains("no networks in integers"), "{error}");
    let mut remote = RemoteController::new(remote.into_connection(), start(Numeric::F32));
    assert!(remote.reset().is_ok(), "it flies in floats");
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
        || Ok(vec![ToyPlant::new()]),
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
