//! The thread that makes films, and what others see of it.

use std::collections::{HashMap, HashSet, VecDeque};
use std::path::PathBuf;
use std::sync::mpsc::Sender;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread;

use axum::body::Bytes;
use serde::Serialize;

use super::cache::{Cache, Still};
use super::plan::{Batch, Plan, batches};
use super::videos::{Projector, Screening};
use super::{FilmSource, NoFilm};
use crate::dataset::Segment;

/// Makes the films of the question that is open, or says where its videos are. Dropped, it ends after the stills that it is about to make.
pub struct Studio {
    shared: Arc<Shared>,
    projector: Option<Projector>,
}

/// How far the films of the open question are.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Progress {
    /// Why there will be no more.
    pub trouble: Option<String>,
    /// Stills that are made, and how many there will be.
    pub all: [usize; 2],
    /// The same of those without which there is nothing to see.
    pub first: [usize; 2],
    /// Left and right; none where nothing is asked.
    pub films: Vec<Film>,
    /// Videos of both clips, where the dataset has them. There are no stills then.
    pub videos: Option<Screening>,
}

/// How far one film is.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Film {
    /// Steps from one still to the next.
    pub every: u32,
    /// Those that are made, by their place in the film.
    pub made: Vec<u32>,
}

#[derive(Default)]
struct Shared {
    state: Mutex<State>,
    changed: Condvar,
}

#[derive(Default)]
struct State {
    plans: Option<[Plan; 2]>,
    to_make: VecDeque<Batch>,
    /// Stills by episode and step.
    made: HashMap<(u32, u32), Bytes>,
    videos: Option<Screening>,
    trouble: Option<NoFilm>,
    closed: bool,
}

impl Studio {
    /// A studio with this source, which keeps its stills if it has where.
    pub(super) fn open(source: impl FilmSource + 'static, cache: Option<Cache>) -> Self {
        let shared = Arc::new(Shared::default());
        let own = Arc::clone(&shared);
        thread::spawn(move || own.work(source, cache));
        Self {
            shared,
            projector: None,
        }
    }

    /// A studio that makes nothing and shows what there is.
    pub(super) fn of_videos(projector: Projector) -> Self {
        Self {
            shared: Arc::default(),
            projector: Some(projector),
        }
    }

    /// A studio that makes nothing.
    #[must_use]
    pub fn closed(reason: &NoFilm) -> Self {
        let shared = Shared::default();
        {
            let mut state = shared.lock();
            state.trouble = Some(reason.clone());
            state.closed = true;
        }
        Self {
            shared: Arc::new(shared),
            projector: None,
        }
    }

    /// Makes the films of these clips from now on, left and right.
    pub fn show(&self, clips: [Segment; 2]) {
        if let Some(projector) = &self.projector {
            let screened = projector.screen(clips);
            let mut state = self.shared.lock();
            state.trouble = screened.as_ref().err().cloned();
            state.videos = screened.ok();
            return;
        }
        let plans = clips.map(Plan::of);
        let mut state = self.shared.lock();
        let wanted: HashSet<_> = (plans.iter())
            .flat_map(|plan| (0..plan.stills).map(|still| (plan.episode, plan.step(still))))
            .collect();
        state.made.retain(|still, _| wanted.contains(still));
        // What went wrong with one episode may go well with another.
        if !state.closed {
            state.trouble = None;
        }
        state.to_make = batches(&plans).collect();
        state.plans = Some(plans);
        self.shared.changed.notify_all();
    }

    /// How far they are.
    #[must_use]
    pub fn progress(&self) -> Progress {
        let state = self.shared.lock();
        let mut progress = Progress {
            trouble: state.trouble.as_ref().map(ToString::to_string),
            videos: state.videos.clone(),
            ..Progress::default()
        };
        for plan in state.plans.iter().flatten() {
            let made = |still: &u32| state.made.contains_key(&(plan.episode, plan.step(*still)));
            let first = || (0..plan.stills).filter(|&still| plan.is_first(still));
            progress.first[0] += first().filter(made).count();
            progress.first[1] += first().count();
            progress.films.push(Film {
                every: plan.every,
                made: (0..plan.stills).filter(made).collect(),
            });
            progress.all[1] += plan.stills as usize;
        }
        progress.all[0] = progress.films.iter().map(|film| film.made.len()).sum();
        progress
    }

    /// A still of the left (0) or right (1) film, by its place.
    #[must_use]
    pub fn still(&self, side: usize, still: u32) -> Option<Bytes> {
        let state = self.shared.lock();
        let plan = state.plans.as_ref()?.get(side)?;
        let known = still < plan.stills;
        let at = (plan.episode, plan.step(if known { still } else { 0 }));
        state.made.get(&at).filter(|_| known).cloned()
    }

    /// The video of the left (0) or right (1) clip by a camera.
    #[must_use]
    pub fn video(&self, side: usize, camera: usize) -> Option<PathBuf> {
        let state = self.shared.lock();
        let file = state.videos.as_ref()?.file(side, camera)?;
        Some(file.to_path_buf())
    }
}

impl Drop for Studio {
    fn drop(&mut self) {
        self.shared.lock().closed = true;
        self.shared.changed.notify_all();
    }
}

impl Shared {
    fn lock(&self) -> MutexGuard<'_, State> {
        // Nothing panics while it holds this.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn work(&self, mut source: impl FilmSource, cache: Option<Cache>) {
        let keeper = cache.clone().map(Cache::keeper);
        let ready = source.prepare();
        while let Some((episode, steps)) = self.next() {
            match made(&mut source, &ready, cache.as_ref(), episode, &steps) {
                Ok(stills) => self.add(episode, stills, keeper.as_ref()),
                Err(reason) => {
                    let mut state = self.lock();
                    // The question may be another one by now.
                    if state.plans.iter().flatten().any(|it| it.episode == episode) {
                        state.trouble = Some(reason);
                        state.to_make.clear();
                    }
                }
            }
        }
    }

    /// Waits for stills to make, by episode and steps; none when there will be no more.
    fn next(&self) -> Option<(u32, Vec<u32>)> {
        let mut state = self.lock();
        loop {
            if state.closed {
                return None;
            }
            if let (Some(plans), Some(batch)) = (state.plans, state.to_make.pop_front()) {
                let plan = plans[batch.side];
                let steps = batch.stills.into_iter().map(|still| plan.step(still));
                let missing = steps.filter(|&step| !state.made.contains_key(&(plan.episode, step)));
                return Some((plan.episode, missing.collect()));
            }
            let woken = self.changed.wait(state);
            state = woken.unwrap_or_else(PoisonError::into_inner);
        }
    }

    fn add(&self, episode: u32, stills: Vec<Made>, keeper: Option<&Sender<Still>>) {
        let mut state = self.lock();
        for Made { step, jpeg, kept } in stills {
            if let Some(keeper) = keeper.filter(|_| !kept) {
                // Nobody listens where nothing can be written.
                let _ = keeper.send((episode, step, jpeg.clone())).is_ok();
            }
            state.made.insert((episode, step), jpeg);
        }
    }
}

/// A still, and whether it comes from the cache.
pub(super) struct Made {
    pub step: u32,
    pub jpeg: Bytes,
    pub kept: bool,
}

/// Takes stills from the cache, and has the source make the others.
pub(super) fn made(
    source: &mut impl FilmSource,
    ready: &Result<(), NoFilm>,
    cache: Option<&Cache>,
    episode: u32,
    steps: &[u32],
) -> Result<Vec<Made>, NoFilm> {
    let (mut stills, mut missing) = (Vec::new(), Vec::new());
    for &step in steps {
        match cache.and_then(|cache| cache.get(episode, step)) {
            Some(jpeg) => stills.push(Made {
                step,
                jpeg: jpeg.into(),
                kept: true,
            }),
            None => missing.push(step),
        }
    }
    if !missing.is_empty() {
        ready.clone()?;
        let drawn = source.stills(episode, &missing)?;
        stills.extend(missing.into_iter().zip(drawn).map(|(step, jpeg)| Made {
            step,
            jpeg: jpeg.into(),
            kept: false,
        }));
    }
    Ok(stills)
}
