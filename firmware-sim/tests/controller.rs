//! The controller, one tick at a time: what it refuses to load, what it refuses to fly on, and what it sends.

use firmware_sim::controller::{Controller, Numeric};
use firmware_sim::plants::toy::artifact_spec;
use firmware_sim::safety::{Action, ActionGuard, Fault, ObservationFrame};
use ted_core::{Dense, Mlp, Normaliser, Output, Policy};
use ted_policy::{Artifact, ArtifactBytes, ArtifactError, ArtifactSpec, SafeAction, write};

const PERIOD_US: u64 = 10_000;
const GOOD: [f32; 5] = [-0.5, 0.25, 0.5, 0.25, 0.0];

fn loaded<T>(
    spec: &ArtifactSpec<'_>,
    then: impl FnOnce(Result<Controller<'_>, ArtifactError>) -> T,
) -> T {
    let bytes = ArtifactBytes::from_vec(write(spec).unwrap());
    then(Controller::load(
        &Artifact::parse(&bytes).unwrap(),
        Numeric::F32,
    ))
}

fn with_toy<T>(then: impl FnOnce(Controller<'_>) -> T) -> T {
    loaded(&artifact_spec().unwrap(), |controller| {
        then(controller.unwrap())
    })
}

/// Ticks with a fresh frame, number `tick` of the episode.
fn tick(controller: &mut Controller<'_>, tick: u32, values: &[f32]) -> (Action, Option<Fault>) {
    let now_us = u64::from(tick) * PERIOD_US;
    let (action, status) = controller.tick(
        now_us,
        &ObservationFrame {
            sequence: tick,
            stamp_us: now_us,
            values,
        },
    );
    (action, status.fault)
}

fn fault_of(frame: &ObservationFrame<'_>) -> Option<Fault> {
    with_toy(|mut controller| {
        assert_eq!(tick(&mut controller, 0, &GOOD).1, None);
        let (action, status) = controller.tick(PERIOD_US, frame);
        if status.fault.is_some() {
            assert_eq!(action[..2], [0.0, 0.0]);
        }
        status.fault
    })
}

fn fault_of_values(values: &[f32]) -> Option<Fault> {
    fault_of(&ObservationFrame {
        sequence: 1,
        stamp_us: PERIOD_US,
        values,
    })
}

#[test]
fn a_good_observation_is_flown() {
    assert_eq!(fault_of_values(&GOOD), None);
}

#[test]
fn every_channel_is_judged() {
    for index in 0..GOOD.len() {
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            let mut values = GOOD;
            values[index] = bad;
            assert_eq!(fault_of_values(&values), Some(Fault::NotFinite { index }));
        }
        for bad in [1.000_000_1, -1.000_000_1, f32::MAX, f32::MIN] {
            let mut values = GOOD;
            values[index] = bad;
            assert_eq!(fault_of_values(&values), Some(Fault::OutOfRange { index }));
        }
    }
}

#[test]
fn the_ends_of_a_range_are_inside_it() {
    assert_eq!(fault_of_values(&[1.0, -1.0, 1.0, -1.0, 1.0]), None);
}

#[test]
fn an_observation_of_any_other_length_is_refused() {
    for actual in [0, 1, 4, 6, 64, 65, 1000] {
        let wrong = Fault::WrongLength {
            expected: 5,
            actual,
        };
        assert_eq!(fault_of_values(&vec![0.0; actual]), Some(wrong));
    }
}

#[test]
fn an_observation_is_fresh_for_its_greatest_age_and_no_longer() {
    let toy = artifact_spec().unwrap();
    assert_eq!(u64::from(toy.contract.max_observation_age_us), PERIOD_US);
    let stamped = |stamp_us| {
        fault_of(&ObservationFrame {
            sequence: 1,
            stamp_us,
            values: &GOOD,
        })
    };
    assert_eq!(stamped(0), None);
    let ahead = PERIOD_US + 1;
    assert_eq!(
        stamped(ahead),
        Some(Fault::Stale {
            stamp_us: ahead,
            now_us: PERIOD_US
        })
    );
    with_toy(|mut controller| {
        let frame = ObservationFrame {
            sequence: 0,
            stamp_us: 5,
            values: &GOOD,
        };
        let (_, status) = controller.tick(6 + PERIOD_US, &frame);
        assert_eq!(
            status.fault,
            Some(Fault::Stale {
                stamp_us: 5,
                now_us: 6 + PERIOD_US
            })
        );
    });
}

#[test]
fn frames_count_up_by_one_from_anywhere_and_round_the_end() {
    with_toy(|mut controller| {
        for (now_us, sequence) in [(0, u32::MAX - 1), (1, u32::MAX), (2, 0), (3, 1)] {
            let frame = ObservationFrame {
                sequence,
                stamp_us: now_us,
                values: &GOOD,
            };
            assert_eq!(controller.tick(now_us, &frame).1.fault, None);
        }
    });
    for actual in [0, 2, u32::MAX] {
        let frame = ObservationFrame {
            sequence: actual,
            stamp_us: PERIOD_US,
            values: &GOOD,
        };
        assert_eq!(
            fault_of(&frame),
            Some(Fault::OutOfSequence {
                expected: 1,
                actual
            })
        );
    }
}

#[test]
fn the_first_reason_stays_latched_whatever_comes_after() {
    with_toy(|mut controller| {
        let nan = [f32::NAN; 5];
        assert_eq!(
            tick(&mut controller, 0, &nan).1,
            Some(Fault::NotFinite { index: 0 })
        );
        assert_eq!(
            tick(&mut controller, 1, &GOOD).1,
            Some(Fault::NotFinite { index: 0 })
        );
        assert_eq!(
            tick(&mut controller, 9, &[]).1,
            Some(Fault::NotFinite { index: 0 })
        );
    });
}

#[test]
fn a_fault_stops_the_motion_at_once_and_keeps_the_grip() {
    with_toy(|mut controller| {
        let flown: Vec<Action> = (0..4)
            .map(|index| tick(&mut controller, index, &GOOD).0)
            .collect();
        assert!(flown[3][0] > 0.9 && flown[3][2] > 0.9, "{:?}", flown[3]);
        let (stopped, _) = tick(&mut controller, 4, &[]);
        assert_eq!(stopped, [0.0, 0.0, flown[3][2]]);
        assert_eq!(tick(&mut controller, 5, &GOOD).0, stopped);
    });
}

#[test]
fn rearming_flies_on_with_the_grip_kept_and_reset_starts_at_rest() {
    with_toy(|mut controller| {
        for index in 0..4 {
            tick(&mut controller, index, &GOOD);
        }
        let (held, fault) = tick(&mut controller, 4, &[]);
        assert!(fault.is_some());
        controller.rearm();
        let (first, fault) = tick(&mut controller, 90, &GOOD);
        assert_eq!((first[0], first[2], fault), (0.5, held[2], None));
        controller.reset();
        let (first, fault) = tick(&mut controller, 0, &GOOD);
        assert_eq!((first[0], first[2], fault), (0.5, 0.25, None));
    });
}

#[test]
fn an_action_moves_no_faster_than_its_slew_limit() {
    with_toy(|mut controller| {
        let mut last = Action::from_array([0.0; 3]);
        for index in 0..40 {
            let side = if index % 3 == 0 { -0.9 } else { 0.9 };
            let (action, fault) = tick(&mut controller, index, &[0.0, side, side, 0.0, 0.0]);
            assert_eq!(fault, None);
            for ((now, before), limit) in action.iter().zip(&last).zip([0.5, 0.5, 0.25]) {
                assert!((now - before).abs() <= limit);
            }
            last = action;
        }
    });
}

#[test]
fn an_action_stays_in_the_contracts_range() {
    let mut spec = artifact_spec().unwrap();
    for channel in &mut spec.contract.action {
        (channel.low, channel.high, channel.slew_per_tick) = (-0.125, 0.375, 10.0);
    }
    loaded(&spec, |controller| {
        let mut controller = controller.unwrap();
        let frame = ObservationFrame {
            sequence: 0,
            stamp_us: 0,
            values: &[0.0, 0.0, 0.9, -0.9, 0.0],
        };
        let (action, status) = controller.tick(0, &frame);
        // The policy wants 1, -1 and a little less than 1, which are the ends of the range and a little less.
        let wanted = [0.375, -0.125, 0.366];
        for (sent, wanted) in action.iter().zip(wanted) {
            assert!((sent - wanted).abs() < 1e-4, "{action:?}");
            assert!((-0.125..=0.375).contains(sent), "{action:?}");
        }
        assert!(!status.slew_limited);
    });
    // A policy without a tanh at its end may want more than there is.
    let mut guard = ActionGuard::new(spec.contract.action.iter().copied());
    let sent = guard.send(&[1.5, -1.5, 0.0]).unwrap();
    assert_eq!(sent.action, [0.375, -0.125, 0.125]);
    assert!(sent.clamped && !sent.slew_limited);
}

#[test]
fn a_channel_may_be_sent_any_value_of_its_range_on_a_fault() {
    let mut spec = artifact_spec().unwrap();
    for channel in &mut spec.contract.action {
        (channel.low, channel.high, channel.slew_per_tick) = (0.25, 1.0, 1.0);
        channel.on_fault = SafeAction::Value(0.75);
    }
    loaded(&spec, |controller| {
        let mut controller = controller.unwrap();
        let (_, fault) = tick(&mut controller, 0, &[0.0, 0.0, 0.9, -0.9, 0.0]);
        assert_eq!(fault, None);
        let (safe, fault) = tick(&mut controller, 1, &[f32::NAN, 0.0, 0.9, -0.9, 0.0]);
        assert!(fault.is_some());
        assert_eq!(safe, [0.75; 3]);
    });
}

#[test]
fn an_action_that_may_go_out_goes_out_with_its_bits_unchanged() {
    let mut spec = artifact_spec().unwrap();
    for channel in &mut spec.contract.action {
        channel.slew_per_tick = 2.0;
    }
    let mut expected = [0.0; 3];
    spec.policy
        .act(&GOOD, &mut ted_core::Scratch::new(), &mut expected)
        .unwrap();
    let sent = loaded(&spec, |controller| {
        tick(&mut controller.unwrap(), 0, &GOOD).0
    });
    assert_eq!(
        sent.iter().map(|value| value.to_bits()).collect::<Vec<_>>(),
        expected.map(f32::to_bits)
    );
}

#[test]
fn a_policy_that_overflows_is_stopped() {
    let weights = [f32::MAX, 0.0, 0.0, 0.0, 0.0].repeat(3);
    let layer = Dense::new(5, 3, &weights, &[0.0; 3]).unwrap();
    let normaliser = Normaliser::new(&[0.0; 5], &[4.0; 5]).unwrap();
    let mut spec = artifact_spec().unwrap();
    spec.policy = Policy::new(normaliser, Mlp::new(&[layer], Output::Linear).unwrap()).unwrap();
    spec.integers = None;
    spec.golden_obs_raw = &[0.0; 5];
    let fault = loaded(&spec, |controller| {
        tick(&mut controller.unwrap(), 0, &GOOD).1
    });
    assert_eq!(fault, Some(Fault::ActionNotFinite { index: 0 }));
}

#[test]
fn the_contract_says_which_channel_holds_on_a_fault_and_not_its_name() {
    let mut spec = artifact_spec().unwrap();
    for channel in &mut spec.contract.action {
        channel.on_fault = match channel.on_fault {
            SafeAction::Zero => SafeAction::HoldLast,
            SafeAction::HoldLast | SafeAction::Value(_) => SafeAction::Zero,
        };
    }
    loaded(&spec, |controller| {
        let mut controller = controller.unwrap();
        let (flown, fault) = tick(&mut controller, 0, &[0.0, 0.0, 0.9, -0.9, 0.0]);
        assert_eq!(fault, None);
        assert!(flown.iter().all(|&value| value != 0.0), "{flown:?}");
        let (safe, fault) = tick(&mut controller, 1, &[]);
        assert!(fault.is_some());
        assert_eq!(safe, [flown[0], flown[1], 0.0]);
    });
}

#[test]
fn a_late_tick_is_counted_and_three_in_a_row_are_a_fault() {
    with_toy(|mut controller| {
        let mut fly = |now_us, sequence| {
            controller
                .tick(
                    now_us,
                    &ObservationFrame {
                        sequence,
                        stamp_us: now_us,
                        values: &GOOD,
                    },
                )
                .1
        };
        assert!(!fly(0, 0).deadline_missed);
        let late = fly(3 * PERIOD_US, 1);
        assert_eq!(
            (late.deadline_missed, late.deadlines_missed, late.fault),
            (true, 1, None)
        );
        assert_eq!(fly(6 * PERIOD_US, 2).fault, None);
        let elapsed_us = 3 * PERIOD_US;
        assert_eq!(
            fly(9 * PERIOD_US, 3).fault,
            Some(Fault::DeadlineMissed { elapsed_us })
        );
    });
}

#[test]
fn a_machine_that_computes_other_bits_does_not_fly() {
    let mut floats = artifact_spec().unwrap();
    floats.integers = None;
    let with_integers = artifact_spec().unwrap();
    for (spec, numeric) in [(floats, Numeric::F32), (with_integers, Numeric::Integer)] {
        let mut bytes = write(&spec).unwrap();
        // The last number of the file is a golden reward; the checksum is mended as a forger would.
        let flipped = bytes.len() - bytes.iter().rev().position(|byte| *byte != 0).unwrap() - 1;
        bytes[flipped] ^= 1;
        mend_checksum(&mut bytes);
        let bytes = ArtifactBytes::from_vec(bytes);
        let refused = Controller::load(&Artifact::parse(&bytes).unwrap(), numeric).unwrap_err();
        assert!(
            matches!(refused, ArtifactError::GoldenMismatch { .. }),
            "{refused}"
        );
    }
}

/// The checksum is a CRC-32 of the file with the checksum's own four bytes, at offset 12, left as zeros.
fn mend_checksum(bytes: &mut [u8]) {
    bytes[12..16].fill(0);
    let checksum = crc32fast::hash(bytes);
    bytes[12..16].copy_from_slice(&checksum.to_le_bytes());
}
