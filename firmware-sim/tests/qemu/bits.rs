//! Every core computes the host's bits, in both numbers: actions, predicted returns and TED's class. Within its memory.

use firmware_sim::controller::{Controller, Numeric};
use firmware_sim::device::message::Start;
use firmware_sim::qemu::{Board, Device, Link};
use firmware_sim::remote::{Connection, RemoteController, RemoteScorer};
use firmware_sim::rollout::Pilot;
use firmware_sim::safety::ObservationFrame;
use firmware_sim::scorer::EpisodeScorer;
use firmware_sim::scoring::{Judge, Verdict};
use ted_core::{DiscountClass, NEW_EPISODE};
use ted_policy::{Artifact, ArtifactBytes};

use super::artefacts::{self, ACTION, Numbers, OBSERVATION};
use super::{boards, memory};

const TICKS: u32 = 12;
const PERIOD_US: u64 = 12_500;

fn flies_the_host_s_bits(board: Board, numeric: Numeric) {
    let bytes = ArtifactBytes::from_vec(artefacts::large());
    let artifact = Artifact::parse(&bytes).unwrap();
    let mut controller = Controller::load(&artifact, numeric).unwrap();
    let mut scorer = EpisodeScorer::load(&artifact, numeric).unwrap();
    let connection = boards::with(&boards::fleet(board, Link::Fifo, None), &bytes);
    let mut pilot = boards::pilot(connection, numeric);
    pilot.reset().unwrap();

    let mut numbers = Numbers::new(7);
    let (mut moved, mut classes) = (false, Vec::new());
    for tick in 0..TICKS {
        let values: [f32; OBSERVATION] = std::array::from_fn(|_| numbers.unit());
        let now_us = u64::from(tick) * PERIOD_US;
        let frame = ObservationFrame {
            sequence: tick,
            stamp_us: now_us,
            values: &values,
        };
        let (action, status) = controller.tick(now_us, &frame);
        scorer.push(&values, &action).unwrap();
        let acted = pilot.act(now_us, &frame).unwrap();

        assert_eq!(acted.status, status);
        assert_eq!(status.fault, None);
        let bits = |action: &[f32]| action.iter().map(|it| it.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&acted.action), bits(&action), "tick {tick} on {board}");
        moved |= action.iter().any(|it| it.abs() > 0.01 && it.abs() < 0.99);
        let score = acted.score.expect("the artefact can score");
        assert_eq!(score.return_hat.to_bits(), scorer.return_hat().to_bits());
        let top_k = scorer.class(NEW_EPISODE) == DiscountClass::TopK;
        assert_eq!(score.top_k, top_k);
        classes.push(top_k);
    }
    assert!(moved, "the actions say something");
    assert_eq!(
        (classes.first(), classes.last()),
        (Some(&false), Some(&true)),
        "return {}",
        scorer.return_hat()
    );
    let connection = scores_logs_as_the_host(pilot, scorer, numeric);
    let health = boards::pilot(connection, numeric).health().unwrap();
    memory::within_budget(board, health.stack_high_water);
}

/// The same networks, now with actions that this policy would not have taken.
fn scores_logs_as_the_host(
    pilot: RemoteController<Device>,
    mut here: EpisodeScorer<'_>,
    numeric: Numeric,
) -> Connection<Device> {
    let start = Start {
        numeric,
        silence_us: 0,
    };
    let mut there = RemoteScorer::new(pilot.into_connection(), start);
    here.reset();
    there.reset().unwrap();
    let mut numbers = Numbers::new(8);
    for _ in 0..TICKS {
        let observation: [f32; OBSERVATION] = std::array::from_fn(|_| numbers.unit());
        let action: [f32; ACTION] = std::array::from_fn(|_| numbers.unit());
        let [here, there]: [Verdict; 2] = [
            Judge::push(&mut here, &observation, &action, NEW_EPISODE).unwrap(),
            there.push(&observation, &action, NEW_EPISODE).unwrap(),
        ];
        assert_eq!(there.return_hat.to_bits(), here.return_hat.to_bits());
        assert_eq!(there.class, here.class);
    }
    there.into_connection()
}

#[test]
fn a_cortex_m4f_computes_the_host_s_floats() {
    flies_the_host_s_bits(Board::An386, Numeric::F32);
}

#[test]
fn a_cortex_m4f_computes_the_host_s_integers() {
    flies_the_host_s_bits(Board::An386, Numeric::Integer);
}

#[test]
fn a_cortex_m7_computes_the_host_s_floats() {
    flies_the_host_s_bits(Board::An500, Numeric::F32);
}

#[test]
fn a_cortex_m7_computes_the_host_s_integers() {
    flies_the_host_s_bits(Board::An500, Numeric::Integer);
}

#[test]
fn a_cortex_m33_computes_the_host_s_floats() {
    flies_the_host_s_bits(Board::An505, Numeric::F32);
}

#[test]
fn a_cortex_m33_computes_the_host_s_integers() {
    flies_the_host_s_bits(Board::An505, Numeric::Integer);
}
