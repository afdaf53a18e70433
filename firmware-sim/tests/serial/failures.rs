//! What goes wrong with a serial port, what the command says then, and the number it ends with.

use std::io::Read;
use std::process::Stdio;
use std::time::Duration;

use embedded_io::ReadReady;
use firmware_sim::bench::{MemoryFlash, Pty};
use firmware_sim::exit::ExitCode;
use firmware_sim::plants::toy;
use firmware_sim::remote::{Connection, LinkOptions, RemoteError};
use firmware_sim::serial::SerialPort;
use rustix::process::{Pid, Signal, kill_process};

use super::board::{Board, FLASH_BYTES, command, folder_with_toy, run};

const FLY: [&str; 5] = ["fly", "toy.ted", "--plant", "toy", "--on"];

fn serial(pty: &Pty) -> String {
    format!("serial:{}", pty.path().display())
}

#[test]
fn a_port_that_is_not_there_is_named() {
    let folder = folder_with_toy();
    for args in [
        &FLY[..4],
        &["flash", "toy.ted"],
        &["score", "toy.ted", "--recording", "flight.json"],
    ] {
        if args[0] == "score" {
            run(
                folder.path(),
                0,
                &[&FLY[..4], &["--record", "flight.json"]].concat(),
            );
        }
        let args = [args, &["--on", "serial:/dev/ttyNowhere"]].concat();
        let words = run(folder.path(), 4, &args);
        for part in ["/dev/ttyNowhere: there is no such port", "this machine has"] {
            assert!(words.contains(part), "{words}");
        }
    }
}

#[test]
fn a_file_is_no_port_and_is_left_alone() {
    let folder = folder_with_toy();
    let before = std::fs::read(folder.path().join("toy.ted")).unwrap();
    let words = run(folder.path(), 2, &[&FLY[..], &["serial:toy.ted"]].concat());
    assert!(words.contains("toy.ted: it is no serial port"), "{words}");
    let after = std::fs::read(folder.path().join("toy.ted")).unwrap();
    assert!(before == after);
}

#[test]
fn a_port_that_another_program_has_is_left_to_it() {
    let folder = folder_with_toy();
    let board = Board::power_on(MemoryFlash::erased(FLASH_BYTES));
    let path = board.name().strip_prefix("serial:").unwrap();
    let held = SerialPort::open(path.as_ref(), 250_000).unwrap();
    let fly = [&FLY[..], &[board.name()]].concat();
    let words = run(folder.path(), 5, &fly);
    assert!(words.contains("another program uses it"), "{words}");
    drop(held);
    run(folder.path(), 0, &fly);
    board.power_off();
}

#[test]
fn a_board_that_is_unplugged_in_mid_flight_ends_the_flight() {
    let folder = folder_with_toy();
    let artefact = toy::artifact_bytes().unwrap();
    let flash = MemoryFlash::with_artefacts(FLASH_BYTES, &[&artefact]).unwrap();
    // Some ticks of 50 episodes.
    let board = Board::power_on_for(flash, 5_000);
    let words = run(folder.path(), 4, &[&FLY[..], &[board.name()]].concat());
    for part in ["fly the episode of seed", "its port is gone; plug it in"] {
        assert!(words.contains(part), "{words}");
    }
    board.power_off();
}

#[test]
fn a_board_that_says_nothing_is_waited_for_and_then_named() {
    let pty = Pty::open().unwrap();
    let options = LinkOptions {
        timeout: Duration::from_millis(50),
        tries: 3,
        session: 1,
    };
    let port = SerialPort::open(pty.path(), 250_000).unwrap();
    let silent = Connection::open(port, options).map(|_| ()).unwrap_err();
    assert!(
        matches!(silent, RemoteError::Silent { tries: 3, .. }),
        "{silent}"
    );
    assert_eq!(silent.exit_code(), ExitCode::Environment);
}

#[test]
fn a_board_that_says_nothing_is_not_waited_for_after_ctrl_c() {
    let folder = folder_with_toy();
    let mut pty = Pty::open().unwrap();
    let mut child = command(folder.path(), &[&FLY[..], &[&serial(&pty)]].concat())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    // It has begun to wait when its greeting is here.
    while !pty.read_ready().unwrap() {
        assert!(child.try_wait().unwrap().is_none(), "it ended by itself");
    }
    kill_process(Pid::from_child(&child), Signal::INT).unwrap();
    let mut words = String::new();
    let stderr = child.stderr.as_mut().unwrap();
    stderr.read_to_string(&mut words).unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(130), "{words}");
    assert!(words.contains("stopped on request"), "{words}");
}

#[test]
fn options_that_would_be_ignored_are_refused() {
    let folder = folder_with_toy();
    let wrong: [(&[&str], &str); 8] = [
        (&["serial:/dev/null", "--link", "uart"], "QEMU's"),
        (&["serial:/dev/null", "--link", "fifo"], "QEMU's"),
        (&["serial:/dev/null", "--flash-image", "f"], "QEMU's"),
        (&["mps2-an386", "--baud", "115200"], "serial port"),
        (&["host", "--baud", "115200"], "belong to a board"),
        (&["host", "--link", "fifo"], "belong to a board"),
        (&["mps2"], "mps2-an386, mps2-an500, mps2-an505, and serial:"),
        (&["serial:/dev/null", "--baud", "0"], "--baud"),
    ];
    for (on, part) in wrong {
        let words = run(folder.path(), 2, &[&FLY[..], on].concat());
        assert!(words.contains(part), "{words}");
    }
    let words = run(folder.path(), 2, &["flash", "toy.ted", "--on", "host"]);
    assert!(words.contains("name a board"), "{words}");
}
