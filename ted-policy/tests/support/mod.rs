//! Small artefacts that use every part of the format, and the bytes of them made valid again after a change.
#![allow(dead_code)]

use std::ops::Range;

use ted_core::integer::{
    IntegerDense, IntegerMlp, IntegerPolicy, IntegerRange, IntegerRewardEnsemble,
};
use ted_core::{
    Dense, Mlp, Normaliser, Output, Policy, ReturnThreshold, RewardEnsemble, RewardInput,
    RewardRange, TedDiscount,
};
use ted_policy::{
    ActionChannel, ArtifactBytes, ArtifactSpec, Contract, Digest, HEADER_LENGTH, IntegerSpec,
    ObservationChannel, Provenance, SafeAction, write,
};

pub static SHIFT: [f32; 3] = [0.5, -0.25, 2.0];
pub static SCALE: [f32; 3] = [1.0, 4.0, 0.125];
pub static HIDDEN: [f32; 15] = [
    0.1, -0.2, 0.3, -0.4, 0.5, -0.6, 0.7, -0.8, 0.9, -1.0, 1.1, -1.2, 1.3, -1.4, 1.5,
];
pub static HIDDEN_BIAS: [f32; 5] = [0.0, 0.1, -0.1, 0.2, -0.2];
pub static LAST: [f32; 10] = [0.3, -0.1, 0.4, -0.1, 0.5, -0.9, 0.2, -0.6, 0.5, -0.3];
pub static LAST_BIAS: [f32; 2] = [0.05, -0.05];
pub static REWARD_SHIFT: [f32; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];
pub static REWARD_SCALE: [f32; 5] = [2.0, 1.0, 0.5, 0.25, 0.125];
pub static GOLDEN: [f32; 6] = [0.4, -0.3, 1.5, 0.6, 0.2, 2.5];
pub static INTEGER_HIDDEN: &[i8] = &[1, -2, 3, -127, 127, 0, 4, -5, 6, -7, 8, -9, 10, -11, 12];
pub static INTEGER_LAST: &[i8] = &[30, -10, 40, -10, 50, -90, 20, -60, 50, -30];
static INTEGER_BIAS: [i32; 5] = [1_000_000, -7, 0, 12, -34];
static MULTIPLIERS: [i32; 5] = [1 << 30, i32::MAX, 1 << 30, 1_500_000_000, 1 << 30];
static SHIFTS: [i8; 5] = [-8, -3, -2, -1, 0];

/// An artefact that uses every part of the format.
pub fn full() -> ArtifactSpec<'static> {
    let hidden = Dense::new(3, 5, &HIDDEN, &HIDDEN_BIAS).unwrap();
    let last = Dense::new(5, 2, &LAST, &LAST_BIAS).unwrap();
    let member = |weights, bias| {
        Mlp::new(&[Dense::new(5, 1, weights, bias).unwrap()], Output::Linear).unwrap()
    };
    let members = [
        member(&HIDDEN[..5], &LAST_BIAS[..1]),
        member(&HIDDEN[5..10], &LAST_BIAS[1..]),
    ];
    ArtifactSpec {
        contract: contract(),
        provenance: provenance(),
        policy: Policy::new(
            Normaliser::new(&SHIFT, &SCALE).unwrap(),
            Mlp::new(&[hidden, last], Output::Tanh).unwrap(),
        )
        .unwrap(),
        reward: Some(
            RewardEnsemble::new(
                RewardInput::ObservationAction,
                Normaliser::new(&REWARD_SHIFT, &REWARD_SCALE).unwrap(),
                &members,
                RewardRange {
                    low: -1.5,
                    high: 2.5,
                },
            )
            .unwrap(),
        ),
        ted: Some(
            TedDiscount::new(
                0.99,
                0.7,
                ReturnThreshold {
                    return_hat: 123.5,
                    last_tied_episode: 300,
                },
            )
            .unwrap(),
        ),
        integers: Some(integers()),
        golden_obs_raw: &GOLDEN,
    }
}

/// Integers in the shapes of [`full`]'s networks.
fn integers() -> IntegerSpec<'static> {
    let layer = |inputs, weights, outputs| {
        IntegerDense::new(
            inputs,
            weights,
            &INTEGER_BIAS[..outputs],
            &MULTIPLIERS[..outputs],
            &SHIFTS[..outputs],
        )
        .unwrap()
    };
    let policy = [layer(3, INTEGER_HIDDEN, 5), layer(5, INTEGER_LAST, 2)];
    let members = [&INTEGER_HIDDEN[..5], &INTEGER_HIDDEN[5..10]]
        .map(|weights| IntegerMlp::new(&[layer(5, weights, 1)], Output::Linear).unwrap());
    let range = IntegerRange {
        low: -300,
        high: 70_000,
    };
    IntegerSpec {
        policy: IntegerPolicy::new(12, 11, IntegerMlp::new(&policy, Output::Tanh).unwrap())
            .unwrap(),
        reward: Some(IntegerRewardEnsemble::new(11, 10, &members, range).unwrap()),
        threshold: Some(ReturnThreshold {
            return_hat: 1 << 33,
            last_tied_episode: 301,
        }),
    }
}

/// An artefact with nothing optional in it: one channel in, one out, one layer.
pub fn minimal() -> ArtifactSpec<'static> {
    static TWO: [f32; 1] = [2.0];
    static HALF: [f32; 1] = [0.5];
    let layer = Dense::new(1, 1, &TWO, &HALF).unwrap();
    ArtifactSpec {
        contract: Contract::new(
            "reach-v3",
            &[ObservationChannel {
                name: "x".into(),
                unit: "m".into(),
                low: -1.0,
                high: 1.0,
            }],
            &[ActionChannel {
                name: "dx".into(),
                unit: "cm".into(),
                low: -1.0,
                high: 1.0,
                slew_per_tick: 2.0,
                on_fault: SafeAction::Zero,
            }],
            12_500,
            25_000,
        )
        .unwrap(),
        provenance: Provenance {
            trainer_version: "0.1.0",
            preset: "true",
            seed: 7,
            steps: 50_000,
            config_digest: Digest([0x11; 32]),
            dataset_id: "ted/reach-v0",
            dataset_digest: Digest([0x22; 32]),
            preferences_digest: None,
            dataset_return_mean: 1.5,
            dataset_return_max: 3.0,
        },
        policy: Policy::new(
            Normaliser::new(&HALF, &TWO).unwrap(),
            Mlp::new(&[layer], Output::Linear).unwrap(),
        )
        .unwrap(),
        reward: None,
        ted: None,
        integers: None,
        golden_obs_raw: &HALF,
    }
}

fn contract() -> Contract<'static> {
    let observation = |name: &'static str, low| ObservationChannel {
        name: name.into(),
        unit: "m".into(),
        low,
        high: 3.0,
    };
    let action = |name: &'static str, on_fault| ActionChannel {
        name: name.into(),
        unit: "cm".into(),
        low: -1.0,
        high: 1.0,
        slew_per_tick: 0.5,
        on_fault,
    };
    Contract::new(
        "drawer-open-v3",
        &[
            observation("hand_x", -1.0),
            observation("hand_y", 0.0),
            observation("hand_z", 3.0),
        ],
        &[
            action("hand_dx", SafeAction::Zero),
            action("grip", SafeAction::HoldLast),
        ],
        12_500,
        30_000,
    )
    .unwrap()
}

fn provenance() -> Provenance<'static> {
    Provenance {
        trainer_version: "0.1.0",
        preset: "oprl-i+ted",
        seed: u64::MAX,
        steps: 250_000,
        config_digest: Digest([0xc0; 32]),
        dataset_id: "ted/drawer-open-v0",
        dataset_digest: Digest([0xda; 32]),
        preferences_digest: Some(Digest([0x9e; 32])),
        dataset_return_mean: 1234.5,
        dataset_return_max: 4321.25,
    }
}

/// The bytes of [`full`], at an aligned address.
pub fn full_bytes() -> ArtifactBytes {
    ArtifactBytes::from_vec(write(&full()).unwrap())
}

/// Changes bytes and makes the checksum right again, so that the damage gets past it.
pub fn resealed(bytes: &[u8], change: impl FnOnce(&mut Vec<u8>)) -> ArtifactBytes {
    let mut bytes = bytes.to_vec();
    change(&mut bytes);
    seal(&mut bytes);
    ArtifactBytes::from_vec(bytes)
}

/// As the format document defines it: CRC-32 with the four checksum bytes counted as zeros.
pub fn seal(bytes: &mut [u8]) {
    bytes[12..16].fill(0);
    let checksum = crc32fast::hash(bytes);
    bytes[12..16].copy_from_slice(&checksum.to_le_bytes());
}

/// One 32-bit header field.
pub fn field(bytes: &[u8], at: usize) -> u32 {
    u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap())
}

/// Where the metadata lies.
pub fn metadata(bytes: &[u8]) -> Range<usize> {
    HEADER_LENGTH..HEADER_LENGTH + field(bytes, 24) as usize
}

/// Where the first array of the blob that starts with these numbers lies.
pub fn array_at(bytes: &[u8], numbers: &[f32]) -> usize {
    let blob = field(bytes, 28) as usize;
    let wanted: Vec<u8> = numbers
        .iter()
        .flat_map(|number| number.to_le_bytes())
        .collect();
    let offset = (blob..bytes.len())
        .step_by(16)
        .find(|at| bytes[*at..].starts_with(&wanted));
    offset.expect("the blob holds these numbers")
}
