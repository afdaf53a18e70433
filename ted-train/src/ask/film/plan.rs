//! Which steps of a clip are drawn, and in which order.

use crate::dataset::Segment;

/// Stills of a clip at most: sixteen a second for an episode of Meta-World, which is as smooth as it needs to be.
const STILLS: u32 = 100;
/// Every eighth still comes first, so that there is something to see soon; then every fourth, and so on.
const PASSES: [u32; 4] = [8, 4, 2, 1];
/// Stills that are made at once: few, so that another question does not wait.
const BATCH: usize = 5;

/// The film of a clip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Plan {
    pub episode: u32,
    start: u32,
    /// Steps from one still to the next.
    pub every: u32,
    /// How many there are.
    pub stills: u32,
}

/// Stills of one clip that are made together, by their place in its film.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Batch {
    /// Which clip.
    pub side: usize,
    pub stills: Vec<u32>,
}

impl Plan {
    pub fn of(segment: Segment) -> Self {
        Self::new(segment.episode(), segment.start(), segment.len())
    }

    /// Of so many steps of an episode, from this one on.
    pub fn new(episode: u32, start: u32, steps: u32) -> Self {
        let every = steps.div_ceil(STILLS).max(1);
        Self {
            episode,
            start,
            every,
            stills: steps.div_ceil(every),
        }
    }

    /// The steps that the first pass shows, in their order.
    pub fn first_pass(&self) -> Vec<u32> {
        let first = (0..self.stills).filter(|&still| self.is_first(still));
        first.map(|still| self.step(still)).collect()
    }

    /// The step that a still shows.
    pub fn step(&self, still: u32) -> u32 {
        self.start + still * self.every
    }

    /// The stills of the first pass, without which there is nothing to see: the last one is how it ended.
    pub fn is_first(&self, still: u32) -> bool {
        still.is_multiple_of(PASSES[0]) || still + 1 == self.stills
    }

    fn pass(&self, still: u32) -> usize {
        let fits = |pass: &u32| still.is_multiple_of(*pass);
        match self.is_first(still) {
            true => 0,
            false => PASSES.iter().position(fits).unwrap_or_default(),
        }
    }
}

/// What is made of both clips, in order.
pub(super) fn batches(plans: &[Plan; 2]) -> impl Iterator<Item = Batch> {
    let plans = *plans;
    (0..PASSES.len()).flat_map(move |pass| {
        plans.into_iter().enumerate().flat_map(move |(side, plan)| {
            let stills: Vec<u32> = (0..plan.stills)
                .filter(|&still| plan.pass(still) == pass)
                .collect();
            let batches: Vec<Batch> = stills
                .chunks(BATCH)
                .map(|stills| Batch {
                    side,
                    stills: stills.to_vec(),
                })
                .collect();
            batches
        })
    })
}
