//! Questions about random pairs, all asked before anything is learned.

use crate::dataset::{Dataset, SegmentSampler};
use crate::preferences::{Context, PreferenceError, PreferenceLog, Query, Teacher};
use crate::rng::Seed;

use super::oprl::{LabelledPair, random_pair};

/// Asks about `queries` random pairs, each from the stream `seed/query/<number>` and appended to `log` before it is used.
pub(crate) fn ask_random_pairs(
    queries: usize,
    dataset: &Dataset,
    sampler: &SegmentSampler,
    teacher: &mut dyn Teacher,
    log: &mut PreferenceLog,
    seed: Seed,
) -> Result<Vec<LabelledPair>, PreferenceError> {
    let context = Context {
        round: 0,
        member: None,
    };
    let mut ask = |query: usize| {
        let mut rng = seed.child(&format!("query/{query}")).rng();
        let segments = random_pair(sampler, &mut rng);
        let answer = log.ask(dataset, teacher, context, Query { segments })?;
        let label = answer.label();
        Ok(LabelledPair { segments, label })
    };
    (0..queries).map(&mut ask).collect()
}
