//! A policy for the toy, written down instead of trained: a proportional controller as a small network, and a reward
//! ensemble that dislikes distance. Its artefact has every part that a trained one has.

use ted_core::integer::{
    IntegerDense, IntegerError, IntegerMlp, IntegerPolicy, IntegerRange, IntegerRewardEnsemble,
};
use ted_core::{
    Dense, DiscountError, Mlp, Normaliser, Output, Policy, ReturnThreshold, RewardEnsemble,
    RewardInput, RewardRange, ShapeError, TedDiscount,
};
use ted_policy::{
    ActionChannel, ArtifactSpec, Contract, ContractFault, Digest, IntegerSpec, ObservationChannel,
    Provenance, SafeAction, WriteError, write,
};
use thiserror::Error;

use super::{ACTION_DIM, CONTROL_PERIOD_US, OBSERVATION_DIM};

const HIDDEN: usize = 4;

/// Observations are doubled, so that a normaliser that is left out shows.
static SHIFT: [f32; OBSERVATION_DIM] = [0.0; OBSERVATION_DIM];
static SCALE: [f32; OBSERVATION_DIM] = [2.0; OBSERVATION_DIM];

/// The way to the goal, split into its positive and negative parts: x+, x-, y+, y-.
static WAY: [f32; HIDDEN * OBSERVATION_DIM] = [
    -5.0, 0.0, 5.0, 0.0, 0.0, //
    5.0, 0.0, -5.0, 0.0, 0.0, //
    0.0, -5.0, 0.0, 5.0, 0.0, //
    0.0, 5.0, 0.0, -5.0, 0.0, //
];
static NO_BIAS: [f32; HIDDEN] = [0.0; HIDDEN];

/// Go that way, and close the gripper.
static MOVE: [f32; ACTION_DIM * HIDDEN] = [
    1.0, -1.0, 0.0, 0.0, //
    0.0, 0.0, 1.0, -1.0, //
    0.0, 0.0, 0.0, 0.0, //
];
static CLOSE: [f32; ACTION_DIM] = [0.0, 0.0, 2.0];

/// Two opinions on how bad distance is.
static DISLIKE: [[f32; HIDDEN]; 2] = [[-0.1; HIDDEN], [-0.12; HIDDEN]];
static NO_OFFSET: [f32; 1] = [0.0];

/// The same in integers: 25 is a weight of 1 on the way, 100 on the move, 1000 in a dislike. An observation has 13 fraction
/// bits, the way 10, a move 11, a dislike 12; the multipliers and shifts follow from that.
static INTEGER_WAY: [i8; HIDDEN * OBSERVATION_DIM] = [
    -125, 0, 125, 0, 0, //
    125, 0, -125, 0, 0, //
    0, -125, 0, 125, 0, //
    0, 125, 0, -125, 0, //
];
static INTEGER_MOVE: [i8; ACTION_DIM * HIDDEN] = [
    100, -100, 0, 0, //
    0, 0, 100, -100, //
    0, 0, 0, 0, //
];
static INTEGER_NO_BIAS: [i32; HIDDEN] = [0; HIDDEN];
static INTEGER_CLOSE: [i32; ACTION_DIM] = [0, 0, (2 * 100) << WAY_BITS];
static INTEGER_DISLIKE: [[i8; HIDDEN]; 2] = [[-100; HIDDEN], [-120; HIDDEN]];
/// 0.64 and 0.512 with 31 fraction bits.
static MOVES: [i32; HIDDEN] = [1_374_389_535; HIDDEN];
static DISLIKES: [i32; 1] = [1_099_511_628];
static WAY_SHIFTS: [i8; HIDDEN] = [-7; HIDDEN];
static MOVE_SHIFTS: [i8; ACTION_DIM] = [-5; ACTION_DIM];
static DISLIKE_SHIFTS: [i8; 1] = [-7];
const OBSERVATION_BITS: u8 = 13;
const WAY_BITS: u8 = 10;
const MOVE_BITS: u8 = 11;
const DISLIKE_BITS: u8 = 12;

/// Rewards from this to 0 become 0 to 1.
const WORST_REWARD: f32 = -4.4;
/// The border between the episodes.
const BORDER: ReturnThreshold = ReturnThreshold {
    return_hat: 60.0,
    last_tied_episode: 6,
};

/// Golden inputs: at the goal, on each side of it, and far away.
static GOLDEN: [f32; 4 * OBSERVATION_DIM] = [
    0.0, 0.0, 0.0, 0.0, 0.0, //
    -0.5, 0.25, 0.125, -0.75, 0.3, //
    0.9, 0.8, -0.7, -0.6, 1.0, //
    0.01, -0.02, 0.03, -0.04, -1.0, //
];

/// Why the toy's artefact could not be made.
#[derive(Debug, Error)]
pub enum ToyError {
    /// The written-down networks do not fit together.
    #[error("make the toy policy: {0}")]
    Shape(#[from] ShapeError),
    /// The written-down networks in integers cannot be used.
    #[error("make the toy policy: {0}")]
    Integer(#[from] IntegerError),
    /// The written-down contract cannot be kept.
    #[error("make the toy policy: {0}")]
    Contract(ContractFault),
    /// The written-down discount cannot be used.
    #[error("make the toy policy: {0}")]
    Discount(#[from] DiscountError),
    /// The artefact was refused.
    #[error("make the toy policy: {0}")]
    Write(#[from] WriteError),
}

/// What goes into the toy's artefact; tests change parts of it.
///
/// # Errors
/// When the parts written down here do not fit together.
pub fn artifact_spec() -> Result<ArtifactSpec<'static>, ToyError> {
    let way = Dense::new(OBSERVATION_DIM, HIDDEN, &WAY, &NO_BIAS)?;
    let go = Dense::new(HIDDEN, ACTION_DIM, &MOVE, &CLOSE)?;
    let members = [
        Mlp::new(
            &[way, Dense::new(HIDDEN, 1, &DISLIKE[0], &NO_OFFSET)?],
            Output::Linear,
        )?,
        Mlp::new(
            &[way, Dense::new(HIDDEN, 1, &DISLIKE[1], &NO_OFFSET)?],
            Output::Linear,
        )?,
    ];
    let range = RewardRange {
        low: WORST_REWARD,
        high: 0.0,
    };
    Ok(ArtifactSpec {
        contract: contract().map_err(ToyError::Contract)?,
        provenance: provenance(),
        policy: Policy::new(normaliser()?, Mlp::new(&[way, go], Output::Tanh)?)?,
        reward: Some(RewardEnsemble::new(
            RewardInput::Observation,
            normaliser()?,
            &members,
            range,
        )?),
        ted: Some(TedDiscount::new(0.99, 0.7, BORDER)?),
        integers: Some(integers()?),
        golden_obs_raw: &GOLDEN,
    })
}

fn integers() -> Result<IntegerSpec<'static>, ToyError> {
    let way = IntegerDense::new(
        OBSERVATION_DIM,
        &INTEGER_WAY,
        &INTEGER_NO_BIAS,
        &MOVES,
        &WAY_SHIFTS,
    )?;
    let go = IntegerDense::new(
        HIDDEN,
        &INTEGER_MOVE,
        &INTEGER_CLOSE,
        &MOVES[..ACTION_DIM],
        &MOVE_SHIFTS,
    )?;
    let member = |dislike| {
        let last = IntegerDense::new(
            HIDDEN,
            dislike,
            &INTEGER_NO_BIAS[..1],
            &DISLIKES,
            &DISLIKE_SHIFTS,
        )?;
        Ok::<_, ToyError>(IntegerMlp::new(&[way, last], Output::Linear)?)
    };
    let members = [member(&INTEGER_DISLIKE[0])?, member(&INTEGER_DISLIKE[1])?];
    let one = f32::from(1_u16 << DISLIKE_BITS) * members.len() as f32;
    let range = IntegerRange {
        low: (WORST_REWARD * one) as i32,
        high: 0,
    };
    let threshold = ReturnThreshold {
        return_hat: BORDER.return_hat as i64 * i64::from(range.span()),
        last_tied_episode: BORDER.last_tied_episode,
    };
    Ok(IntegerSpec {
        policy: IntegerPolicy::new(
            OBSERVATION_BITS,
            MOVE_BITS,
            IntegerMlp::new(&[way, go], Output::Tanh)?,
        )?,
        reward: Some(IntegerRewardEnsemble::new(
            OBSERVATION_BITS,
            DISLIKE_BITS,
            &members,
            range,
        )?),
        threshold: Some(threshold),
    })
}

/// The toy's artefact, for tests and demonstrations; the same bytes every time.
///
/// # Errors
/// When the parts written down here do not fit together.
pub fn artifact_bytes() -> Result<Vec<u8>, ToyError> {
    Ok(write(&artifact_spec()?)?)
}

fn normaliser() -> Result<Normaliser<'static>, ShapeError> {
    Normaliser::new(&SHIFT, &SCALE)
}

fn contract() -> Result<Contract<'static>, ContractFault> {
    let observe = |name: &'static str| ObservationChannel {
        name: name.into(),
        unit: "table".into(),
        low: -1.0,
        high: 1.0,
    };
    let act = |name: &'static str, unit: &'static str, slew_per_tick, on_fault| ActionChannel {
        name: name.into(),
        unit: unit.into(),
        low: -1.0,
        high: 1.0,
        slew_per_tick,
        on_fault,
    };
    Contract::new(
        "toy-reach",
        &["x", "y", "goal_x", "goal_y", "gripper"].map(observe),
        &[
            act("move_x", "table/20", 0.5, SafeAction::Zero),
            act("move_y", "table/20", 0.5, SafeAction::Zero),
            act("gripper", "closed", 0.25, SafeAction::HoldLast),
        ],
        CONTROL_PERIOD_US,
        CONTROL_PERIOD_US,
    )
}

fn provenance() -> Provenance<'static> {
    Provenance {
        trainer_version: env!("CARGO_PKG_VERSION"),
        preset: "written-down",
        seed: 0,
        steps: 0,
        config_digest: Digest::default(),
        dataset_id: "toy/none-v0",
        dataset_digest: Digest::default(),
        preferences_digest: None,
        dataset_return_mean: 50.0,
        dataset_return_max: 100.0,
    }
}
