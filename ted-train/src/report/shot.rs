//! Clips as a report shows them: numbers of everything, and stills where something here can draw them.

use std::path::Path;

use axum::body::Bytes;
use firmware_sim::progress::Audience;
use firmware_sim::rollout::episode_seed;

use crate::ask::film::{NoFilm, Reel};
use crate::ask::{Channels, ClipSource, Numbers, Picture};
use crate::dataset::{Dataset, Segment};
use crate::evaluate::Evaluation;
use crate::recording::{Moment, Recording, record};

/// A clip.
pub(super) struct Shot {
    pub picture: Picture,
    /// JPEGs in the order of the steps; none where nothing drew them.
    pub stills: Vec<Bytes>,
}

/// One of the flights.
pub(super) struct Flown {
    /// Its place among them.
    pub place: usize,
    pub return_true: f64,
    pub success: bool,
    pub shot: Shot,
}

/// What makes the clips of a report.
pub(super) struct Camera<'a> {
    numbers: Numbers<'a>,
    reel: Option<Reel>,
    audience: Audience,
}

impl<'a> Camera<'a> {
    /// Of a dataset in this folder.
    pub fn of(dataset: &'a Dataset, folder: &Path, audience: Audience) -> Self {
        Self {
            numbers: Numbers::of(dataset),
            // Logs that no simulator made have no pictures, and nobody misses them.
            reel: Reel::of(dataset, folder).ok(),
            audience,
        }
    }

    /// A clip of the logs.
    pub fn shoot(&mut self, segment: Segment) -> Shot {
        Shot {
            picture: self.numbers.picture(segment),
            stills: self.stills(|reel| reel.clip(segment)),
        }
    }

    /// The flight whose return is nearest the mean, flown again by the artefact at this path; none where it cannot be flown here.
    pub fn shoot_flight(
        &mut self,
        flown: &Evaluation,
        artefact: &Path,
        dataset: &Dataset,
    ) -> Option<Flown> {
        let off = |place: &usize| (flown.returns[*place] - flown.return_mean).abs();
        let place = (0..flown.returns.len()).min_by(|a, b| off(a).total_cmp(&off(b)))?;
        if !artefact.is_file() {
            return None;
        }
        let again = self.fly(flown, artefact, place)?;
        // A page shows actions as a policy gives them.
        let unit = |moment: &Moment| -> Vec<f32> {
            let maps = dataset.robot().action_maps();
            maps.zip(&moment.action)
                .map(|(map, &it)| map.unit(it))
                .collect()
        };
        let actions: Vec<_> = again.moments.iter().map(unit).collect();
        let rows: Vec<_> = (again.moments.iter().zip(&actions))
            .map(|(moment, action)| (moment.observation.as_slice(), action.as_slice()))
            .collect();
        Some(Flown {
            place,
            return_true: again.report.return_true,
            success: again.report.success,
            shot: Shot {
                picture: Picture::drawn(
                    &Channels::of(dataset),
                    u32::try_from(place).unwrap_or_default(),
                    0,
                    &rows,
                ),
                stills: self.stills(|reel| reel.flight(&again)),
            },
        })
    }

    fn fly(&self, flown: &Evaluation, artefact: &Path, place: usize) -> Option<Recording> {
        let seed = episode_seed(flown.seed, place as u64);
        // A simulator that is not there is not installed for a report.
        let world = flown.world()?;
        let world = world.ready_if_installed(flown.engine).ok()??;
        let recorded = record(artefact, flown.numeric, &world, seed);
        let missed = |error| {
            self.audience
                .note(&format!("the report shows no flight: {error}"))
        };
        recorded.map_err(missed).ok()
    }

    /// What a reel gives. One that fails is not asked again, and what it gave stays.
    fn stills(&mut self, make: impl FnOnce(&mut Reel) -> Result<Vec<Bytes>, NoFilm>) -> Vec<Bytes> {
        let Some(reel) = &mut self.reel else {
            return Vec::new();
        };
        make(reel).unwrap_or_else(|reason| {
            self.audience
                .note(&format!("no more pictures in the report: {reason}"));
            self.reel = None;
            Vec::new()
        })
    }
}
