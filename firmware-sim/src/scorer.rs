//! Scoring one's own experience: the predicted return of the running episode, and on which side of TED's border it ends.
//!
//! It computes what the trainer computed over its dataset, to the bit, so that a logged episode is told apart here as it
//! would be there: the ones in the top k % are worth uploading.

use heapless::Vec;
use ted_core::MAX_ACTION;
use ted_core::quantised::QuantisedRewardEnsemble;
use ted_core::{
    DiscountClass, EpisodeReturn, Part, ReturnThreshold, RewardEnsemble, ShapeError, TedDiscount,
};
use ted_policy::{ActionMap, Artifact};

use crate::controller::Numeric;
use crate::workspace::Workspace;

/// A reward ensemble, TED's border, and the return so far, in working memory of its own.
#[derive(Clone, Debug)]
pub struct EpisodeScorer<'a> {
    bare: BareScorer<'a>,
    workspace: Workspace,
    maps: Vec<ActionMap, MAX_ACTION>,
}

/// A scorer without working memory of its own: a device lends it the controller's.
#[derive(Clone, Debug)]
pub struct BareScorer<'a> {
    networks: Networks<'a>,
    ted: TedDiscount,
}

// The larger variant cannot be boxed: a device has no heap.
#[allow(clippy::large_enum_variant)]
#[derive(Clone, Debug)]
enum Networks<'a> {
    F32 {
        reward: RewardEnsemble<'a>,
        episode: EpisodeReturn,
    },
    Integer {
        reward: QuantisedRewardEnsemble<'a>,
        threshold: ReturnThreshold<i64>,
        episode: EpisodeReturn<i64>,
    },
}

impl<'a> EpisodeScorer<'a> {
    /// A scorer before the first step of an episode; nothing if the artefact has no reward ensemble, no discount, or not
    /// in these numbers. The controller's load gate has replayed the ensemble's golden vectors.
    #[must_use]
    pub fn load(artifact: &Artifact<'a>, numeric: Numeric) -> Option<Self> {
        let mut maps = Vec::new();
        for channel in artifact.terms().action.iter() {
            // There is room: a contract has no more.
            maps.push(channel.map()).ok();
        }
        Some(Self {
            bare: BareScorer::load(artifact, numeric)?,
            workspace: Workspace::new(numeric),
            maps,
        })
    }

    /// Adds a step: what was seen, and the action that went out, in the robot's units.
    ///
    /// # Errors
    /// When one of the two has another length than the contract says; the return stays as it was.
    pub fn push(&mut self, obs_raw: &[f32], action_env: &[f32]) -> Result<(), ShapeError> {
        if action_env.len() != self.maps.len() {
            return Err(ShapeError::Mismatch {
                part: Part::Action,
                expected: self.maps.len(),
                actual: action_env.len(),
            });
        }
        let mut action_unit = Vec::<f32, MAX_ACTION>::new();
        for (map, &env) in self.maps.iter().zip(action_env) {
            // There is room: there are as many as maps.
            action_unit.push(map.unit(env)).ok();
        }
        self.bare.push(obs_raw, &action_unit, &mut self.workspace)
    }

    /// Predicted return so far, for people: a reward of 1 at every step adds up to the number of steps.
    #[must_use]
    pub fn return_hat(&self) -> f32 {
        self.bare.return_hat()
    }

    /// On which side of TED's border the episode would lie if it ended now.
    ///
    /// `number` is its place in the dataset, which decides between equal returns: [`ted_core::NEW_EPISODE`] for one that is
    /// not in it.
    #[must_use]
    pub fn class(&self, number: u32) -> DiscountClass {
        self.bare.class(number)
    }

    /// The discount factor that TED gives to the transitions of an episode of this class.
    #[must_use]
    pub fn discount(&self, class: DiscountClass) -> f32 {
        self.bare.discount(class)
    }

    /// Starts a new episode.
    pub fn reset(&mut self) {
        self.bare.reset();
    }
}

impl<'a> BareScorer<'a> {
    /// A scorer before the first step of an episode; nothing if the artefact has no reward ensemble, no discount, or not
    /// in these numbers. The controller's load gate has replayed the ensemble's golden vectors.
    #[must_use]
    pub fn load(artifact: &Artifact<'a>, numeric: Numeric) -> Option<Self> {
        let mut scorer = Self::unfilled(artifact, numeric)?;
        scorer.fill(artifact).then_some(scorer)
    }

    /// A scorer without networks, a place for [`Self::fill`]; nothing if the artefact has no discount.
    // Not part of its caller, whose stack would hold it twice.
    #[inline(never)]
    #[must_use]
    pub fn unfilled(artifact: &Artifact<'a>, numeric: Numeric) -> Option<Self> {
        let networks = match numeric {
            Numeric::F32 => Networks::F32 {
                reward: RewardEnsemble::unfilled(),
                episode: EpisodeReturn::default(),
            },
            Numeric::Integer => Networks::Integer {
                reward: QuantisedRewardEnsemble::unfilled(),
                threshold: ReturnThreshold {
                    return_hat: 0,
                    last_tied_episode: 0,
                },
                episode: EpisodeReturn::default(),
            },
        };
        let ted = artifact.ted()?;
        Some(Self { networks, ted })
    }

    /// Takes the artefact's networks, where it is: on a device there is no room to move them. False if it has none in
    /// these numbers; the scorer is not to be used then.
    pub fn fill(&mut self, artifact: &Artifact<'a>) -> bool {
        match &mut self.networks {
            Networks::F32 { reward, .. } => artifact.read_reward(reward),
            Networks::Integer {
                reward, threshold, ..
            } => match artifact.integer_threshold() {
                Some(border) => {
                    *threshold = border;
                    artifact.read_integer_reward(reward)
                }
                None => false,
            },
        }
    }

    /// Adds a step: what was seen, and the action that went out, as it is to the policy.
    ///
    /// # Errors
    /// When one of the two has another length than the contract says, or the workspace is for other numbers; the return
    /// stays as it was.
    pub fn push(
        &mut self,
        obs_raw: &[f32],
        action_unit: &[f32],
        workspace: &mut Workspace,
    ) -> Result<(), ShapeError> {
        match (&mut self.networks, workspace) {
            (
                Networks::F32 {
                    reward, episode, ..
                },
                Workspace::F32(scratch),
            ) => episode.push(reward.reward_hat(obs_raw, action_unit, scratch)?),
            (
                Networks::Integer {
                    reward, episode, ..
                },
                Workspace::Integer(scratch),
            ) => episode.push(reward.reward_hat(obs_raw, action_unit, scratch)?),
            _ => return Err(ShapeError::Empty { part: Part::Input }),
        }
        Ok(())
    }

    /// Predicted return so far, for people: a reward of 1 at every step adds up to the number of steps.
    #[must_use]
    pub fn return_hat(&self) -> f32 {
        match &self.networks {
            Networks::F32 { episode, .. } => episode.return_hat(),
            Networks::Integer {
                reward, episode, ..
            } => reward.unit(episode.return_hat()),
        }
    }

    /// On which side of TED's border the episode would lie if it ended now.
    ///
    /// `number` is its place in the dataset, which decides between equal returns: [`ted_core::NEW_EPISODE`] for one that is
    /// not in it.
    #[must_use]
    pub fn class(&self, number: u32) -> DiscountClass {
        match &self.networks {
            Networks::F32 { episode, .. } => self.ted.class(episode.return_hat(), number),
            Networks::Integer {
                threshold, episode, ..
            } => threshold.class(episode.return_hat(), number),
        }
    }

    /// The discount factor that TED gives to the transitions of an episode of this class.
    #[must_use]
    pub fn discount(&self, class: DiscountClass) -> f32 {
        self.ted.discount(class)
    }

    /// Starts a new episode.
    pub fn reset(&mut self) {
        match &mut self.networks {
            Networks::F32 { episode, .. } => *episode = EpisodeReturn::default(),
            Networks::Integer { episode, .. } => *episode = EpisodeReturn::default(),
        }
    }
}
