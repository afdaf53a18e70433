//! Questions about random pairs, all asked before anything is learned.

use crate::dataset::{Dataset, SegmentSampler};
use crate::preferences::{
    Context, LabelledPair, PreferenceError, PreferenceLog, Query, QueryStrategy, RandomPair,
    Teacher,
};
use crate::rng::Seed;

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
        let segments = RandomPair.choose(sampler, &mut rng);
        let query = Query { segments };
        let answer = log.ask(dataset, teacher, context, query)?;
        Ok(LabelledPair::new(query, answer))
    };
    (0..queries).map(&mut ask).collect()
}
