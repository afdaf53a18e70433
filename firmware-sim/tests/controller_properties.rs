//! Whatever comes in, what goes out is finite, in range, no faster than it may be, and safe once a fault is latched.

use firmware_sim::controller::{Controller, Numeric};
use firmware_sim::plants::toy::artifact_bytes;
use firmware_sim::safety::ObservationFrame;
use proptest::prelude::*;
use ted_policy::{Artifact, ArtifactBytes};

#[derive(Clone, Debug)]
struct Input {
    elapsed_us: u64,
    age_us: i64,
    sequence_step: u32,
    values: Vec<f32>,
    rearm: bool,
}

/// Mostly good input, so that runs get past the first check, with anything at all in between.
fn input() -> impl Strategy<Value = Input> {
    let value = prop_oneof![20 => -1.0..=1.0_f32, 1 => any::<f32>()];
    (
        prop_oneof![10 => Just(10_000), 1 => any::<u32>().prop_map(u64::from)],
        prop_oneof![10 => 0..=10_000_i64, 1 => any::<i32>().prop_map(i64::from)],
        prop_oneof![20 => Just(1), 1 => any::<u32>()],
        prop_oneof![20 => prop::collection::vec(value.clone(), 5), 1 => prop::collection::vec(value, 0..80)],
        prop::bool::weighted(0.2),
    )
        .prop_map(|(elapsed_us, age_us, sequence_step, values, rearm)| Input {
            elapsed_us,
            age_us,
            sequence_step,
            values,
            rearm,
        })
}

proptest! {
    #[test]
    fn no_input_gets_an_unsafe_action_out(inputs in prop::collection::vec(input(), 1..40)) {
        let bytes = ArtifactBytes::from_vec(artifact_bytes().unwrap());
        let artifact = Artifact::parse(&bytes).unwrap();
        let mut controller = Controller::load(&artifact, Numeric::F32).unwrap();
        let channels = &artifact.contract().action;
        let (mut now_us, mut sequence, mut last, mut latched) = (0_u64, 0_u32, vec![0.0; channels.len()], None);
        for input in inputs {
            now_us += input.elapsed_us;
            sequence = sequence.wrapping_add(input.sequence_step);
            let stamp_us = now_us.saturating_add_signed(-input.age_us);
            if input.rearm {
                controller.rearm();
                latched = None;
            }
            let frame = ObservationFrame { sequence, stamp_us, values: &input.values };
            let (action, status) = controller.tick(now_us, &frame);
            prop_assert_eq!(action.len(), channels.len());
            for ((channel, &sent), &before) in channels.iter().zip(&action).zip(&last) {
                prop_assert!(sent.is_finite() && channel.low <= sent && sent <= channel.high);
                match status.fault {
                    Some(_) if channel.name == "gripper".into() => prop_assert_eq!(sent, before),
                    Some(_) => prop_assert_eq!(sent, 0.0),
                    // The difference itself is rounded once more.
                    None => prop_assert!((sent - before).abs() <= channel.slew_per_tick + f32::EPSILON),
                }
            }
            prop_assert!(latched.is_none() || status.fault == latched);
            latched = status.fault;
            last = action.to_vec();
        }
    }
}
