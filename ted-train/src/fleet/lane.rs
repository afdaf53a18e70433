//! One run from its dataset to its evaluation.

use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

use firmware_sim::bridge::Engine;
use firmware_sim::tasks;
use serde::Serialize;

use super::LaneError;
use crate::config::Config;
use crate::dataset::Dataset;
use crate::evaluate::{Evaluation, FlightPlan, evaluate_once};
use crate::preferences::{PreferenceLog, ReplayTeacher, ScriptedTeacher, Teacher};
use crate::run::{DatasetReference, PREFERENCES, RunFolder};
use crate::train::{Watch, check, train};

/// A run that is to be made, or gone on with.
#[derive(Clone, Debug)]
pub struct Lane {
    /// The folder of its dataset.
    pub dataset: PathBuf,
    /// Everything that decides what it computes.
    pub config: Config,
    /// The folder of the run.
    pub folder: PathBuf,
    /// A preference log to answer from; true returns answer if there is none.
    pub answers: Option<PathBuf>,
}

/// What a run left.
#[derive(Clone, Debug, Serialize)]
pub struct Trained {
    /// The artefact.
    pub artefact: PathBuf,
    /// How it flew, if it was to fly and its task can be simulated.
    pub evaluation: Option<Evaluation>,
}

impl Lane {
    /// Trains and flies what the folder does not hold yet, with at most so many simulators side by side.
    ///
    /// # Errors
    /// When a phase fails or is interrupted; the same call goes on.
    pub fn run(
        &self,
        dataset: &Dataset,
        simulators: NonZeroUsize,
        watch: Watch<'_>,
    ) -> Result<Trained, LaneError> {
        let reference = DatasetReference {
            id: dataset.id().to_owned(),
            digest: dataset.digest().to_owned(),
            path: self.dataset.clone(),
        };
        // Nothing is begun that cannot be ended.
        check(dataset, &self.config)?;
        let answers = match &self.answers {
            Some(log) => Some((log, ReplayTeacher::open(log, dataset)?)),
            None => None,
        };
        let folder = RunFolder::begin(&self.folder, &self.config, &reference)?;
        let mut teacher: Box<dyn Teacher> = match answers {
            Some((log, answers)) => {
                same_answers(&answers, log, &folder, dataset)?;
                Box::new(answers)
            }
            None => Box::new(ScriptedTeacher::new(0.0)?),
        };
        train(dataset, &self.config, &folder, teacher.as_mut(), watch)?;
        let artefact = folder.artefact_path();
        let audience = watch.audience();
        audience.note(&format!("wrote {}", artefact.display()));

        let episodes = self.config.schedule.evaluation_episodes;
        let simulated = dataset
            .task()
            .is_some_and(|task| tasks::single(task).is_ok());
        if episodes > 0 && !simulated {
            audience.note("not flown: the dataset is of no Meta-World task");
        }
        let evaluation = match episodes > 0 && simulated {
            true => {
                let plan = FlightPlan {
                    episodes,
                    seed: self.config.seed,
                    workers: simulators.get(),
                    engine: Engine::default(),
                };
                Some(evaluate_once(&folder, &plan, audience)?)
            }
            false => None,
        };
        Ok(Trained {
            artefact,
            evaluation,
        })
    }
}

/// Refuses to go on in a folder that holds answers of anybody else.
fn same_answers(
    answers: &ReplayTeacher,
    log: &Path,
    folder: &RunFolder,
    dataset: &Dataset,
) -> Result<(), LaneError> {
    let held = folder.file(PREFERENCES);
    if !held.exists() {
        return Ok(());
    }
    let held = PreferenceLog::read(&held, dataset)?;
    match answers.first_other_answer(&held) {
        None => Ok(()),
        Some(number) => {
            let difference = format!("its answer {number} is not one of {}", log.display());
            Err(folder.other(difference).into())
        }
    }
}
