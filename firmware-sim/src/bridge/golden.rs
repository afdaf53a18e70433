//! The golden frames of `docs/bridge-protocol.md`: the Rust side of what `test_wire.py` tests on the Python side.

use std::collections::HashMap;

use super::episode::{Behaviour, Episode, EpisodeJob};
use super::frame::{self, FrameError, HEADER_LEN, HELLO_LEN, Header, PROTOCOL_VERSION};
use super::message::{self, FaultCode, MessageError, Move, Shape, Step, kind};
use super::picture::{Look, PictureJob, Pictures, State};

const DOCUMENT: &str = include_str!("../../../docs/bridge-protocol.md");

const SHAPE: Shape = Shape {
    observation: 2,
    action: 1,
    qpos: 1,
    qvel: 1,
    mocap: 1,
    goal: 1,
    horizon: 500,
};

/// The frames of the document by name.
fn golden() -> HashMap<&'static str, Vec<u8>> {
    let block = DOCUMENT
        .split("```golden\n")
        .nth(1)
        .and_then(|rest| rest.split("```").next());
    let mut frames: HashMap<_, Vec<u8>> = HashMap::new();
    let mut current = "";
    for line in block.expect("the document has golden frames").lines() {
        let digits = match line.split_once('=') {
            Some((name, digits)) => {
                current = name.trim();
                digits.trim()
            }
            None => line.trim(),
        };
        let bytes = digits.as_bytes().chunks(2).map(|pair| {
            u8::from_str_radix(&String::from_utf8_lossy(pair), 16)
                .expect("the document holds hex digits")
        });
        frames.entry(current).or_default().extend(bytes);
    }
    frames
}

fn framed(kind: u16, sequence: u32, payload: &[u8]) -> Vec<u8> {
    let mut out = Vec::new();
    frame::write(&mut out, kind, sequence, payload);
    out
}

fn unframed(bytes: &[u8]) -> Result<(u16, u32, &[u8]), FrameError> {
    let (header, payload) = bytes.split_first_chunk::<HEADER_LEN>().expect("a header");
    let header = Header::parse(header)?;
    assert_eq!(header.length, payload.len());
    header.check(payload)?;
    Ok((header.kind, header.sequence, payload))
}

fn payload_of(name: &str, kind: u16) -> Vec<u8> {
    let (found, _, payload) = unframed(&golden()[name])
        .map(|(k, s, p)| (k, s, p.to_vec()))
        .expect("a frame");
    assert_eq!(found, kind);
    payload
}

#[test]
fn the_document_names_the_version_that_the_code_speaks() {
    let title = DOCUMENT.lines().next().expect("a title");
    assert!(
        title.ends_with(&format!("version {PROTOCOL_VERSION}")),
        "{title}"
    );
}

#[test]
fn the_greeting_is_the_document_s() {
    assert_eq!(golden()["hello"], frame::hello(PROTOCOL_VERSION));
    let other: [u8; HELLO_LEN] = frame::hello(7);
    assert_eq!(frame::check_hello(&other), Ok(7));
}

#[test]
fn requests_are_the_document_s() {
    let golden = golden();
    assert_eq!(
        golden["open"],
        framed(kind::OPEN, 1, &message::open("drawer-open-v3"))
    );
    assert_eq!(
        golden["reset"],
        framed(kind::RESET, 2, &message::reset(1, 7))
    );
    let mut action = vec![9];
    let moves = [(0, 0.5), (1, -1.0)].map(|(slot, value)| Move {
        slot,
        action: vec![value],
    });
    message::step(&moves, &mut action);
    assert_eq!(golden["step"], framed(kind::STEP, 3, &action));
    let job = EpisodeJob {
        task: "not on the wire".to_owned(),
        behaviour: Behaviour {
            push: [0.25, -0.5, 0.0, 1.0],
            drift_std: 0.4,
            drift_correlation: 0.98,
            purpose: 1,
            ..Behaviour::PAPER_EPSILON
        },
        seed: 0xDEAD_BEEF,
        steps: 500,
    };
    assert_eq!(
        golden["collect"],
        framed(kind::COLLECT, 4, &message::collect(&job))
    );
}

#[test]
fn replies_are_read_as_the_document_says() {
    let ready = message::parse_ready(&payload_of("ready", kind::READY));
    assert_eq!(ready.as_deref(), Ok("python=3.11.7 mujoco=3.3.0"));
    assert_eq!(
        message::parse_opened(&payload_of("opened", kind::OPENED)),
        Ok(SHAPE)
    );
    let resetted = message::parse_resetted(&payload_of("resetted", kind::RESETTED), &SHAPE);
    assert_eq!(resetted, Ok((vec![1.0, -0.5], vec![0.25])));
    let solved = Step {
        observation: vec![0.25, 2.0],
        reward: 1.5,
        success: true,
        terminated: false,
        truncated: true,
    };
    let unsolved = Step {
        observation: vec![0.5, 3.0],
        reward: -2.5,
        ..Step::default()
    };
    assert_eq!(
        message::parse_stepped(&payload_of("stepped", kind::STEPPED), &SHAPE, 2),
        Ok(vec![solved, unsolved])
    );
    let fault = message::parse_fault(&payload_of("fault", kind::FAULT));
    assert_eq!(
        fault,
        Ok((FaultCode::UnknownTask, "no such task".to_owned()))
    );
}

#[test]
fn pictures_are_asked_for_and_read_as_the_document_says() {
    let state = |at: f64| State {
        qpos: vec![at],
        mocap_pos: vec![at, 1.0, 2.0],
        mocap_quat: vec![1.0, 0.0, 1.0, at],
    };
    let job = PictureJob {
        task: "not on the wire".to_owned(),
        seed: 0xDEAD_BEEF,
        look: Look {
            width: 400,
            height: 300,
            quality: 80,
        },
        states: vec![state(0.5), state(-0.5)],
    };
    assert_eq!(
        golden()["render"],
        framed(kind::RENDER, 5, &message::render(&job))
    );
    let payload = payload_of("rendered", kind::RENDERED);
    let pictures = Pictures {
        way: "egl".to_owned(),
        jpegs: vec![vec![0xFF, 0xD8, 0xFF], vec![0xFF, 0xD9]],
    };
    assert_eq!(message::parse_rendered(&payload, 2), Ok(pictures));
    for states in [1, 3] {
        assert!(matches!(
            message::parse_rendered(&payload, states),
            Err(MessageError::Length { .. })
        ));
    }
}

#[test]
fn a_state_is_asked_for_and_read_as_the_document_says() {
    assert_eq!(
        golden()["state"],
        framed(kind::STATE, 6, &message::state(1))
    );
    let payload = payload_of("stated", kind::STATED);
    let state = State {
        qpos: vec![0.5],
        mocap_pos: vec![0.5, 1.0, 2.0],
        mocap_quat: vec![1.0, 0.0, 1.0, 0.5],
    };
    assert_eq!(message::parse_stated(&payload, &SHAPE), Ok(state));
}

#[test]
fn an_episode_is_read_as_the_document_says() {
    let episode = Episode {
        shape: SHAPE,
        observations: vec![1.0, 2.0, 3.0, 4.0],
        actions: vec![-1.0],
        rewards: vec![1.5],
        success: vec![true],
        terminations: vec![false],
        truncations: vec![true],
        qpos: vec![0.1, 0.2],
        qvel: vec![0.3, 0.4],
        mocap_pos: vec![0.0, 1.0, 2.0, 3.0, 4.0, 5.0],
        mocap_quat: vec![1.0, 0.0, 1.0, 0.0, 1.0, 0.0, 1.0, 0.0],
        goal: vec![0.25],
    };
    assert_eq!(
        message::parse_collected(&payload_of("collected", kind::COLLECTED), &SHAPE),
        Ok(episode)
    );
}

#[test]
fn any_flipped_bit_of_a_frame_is_noticed() {
    let good = &golden()["stepped"];
    for bit in 0..good.len() * 8 {
        let mut bad = good.clone();
        bad[bit / 8] ^= 1 << (bit % 8);
        let header = bad.first_chunk::<HEADER_LEN>().expect("a header");
        let noticed = match Header::parse(header) {
            Err(_) => true,
            Ok(header) => {
                header.length != good.len() - HEADER_LEN
                    || header.check(&bad[HEADER_LEN..]).is_err()
            }
        };
        assert!(noticed, "bit {bit}");
    }
}

#[test]
fn any_flipped_bit_of_a_greeting_is_noticed() {
    for bit in 0..HELLO_LEN * 8 {
        let mut bad = frame::hello(1);
        bad[bit / 8] ^= 1 << (bit % 8);
        assert_eq!(
            frame::check_hello(&bad),
            Err(FrameError::NotAGreeting),
            "bit {bit}"
        );
    }
}

#[test]
fn a_payload_of_any_other_length_is_refused() {
    let payload = payload_of("collected", kind::COLLECTED);
    for length in 0..payload.len() {
        assert!(matches!(
            message::parse_collected(&payload[..length], &SHAPE),
            Err(MessageError::Length { .. })
        ));
    }
    let mut longer = payload;
    longer.push(0);
    assert!(matches!(
        message::parse_collected(&longer, &SHAPE),
        Err(MessageError::Length { .. })
    ));
    let endless = [0xFF; 4];
    assert!(
        message::parse_collected(&endless, &SHAPE).is_err(),
        "sizes that overflow are no panic"
    );
}
