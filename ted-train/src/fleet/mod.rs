//! A fleet: several runs side by side, each with a folder, checkpoints and an end of its own.
//!
//! A lane is one run: a dataset, a configuration, a seed, a folder. Lanes share nothing but datasets, which are read and never
//! written. On a processor each is trained from start to end by one thread of the fleet, and no thread ever waits for another
//! one; on a GPU, which one lane leaves idle, all of them are one batch. Neither shows in what a lane learns, and lanes of
//! different tasks and methods go together.

mod batch;
mod collecting;
mod crew;
mod datasets;
mod error;
mod lane;

pub use batch::together;
pub use crew::Crew;
pub use datasets::Datasets;
pub use error::{FleetError, LaneError};
pub use lane::{Lane, Trained, introduce};

use std::num::NonZeroUsize;
use std::sync::{Mutex, PoisonError};

use firmware_sim::progress::{Audience, Progress};
use rayon::ThreadPoolBuilder;

use crate::train::Watch;

/// Trains and flies every lane, at most `jobs` batches at a time, and says of each how it ended, in the order of the lanes.
/// One that fails does not stop the others; a request to stop stops all of them, and the same call goes on. `ended` is told
/// the place of each when it has ended.
pub fn run(
    lanes: &[Lane],
    datasets: &Datasets,
    jobs: Option<NonZeroUsize>,
    audience: Audience,
    ended: impl Fn(usize) + Sync,
) -> Vec<Result<Trained, LaneError>> {
    let updates = lanes.iter().map(|lane| lane.config.algorithm.steps()).sum();
    let progress = audience.start("train", updates, "updates");
    let batches = batches(lanes);
    let crew = Crew::of(batches.len(), jobs);
    let ends = Mutex::new(Vec::new());
    crew.share_out(batches, |batch| {
        let (places, batch): (Vec<_>, Vec<_>) = batch.into_iter().unzip();
        let outcomes = one(&batch, datasets, crew.threads, &progress);
        for (lane, end) in batch.iter().zip(&outcomes) {
            // Of many that were not begun, each would say the same.
            if !matches!(end, Err(LaneError::NotBegun)) {
                progress.note(&describe(lane, end));
            }
        }
        places.iter().for_each(|place| ended(*place));
        // Nothing panics while it holds this.
        let mut ends = ends.lock().unwrap_or_else(PoisonError::into_inner);
        ends.extend(places.into_iter().zip(outcomes));
        progress.message(&format!("{} of {} runs ended", ends.len(), lanes.len()));
    });
    progress.finish();
    let mut ends = ends.into_inner().unwrap_or_else(PoisonError::into_inner);
    ends.sort_by_key(|(place, _)| *place);
    ends.into_iter().map(|(_, end)| end).collect()
}

/// The first failure among the ends of these lanes, if there is one.
#[must_use]
pub fn first_failure(lanes: &[Lane], ends: Vec<Result<Trained, LaneError>>) -> Option<FleetError> {
    let failed = ends.iter().filter(|end| end.is_err()).count();
    let (lane, first) = lanes
        .iter()
        .zip(ends)
        .find_map(|(lane, end)| Some((lane, end.err()?)))?;
    Some(FleetError {
        failed,
        lanes: lanes.len(),
        folder: lane.folder.clone(),
        first: Box::new(first),
    })
}

/// What is trained together, with the places of the lanes: on a processor each by itself, those that may find their reward
/// with a sibling last; on a GPU all.
fn batches(lanes: &[Lane]) -> Vec<Vec<(usize, &Lane)>> {
    let lanes = lanes.iter().enumerate();
    let (gpu, mut processor): (Vec<_>, Vec<_>) =
        lanes.partition(|(_, lane)| lane.config.backend.is_gpu());
    processor.sort_by_key(|(_, lane)| !lane.siblings.is_empty());
    let mut batches: Vec<_> = processor.into_iter().map(|lane| vec![lane]).collect();
    if !gpu.is_empty() {
        batches.push(gpu);
    }
    batches
}

/// One batch, in a pool of threads of its own: whatever it computes side by side stays among them.
fn one(
    batch: &[&Lane],
    datasets: &Datasets,
    threads: NonZeroUsize,
    progress: &Progress,
) -> Vec<Result<Trained, LaneError>> {
    let pool = ThreadPoolBuilder::new().num_threads(threads.get()).build();
    match pool {
        Ok(pool) => pool.install(|| together(batch, datasets, threads, Watch::Fleet(progress))),
        Err(error) => {
            let no_threads = |_| Err(LaneError::Threads(error.to_string()));
            batch.iter().map(no_threads).collect()
        }
    }
}

fn describe(lane: &Lane, end: &Result<Trained, LaneError>) -> String {
    let folder = lane.folder.display();
    match end {
        Ok(Trained {
            evaluation: Some(it),
            ..
        }) => {
            let score = it
                .score
                .map_or(String::new(), |it| format!(", score {it:.3}"));
            format!("{folder}: mean return {:.1}{score}", it.return_mean)
        }
        Ok(_) => format!("{folder}: trained"),
        Err(error) => format!("{folder}: {error}"),
    }
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use super::*;
    use crate::config::Preset;

    #[test]
    fn the_place_of_every_lane_is_told_once_also_of_those_that_are_begun_last() {
        let lane = |preset: Preset, name: &str| Lane {
            dataset: PathBuf::from("/nowhere"),
            config: preset.config(),
            folder: PathBuf::from("/nowhere").join(name),
            answers: None,
            siblings: Vec::new(),
        };
        let mut lanes = [
            lane(Preset::Pt, "a"),
            lane(Preset::PtTed, "b"),
            lane(Preset::True, "c"),
        ];
        introduce(&mut lanes);
        let told = Mutex::new(Vec::new());
        let one = NonZeroUsize::new(1);
        let ends = run(&lanes, &Datasets::default(), one, Audience::Nobody, |at| {
            told.lock().unwrap().push(at);
        });
        assert!(ends.iter().all(Result::is_err));
        assert_eq!(told.into_inner().unwrap(), [0, 2, 1]);
    }
}
