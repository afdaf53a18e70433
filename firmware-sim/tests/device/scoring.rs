//! Logged episodes scored on a device: the host's returns to the bit, whatever the line does, and the trainer's ties.

use std::io::{Read, Write};

use firmware_sim::bench::Disturbed;
use firmware_sim::controller::Numeric;
use firmware_sim::device::message::{Floats, Refusal, Reply, Request, Score, Start};
use firmware_sim::plant::Plant;
use firmware_sim::plants::recorder::{Recorder, Shelf};
use firmware_sim::plants::recording::{Recording, RecordingShape};
use firmware_sim::plants::toy::{self, ToyPlant};
use firmware_sim::remote::{Connection, RemoteController, RemoteError, RemoteScorer};
use firmware_sim::rollout::{Pilot, fly_episode};
use firmware_sim::scoring::{Judge, Verdict, judge, score_recording};
use ted_core::{DiscountClass, MAX_ACTION, MAX_OBSERVATION, NEW_EPISODE, ReturnThreshold};
use ted_policy::{Artifact, ArtifactBytes, write};

use super::artefacts::{QUICK, connected, flash_with, toy_artefact, toy_device};

const SHAPE: RecordingShape = RecordingShape {
    observation_dim: toy::OBSERVATION_DIM,
    action_dim: toy::ACTION_DIM,
    control_period_us: toy::CONTROL_PERIOD_US,
};

/// Episodes in which somebody pushed the sticks about: good ones and bad ones.
fn logs() -> Vec<Recording> {
    let shelf = Shelf::default();
    for seed in 0..6_u8 {
        let mut plant = Recorder::new(ToyPlant::new(), shelf.clone());
        plant.reset(u64::from(seed)).unwrap();
        loop {
            let observed = plant.observe().unwrap().values;
            let towards = |axis: usize| f32::from(seed) * (observed[axis + 2] - observed[axis]);
            let action = [towards(0), towards(1), 0.5].map(|value| value.clamp(-1.0, 1.0));
            if plant.apply(&action).unwrap().done {
                break;
            }
        }
    }
    shelf.take()
}

fn start(numeric: Numeric) -> Start {
    Start {
        numeric,
        silence_us: 0,
    }
}

fn verdicts(judge: &mut impl Judge, episode: u32) -> Vec<(u32, DiscountClass)> {
    let bits = |verdict: Verdict| (verdict.return_hat.to_bits(), verdict.class);
    let score = |log: &Recording| score_recording(judge, SHAPE, log, episode).unwrap();
    logs().iter().map(score).map(bits).collect()
}

fn on_the_host(numeric: Numeric) -> Vec<(u32, DiscountClass)> {
    let bytes = ArtifactBytes::from_vec(toy_artefact());
    let artifact = Artifact::parse(&bytes).unwrap();
    verdicts(&mut judge(&artifact, numeric).unwrap(), NEW_EPISODE)
}

fn on_a_device(device: impl Read + Write, numeric: Numeric) -> Vec<(u32, DiscountClass)> {
    let connection = Connection::open(device, QUICK).unwrap();
    verdicts(
        &mut RemoteScorer::new(connection, start(numeric)),
        NEW_EPISODE,
    )
}

#[test]
fn a_device_scores_logged_episodes_as_the_host_does() {
    let scored = [Numeric::F32, Numeric::Integer].map(|numeric| {
        let host = on_the_host(numeric);
        for class in [DiscountClass::TopK, DiscountClass::BelowTopK] {
            assert!(host.iter().any(|verdict| verdict.1 == class), "{host:?}");
        }
        assert_eq!(on_a_device(toy_device(), numeric), host);
        host
    });
    assert_ne!(scored[0], scored[1], "the numbers make a difference");
}

#[test]
fn a_recorded_flight_is_scored_as_it_was_in_flight() {
    for numeric in [Numeric::F32, Numeric::Integer] {
        let connection = Connection::open(toy_device(), QUICK).unwrap();
        let mut pilot = RemoteController::new(connection, start(numeric));
        let shelf = Shelf::default();
        let mut plant = Recorder::new(ToyPlant::new(), shelf.clone());
        let flown = [1, 2, 3].map(|seed| {
            fly_episode(&mut pilot, &mut plant, seed).unwrap();
            let score = pilot.debrief().unwrap().unwrap().score.unwrap();
            (score.return_hat.to_bits(), score.top_k)
        });
        let mut scorer = RemoteScorer::new(pilot.into_connection(), start(numeric));
        for (log, flown) in shelf.take().iter().zip(flown) {
            let verdict = score_recording(&mut scorer, SHAPE, log, NEW_EPISODE).unwrap();
            let top_k = verdict.class == DiscountClass::TopK;
            assert_eq!((verdict.return_hat.to_bits(), top_k), flown);
        }
    }
}

#[test]
fn over_a_noisy_line_every_step_counts_once() {
    let host = on_the_host(Numeric::Integer);
    for seed in 0..3 {
        let device = Disturbed::by_chance(toy_device(), 0.02, seed);
        assert_eq!(on_a_device(device, Numeric::Integer), host, "seed {seed}");
    }
}

#[test]
fn an_episode_on_the_border_is_told_by_its_place_in_the_dataset() {
    // The border is drawn through one of the logs, as the trainer would.
    let log = &logs()[3];
    let bytes = ArtifactBytes::from_vec(toy_artefact());
    let artifact = Artifact::parse(&bytes).unwrap();
    let mut scorer = judge(&artifact, Numeric::F32).unwrap();
    let verdict = score_recording(&mut scorer, SHAPE, log, 0).unwrap();
    let mut spec = toy::artifact_spec().unwrap();
    let border = ReturnThreshold {
        return_hat: verdict.return_hat,
        last_tied_episode: 6,
    };
    spec.ted = Some(ted_core::TedDiscount::new(0.99, 0.7, border).unwrap());
    let flash = flash_with(&[&write(&spec).unwrap()]);
    let mut remote = RemoteScorer::new(connected(flash), start(Numeric::F32));
    let classes = [0, 6, 7, NEW_EPISODE].map(|episode| {
        let verdict = score_recording(&mut remote, SHAPE, log, episode).unwrap();
        verdict.class
    });
    use DiscountClass::{BelowTopK, TopK};
    assert_eq!(classes, [TopK, TopK, BelowTopK, BelowTopK]);
}

/// What a device with this artefact says of one logged step of these lengths.
fn ask(artefact: &[u8], numeric: Numeric, lengths: [usize; 2]) -> Result<Score, RemoteError> {
    let mut connection = connected(flash_with(&[artefact]));
    let begun = connection.ask("start", &Request::Start(start(numeric)))?;
    assert_eq!(begun, Reply::Done);
    let [observation, action] = lengths.map(|length| vec![0; 4 * length]);
    let log = Request::Log {
        episode: NEW_EPISODE,
        observation: Floats::from_le_bytes(&observation).unwrap(),
        action: Floats::from_le_bytes(&action).unwrap(),
    };
    match connection.ask("score", &log)? {
        Reply::Scored(score) => Ok(score),
        other => panic!("{other:?}"),
    }
}

fn refusal(scored: Result<Score, RemoteError>) -> Refusal {
    match scored {
        Err(RemoteError::Refused { refusal, .. }) => refusal,
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_step_of_another_length_is_refused_and_the_largest_of_all_fits_a_frame() {
    for numeric in [Numeric::F32, Numeric::Integer] {
        let lengths = |observation, action| ask(&toy_artefact(), numeric, [observation, action]);
        assert!(lengths(toy::OBSERVATION_DIM, toy::ACTION_DIM).is_ok());
        let largest = [MAX_OBSERVATION, MAX_ACTION];
        for [observation, action] in [[0, 0], [4, 3], largest] {
            assert_eq!(refusal(lengths(observation, action)), Refusal::OtherShape);
        }
        for [observation, action] in [[MAX_OBSERVATION + 1, 3], [5, MAX_ACTION + 1]] {
            assert_eq!(refusal(lengths(observation, action)), Refusal::Malformed);
        }
    }
}

#[test]
fn an_artefact_without_a_reward_ensemble_or_a_border_cannot_score() {
    let without = |part: fn(&mut ted_policy::ArtifactSpec<'static>)| {
        let mut spec = toy::artifact_spec().unwrap();
        spec.integers = None;
        part(&mut spec);
        write(&spec).unwrap()
    };
    let lacking = [
        without(|spec| spec.reward = None),
        without(|spec| spec.ted = None),
    ];
    for artefact in lacking {
        let lengths = [toy::OBSERVATION_DIM, toy::ACTION_DIM];
        let error = ask(&artefact, Numeric::F32, lengths).unwrap_err();
        assert!(error.to_string().contains("learned reward"), "{error}");
        assert_eq!(refusal(Err(error)), Refusal::CannotScore);
    }
}

#[test]
fn a_step_before_an_episode_was_started_is_refused() {
    let mut connection = connected(flash_with(&[&toy_artefact()]));
    let log = Request::Log {
        episode: 0,
        observation: Floats::from_le_bytes(&[0; 20]).unwrap(),
        action: Floats::from_le_bytes(&[0; 12]).unwrap(),
    };
    let error = connection.ask("score", &log).unwrap_err();
    assert_eq!(refusal(Err(error)), Refusal::NotStarted);
}
