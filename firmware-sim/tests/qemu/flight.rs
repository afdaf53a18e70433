//! A closed loop around a board gives the host's report, whatever the link.

use std::num::NonZeroUsize;

use firmware_sim::controller::Numeric;
use firmware_sim::plants::fault::FaultInjector;
use firmware_sim::plants::toy::ToyPlant;
use firmware_sim::qemu::{Board, Link};
use firmware_sim::rollout::{DeviceSummary, Flight, episode_seeds, fly, fly_with};
use ted_policy::{Artifact, ArtifactBytes};

use super::{artefacts, boards};

/// Faults as well, or the loop would be closed by good observations alone.
fn plant() -> FaultInjector<ToyPlant> {
    let plans = ["nan~0.003", "late~0.05", "dropped~0.003"];
    let plans = plans.map(|plan| plan.parse().unwrap()).to_vec();
    FaultInjector::new(ToyPlant::new(), plans, 5)
}

fn on_the_host(episodes: usize) -> Flight {
    let bytes = ArtifactBytes::from_vec(artefacts::toy());
    let artifact = Artifact::parse(&bytes).unwrap();
    let seeds = episode_seeds(3, episodes);
    let one = NonZeroUsize::MIN;
    fly(
        &artifact,
        Numeric::F32,
        || Ok(vec![plant()]),
        &seeds,
        one,
        || false,
        |_| (),
    )
    .unwrap()
}

fn on_a_board(board: Board, link: Link, episodes: usize) -> (Flight, DeviceSummary) {
    let fleet = boards::fleet(board, link, None);
    let make_pilot = || {
        Ok(boards::pilot(
            boards::with(&fleet, &artefacts::toy()),
            Numeric::F32,
        ))
    };
    let seeds = episode_seeds(3, episodes);
    let one = NonZeroUsize::MIN;
    let flight = fly_with(
        make_pilot,
        || Ok(vec![plant()]),
        &seeds,
        one,
        || false,
        |_| (),
    )
    .unwrap();
    let summary = flight.device.clone().expect("a device flew");
    (flight, summary)
}

#[test]
fn a_flight_on_the_cortex_m4f_is_the_host_s_flight() {
    let host = on_the_host(10);
    assert!(host.episodes.iter().any(|it| it.fault.is_some()));
    assert!(host.episodes.iter().any(|it| it.fault.is_none()));
    let (flight, summary) = on_a_board(Board::An386, Link::Fifo, 10);
    assert_eq!(flight.episodes, host.episodes);
    assert!(summary.link.is_clean(), "{:?}", summary.link);
    assert_eq!(summary.scores.len(), 10);
    assert!(summary.work.total > 0);
}

#[test]
fn over_the_serial_port_it_is_the_same_flight() {
    let (flight, summary) = on_a_board(Board::An386, Link::Uart, 2);
    assert_eq!(flight.episodes, on_the_host(2).episodes);
    assert!(summary.link.is_clean(), "{:?}", summary.link);
}

#[test]
fn the_serial_ports_of_the_other_boards_work_too() {
    for board in [Board::An500, Board::An505] {
        let (flight, summary) = on_a_board(board, Link::Uart, 1);
        assert_eq!(flight.episodes, on_the_host(1).episodes, "{board}");
        assert!(summary.link.is_clean(), "{board}: {:?}", summary.link);
    }
}

/// The clock's own interrupt falls into one tick or another, as the pipe's bytes come: nothing else differs between runs.
#[test]
fn what_a_tick_costs_is_the_same_in_every_run_but_for_the_clock() {
    let [first, second] = [(); 2].map(|()| on_a_board(Board::An386, Link::Fifo, 2).1);
    for (first, second) in [(first.work, second.work), (first.scoring, second.scoring)] {
        assert_eq!(first.times, second.times);
        let difference = first.total.abs_diff(second.total);
        assert!(difference * 1000 <= first.total, "{first:?} and {second:?}");
    }
}
