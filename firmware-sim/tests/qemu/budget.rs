//! What a tick may cost on each core: instructions, against a table that is committed and grows only where somebody sees it.

use std::fmt::Write;

use firmware_sim::controller::Numeric;
use firmware_sim::qemu::{Board, Link, instructions};
use firmware_sim::rollout::{Pilot, Work};
use firmware_sim::safety::ObservationFrame;

use super::artefacts::{self, Numbers, OBSERVATION};
use super::boards;

/// The committed table: board, numbers, instructions of a tick, instructions of scoring it.
const BUDGET: &str = include_str!("budget.txt");

/// What is said about it.
const DOCUMENT: &str = include_str!("../../../docs/device.md");

/// How much more than its budget a count may be: compilers differ.
const TOLERANCE: f64 = 1.02;

const TICKS: u32 = 20;
const PERIOD_US: u64 = 12_500;

/// The mean instructions of a tick and of its scoring, with the 39-256-256-4 policy and seven reward models of 43-256-256-1.
fn measure(board: Board, numeric: Numeric) -> [f64; 2] {
    let connection = boards::with(&boards::fleet(board, Link::Fifo, None), &artefacts::large());
    let mut pilot = boards::pilot(connection, numeric);
    pilot.reset().unwrap();
    let (mut numbers, mut tick_work, mut scoring) =
        (Numbers::new(7), Work::default(), Work::default());
    for tick in 0..TICKS {
        let values: [f32; OBSERVATION] = std::array::from_fn(|_| numbers.unit());
        let now_us = u64::from(tick) * PERIOD_US;
        let frame = ObservationFrame {
            sequence: tick,
            stamp_us: now_us,
            values: &values,
        };
        let acted = pilot.act(now_us, &frame).unwrap();
        assert_eq!(acted.status.fault, None);
        tick_work.add(acted.work);
        scoring.add(acted.score.expect("the artefact can score").work);
    }
    let work_hz = pilot.hello().work_hz;
    [tick_work, scoring].map(|work| instructions(work.mean(), work_hz))
}

#[test]
fn no_core_takes_more_instructions_than_its_budget() {
    let mut table = String::new();
    let mut over = Vec::new();
    let rows = BUDGET.lines().filter(|line| !line.starts_with('#'));
    for row in rows {
        let [board, numbers, tick, scoring] = row.split_whitespace().collect::<Vec<_>>()[..] else {
            panic!("four words in a row, not {row:?}");
        };
        let board: Board = Board::ALL
            .into_iter()
            .find(|known| known.to_string() == board)
            .unwrap_or_else(|| panic!("no board {board}"));
        let numeric = match numbers {
            "f32" => Numeric::F32,
            "integer" => Numeric::Integer,
            _ => panic!("no numbers {numbers}"),
        };
        let measured = measure(board, numeric);
        writeln!(
            table,
            "{board} {numbers} {:.0} {:.0}",
            measured[0], measured[1]
        )
        .unwrap();
        for ((what, budget), measured) in [("a tick", tick), ("scoring", scoring)]
            .into_iter()
            .zip(measured)
        {
            let budget: f64 = budget.parse().unwrap();
            if measured > TOLERANCE * budget {
                over.push(format!(
                    "{what} on {board} in {numbers}: {measured:.0}, not {budget:.0}"
                ));
            }
        }
    }
    assert_eq!(
        table.lines().count(),
        2 * Board::ALL.len(),
        "a row for each"
    );
    assert!(
        over.is_empty(),
        "instructions over budget: {}\nmeasured:\n{table}",
        over.join("; ")
    );
}

/// A number as the document writes it.
fn with_commas(number: &str) -> String {
    let digits = number.as_bytes().rchunks(3).rev();
    let groups: Vec<&str> = digits.map(|it| std::str::from_utf8(it).unwrap()).collect();
    groups.join(",")
}

#[test]
fn the_document_says_what_the_budget_says() {
    let rows: Vec<_> = BUDGET.lines().filter(|it| !it.starts_with('#')).collect();
    assert_eq!(rows.len(), 2 * Board::ALL.len());
    for row in rows {
        let words: Vec<_> = row.split_whitespace().collect();
        let [tick, scoring] = [words[2], words[3]].map(with_commas);
        let row = format!("| {} | {tick} | {scoring} |", words[1]);
        assert!(DOCUMENT.contains(&row), "{}: {row}", words[0]);
    }
    let ticks = format!("the mean of {TICKS} ticks");
    assert!(DOCUMENT.contains(&ticks), "{ticks}");
}
