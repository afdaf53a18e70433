//! What is written is what is read.
#![cfg(feature = "std")]

mod support;

use proptest::prelude::*;
use support::{full, full_bytes, minimal};
use ted_core::integer::IntegerMlp;
use ted_core::{Dense, Mlp, Normaliser, Output, Policy, Scratch};
use ted_policy::{
    ActionChannel, Artifact, ArtifactBytes, ArtifactSpec, Contract, IntegerSpec,
    ObservationChannel, Provenance, SafeAction, write,
};

#[test]
fn everything_written_is_read_back() {
    let spec = full();
    let bytes = full_bytes();
    let artifact = Artifact::parse(&bytes).unwrap();
    assert_eq!(artifact.contract(), spec.contract);
    assert_eq!(artifact.provenance(), spec.provenance);
    assert_eq!(artifact.ted(), spec.ted);

    let policy = artifact.policy();
    assert_eq!(policy.normaliser().shift(), support::SHIFT);
    assert_eq!(policy.normaliser().scale(), support::SCALE);
    assert_eq!(policy.mlp().output(), Output::Tanh);
    let layers: Vec<_> = policy
        .mlp()
        .layers()
        .map(|layer| (layer.weights(), layer.bias()))
        .collect();
    let expected = [
        (&support::HIDDEN[..], &support::HIDDEN_BIAS[..]),
        (&support::LAST[..], &support::LAST_BIAS[..]),
    ];
    assert_eq!(layers, expected);

    let (reward, expected) = (artifact.reward().unwrap(), spec.reward.unwrap());
    assert_eq!(reward.input(), expected.input());
    assert_eq!(reward.range(), expected.range());
    assert_eq!(reward.normaliser().shift(), support::REWARD_SHIFT);
    assert_eq!(reward.normaliser().scale(), support::REWARD_SCALE);
    let weights = |members: &[Mlp<'_>]| -> Vec<Vec<f32>> {
        members
            .iter()
            .flat_map(Mlp::layers)
            .map(|layer| layer.weights().to_vec())
            .collect()
    };
    assert_eq!(weights(reward.members()), weights(expected.members()));

    let (integers, expected) = (artifact.integers().unwrap(), spec.integers.unwrap());
    let policy = integers.policy.integer();
    assert_eq!(policy.input_fraction_bits(), 12);
    assert_eq!(policy.output_fraction_bits(), 11);
    assert_eq!(integers.policy.normaliser().shift(), support::SHIFT);
    same_layers(policy.mlp(), expected.policy.mlp());
    let reward = integers.reward.as_ref().unwrap().integer();
    let expected_reward = expected.reward.unwrap();
    assert_eq!(reward.input_fraction_bits(), 11);
    assert_eq!(reward.output_fraction_bits(), 10);
    assert_eq!(reward.range(), expected_reward.range());
    assert_eq!(reward.members().len(), 2);
    for (member, expected) in reward.members().iter().zip(expected_reward.members()) {
        same_layers(member, expected);
    }
    assert_eq!(integers.threshold, expected.threshold);
}

fn same_layers(network: &IntegerMlp<'_>, expected: &IntegerMlp<'_>) {
    assert_eq!(network.output(), expected.output());
    assert_eq!(network.layers().len(), expected.layers().len());
    for (layer, expected) in network.layers().iter().zip(expected.layers()) {
        assert_eq!(layer.weights(), expected.weights());
        assert_eq!(layer.bias(), expected.bias());
        assert_eq!(layer.multipliers(), expected.multipliers());
        assert_eq!(layer.shifts(), expected.shifts());
    }
}

#[test]
fn what_is_left_out_stays_out() {
    let bytes = ArtifactBytes::from_vec(write(&minimal()).unwrap());
    let artifact = Artifact::parse(&bytes).unwrap();
    assert!(artifact.reward().is_none());
    assert!(artifact.ted().is_none());
    assert!(artifact.integers().is_none());
    assert!(artifact.provenance().preferences_digest.is_none());
    assert_eq!(artifact.golden().cases().next().unwrap().reward_raw, None);
}

#[test]
fn a_discount_without_an_ensemble_goes_without_a_border_in_integers() {
    let spec = ArtifactSpec {
        reward: None,
        integers: full().integers.map(|integers| IntegerSpec {
            reward: None,
            threshold: None,
            ..integers
        }),
        ..full()
    };
    let bytes = ArtifactBytes::from_vec(write(&spec).unwrap());
    let artifact = Artifact::parse(&bytes).unwrap();
    assert_eq!(artifact.ted(), spec.ted);
    assert_eq!(artifact.integers().unwrap().threshold, None);
}

#[test]
fn weights_are_borrowed_from_the_file() {
    let bytes = full_bytes();
    let artifact = Artifact::parse(&bytes).unwrap();
    let file = bytes.as_ptr_range();
    for layer in artifact.policy().mlp().layers() {
        assert!(file.contains(&layer.weights().as_ptr().cast()));
        assert!(layer.weights().as_ptr().addr().is_multiple_of(16));
    }
}

#[test]
fn the_same_specification_gives_the_same_bytes() {
    assert_eq!(write(&full()).unwrap(), write(&full()).unwrap());
}

#[test]
fn an_artefact_that_was_read_can_be_written_again() {
    let bytes = full_bytes();
    let artifact = Artifact::parse(&bytes).unwrap();
    let golden_obs_raw: Vec<f32> = artifact
        .golden()
        .cases()
        .flat_map(|case| case.obs_raw.to_vec())
        .collect();
    let spec = ArtifactSpec {
        contract: artifact.contract(),
        provenance: artifact.provenance(),
        policy: artifact.policy(),
        reward: artifact.reward(),
        ted: artifact.ted(),
        integers: artifact.integers().map(|integers| IntegerSpec {
            policy: integers.policy.integer().clone(),
            reward: (integers.reward.as_ref()).map(|reward| reward.integer().clone()),
            threshold: integers.threshold,
        }),
        golden_obs_raw: &golden_obs_raw,
    };
    assert_eq!(write(&spec).unwrap(), bytes.to_vec());
}

#[test]
fn golden_vectors_hold_what_the_networks_compute() {
    let bytes = full_bytes();
    let artifact = Artifact::parse(&bytes).unwrap();
    let mut scratch = Scratch::new();
    artifact.verify_golden(&mut scratch).unwrap();
    let (policy, reward) = (artifact.policy(), artifact.reward().unwrap());
    let cases: Vec<_> = artifact.golden().cases().collect();
    assert_eq!(cases.len(), 2);
    for (case, obs_raw) in cases.iter().zip(support::GOLDEN.chunks(3)) {
        let mut action_unit = [0.0; 2];
        policy.act(obs_raw, &mut scratch, &mut action_unit).unwrap();
        assert_eq!(case.obs_raw, obs_raw);
        assert_eq!(case.action_unit, action_unit);
        assert_eq!(
            case.reward_raw,
            Some(reward.raw(obs_raw, &action_unit, &mut scratch).unwrap())
        );
    }
}

#[test]
fn an_artefact_survives_a_file() {
    let path = std::env::temp_dir().join(format!("ted-policy-{}.ted", std::process::id()));
    std::fs::write(&path, write(&full()).unwrap()).unwrap();
    let bytes = ArtifactBytes::read(&path);
    std::fs::remove_file(&path).unwrap();
    assert_eq!(bytes.unwrap().to_vec(), full_bytes().to_vec());
    let error = ArtifactBytes::read(&path).unwrap_err().to_string();
    assert!(
        error.starts_with("read artefact ") && error.contains(".ted: "),
        "{error}"
    );
}

/// Widths of a network and enough numbers for all of its parameters and for two golden observations.
fn networks() -> impl Strategy<Value = (Vec<usize>, Vec<f32>)> {
    let widths = (
        1_usize..=64,
        prop::collection::vec(1_usize..40, 0..=3),
        1_usize..=16,
    );
    widths.prop_flat_map(|(inputs, hidden, outputs)| {
        let widths: Vec<_> = [inputs]
            .into_iter()
            .chain(hidden)
            .chain([outputs])
            .collect();
        let parameters: usize = widths
            .windows(2)
            .map(|pair| pair[0] * pair[1] + pair[1])
            .sum();
        let numbers = prop::collection::vec(-2.0_f32..2.0, parameters + 4 * inputs);
        (Just(widths), numbers)
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn any_policy_survives_the_round_trip_bit_for_bit(
        (widths, numbers) in networks(),
        task in "[a-z-]{1,30}",
        seed: u64,
        return_max in prop::num::f64::NORMAL,
        idle in -1.0_f32..3.0,
        declared: bool,
    ) {
        let (inputs, outputs) = (widths[0], widths[widths.len() - 1]);
        let mut rest = &numbers[..];
        let mut take = |count| {
            let (taken, left) = rest.split_at(count);
            rest = left;
            taken
        };
        let layers: Vec<_> = widths
            .windows(2)
            .map(|pair| Dense::new(pair[0], pair[1], take(pair[0] * pair[1]), take(pair[1])).unwrap())
            .collect();
        let scale: Vec<f32> = take(inputs).iter().map(|scale| scale.abs() + 1e-3).collect();
        let normaliser = Normaliser::new(take(inputs), &scale).unwrap();
        let policy = Policy::new(normaliser, Mlp::new(&layers, Output::Tanh).unwrap()).unwrap();
        let observation = ObservationChannel { name: "o".into(), unit: "".into(), low: -2.0, high: 2.0 };
        let action = ActionChannel { name: "a".into(), unit: "".into(), low: -1.0, high: 3.0, slew_per_tick: 1.0, on_fault: SafeAction::Value(idle) };
        let minimal = minimal();
        let spec = ArtifactSpec {
            contract: Contract { declared, ..Contract::new(&task, &vec![observation; inputs], &vec![action; outputs], 1, 0).unwrap() },
            provenance: Provenance { seed, dataset_return_max: return_max, ..minimal.provenance.clone() },
            policy,
            golden_obs_raw: take(2 * inputs),
            ..minimal
        };
        let bytes = ArtifactBytes::from_vec(write(&spec).unwrap());
        let artifact = Artifact::parse(&bytes).unwrap();
        prop_assert_eq!(artifact.contract(), spec.contract);
        prop_assert_eq!(artifact.provenance(), spec.provenance);
        let parameters = |policy: &Policy<'_>| -> Vec<u32> {
            let layers = policy.mlp().layers().flat_map(|layer| layer.weights().iter().chain(layer.bias()));
            let normaliser = policy.normaliser();
            let all = layers.chain(normaliser.shift()).chain(normaliser.scale());
            all.map(|number| number.to_bits()).collect()
        };
        prop_assert_eq!(parameters(&artifact.policy()), parameters(&spec.policy));
        artifact.verify_golden(&mut Scratch::new()).unwrap();
    }
}
