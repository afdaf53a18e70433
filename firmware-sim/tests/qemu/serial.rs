//! An emulated board behind a serial port of this machine, flown as a board of one's own is.

use std::io::{ErrorKind, Read, Write};
use std::path::PathBuf;
use std::process::Command;
use std::sync::mpsc::{Receiver, Sender, TryRecvError, channel};
use std::thread;
use std::time::Duration;

use embedded_io::ReadReady;
use firmware_sim::bench::Pty;
use firmware_sim::qemu::Link;
use serde_json::Value;

use super::boards;

/// A board at a serial port of this machine, until the sender is dropped.
fn board_at_a_port() -> (PathBuf, Sender<()>) {
    let pty = Pty::open().expect("there is a port");
    let path = pty.path().to_owned();
    let (plug, pulled) = channel();
    thread::spawn(move || bridge(pty, &pulled));
    (path, plug)
}

/// Carries bytes between the board's serial port and this machine's.
fn bridge(mut pty: Pty, pulled: &Receiver<()>) {
    let (emulator, firmware) = boards::m4();
    let mut board = emulator
        .start(&firmware, Link::Uart, None)
        .expect("it starts");
    board.set_patience(Duration::from_millis(1));
    let mut bytes = [0; 256];
    while pulled.try_recv() == Err(TryRecvError::Empty) {
        if pty.read_ready().expect("the port is there") {
            let length = embedded_io::Read::read(&mut pty, &mut bytes).expect("it is read");
            board.write_all(&bytes[..length]).expect("the board is fed");
        }
        match board.read(&mut bytes) {
            Ok(length) => embedded_io::Write::write_all(&mut pty, &bytes[..length])
                .expect("the host is answered"),
            Err(error) => assert_eq!(error.kind(), ErrorKind::TimedOut, "{error}"),
        }
    }
}

#[test]
fn a_flight_through_a_serial_port_is_the_host_s_flight() {
    let folder = tempfile::tempdir().unwrap();
    let firmware_sim = |args: &[&str]| -> String {
        let output = Command::new(env!("CARGO_BIN_EXE_firmware-sim"))
            .current_dir(folder.path())
            .args(args)
            .output()
            .unwrap();
        let text = String::from_utf8([output.stdout, output.stderr].concat()).unwrap();
        assert!(output.status.success(), "{text}");
        text
    };
    let json = |args: &[&str]| -> Value {
        serde_json::from_str(&firmware_sim(&[args, &["--json"]].concat())).unwrap()
    };
    firmware_sim(&["toy", "toy.ted"]);
    let fly = ["fly", "toy.ted", "--plant", "toy", "--episodes", "2"];
    let host = json(&fly);
    let (path, plug) = board_at_a_port();
    let port = format!("serial:{}", path.display());
    let words = firmware_sim(&["flash", "toy.ted", "--on", &port]);
    assert!(words.contains("mps2-an386 flies toy-reach"), "{words}");
    let there = json(&[&fly[..], &["--on", &port]].concat());
    assert_eq!(there["episodes"], host["episodes"]);
    let device = &there["device"];
    assert_eq!(device["board"], "mps2-an386");
    assert_eq!(device["unit"], "microseconds");
    assert_eq!(device["link_errors"]["damaged"], 0);
    drop(plug);
}
