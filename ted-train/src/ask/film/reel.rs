//! Stills of whole clips, for whoever can wait for them.

use std::path::Path;

use axum::body::Bytes;
use firmware_sim::bridge::Look;

use super::NoFilm;
use super::cache::Cache;
use super::plan::Plan;
use super::simulator::Simulator;
use super::studio::made;
use crate::dataset::{Dataset, Segment};
use crate::recording::Recording;

/// Small, since there are many in one file.
const LOOK: Look = Look {
    width: 240,
    height: 180,
    quality: 70,
};

/// Draws few stills of a clip, fourteen of a whole episode of Meta-World, and keeps them beside the dataset.
pub struct Reel {
    simulator: Simulator,
    cache: Cache,
}

impl Reel {
    /// Of a dataset in this folder. Nothing is installed for it.
    ///
    /// # Errors
    /// When nothing can draw its states.
    pub fn of(dataset: &Dataset, folder: &Path) -> Result<Self, NoFilm> {
        let simulator = Simulator::of(dataset, folder, LOOK)?;
        let cache = Cache::beside(folder, &simulator.key(dataset));
        Ok(Self { simulator, cache })
    }

    /// JPEGs of a clip, in the order of its steps.
    ///
    /// # Errors
    /// When they cannot be made.
    pub fn clip(&mut self, segment: Segment) -> Result<Vec<Bytes>, NoFilm> {
        let plan = Plan::of(segment);
        let (episode, steps) = (plan.episode, plan.first_pass());
        let (source, cache) = (&mut self.simulator, Some(&self.cache));
        let mut stills = made(source, &Ok(()), cache, episode, &steps)?;
        stills.sort_by_key(|still| still.step);
        for still in stills.iter().filter(|still| !still.kept) {
            // One that cannot be kept is made again the next time.
            let _ = self.cache.put(episode, still.step, &still.jpeg).is_ok();
        }
        Ok(stills.into_iter().map(|still| still.jpeg).collect())
    }

    /// The same of a flight on the task of the dataset; none where nothing was simulated.
    ///
    /// # Errors
    /// When they cannot be made.
    pub fn flight(&mut self, flight: &Recording) -> Result<Vec<Bytes>, NoFilm> {
        let plan = Plan::new(0, 0, flight.report.ticks);
        let moments = plan.first_pass().into_iter();
        let states = moments.filter_map(|step| flight.moments.get(step as usize)?.state.clone());
        let drawn = self.simulator.draw(flight.report.seed, states.collect())?;
        Ok(drawn.into_iter().map(Bytes::from).collect())
    }
}
