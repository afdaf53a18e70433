//! Learners side by side, each by itself: their updates are large enough to fill a machine alone.

use super::{Oppo, UpdateLosses};
use crate::algorithm::Replay;
use crate::algorithm::learner::{Learner, Losses, Metrics, Policy, metrics};
use crate::checkpoint::{Checkpoint, ForeignCheckpoint};

impl Learner for Vec<Oppo> {
    fn step(&self) -> u64 {
        self.first().map_or(0, Oppo::step)
    }

    fn update(&mut self, lanes: &[&Replay<'_>]) -> Box<dyn Losses> {
        let lanes = self.iter_mut().zip(lanes);
        let losses = lanes.map(|(oppo, lane)| oppo.update(lane.dataset(), lane.answers()));
        Box::new(losses.collect::<Vec<_>>())
    }

    fn checkpoint(&self, lane: usize, config_digest: [u8; 32]) -> Checkpoint {
        Checkpoint {
            config_digest,
            ..self[lane].checkpoint()
        }
    }

    fn restore(&mut self, lanes: &[&Checkpoint]) -> Result<(), ForeignCheckpoint> {
        Checkpoint::common_step(lanes, self.len())?;
        let mut lanes = self.iter_mut().zip(lanes);
        lanes.try_for_each(|(oppo, saved)| oppo.restore(saved))
    }

    fn policies(&self) -> Vec<Policy> {
        let policies = self.iter().cloned().map(Box::new);
        policies.map(Policy::Sequence).collect()
    }
}

impl Losses for Vec<UpdateLosses> {
    fn read(self: Box<Self>) -> Vec<Metrics> {
        self.iter().map(metrics).collect()
    }
}
