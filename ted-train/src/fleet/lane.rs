//! One run from its dataset to its evaluation: what comes before it learns a policy, and what comes after.

use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use firmware_sim::bridge::Engine;
use firmware_sim::controller::Numeric;
use firmware_sim::interrupt;
use firmware_sim::progress::Audience;
use firmware_sim::worlds::World;
use serde::Serialize;

use super::{Datasets, LaneError};
use crate::config::Config;
use crate::dataset::Dataset;
use crate::evaluate::{Evaluation, FlightPlan, Flyer, evaluate_once};
use crate::preferences::{PreferenceLog, ReplayTeacher, Teacher, Use, findings, in_words};
use crate::reward::RewardLearner;
use crate::reward::episodes::Confidence;
use crate::run::{ANSWERS, DatasetReference, PREFERENCES, RunError, RunFolder};
use crate::train::{Finished, LearnedPolicy, Prepared, Watch, check, check_teacher};

/// A run that is to be made, or gone on with.
#[derive(Clone, Debug)]
pub struct Lane {
    /// The folder of its dataset.
    pub dataset: PathBuf,
    /// Everything that decides what it computes.
    pub config: Config,
    /// The folder of the run.
    pub folder: PathBuf,
    /// A preference log to answer from; the simulated teacher answers if there is none.
    pub answers: Option<PathBuf>,
    /// Folders of runs that may have learned the reward of this one, which takes long.
    pub siblings: Vec<PathBuf>,
}

/// What a run left.
#[derive(Clone, Debug, Serialize)]
pub struct Trained {
    /// The artefact, if a controller can fly the policy.
    pub artefact: Option<PathBuf>,
    /// How sure it is that its best episodes are better than the logs, if its reward can tell.
    pub confidence: Option<Confidence>,
    /// How it flew, if it was to fly and its task can be simulated.
    pub evaluation: Option<Evaluation>,
}

/// What became of the lines of a file of answers: what `answers.json` says.
#[derive(Clone, Debug, Serialize)]
struct Answered<'a> {
    /// The file.
    file: &'a Path,
    /// Its lines.
    lines: Vec<Use>,
}

/// A run at work, which holds its dataset and its folder.
pub(super) struct Begun<'l> {
    lane: &'l Lane,
    dataset: Arc<Dataset>,
    folder: RunFolder,
    answers: Option<ReplayTeacher>,
}

/// Tells lanes of those before them whose rewards take long to learn and are the same. [`super::run`] begins them last, when
/// what they need is most likely there; a lane that finds nothing yet learns its reward itself, to the same bits.
pub fn introduce(lanes: &mut [Lane]) {
    for place in 1..lanes.len() {
        let (before, rest) = lanes.split_at_mut(place);
        let lane = &mut rest[0];
        let family = before.iter().filter(|other| lane.is_of(other));
        let family = family.map(|other| other.folder.clone()).collect();
        lane.siblings = family;
    }
}

impl Lane {
    /// Whether it learns the reward of another lane, and that takes long.
    fn is_of(&self, other: &Self) -> bool {
        let learns = |lane: &Self| {
            (
                lane.config.reward.clone(),
                lane.config.seed,
                lane.config.backend,
                lane.config.teacher,
            )
        };
        self.config
            .reward
            .learner()
            .is_some_and(RewardLearner::takes_long)
            && learns(self) == learns(other)
            && (&self.dataset, &self.answers) == (&other.dataset, &other.answers)
    }

    /// Opens what the run needs. Nothing is begun that cannot be ended.
    pub(super) fn begin(
        &self,
        datasets: &Datasets,
        watch: Watch<'_>,
    ) -> Result<Begun<'_>, LaneError> {
        if interrupt::requested() {
            return Err(LaneError::NotBegun);
        }
        datasets.complete(&self.dataset, watch)?;
        let dataset = datasets.open(&self.dataset)?;
        let reference = DatasetReference {
            id: dataset.id().to_owned(),
            digest: dataset.digest().to_owned(),
            path: self.dataset.clone(),
        };
        check(&dataset, &self.config)?;
        let answers = match &self.answers {
            Some(log) => Some((log, ReplayTeacher::open(log, &dataset)?)),
            None => {
                check_teacher(&dataset, &self.config)?;
                None
            }
        };
        let folder = RunFolder::begin(&self.folder, &self.config, &reference)?;
        if let Some((log, answers)) = &answers {
            same_answers(answers, log, &folder, &dataset)?;
            for finding in findings(answers.lines()) {
                watch.note(&format!("{}: {}", log.display(), finding.says));
            }
        }
        Ok(Begun {
            lane: self,
            dataset,
            folder: folder.among(self.siblings.clone()),
            answers: answers.map(|(_, answers)| answers),
        })
    }
}

impl Begun<'_> {
    /// Everything up to the policy.
    pub(super) fn prepare(&self, audience: Audience) -> Result<Prepared<'_>, LaneError> {
        let mut teacher: Box<dyn Teacher> = match &self.answers {
            Some(answers) => Box::new(answers.clone()),
            None => Box::new(self.lane.config.simulated_teacher()),
        };
        let (dataset, config) = (&*self.dataset, &self.lane.config);
        let teacher = teacher.as_mut();
        let prepared = Prepared::new(dataset, config, &self.folder, teacher, audience)?;
        self.account(audience)?;
        Ok(prepared)
    }

    /// Says what the answers that it was given were used for, all questions being asked.
    fn account(&self, audience: Audience) -> Result<(), LaneError> {
        let (Some(file), Some(answers)) = (&self.lane.answers, &self.answers) else {
            return Ok(());
        };
        let asked = PreferenceLog::read(self.folder.file(PREFERENCES), &self.dataset)?;
        let lines = answers.account(&asked);
        audience.note(&format!("{}: {}", file.display(), in_words(&lines)));
        let answered = Answered { file, lines };
        (self.folder.write_json(ANSWERS, &answered)).map_err(RunError::from)?;
        Ok(())
    }

    /// Everything after it: the artefact, and its flight if there is to be one and was none yet, with at most so many
    /// simulators side by side.
    pub(super) fn finish(
        &self,
        run: Prepared<'_>,
        policy: LearnedPolicy,
        simulators: NonZeroUsize,
        audience: Audience,
    ) -> Result<Trained, LaneError> {
        let confidence = run.confidence().cloned();
        let finished = run.finish(policy)?;
        let (flyer, artefact) = match &finished {
            Finished::Artefact(path) => {
                audience.note(&format!("wrote {}", path.display()));
                (Flyer::Artefact(path, Numeric::F32), Some(path.clone()))
            }
            Finished::Sequence(oppo) => {
                audience.note("no artefact: a sequence policy flies from this machine only");
                (Flyer::Sequence(oppo, &self.dataset), None)
            }
        };
        let episodes = self.lane.config.schedule.evaluation_episodes;
        let task = self.dataset.task();
        let simulated = task.is_some_and(|task| World::of_task(task).is_ok());
        if episodes > 0 && !simulated {
            audience.note("not flown: the dataset is of no world that is known here; `ted eval RUN --world FILE` flies in one of your own");
        }
        let evaluation = match episodes > 0 && simulated {
            true => {
                let plan = FlightPlan {
                    episodes,
                    seed: self.lane.config.seed,
                    workers: simulators.get(),
                    engine: Engine::default(),
                };
                Some(evaluate_once(&self.folder, flyer, None, &plan, audience)?)
            }
            false => None,
        };
        Ok(Trained {
            artefact,
            confidence,
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
    // Its own log is what it was told, also where two people were asked about the same clips.
    if !held.exists() || held.canonicalize().ok() == log.canonicalize().ok() {
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
