//! Logged episodes, scored step by step, here or on a device: on which side of TED's border each of them lies.

use ted_core::{DiscountClass, ShapeError};
use ted_policy::{Artifact, ArtifactError};
use thiserror::Error;

use crate::controller::Numeric;
use crate::exit::ExitCode;
use crate::plants::recording::{Recording, RecordingError, RecordingShape, Recordings};
use crate::proven::Proven;
use crate::remote::RemoteError;
use crate::scorer::EpisodeScorer;

/// Whatever scores episodes: a scorer here, or one on a device.
pub trait Judge {
    /// Starts a new episode.
    ///
    /// # Errors
    /// When the judge cannot be reached, or has nothing to score with.
    fn reset(&mut self) -> Result<(), ScoreError>;

    /// Adds a step: what was seen, and the action that went out. The verdict is that of an episode that ends there.
    ///
    /// `episode` is its place in the dataset that TED ranked, [`ted_core::NEW_EPISODE`] if it is not in it.
    ///
    /// # Errors
    /// When the judge cannot be reached, or one of the two has another length than the contract says.
    fn push(
        &mut self,
        observation: &[f32],
        action: &[f32],
        episode: u32,
    ) -> Result<Verdict, ScoreError>;
}

/// What became of an episode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Verdict {
    /// The predicted return: a reward of 1 at every step adds up to the number of steps.
    pub return_hat: f32,
    /// The side of TED's border. The episodes in the top k % are worth uploading.
    pub class: DiscountClass,
}

/// Why episodes could not be scored.
#[derive(Debug, Error)]
pub enum ScoreError {
    /// This machine does not compute the artefact's golden vectors, or it has no networks in these numbers.
    #[error("score with the artefact: {0}")]
    Load(#[from] ArtifactError),
    /// The artefact lacks what scoring needs.
    #[error(
        "score with the artefact: it has no {missing}; train with a learned reward and TED's border, as the default preset \
         steer does"
    )]
    CannotScore {
        /// What it lacks.
        missing: &'static str,
    },
    /// The recording is not of the robot that the artefact is for.
    #[error(
        "the recording's {what} is {actual}, the artefact's {expected}; score it with an artefact for the robot that it was \
         recorded from"
    )]
    OtherShape {
        /// What differs.
        what: &'static str,
        /// What the artefact's contract says.
        expected: usize,
        /// What the recording says.
        actual: usize,
    },
    /// There is none.
    #[error("the recording holds no episode")]
    Empty,
    /// The arrays of an episode do not fit together.
    #[error(transparent)]
    Arrays(#[from] RecordingError),
    /// A step does not fit the networks.
    #[error("score a step: {0}")]
    Step(#[from] ShapeError),
    /// The device could not be reached, or refused.
    #[error(transparent)]
    Remote(#[from] RemoteError),
}

impl ScoreError {
    /// How a command ends that fails with this error.
    #[must_use]
    pub fn exit_code(&self) -> ExitCode {
        match self {
            Self::Load(ArtifactError::GoldenMismatch { .. }) => ExitCode::Faulted,
            Self::Load(_)
            | Self::CannotScore { .. }
            | Self::OtherShape { .. }
            | Self::Empty
            | Self::Arrays(_)
            | Self::Step(_) => ExitCode::BadInput,
            Self::Remote(source) => source.exit_code(),
        }
    }
}

/// A scorer on this machine, which has proved that it computes the artefact's golden vectors.
///
/// # Errors
/// When it does not, or when the artefact lacks what scoring needs, in these numbers.
pub fn judge<'a>(
    artifact: &Artifact<'a>,
    numeric: Numeric,
) -> Result<EpisodeScorer<'a>, ScoreError> {
    Proven::of(artifact, numeric)?;
    EpisodeScorer::load(artifact, numeric).ok_or(ScoreError::CannotScore {
        missing: match artifact.reward() {
            None => "reward ensemble",
            Some(_) => "border of TED's",
        },
    })
}

/// Whether these recordings are whole, and of the robot that the artefact is for.
///
/// # Errors
/// The first thing that is wrong.
pub fn check(recordings: &Recordings, artifact: &Artifact<'_>) -> Result<(), ScoreError> {
    let Recordings { shape, episodes } = recordings;
    check_shape(*shape, artifact)?;
    if episodes.is_empty() {
        return Err(ScoreError::Empty);
    }
    for episode in episodes {
        episode.check(*shape)?;
    }
    Ok(())
}

fn check_shape(shape: RecordingShape, artifact: &Artifact<'_>) -> Result<(), ScoreError> {
    let expected = RecordingShape::of(&artifact.contract());
    let numbers = |shape: RecordingShape| {
        [
            ("number of observation channels", shape.observation_dim),
            ("number of action channels", shape.action_dim),
            (
                "control period in microseconds",
                shape.control_period_us as usize,
            ),
        ]
    };
    let mut pairs = numbers(expected).into_iter().zip(numbers(shape));
    match pairs.find(|(expected, actual)| expected != actual) {
        Some(((what, expected), (_, actual))) => Err(ScoreError::OtherShape {
            what,
            expected,
            actual,
        }),
        None => Ok(()),
    }
}

/// Scores a recorded episode, found whole by [`check`], to its end. `episode` is its place in the dataset, as in
/// [`Judge::push`].
///
/// # Errors
/// When the judge fails.
pub fn score_recording(
    judge: &mut impl Judge,
    shape: RecordingShape,
    recording: &Recording,
    episode: u32,
) -> Result<Verdict, ScoreError> {
    judge.reset()?;
    let mut verdict = Verdict {
        return_hat: 0.0,
        class: DiscountClass::BelowTopK,
    };
    // The observation after the last step was not acted on.
    for step in 0..recording.rewards.len() {
        verdict = judge.push(
            recording.observation(shape, step),
            recording.action(shape, step),
            episode,
        )?;
    }
    Ok(verdict)
}

impl Judge for EpisodeScorer<'_> {
    fn reset(&mut self) -> Result<(), ScoreError> {
        self.reset();
        Ok(())
    }

    fn push(
        &mut self,
        observation: &[f32],
        action: &[f32],
        episode: u32,
    ) -> Result<Verdict, ScoreError> {
        self.push(observation, action)?;
        Ok(Verdict {
            return_hat: self.return_hat(),
            class: self.class(episode),
        })
    }
}
