//! Lanes that are made together: each is prepared, all of them learn at once, each is finished and flown. One that fails on
//! the way stays behind with its error, and the others go on. A run alone is a batch of one.

use std::num::NonZeroUsize;
use std::panic::{AssertUnwindSafe, catch_unwind};

use super::{Datasets, Lane, LaneError, Trained};
use crate::train::{Prepared, Watch, learn};

/// How the lanes of a batch ended, as far as they have.
struct Ends(Vec<Option<Result<Trained, LaneError>>>);

/// Lanes that are still going on, each with its place in the batch.
type GoingOn<T> = Vec<(usize, T)>;

/// Makes what the folders of these lanes do not hold yet, with at most so many simulators side by side, and says of each how
/// it ended, in their order. The same call goes on where one was stopped.
pub fn together(
    lanes: &[&Lane],
    datasets: &Datasets,
    simulators: NonZeroUsize,
    watch: Watch<'_>,
) -> Vec<Result<Trained, LaneError>> {
    let audience = watch.audience();
    let mut ends = Ends(lanes.iter().map(|_| None).collect());
    let begun = lanes.iter().enumerate();
    let begun = ends.stage(begun, |lane| lane.begin(datasets, watch));
    let prepared = begun.iter().map(|(place, run)| (*place, run));
    let prepared = ends.stage(prepared, |run| Ok((run, run.prepare(audience)?)));

    let runs: Vec<&Prepared<'_>> = prepared.iter().map(|(_, (_, run))| run).collect();
    let policies: Vec<_> = match catch_unwind(AssertUnwindSafe(|| learn(&runs, watch))) {
        Ok(learned) => learned.into_iter().map(|end| Ok(end?)).collect(),
        Err(_) => runs.iter().map(|_| Err(LaneError::Panicked)).collect(),
    };

    let learned = prepared.into_iter().zip(policies);
    let learned = learned.map(|((place, run), policy)| (place, (run, policy)));
    let finished = ends.stage(learned, |((begun, run), policy)| {
        begun.finish(run, policy?, simulators, audience)
    });
    for (place, trained) in finished {
        ends.0[place] = Some(Ok(trained));
    }
    let ended = ends.0.into_iter();
    ended
        .map(|end| end.unwrap_or(Err(LaneError::Panicked)))
        .collect()
}

impl Ends {
    /// Takes lanes through a part of their work, and returns those that came out of it.
    fn stage<A, B>(
        &mut self,
        lanes: impl IntoIterator<Item = (usize, A)>,
        work: impl Fn(A) -> Result<B, LaneError>,
    ) -> GoingOn<B> {
        let mut going_on = Vec::new();
        for (place, lane) in lanes {
            // A panic is a mistake of ours, and still no reason to lose the other lanes.
            let end = catch_unwind(AssertUnwindSafe(|| work(lane)));
            match end.unwrap_or(Err(LaneError::Panicked)) {
                Ok(on) => going_on.push((place, on)),
                Err(error) => self.0[place] = Some(Err(error)),
            }
        }
        going_on
    }
}
