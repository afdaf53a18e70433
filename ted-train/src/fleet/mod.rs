//! A fleet: several runs side by side, each with a folder, checkpoints and an end of its own.
//!
//! A lane is one run: a dataset, a configuration, a seed, a folder. Lanes share nothing but datasets, which are read and never
//! written, and each is trained from start to end by one thread of the fleet. So what a lane learns cannot depend on its
//! company, lanes of different tasks and methods go together, and no thread ever waits for another one.

mod datasets;
mod error;
mod lane;

pub use datasets::Datasets;
pub use error::{FleetError, LaneError};
pub use lane::{Lane, Trained};

use std::num::NonZeroUsize;
use std::panic::{self, AssertUnwindSafe};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread;

use firmware_sim::interrupt;
use firmware_sim::progress::{Audience, Progress};
use rayon::ThreadPoolBuilder;

use crate::train::Watch;

/// How a fleet uses the machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Crew {
    /// Lanes that are trained at the same time.
    pub lanes: NonZeroUsize,
    /// Threads of each of them.
    pub threads: NonZeroUsize,
}

impl Crew {
    /// As many lanes at a time as `asked`, or as there are cores; cores that are left over are shared out.
    #[must_use]
    pub fn of(lanes: usize, asked: Option<NonZeroUsize>) -> Self {
        let cores = thread::available_parallelism().unwrap_or(NonZeroUsize::MIN);
        let most = NonZeroUsize::new(lanes).unwrap_or(NonZeroUsize::MIN);
        let lanes = asked.unwrap_or(cores).min(most);
        let threads = NonZeroUsize::new(cores.get() / lanes).unwrap_or(NonZeroUsize::MIN);
        Self { lanes, threads }
    }
}

/// Trains and flies every lane, and says of each how it ended, in the order of the lanes. One that fails does not stop the
/// others; a request to stop stops all of them, and the same call goes on.
pub fn run(
    lanes: &[Lane],
    datasets: &Datasets,
    crew: Crew,
    audience: Audience,
) -> Vec<Result<Trained, LaneError>> {
    let updates = lanes.iter().map(|lane| lane.config.algorithm.steps()).sum();
    let progress = audience.start("train", updates, "updates");
    let queue = Mutex::new(lanes.iter().enumerate());
    let ends = Mutex::new(Vec::new());
    thread::scope(|scope| {
        for _ in 0..crew.lanes.get() {
            scope.spawn(|| {
                while let Some((index, lane)) = locked(&queue).next() {
                    let end = one(lane, datasets, crew.threads, &progress);
                    progress.note(&describe(lane, &end));
                    let mut ends = locked(&ends);
                    ends.push((index, end));
                    progress.message(&format!("{} of {} runs ended", ends.len(), lanes.len()));
                }
            });
        }
    });
    progress.finish();
    let mut ends = ends.into_inner().unwrap_or_else(PoisonError::into_inner);
    ends.sort_by_key(|(index, _)| *index);
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

/// Nothing panics while it holds one of these.
fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// One lane, in a pool of threads of its own: whatever it computes side by side stays among them.
fn one(
    lane: &Lane,
    datasets: &Datasets,
    threads: NonZeroUsize,
    progress: &Progress,
) -> Result<Trained, LaneError> {
    if interrupt::requested() {
        return Err(LaneError::NotBegun);
    }
    let pool = ThreadPoolBuilder::new()
        .num_threads(threads.get())
        .build()
        .map_err(LaneError::Threads)?;
    // A panic is a mistake of ours, and still no reason to lose the other lanes.
    panic::catch_unwind(AssertUnwindSafe(|| {
        let dataset = datasets.open(&lane.dataset)?;
        pool.install(|| lane.run(&dataset, threads, Watch::Fleet(progress)))
    }))
    .unwrap_or(Err(LaneError::Panicked))
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
    use super::*;

    #[test]
    fn there_are_never_more_lanes_at_a_time_than_lanes_and_no_lane_without_a_thread() {
        let cores = thread::available_parallelism().unwrap().get();
        let crew = |lanes, asked| {
            let crew = Crew::of(lanes, NonZeroUsize::new(asked));
            (crew.lanes.get(), crew.threads.get())
        };
        assert_eq!(crew(1, 0), (1, cores));
        assert_eq!(crew(12, 0), (cores.min(12), (cores / cores.min(12)).max(1)));
        assert_eq!(crew(12, 3), (3, (cores / 3).max(1)));
        assert_eq!(crew(2, 64).0, 2);
    }
}
