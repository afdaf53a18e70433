//! The commands on a board at a serial port say what they say on the host, to the bit.

use std::fs;

use firmware_sim::bench::MemoryFlash;
use firmware_sim::plants::toy;
use ted_policy::write;

use super::board::{Board, FLASH_BYTES, folder_with_toy, json, run};

const FLY: [&str; 8] = [
    "fly",
    "toy.ted",
    "--plant",
    "toy",
    "--episodes",
    "6",
    "--fault",
    "nan~0.003",
];

#[test]
fn a_flight_on_a_board_is_the_host_s_flight_and_its_work_is_time() {
    let folder = folder_with_toy();
    let board = Board::power_on(MemoryFlash::erased(FLASH_BYTES));
    for numeric in ["f32", "integer"] {
        let host = [&FLY[..], &["--numeric", numeric]].concat();
        let there = [&host[..], &["--on", board.name(), "--workers", "4"]].concat();
        let host = json(folder.path(), 7, &host);
        let there = json(folder.path(), 7, &there);
        let faulted = host["faulted"].as_u64().unwrap();
        assert!((1..6).contains(&faulted), "{faulted} of 6");
        assert_eq!(there["episodes"], host["episodes"]);
        let device = &there["device"];
        assert_eq!(
            (&device["board"], &device["unit"]),
            (&"host".into(), &"microseconds".into())
        );
        assert_eq!(device["link"], board.name());
        assert!(device.get("emulator").is_none());
        assert!(device["tick"]["mean"].as_f64().unwrap() > 0.0);
    }
    let there = [&FLY[..], &["--on", board.name()]].concat();
    let table = run(folder.path(), 7, &there);
    for part in ["us a tick", "by the board's counter", "not measured"] {
        assert!(table.contains(part), "{part}: {table}");
    }
    assert!(!table.contains("instructions"), "{table}");
    board.power_off();
}

#[test]
fn an_artefact_is_sent_once() {
    let folder = folder_with_toy();
    let fly = &FLY[..6];
    let mut flash = MemoryFlash::erased(FLASH_BYTES);
    let mut changed = Vec::new();
    for _ in 0..2 {
        let board = Board::power_on(flash);
        run(folder.path(), 0, &[fly, &["--on", board.name()]].concat());
        flash = board.power_off();
        changed.push(flash.changed());
    }
    assert!(changed[0] > 0);
    assert_eq!(changed[0], changed[1]);
}

#[test]
fn a_board_is_given_another_policy_and_another_contract_only_when_told_to() {
    let folder = folder_with_toy();
    let mut rewired = toy::artifact_spec().unwrap();
    rewired.contract.observation.swap(0, 1);
    fs::write(folder.path().join("rewired.ted"), write(&rewired).unwrap()).unwrap();

    let board = Board::power_on(MemoryFlash::erased(FLASH_BYTES));
    let flash = |code, policy, more: &[&str]| {
        let args = ["flash", policy, "--on", board.name(), "--baud", "115200"];
        run(folder.path(), code, &[&args, more].concat())
    };
    let words = flash(0, "toy.ted", &[]);
    assert!(
        words.contains("host flies toy-reach from slot 0"),
        "{words}"
    );
    assert!(!words.contains("forgotten"), "{words}");
    let words = flash(3, "rewired.ted", &[]);
    assert!(words.contains("--accept-other-contract"), "{words}");
    let words = flash(0, "rewired.ted", &["--accept-other-contract"]);
    assert!(words.contains("from slot 1"), "{words}");
    board.power_off();
}

#[test]
fn a_recording_is_replayed_and_scored_on_a_board_as_on_the_host() {
    let folder = folder_with_toy();
    let record = [&FLY[..6], &["--record", "flight.json"]].concat();
    run(folder.path(), 0, &record);
    let board = Board::power_on(MemoryFlash::erased(FLASH_BYTES));
    let replay = [
        "fly",
        "toy.ted",
        "--plant",
        "replay",
        "--recording",
        "flight.json",
    ];
    let score = ["score", "toy.ted", "--recording", "flight.json"];
    for (args, field) in [(&replay[..], "largest_difference"), (&score[..], "upload")] {
        let host = json(folder.path(), 0, args);
        let there = json(folder.path(), 0, &[args, &["--on", board.name()]].concat());
        assert_eq!(there["episodes"], host["episodes"]);
        assert_eq!(there[field], host[field]);
    }
    board.power_off();
}
