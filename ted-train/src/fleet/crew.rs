//! How a fleet uses the machine: so many batches at a time, so many threads for each.

use std::num::NonZeroUsize;
use std::sync::{Mutex, PoisonError};
use std::thread;

/// Who does the work of a fleet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Crew {
    /// Batches that are trained at the same time.
    pub batches: NonZeroUsize,
    /// Threads of each of them.
    pub threads: NonZeroUsize,
}

impl Crew {
    /// As many batches at a time as `asked`, or as there are cores; cores that are left over are shared out.
    #[must_use]
    pub fn of(batches: usize, asked: Option<NonZeroUsize>) -> Self {
        let cores = thread::available_parallelism().unwrap_or(NonZeroUsize::MIN);
        let most = NonZeroUsize::new(batches).unwrap_or(NonZeroUsize::MIN);
        let batches = asked.unwrap_or(cores).min(most);
        let threads = NonZeroUsize::new(cores.get() / batches).unwrap_or(NonZeroUsize::MIN);
        Self { batches, threads }
    }

    /// Does each piece of work, in order, as many at a time as there are batches.
    pub(super) fn share_out<T: Send>(self, work: Vec<T>, body: impl Fn(T) + Sync) {
        let queue = Mutex::new(work.into_iter());
        // A function of its own gives the lock back before the work begins; in the condition of the loop it would be held.
        let next = || {
            let mut queue = queue.lock().unwrap_or_else(PoisonError::into_inner);
            queue.next()
        };
        thread::scope(|scope| {
            for _ in 0..self.batches.get() {
                scope.spawn(|| {
                    while let Some(piece) = next() {
                        body(piece);
                    }
                });
            }
        });
    }
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc;
    use std::time::Duration;

    use super::*;

    #[test]
    fn there_are_never_more_batches_at_a_time_than_batches_and_none_without_a_thread() {
        let cores = thread::available_parallelism().unwrap().get();
        let crew = |batches, asked| {
            let crew = Crew::of(batches, NonZeroUsize::new(asked));
            (crew.batches.get(), crew.threads.get())
        };
        assert_eq!(crew(1, 0), (1, cores));
        assert_eq!(crew(12, 0), (cores.min(12), (cores / cores.min(12)).max(1)));
        assert_eq!(crew(12, 3), (3, (cores / 3).max(1)));
        assert_eq!(crew(2, 64).0, 2);
    }

    #[test]
    fn work_is_done_at_the_same_time() {
        let (here, there) = (mpsc::channel::<()>(), mpsc::channel::<()>());
        // Each says that it has begun and waits for the other one to say so.
        let work = vec![(here.0, there.1), (there.0, here.1)];
        Crew::of(2, NonZeroUsize::new(2)).share_out(work, |(begun, other)| {
            begun.send(()).unwrap();
            let met = other.recv_timeout(Duration::from_secs(60));
            assert!(met.is_ok(), "the other one has not begun");
        });
    }

    #[test]
    fn every_piece_is_done_once_and_in_order() {
        let done = Mutex::new(Vec::new());
        let alone = Crew::of(1, None);
        alone.share_out((0..5).collect(), |piece| done.lock().unwrap().push(piece));
        assert_eq!(done.into_inner().unwrap(), [0, 1, 2, 3, 4]);
    }
}
