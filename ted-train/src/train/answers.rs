//! Answers that a policy is learned from without a reward in between.

use crate::preferences::{LabelledPair, Teacher};
use crate::reward::{LearnError, RandomQueries};
use crate::run::{PREFERENCES, RunError, RunFolder};

use super::TrainError;
use super::model::Facts;
use super::work::Work;

/// Holds the digest of the answers that the checkpoints are of.
pub(super) const STATE: &str = "answers.state";

/// Asks what the log of the run does not answer yet.
pub(super) fn of_a_policy(
    questions: RandomQueries,
    work: Work<'_>,
    teacher: &mut dyn Teacher,
) -> Result<(Vec<LabelledPair>, Facts), TrainError> {
    let mut interview = work.interview(teacher)?;
    let pairs = questions.ask(work.dataset, &mut interview, work.reward_seed())?;
    let digest = interview.digest().map_err(LearnError::from)?;
    same_answers(work.folder, &digest)?;
    let facts = Facts {
        queries: interview.answered(),
        preferences_digest: Some(digest),
        ..Facts::default()
    };
    Ok((pairs, facts))
}

/// Refuses to go on with a policy that was learned from other answers than those of this digest.
fn same_answers(folder: &RunFolder, digest: &str) -> Result<(), TrainError> {
    let held = match folder.file(STATE).exists() {
        true => Some(folder.read_state::<String>(STATE).map_err(RunError::from)?),
        false => None,
    };
    let difference = match held {
        Some(held) if held == digest => return Ok(()),
        Some(_) => format!("its policy is learned from other answers than {PREFERENCES} has now"),
        None if folder.has_checkpoints() => {
            format!("{STATE} is gone, which says what answers its policy is learned from")
        }
        None => return Ok(folder.write_state(STATE, &digest)?),
    };
    Err(folder.other(difference).into())
}
