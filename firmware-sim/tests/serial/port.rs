//! A serial port as a stream.

use std::fs::File;
use std::io::{self, ErrorKind, Read, Write};
use std::time::Duration;

use firmware_sim::bench::Pty;
use firmware_sim::remote::NoLink;
use firmware_sim::serial::{SerialError, SerialPort};
use rustix::termios::{ControlModes, InputModes, LocalModes, OutputModes, tcgetattr};

fn pair() -> (Pty, SerialPort) {
    let pty = Pty::open().unwrap();
    let port = SerialPort::open(pty.path(), 250_000).unwrap();
    (pty, port)
}

fn words(error: io::Error) -> String {
    error.downcast::<NoLink>().unwrap().to_string()
}

#[test]
fn all_bytes_come_through_as_they_are_both_ways() {
    let (mut pty, mut port) = pair();
    let bytes: Vec<u8> = (0..=255).collect();
    port.write_all(&bytes).unwrap();
    let mut heard = [0; 256];
    embedded_io::Read::read_exact(&mut pty, &mut heard).unwrap();
    assert_eq!(heard, *bytes);
    embedded_io::Write::write_all(&mut pty, &bytes).unwrap();
    port.read_exact(&mut heard).unwrap();
    assert_eq!(heard, *bytes);
    port.set_read_patience(Duration::from_millis(1));
    assert_eq!(
        port.read(&mut heard).unwrap_err().kind(),
        ErrorKind::TimedOut
    );
}

#[test]
fn a_port_is_raw_and_has_the_speed_that_was_asked_for() {
    let (pty, port) = pair();
    let settings = tcgetattr(File::open(pty.path()).unwrap()).unwrap();
    assert_eq!(settings.output_speed(), 250_000);
    let flow = InputModes::IXON | InputModes::IXOFF | InputModes::IXANY;
    let (input, control) = (settings.input_modes, settings.control_modes);
    assert!(!input.intersects(flow | InputModes::ICRNL | InputModes::ISTRIP));
    assert!(!control.intersects(ControlModes::CRTSCTS | ControlModes::CSTOPB));
    assert!(control.contains(ControlModes::CS8 | ControlModes::CREAD | ControlModes::CLOCAL));
    assert!(
        !settings
            .local_modes
            .intersects(LocalModes::ECHO | LocalModes::ICANON)
    );
    assert!(!settings.output_modes.contains(OutputModes::OPOST));
    drop(port);
}

#[test]
fn what_came_before_a_port_was_opened_is_dropped() {
    let mut pty = Pty::open().unwrap();
    embedded_io::Write::write_all(&mut pty, b"of another host\n").unwrap();
    let mut port = SerialPort::open(pty.path(), 250_000).unwrap();
    embedded_io::Write::write_all(&mut pty, b"new").unwrap();
    let mut heard = [0; 32];
    let length = port.read(&mut heard).unwrap();
    assert_eq!(&heard[..length], b"new");
}

#[test]
fn a_port_is_free_again_when_its_owner_is_done() {
    let (pty, port) = pair();
    let second = SerialPort::open(pty.path(), 250_000);
    assert!(matches!(second, Err(SerialError::InUse { .. })));
    drop(port);
    SerialPort::open(pty.path(), 250_000).unwrap();
}

#[test]
fn a_port_that_is_unplugged_says_so_to_readers_and_writers() {
    for reads in [true, false] {
        let (pty, mut port) = pair();
        drop(pty);
        let gone = match reads {
            true => port.read(&mut [0; 8]),
            false => port.write(b"hello"),
        };
        let words = words(gone.unwrap_err());
        assert!(words.contains("its port is gone"), "{words}");
    }
}

#[test]
fn a_port_that_takes_nothing_is_not_written_to_for_ever() {
    let (_pty, mut port) = pair();
    let stuck = (0..1_000).find_map(|_| port.write_all(&[0; 512]).err());
    let words = words(stuck.expect("nobody reads what is sent"));
    assert!(words.contains("takes no bytes any more"), "{words}");
}
