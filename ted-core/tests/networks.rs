//! Networks, policies and reward ensembles: what they compute and which shapes they refuse.

use ted_core::{
    Dense, MAX_ACTION, MAX_LAYERS, MAX_MEMBERS, MAX_OBSERVATION, MAX_WIDTH, Mlp, Normaliser,
    Output, Part, Policy, RewardEnsemble, RewardInput, RewardRange, Scratch, ShapeError,
};

static ZEROS: [f32; MAX_WIDTH * MAX_WIDTH] = [0.0; MAX_WIDTH * MAX_WIDTH];
static ONES: [f32; MAX_WIDTH] = [1.0; MAX_WIDTH];

fn zero_layer(inputs: usize, outputs: usize) -> Dense<'static> {
    Dense::new(
        inputs,
        outputs,
        &ZEROS[..inputs * outputs],
        &ZEROS[..outputs],
    )
    .unwrap()
}

fn zero_mlp(inputs: usize, outputs: usize) -> Mlp<'static> {
    Mlp::new(&[zero_layer(inputs, outputs)], Output::Linear).unwrap()
}

fn identity(channels: usize) -> Normaliser<'static> {
    Normaliser::new(&ZEROS[..channels], &ONES[..channels]).unwrap()
}

#[test]
fn a_layer_refuses_parameters_of_another_size() {
    let error = Dense::new(2, 3, &[0.0; 5], &[0.0; 3]).unwrap_err();
    assert_eq!(
        error,
        ShapeError::Mismatch {
            part: Part::Weights,
            expected: 6,
            actual: 5
        }
    );
    let error = Dense::new(2, 3, &[0.0; 6], &[0.0; 4]).unwrap_err();
    assert_eq!(
        error,
        ShapeError::Mismatch {
            part: Part::Bias,
            expected: 3,
            actual: 4
        }
    );
    assert_eq!(
        Dense::new(0, 3, &[], &[0.0; 3]).unwrap_err(),
        ShapeError::Empty { part: Part::Inputs }
    );
    assert_eq!(
        Dense::new(3, 0, &[], &[]).unwrap_err(),
        ShapeError::Empty {
            part: Part::Outputs
        }
    );
    let error = Dense::new(MAX_WIDTH + 1, 1, &[], &[]).unwrap_err();
    assert_eq!(
        error,
        ShapeError::TooLarge {
            part: Part::Inputs,
            limit: MAX_WIDTH,
            actual: MAX_WIDTH + 1
        }
    );
    let error = Dense::new(usize::MAX, usize::MAX, &[], &[]).unwrap_err();
    assert_eq!(
        error,
        ShapeError::TooLarge {
            part: Part::Inputs,
            limit: MAX_WIDTH,
            actual: usize::MAX
        }
    );
}

#[test]
fn a_network_refuses_layers_that_do_not_chain() {
    assert_eq!(
        Mlp::new(&[], Output::Tanh).unwrap_err(),
        ShapeError::Empty { part: Part::Layers }
    );
    let error = Mlp::new(&[zero_layer(3, 5), zero_layer(4, 1)], Output::Tanh).unwrap_err();
    assert_eq!(
        error,
        ShapeError::Mismatch {
            part: Part::Inputs,
            expected: 5,
            actual: 4
        }
    );
    let error = Mlp::new(&[zero_layer(1, 1); MAX_LAYERS + 1], Output::Tanh).unwrap_err();
    assert_eq!(
        error,
        ShapeError::TooLarge {
            part: Part::Layers,
            limit: MAX_LAYERS,
            actual: MAX_LAYERS + 1
        }
    );
}

#[test]
fn a_network_refuses_inputs_and_outputs_of_another_length() {
    let mlp = zero_mlp(3, 2);
    let mut scratch = Scratch::new();
    let error = mlp
        .forward(&[0.0; 4], &mut scratch, &mut [0.0; 2])
        .unwrap_err();
    assert_eq!(
        error,
        ShapeError::Mismatch {
            part: Part::Input,
            expected: 3,
            actual: 4
        }
    );
    let error = mlp
        .forward(&[0.0; 3], &mut scratch, &mut [0.0; 1])
        .unwrap_err();
    assert_eq!(
        error,
        ShapeError::Mismatch {
            part: Part::Output,
            expected: 2,
            actual: 1
        }
    );
}

#[test]
fn a_network_by_hand() {
    let hidden = Dense::new(2, 2, &[1.0, -1.0, 2.0, 0.5], &[0.0, -1.0]).unwrap();
    let last = Dense::new(2, 1, &[3.0, 10.0], &[0.25]).unwrap();
    let mlp = Mlp::new(&[hidden, last], Output::Linear).unwrap();
    let mut out = [0.0];
    // Hidden: relu(1 - 3) = 0 and relu(2 + 1.5 - 1) = 2.5.
    mlp.forward(&[1.0, 3.0], &mut Scratch::new(), &mut out)
        .unwrap();
    assert_eq!(out, [25.25]);
    assert_eq!(
        (mlp.inputs(), mlp.outputs(), mlp.layers().count()),
        (2, 1, 2)
    );
}

#[test]
fn a_policy_standardises_and_then_runs_the_network() {
    let layer = Dense::new(2, 1, &[1.0, 1.0], &[0.0]).unwrap();
    let normaliser = Normaliser::new(&[10.0, -1.0], &[0.5, 0.25]).unwrap();
    let policy = Policy::new(normaliser, Mlp::new(&[layer], Output::Tanh).unwrap()).unwrap();
    let mut action_unit = [0.0];
    policy
        .act(&[11.0, 1.0], &mut Scratch::new(), &mut action_unit)
        .unwrap();
    assert_eq!(action_unit, [ted_core::activation::tanh(1.0)]);
}

#[test]
fn what_scratch_held_before_changes_nothing() {
    let hidden = Dense::new(2, 3, &[0.3, -0.7, 0.9, 0.1, 0.5, 0.6], &[0.1, 0.2, 0.3]).unwrap();
    let last = Dense::new(3, 1, &[0.3, 0.4, -0.5], &[0.0]).unwrap();
    let policy = Policy::new(
        identity(2),
        Mlp::new(&[hidden, last], Output::Tanh).unwrap(),
    )
    .unwrap();
    let mut scratch = Scratch::new();
    let (mut clean, mut dirty) = ([0.0], [0.0]);
    policy.act(&[0.4, 0.8], &mut scratch, &mut clean).unwrap();
    policy
        .act(&[f32::NAN, f32::INFINITY], &mut scratch, &mut dirty)
        .unwrap();
    policy.act(&[0.4, 0.8], &mut scratch, &mut dirty).unwrap();
    assert_eq!(clean[0].to_bits(), dirty[0].to_bits());
}

#[test]
fn a_policy_refuses_what_does_not_fit() {
    let error = Policy::new(identity(3), zero_mlp(2, 1)).unwrap_err();
    assert_eq!(
        error,
        ShapeError::Mismatch {
            part: Part::Shift,
            expected: 2,
            actual: 3
        }
    );
    let wide = MAX_OBSERVATION + 1;
    let error = Policy::new(identity(wide), zero_mlp(wide, 1)).unwrap_err();
    assert_eq!(
        error,
        ShapeError::TooLarge {
            part: Part::Observation,
            limit: MAX_OBSERVATION,
            actual: wide
        }
    );
    let wide = MAX_ACTION + 1;
    let error = Policy::new(identity(1), zero_mlp(1, wide)).unwrap_err();
    assert_eq!(
        error,
        ShapeError::TooLarge {
            part: Part::Action,
            limit: MAX_ACTION,
            actual: wide
        }
    );

    let policy = Policy::new(identity(2), zero_mlp(2, 1)).unwrap();
    let error = policy
        .act(&[0.0; 1], &mut Scratch::new(), &mut [0.0])
        .unwrap_err();
    assert_eq!(
        error,
        ShapeError::Mismatch {
            part: Part::Observation,
            expected: 2,
            actual: 1
        }
    );
    let error = policy
        .act(&[0.0; 2], &mut Scratch::new(), &mut [0.0; 2])
        .unwrap_err();
    assert_eq!(
        error,
        ShapeError::Mismatch {
            part: Part::Action,
            expected: 1,
            actual: 2
        }
    );
}

/// One-layer members `w . (obs, action) + b` with the weights given.
fn ensemble(weights: &[[f32; 3]], range: RewardRange) -> RewardEnsemble<'_> {
    let member = |w| Mlp::new(&[Dense::new(3, 1, w, &[0.0]).unwrap()], Output::Linear).unwrap();
    let members: Vec<_> = weights.iter().map(|w| member(w)).collect();
    RewardEnsemble::new(RewardInput::ObservationAction, identity(3), &members, range).unwrap()
}

const RANGE: RewardRange = RewardRange {
    low: -2.0,
    high: 6.0,
};

#[test]
fn the_raw_reward_is_the_members_mean_summed_in_order() {
    let weights = [[1e8, 0.0, 0.0], [0.0, 1.0, 0.0], [-1e8, 0.0, 0.0]];
    let ensemble = ensemble(&weights, RANGE);
    let mut scratch = Scratch::new();
    let outputs = ensemble
        .member_outputs(&[1.0, 3.0], &[5.0], &mut scratch)
        .unwrap();
    assert_eq!(outputs.as_slice(), [1e8, 3.0, -1e8]);
    let expected = ((1e8_f32 + 3.0) - 1e8) / 3.0;
    assert_eq!(
        ensemble.raw(&[1.0, 3.0], &[5.0], &mut scratch).unwrap(),
        expected
    );
}

#[test]
fn the_reward_is_mapped_to_the_unit_range_and_clamped() {
    let ensemble = ensemble(&[[1.0, 0.0, 0.0]], RANGE);
    let mut scratch = Scratch::new();
    for (raw, reward_hat) in [
        (-2.0, 0.0),
        (0.0, 0.25),
        (6.0, 1.0),
        (-9.0, 0.0),
        (7.0, 1.0),
    ] {
        assert_eq!(
            ensemble
                .reward_hat(&[raw, 0.0], &[0.0], &mut scratch)
                .unwrap(),
            reward_hat
        );
    }
    assert_eq!(
        RewardRange {
            low: 3.0,
            high: 3.0
        }
        .reward_hat(3.0),
        0.0
    );
}

#[test]
fn members_that_see_only_the_observation_ignore_the_action() {
    let member = Mlp::new(
        &[Dense::new(2, 1, &[1.0, 2.0], &[0.0]).unwrap()],
        Output::Linear,
    )
    .unwrap();
    let ensemble =
        RewardEnsemble::new(RewardInput::Observation, identity(2), &[member], RANGE).unwrap();
    let mut scratch = Scratch::new();
    for action_unit in [&[][..], &[f32::NAN; 4]] {
        assert_eq!(
            ensemble
                .raw(&[1.0, 2.0], action_unit, &mut scratch)
                .unwrap(),
            5.0
        );
    }
}

#[test]
fn an_ensemble_refuses_what_does_not_fit() {
    let new = |channels, members: &[Mlp<'static>]| {
        RewardEnsemble::new(
            RewardInput::ObservationAction,
            identity(channels),
            members,
            RANGE,
        )
        .map(|_| ())
    };
    assert_eq!(
        new(3, &[]),
        Err(ShapeError::Empty {
            part: Part::Members
        })
    );
    let many = vec![zero_mlp(3, 1); MAX_MEMBERS + 1];
    let error = ShapeError::TooLarge {
        part: Part::Members,
        limit: MAX_MEMBERS,
        actual: MAX_MEMBERS + 1,
    };
    assert_eq!(new(3, &many), Err(error));
    let error = ShapeError::Mismatch {
        part: Part::Outputs,
        expected: 1,
        actual: 2,
    };
    assert_eq!(new(3, &[zero_mlp(3, 1), zero_mlp(3, 2)]), Err(error));
    let error = ShapeError::Mismatch {
        part: Part::Inputs,
        expected: 4,
        actual: 3,
    };
    assert_eq!(new(4, &[zero_mlp(3, 1)]), Err(error));

    let ensemble = ensemble(&[[0.0; 3]], RANGE);
    let error = ensemble
        .raw(&[0.0; 3], &[0.0; 3], &mut Scratch::new())
        .unwrap_err();
    assert_eq!(
        error,
        ShapeError::Mismatch {
            part: Part::Input,
            expected: 3,
            actual: 6
        }
    );
    let error = ensemble
        .raw(&[0.0; 64], &[0.0; 64], &mut Scratch::new())
        .unwrap_err();
    assert_eq!(
        error,
        ShapeError::TooLarge {
            part: Part::Input,
            limit: 80,
            actual: 128
        }
    );
}
