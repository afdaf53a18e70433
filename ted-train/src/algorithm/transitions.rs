//! Algorithms that learn from single transitions: every update draws a batch from each lane.

use rayon::prelude::*;

use super::learner::{Learner, Losses, Metrics, Policy, metrics};
use super::{Batch, Replay};
use super::{atac, awr, bc, conditioned, iql};
use crate::checkpoint::{Checkpoint, ForeignCheckpoint};
use crate::rng::Seed;

/// A learner, and where its batches come from.
pub(super) struct OfTransitions<L> {
    learner: L,
    /// A stream for each lane.
    streams: Vec<Seed>,
    /// Transitions in the batch of a lane.
    size: usize,
}

impl<L> OfTransitions<L> {
    pub(super) fn new(learner: L, streams: Vec<Seed>, size: usize) -> Self {
        Self {
            learner,
            streams,
            size,
        }
    }

    /// The batches of an update.
    fn batch(&self, lanes: &[&Replay<'_>], step: u64) -> Batch {
        let size = self.size;
        let batches = lanes.par_iter().zip(&self.streams);
        let batches = batches.map(|(lane, stream)| lane.batch(*stream, step, size));
        Batch::of_lanes(batches.collect())
    }
}

/// Makes a learner of a type that has all of a learner's methods; some look at whole datasets before they see a batch.
macro_rules! learner {
    ($learner:ty, $losses:ty $(, $prepare:ident)?) => {
        impl Learner for OfTransitions<$learner> {
            fn step(&self) -> u64 {
                self.learner.step()
            }

            fn update(&mut self, lanes: &[&Replay<'_>]) -> Box<dyn Losses> {
                let batch = self.batch(lanes, self.learner.step());
                $(self.learner.$prepare(lanes);)?
                Box::new(self.learner.update(&batch))
            }

            fn checkpoint(&self, lane: usize, config_digest: [u8; 32]) -> Checkpoint {
                self.learner.checkpoint(lane, config_digest)
            }

            fn restore(&mut self, lanes: &[&Checkpoint]) -> Result<(), ForeignCheckpoint> {
                self.learner.restore(lanes)
            }

            fn policies(&self) -> Vec<Policy> {
                self.learner.actors().into_iter().map(Policy::Mlp).collect()
            }
        }

        impl Losses for $losses {
            fn read(self: Box<Self>) -> Vec<Metrics> {
                (*self).read().iter().map(metrics).collect()
            }
        }
    };
}

learner!(iql::Iql, iql::Losses);
learner!(atac::Atac, atac::Losses);
learner!(awr::Awr, awr::Losses, prepare);
learner!(bc::Bc, bc::Losses);
learner!(conditioned::Conditioned, conditioned::Losses);
