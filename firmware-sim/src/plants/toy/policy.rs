//! A policy for the toy, written down instead of trained: a proportional controller as a small network, and a reward
//! ensemble that dislikes distance. Its artefact has every part that a trained one has.

use ted_core::{
    Dense, DiscountError, Mlp, Normaliser, Output, Policy, ReturnThreshold, RewardEnsemble,
    RewardInput, RewardRange, ShapeError, TedDiscount,
};
use ted_policy::{
    ActionChannel, ArtifactSpec, Contract, ContractFault, Digest, ObservationChannel, Provenance,
    SafeAction, WriteError, write,
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
        low: -4.4,
        high: 0.0,
    };
    let threshold = ReturnThreshold {
        return_hat: 60.0,
        last_tied_episode: 6,
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
        ted: Some(TedDiscount::new(0.99, 0.7, threshold)?),
        integers: None,
        golden_obs_raw: &GOLDEN,
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
    let observe = |name| ObservationChannel {
        name,
        unit: "table",
        low: -1.0,
        high: 1.0,
    };
    let act = |name, unit, slew_per_tick, on_fault| ActionChannel {
        name,
        unit,
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
