//! How well a model of rewards fits the answers that it learned from, and pairs that nobody was asked about.

use serde::{Deserialize, Serialize};

use crate::dataset::{Dataset, Segment, SegmentSampler};
use crate::preferences::RandomPair;
use crate::rng::Seed;

/// How well the training pairs are fitted, members averaged.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Fit {
    /// Cross-entropy in nats.
    pub loss: f32,
    /// Share of the strict answers on which the member's own order agrees.
    pub agreement: f32,
}

impl Fit {
    /// From the loss and, pair after pair, what was said of it and whether the model puts the second segment first.
    pub(super) fn new(loss: f32, pairs: impl Iterator<Item = (f32, bool)> + Clone) -> Self {
        let strict = pairs.filter(|(label, _)| *label != 0.5);
        let agrees = strict
            .clone()
            .filter(|&(label, second)| second == (label > 0.5));
        Self {
            loss,
            agreement: agrees.count() as f32 / strict.count().max(1) as f32,
        }
    }
}

/// Agreement of a model with true returns on pairs that it was not trained on.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct HeldOut {
    /// Pairs with different true returns.
    pub pairs: usize,
    /// Share of them that the model orders as the true return does.
    pub agreement: f64,
}

impl HeldOut {
    /// Measures a model on `count` random pairs from the stream `seed/held-out`, against true returns. `second_first` says of
    /// each pair whether the model puts its second segment first.
    #[must_use]
    pub fn measure(
        count: usize,
        dataset: &Dataset,
        sampler: &SegmentSampler,
        seed: Seed,
        second_first: impl FnOnce(&[[Segment; 2]]) -> Vec<bool>,
    ) -> Self {
        let mut rng = seed.child("held-out").rng();
        let mut pair = || RandomPair.draw(sampler, &mut rng);
        let pairs: Vec<[Segment; 2]> = (0..count).map(|_| pair()).collect();
        let (mut strict, mut agree) = (0, 0);
        for (pair, second_first) in pairs.iter().zip(second_first(&pairs)) {
            let [first, second] = pair.map(|segment| segment.return_true(dataset));
            strict += usize::from(first != second);
            agree += usize::from(first != second && second_first == (second > first));
        }
        Self {
            pairs: strict,
            agreement: agree as f64 / strict.max(1) as f64,
        }
    }
}
