//! One thread of a flight: its plants fly abreast, and the next seed goes to the first that is free.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::Sender;

use super::episode::{EpisodeError, EpisodeReport, Underway};
use super::{Debrief, FlyError, Pilot, TickTimes};
use crate::plant::{Plant, PlantError};
use crate::remote::RemoteError;
use crate::safety::Action;

/// An episode that ended.
pub(super) struct Landed {
    pub(super) index: usize,
    pub(super) report: EpisodeReport,
    pub(super) times: TickTimes,
    pub(super) debrief: Option<Debrief>,
}

/// What the workers of a flight share.
pub(super) struct Crew<'a, L, M, S> {
    make_pilot: L,
    make_plants: M,
    seeds: &'a [u64],
    stop: S,
    next: AtomicUsize,
    failed: AtomicBool,
}

/// A plant, whoever flies it, and what they are flying.
struct Berth<Q, P> {
    pilot: Q,
    plant: P,
    task: Option<Task>,
}

/// An episode to fly.
struct Task {
    index: usize,
    seed: u64,
    /// Whether it is flown for the second time.
    again: bool,
    /// None before it took off.
    underway: Option<Underway>,
    /// What the pilot decided in the tick that is being made.
    action: Action,
    /// Whether that tick was the last one.
    done: bool,
}

impl<'a, Q, P, L, M, S> Crew<'a, L, M, S>
where
    Q: Pilot,
    P: Plant,
    L: Fn() -> Result<Q, RemoteError>,
    M: Fn() -> Result<Vec<P>, PlantError>,
    S: Fn() -> bool,
{
    pub(super) const fn new(make_pilot: L, make_plants: M, seeds: &'a [u64], stop: S) -> Self {
        Self {
            make_pilot,
            make_plants,
            seeds,
            stop,
            next: AtomicUsize::new(0),
            failed: AtomicBool::new(false),
        }
    }

    /// Flies until there is nothing left to fly, or somebody failed or asked to stop.
    pub(super) fn work(&self, landings: &Sender<Result<Landed, FlyError>>) {
        if let Err(error) = self.fly_until_done(landings) {
            self.failed.store(true, Ordering::Relaxed);
            // The receiver lives until every worker has ended.
            landings.send(Err(error)).unwrap_or_default();
        }
    }

    fn fly_until_done(&self, landings: &Sender<Result<Landed, FlyError>>) -> Result<(), FlyError> {
        let mut berths = self.berths()?;
        loop {
            self.board(&mut berths);
            if berths.iter().all(|berth| berth.task.is_none()) {
                return Ok(());
            }
            match tick(&mut berths) {
                Ok(()) => {
                    for landed in land(&mut berths) {
                        landings.send(Ok(landed?)).unwrap_or_default();
                    }
                }
                // A link may well break because of what asked for the stop.
                Err((_, EpisodeError::Plant(PlantError::Link(_)) | EpisodeError::Pilot(_)))
                    if (self.stop)() =>
                {
                    return Ok(());
                }
                Err((place, EpisodeError::Plant(PlantError::Link(_))))
                    if berths[place].task.as_ref().is_some_and(|task| !task.again) =>
                {
                    self.renew(&mut berths)?;
                }
                Err((place, source)) => {
                    let seed = berths[place].task.as_ref().map_or(0, |task| task.seed);
                    return Err(FlyError::Episode { seed, source });
                }
            }
        }
    }

    fn berths(&self) -> Result<Vec<Berth<Q, P>>, FlyError> {
        // Pilots first: a device that does not answer costs less time than a simulator.
        let first = (self.make_pilot)().map_err(FlyError::NoPilot)?;
        let plants = (self.make_plants)().map_err(FlyError::NoPlant)?;
        let mut first = Some(first);
        plants
            .into_iter()
            .map(|plant| {
                let pilot = match first.take() {
                    Some(pilot) => pilot,
                    None => (self.make_pilot)().map_err(FlyError::NoPilot)?,
                };
                Ok(Berth {
                    pilot,
                    plant,
                    task: None,
                })
            })
            .collect()
    }

    /// Hands out the next seeds, unless the flight is to end.
    fn board(&self, berths: &mut [Berth<Q, P>]) {
        for berth in berths.iter_mut().filter(|berth| berth.task.is_none()) {
            if self.failed.load(Ordering::Relaxed) || (self.stop)() {
                return;
            }
            let index = self.next.fetch_add(1, Ordering::Relaxed);
            let Some(&seed) = self.seeds.get(index) else {
                return;
            };
            berth.task = Some(Task {
                index,
                seed,
                again: false,
                underway: None,
                action: Action::new(),
                done: false,
            });
        }
    }

    /// Fresh plants, and every episode once more from its seed.
    fn renew(&self, berths: &mut [Berth<Q, P>]) -> Result<(), FlyError> {
        let plants = (self.make_plants)().map_err(FlyError::NoPlant)?;
        for (berth, plant) in berths.iter_mut().zip(plants) {
            berth.plant = plant;
            if let Some(task) = &mut berth.task {
                (task.again, task.underway, task.done) = (true, None, false);
            }
        }
        Ok(())
    }
}

/// One control period on every plant that flies: all decide before any moves. The error comes with its berth's place.
fn tick<Q: Pilot, P: Plant>(berths: &mut [Berth<Q, P>]) -> Result<(), (usize, EpisodeError)> {
    for (place, berth) in berths.iter_mut().enumerate() {
        berth.decide().map_err(|error| (place, error))?;
    }
    for (place, berth) in berths.iter_mut().enumerate() {
        berth.apply().map_err(|error| (place, error))?;
    }
    Ok(())
}

/// Takes what ended off its berth.
fn land<Q: Pilot, P: Plant>(berths: &mut [Berth<Q, P>]) -> Vec<Result<Landed, FlyError>> {
    let ended = |berth: &mut Berth<Q, P>| {
        let Task {
            index,
            seed,
            underway,
            ..
        } = berth.task.take_if(|task| task.done)?;
        let (report, times) = underway?.land();
        let debrief = berth.pilot.debrief().map_err(|error| FlyError::Episode {
            seed,
            source: error.into(),
        });
        Some(debrief.map(|debrief| Landed {
            index,
            report,
            times,
            debrief,
        }))
    };
    berths.iter_mut().filter_map(ended).collect()
}

impl<Q: Pilot, P: Plant> Berth<Q, P> {
    fn decide(&mut self) -> Result<(), EpisodeError> {
        let Some(task) = &mut self.task else {
            return Ok(());
        };
        let underway = match &mut task.underway {
            Some(underway) => underway,
            none => none.insert(Underway::take_off(
                &mut self.pilot,
                &mut self.plant,
                task.seed,
            )?),
        };
        task.action = underway.decide(&mut self.pilot, &mut self.plant)?;
        self.plant.announce(&task.action)?;
        Ok(())
    }

    fn apply(&mut self) -> Result<(), EpisodeError> {
        if let Some(task) = &mut self.task
            && let Some(underway) = &mut task.underway
        {
            task.done = underway.settle(self.plant.apply(&task.action)?);
        }
        Ok(())
    }
}
