//! What all offline algorithms have in common, as a run sees them.

use serde::Serialize;
use serde_json::{Map, Value};

use super::Replay;
use super::oppo::Oppo;
use crate::checkpoint::{Checkpoint, ForeignCheckpoint};
use crate::nn::ExportedMlp;

/// A learner of one policy for each of its lanes, which make every update together and share nothing.
pub trait Learner: Send {
    /// Updates made so far, the same number in every lane.
    fn step(&self) -> u64;

    /// One update of every lane, from what each learns from, lane after lane.
    fn update(&mut self, lanes: &[&Replay<'_>]) -> Box<dyn Losses>;

    /// Everything that the next update of a lane depends on: the same whatever lanes are beside it.
    fn checkpoint(&self, lane: usize, config_digest: [u8; 32]) -> Checkpoint;

    /// Puts saved states in the place of this one: a checkpoint of each lane, all after the same update.
    ///
    /// # Errors
    /// When they are not, or one lacks a tensor or has another shape; the learner must not be used then.
    fn restore(&mut self, lanes: &[&Checkpoint]) -> Result<(), ForeignCheckpoint>;

    /// The policy of each lane.
    fn policies(&self) -> Vec<Policy>;
}

/// What a learner has learned.
#[derive(Clone, Debug)]
pub enum Policy {
    /// A network from a standardised observation to the mean action, in the controller's layout.
    Mlp(ExportedMlp),
    /// A transformer over the last steps, which no controller has room for.
    Sequence(Box<Oppo>),
}

/// What an update saw, still on the device.
pub trait Losses {
    /// Fetches the numbers of each lane, by name. One that is not finite is null.
    fn read(self: Box<Self>) -> Vec<Metrics>;
}

/// Numbers of an update by name; those called `…_loss` are what it minimised.
pub type Metrics = Map<String, Value>;

/// The fields of a struct of numbers.
pub(crate) fn metrics(update: &impl Serialize) -> Metrics {
    match serde_json::to_value(update) {
        Ok(Value::Object(metrics)) => metrics,
        _ => unreachable!("metrics are plain data"),
    }
}
