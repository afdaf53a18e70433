//! The writer writes nothing that a reader would refuse, and says why.
#![cfg(feature = "std")]

mod support;

use support::{full, minimal};
use ted_core::{
    Dense, Mlp, Normaliser, Output, Part, Policy, RewardEnsemble, RewardInput, RewardRange,
    ShapeError,
};
use ted_policy::{
    ActionChannel, ArtifactError, ArtifactSpec, Contract, ContractFault, IntegerSpec,
    ObservationChannel, Place, Provenance, SafeAction, WriteError, write,
};

fn refusal(spec: &ArtifactSpec<'_>) -> ArtifactError {
    match write(spec) {
        Err(WriteError::Refused(error)) => error,
        other => panic!("{other:?}"),
    }
}

/// A policy of one layer `2 -> 1` with these parameters.
fn policy<'a>(
    shift: &'a [f32; 2],
    scale: &'a [f32; 2],
    weights: &'a [f32; 2],
    bias: &'a [f32; 1],
) -> Policy<'a> {
    let mlp = Mlp::new(&[Dense::new(2, 1, weights, bias).unwrap()], Output::Tanh).unwrap();
    Policy::new(Normaliser::new(shift, scale).unwrap(), mlp).unwrap()
}

fn contract(observation: usize, action: usize) -> Contract<'static> {
    let x = ObservationChannel {
        name: "x".into(),
        unit: "m".into(),
        low: -1.0,
        high: 1.0,
    };
    let dx = ActionChannel {
        name: "dx".into(),
        unit: "cm".into(),
        low: -1.0,
        high: 1.0,
        slew_per_tick: 1.0,
        on_fault: SafeAction::Zero,
    };
    Contract::new("t", &vec![x; observation], &vec![dx; action], 1, 1).unwrap()
}

/// What the writer says about a policy of one layer with these parameters.
fn refusal_of(shift: [f32; 2], scale: [f32; 2], weights: [f32; 2], bias: f32) -> ArtifactError {
    let bias = [bias];
    let policy = policy(&shift, &scale, &weights, &bias);
    refusal(&ArtifactSpec {
        contract: contract(2, 1),
        policy,
        golden_obs_raw: &[0.0; 2],
        ..minimal()
    })
}

#[test]
fn parameters_that_are_not_finite_are_refused() {
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let cases = [
            (
                refusal_of([0.0; 2], [1.0; 2], [0.5, bad], 0.0),
                Place::Policy,
            ),
            (refusal_of([0.0; 2], [1.0; 2], [0.5; 2], bad), Place::Policy),
            (
                refusal_of([bad, 0.0], [1.0; 2], [0.5; 2], 0.0),
                Place::Normaliser,
            ),
            (
                refusal_of([0.0; 2], [1.0, bad], [0.5; 2], 0.0),
                Place::Normaliser,
            ),
        ];
        for (error, wanted) in cases {
            match error {
                ArtifactError::NotFinite { place, offset } => {
                    assert!(place == wanted && offset > 0)
                }
                other => panic!("{other}"),
            }
        }
    }
}

#[test]
fn scales_that_are_not_positive_are_refused() {
    for bad in [0.0, -0.0, -3.0] {
        let error = refusal_of([0.0; 2], [1.0, bad], [0.5; 2], 0.0);
        assert_eq!(
            error,
            ArtifactError::ScaleNotPositive {
                place: Place::Normaliser,
                channel: 1
            }
        );
    }
}

#[test]
fn golden_observations_that_are_not_finite_are_refused() {
    let spec = ArtifactSpec {
        golden_obs_raw: &[f32::NAN],
        ..minimal()
    };
    assert!(matches!(
        refusal(&spec),
        ArtifactError::NotFinite {
            place: Place::Golden,
            ..
        }
    ));
}

#[test]
fn golden_observations_that_are_not_whole_rows_are_refused() {
    for golden_obs_raw in [&[][..], &[0.0; 2], &[0.0; 4]] {
        let error = write(&ArtifactSpec {
            golden_obs_raw,
            ..full()
        })
        .unwrap_err();
        assert_eq!(
            error,
            WriteError::GoldenLength {
                width: 3,
                actual: golden_obs_raw.len()
            }
        );
    }
    let many = vec![0.0; 65_536];
    let error = write(&ArtifactSpec {
        golden_obs_raw: &many,
        ..minimal()
    })
    .unwrap_err();
    assert_eq!(
        error,
        WriteError::GoldenLength {
            width: 1,
            actual: 65_536
        }
    );
}

#[test]
fn shapes_that_do_not_match_the_contract_are_refused() {
    let policy = policy(&[0.0; 2], &[1.0; 2], &[0.5; 2], &[0.0]);
    for (observation, action, part, expected, actual) in [
        (1, 1, Part::Observation, 1, 2),
        (3, 1, Part::Observation, 3, 2),
        (2, 2, Part::Action, 2, 1),
    ] {
        let policy = policy.clone();
        let contract = contract(observation, action);
        let spec = ArtifactSpec {
            contract,
            policy,
            golden_obs_raw: &[0.0; 2],
            ..minimal()
        };
        let error = ShapeError::Mismatch {
            part,
            expected,
            actual,
        };
        assert_eq!(
            refusal(&spec),
            ArtifactError::Shape {
                place: Place::Policy,
                error
            }
        );
    }
}

#[test]
fn reward_members_that_do_not_match_the_contract_are_refused() {
    let seen = full();
    for input in [RewardInput::Observation, RewardInput::ObservationAction] {
        let reward = RewardEnsemble::new(
            input,
            Normaliser::new(&[0.0; 4], &[1.0; 4]).unwrap(),
            &[Mlp::new(
                &[Dense::new(4, 1, &[1.0; 4], &[0.0]).unwrap()],
                Output::Linear,
            )
            .unwrap()],
            RewardRange {
                low: 0.0,
                high: 1.0,
            },
        )
        .unwrap();
        match write(&ArtifactSpec {
            reward: Some(reward),
            integers: None,
            ..seen.clone()
        })
        .unwrap_err()
        {
            // Three observation channels are not the four that the members see.
            WriteError::Golden(ShapeError::Mismatch {
                part: Part::Input,
                expected: 4,
                ..
            }) => {}
            other => panic!("{other}"),
        }
    }
}

#[test]
fn integers_of_other_shapes_are_refused() {
    let spec = ArtifactSpec {
        integers: full().integers,
        ..minimal()
    };
    assert_eq!(write(&spec).unwrap_err(), WriteError::IntegerShape);
}

#[test]
fn integers_for_half_of_the_networks_are_refused() {
    let integers = || full().integers.unwrap();
    let without_reward = IntegerSpec {
        reward: None,
        ..integers()
    };
    let without_threshold = IntegerSpec {
        threshold: None,
        ..integers()
    };
    for (half, place) in [
        (without_reward, Place::Reward),
        (without_threshold, Place::Discount),
    ] {
        let spec = ArtifactSpec {
            integers: Some(half),
            ..full()
        };
        assert_eq!(refusal(&spec), ArtifactError::IntegerPart { place });
    }
}

#[test]
fn a_reward_range_that_is_not_finite_and_ordered_is_refused() {
    let member = Mlp::new(&[Dense::new(1, 1, &[1.0], &[0.0]).unwrap()], Output::Linear).unwrap();
    for (low, high) in [(1.0, 0.0), (f32::NAN, 1.0), (0.0, f32::INFINITY)] {
        let normaliser = Normaliser::new(&[0.0], &[1.0]).unwrap();
        let range = RewardRange { low, high };
        let reward = RewardEnsemble::new(
            RewardInput::Observation,
            normaliser,
            std::slice::from_ref(&member),
            range,
        )
        .unwrap();
        let spec = ArtifactSpec {
            reward: Some(reward),
            ..minimal()
        };
        assert!(matches!(refusal(&spec), ArtifactError::RewardRange { .. }));
    }
}

#[test]
fn a_provenance_return_that_is_not_finite_is_refused() {
    let minimal = minimal();
    for bad in [f64::NAN, f64::INFINITY] {
        let provenance = Provenance {
            dataset_return_max: bad,
            ..minimal.provenance.clone()
        };
        let spec = ArtifactSpec {
            provenance,
            ..minimal.clone()
        };
        assert_eq!(
            refusal(&spec),
            ArtifactError::NotFinite {
                place: Place::Provenance,
                offset: 0
            }
        );
    }
}

#[test]
fn a_contract_that_cannot_be_kept_is_refused() {
    let x = ObservationChannel {
        name: "x".into(),
        unit: "m".into(),
        low: -1.0,
        high: 1.0,
    };
    let dx = ActionChannel {
        name: "dx".into(),
        unit: "cm".into(),
        low: -1.0,
        high: 1.0,
        slew_per_tick: 1.0,
        on_fault: SafeAction::Zero,
    };
    let new =
        |observation: &[_], action: &[_]| Contract::new("t", observation, action, 1, 1).map(|_| ());
    assert_eq!(new(&[x], &[dx]), Ok(()));
    assert_eq!(
        new(&[ObservationChannel { low: 1.0, ..x }], &[dx]),
        Ok(()),
        "a constant channel is fine"
    );

    assert_eq!(
        new(&[], &[dx]),
        Err(ContractFault::ObservationChannels {
            limit: 64,
            actual: 0
        })
    );
    assert_eq!(
        new(&[x; 65], &[dx]),
        Err(ContractFault::ObservationChannels {
            limit: 64,
            actual: 65
        })
    );
    assert_eq!(
        new(&[x], &[]),
        Err(ContractFault::ActionChannels {
            limit: 16,
            actual: 0
        })
    );
    assert_eq!(
        new(&[x], &[dx; 17]),
        Err(ContractFault::ActionChannels {
            limit: 16,
            actual: 17
        })
    );
    let bad = [
        ObservationChannel {
            name: "".into(),
            ..x
        },
        ObservationChannel { low: 2.0, ..x },
        ObservationChannel { low: f32::NAN, ..x },
        ObservationChannel {
            high: f32::INFINITY,
            ..x
        },
    ];
    for bad in bad {
        assert_eq!(
            new(&[x, bad], &[dx]),
            Err(ContractFault::Observation { channel: 1 })
        );
    }
    let bad = [
        ActionChannel {
            name: "".into(),
            ..dx
        },
        ActionChannel { low: 1.0, ..dx },
        ActionChannel {
            high: f32::NAN,
            ..dx
        },
        ActionChannel {
            slew_per_tick: 0.0,
            ..dx
        },
        ActionChannel {
            slew_per_tick: f32::NAN,
            ..dx
        },
    ];
    for bad in bad {
        assert_eq!(
            new(&[x], &[dx, bad]),
            Err(ContractFault::Action { channel: 1 })
        );
    }
    let never_zero = ActionChannel { low: 0.5, ..dx };
    assert_eq!(
        new(&[x], &[dx, never_zero]),
        Err(ContractFault::NoSafeAction { channel: 1 })
    );
    let held = ActionChannel {
        on_fault: SafeAction::HoldLast,
        ..never_zero
    };
    assert_eq!(new(&[x], &[dx, held]), Ok(()));
    for (value, kept) in [(0.75, true), (0.25, false), (f32::NAN, false)] {
        let idle = ActionChannel {
            on_fault: SafeAction::Value(value),
            ..never_zero
        };
        assert_eq!(new(&[x], &[dx, idle]).is_ok(), kept, "{value}");
    }
    assert_eq!(
        Contract::new("", &[x], &[dx], 1, 1),
        Err(ContractFault::Task)
    );
    assert_eq!(
        Contract::new("t", &[x], &[dx], 0, 1),
        Err(ContractFault::ControlPeriod)
    );

    // The fields are public, so the reader checks a contract that nobody built with `new`.
    let mut contract = minimal().contract;
    contract.control_period_us = 0;
    let spec = ArtifactSpec {
        contract,
        ..minimal()
    };
    assert_eq!(
        refusal(&spec),
        ArtifactError::Contract(ContractFault::ControlPeriod)
    );
}
