//! Builds the contiguous arrays from episodes that arrive in any order, in parallel, each into its own place.

use super::digest::{EpisodeArrays, combine};
use super::ends::check_ends;
use super::glitches::mend;
use super::in_memory::{Dataset, Episode};
use super::record::check_values;
use super::{DatasetError, EpisodeRecord, Shape};
use firmware_sim::robot::Robot;
use rayon::prelude::*;
use ted_policy::ActionMap;

/// Where one episode's arrays go.
pub(super) struct EpisodeSlots<'a> {
    pub observations: &'a mut [f32],
    pub actions: &'a mut [f32],
    pub terminations: &'a mut [bool],
    pub truncations: &'a mut [bool],
    pub success: &'a mut [bool],
}

/// What an episode's source hands over beside the filled slots.
pub(super) struct Filled {
    pub place: String,
    pub seed: Option<u64>,
    pub rewards: Vec<f64>,
}

/// Builds a dataset of episodes of this robot with these lengths; `fill` must fill every slot of the episode it is asked for, actions
/// as recorded.
pub(super) fn assemble(
    id: &str,
    robot: Robot,
    lengths: &[usize],
    fill: impl Fn(usize, &mut EpisodeSlots) -> Result<Filled, DatasetError> + Sync,
) -> Result<Dataset, DatasetError> {
    let shape = Shape::of(&robot);
    if lengths.is_empty() {
        return Err(DatasetError::NoEpisodes { id: id.into() });
    }
    let steps: usize = lengths.iter().sum();
    let rows = steps + lengths.len();
    if u32::try_from(rows).is_err() {
        return Err(DatasetError::TooLarge {
            id: id.into(),
            steps: steps as u64,
            limit: u64::from(u32::MAX),
        });
    }
    let mut observations = vec![0.0; rows * shape.observation];
    let mut actions = vec![0.0; steps * shape.action];
    let mut rewards_true = vec![0.0; steps];
    let [mut terminations, mut truncations, mut success] = [0; 3].map(|_| vec![false; steps]);

    let mut rest = (
        observations.as_mut_slice(),
        actions.as_mut_slice(),
        rewards_true.as_mut_slice(),
        terminations.as_mut_slice(),
        truncations.as_mut_slice(),
        success.as_mut_slice(),
    );
    let slots: Vec<_> = lengths
        .iter()
        .map(|&len| {
            let slots = EpisodeSlots {
                observations: take(&mut rest.0, (len + 1) * shape.observation),
                actions: take(&mut rest.1, len * shape.action),
                terminations: take(&mut rest.3, len),
                truncations: take(&mut rest.4, len),
                success: take(&mut rest.5, len),
            };
            (slots, take(&mut rest.2, len))
        })
        .collect();

    let finished: Vec<Result<_, DatasetError>> = slots
        .into_par_iter()
        .enumerate()
        .map(|(episode, (mut slots, rewards_f32))| {
            let filled = fill(episode, &mut slots)?;
            finish(&robot, &slots, &filled, rewards_f32)
        })
        .collect();

    let mut episodes = Vec::with_capacity(lengths.len());
    let mut hashes = Vec::with_capacity(lengths.len());
    let mut row_of_step = Vec::with_capacity(steps);
    let mut first_step = 0;
    for (finished, &len) in finished.into_iter().zip(lengths) {
        let (mut episode, hash) = finished?;
        episode.first_step = first_step;
        let first_row = first_step + episodes.len();
        row_of_step.extend((first_row..first_row + len).map(|row| row as u32));
        first_step += len;
        episodes.push(episode);
        hashes.push(hash);
    }
    let glitches = mend(&mut observations, shape.observation, &episodes);
    let (actions, actions_env) = in_unit(&robot, actions);
    Ok(Dataset {
        id: id.into(),
        origin: None,
        digest: combine(&robot, &hashes),
        robot,
        shape,
        episodes,
        row_of_step,
        observations,
        glitches,
        actions,
        actions_env,
        rewards_true,
        terminations,
        truncations,
        success,
    })
}

/// Recorded actions as a policy sees them, and as they were recorded where that is not the same.
fn in_unit(robot: &Robot, mut actions: Vec<f32>) -> (Vec<f32>, Option<Vec<f32>>) {
    if robot.action.iter().all(|it| it.range == UNIT) {
        return (actions, None);
    }
    let recorded = actions.clone();
    let maps: Vec<ActionMap> = robot.action_maps().collect();
    for row in actions.chunks_exact_mut(maps.len()) {
        for (value, map) in row.iter_mut().zip(&maps) {
            *value = map.unit(*value);
        }
    }
    (actions, Some(recorded))
}

/// The range in which policies give actions.
pub(super) const UNIT: [f32; 2] = [-1.0, 1.0];

/// Builds a dataset from episodes in memory.
pub(super) fn from_records(
    id: &str,
    robot: Robot,
    records: &[EpisodeRecord],
) -> Result<Dataset, DatasetError> {
    let place = |episode| format!("episode {episode}");
    for (episode, record) in records.iter().enumerate() {
        record.check(&robot, &place(episode))?;
    }
    let lengths: Vec<_> = records.iter().map(EpisodeRecord::steps).collect();
    assemble(id, robot, &lengths, |episode, slots| {
        let record = &records[episode];
        slots.observations.copy_from_slice(&record.observations);
        slots.actions.copy_from_slice(&record.actions);
        slots.terminations.copy_from_slice(&record.terminations);
        slots.truncations.copy_from_slice(&record.truncations);
        slots.success.copy_from_slice(&record.success);
        Ok(Filled {
            place: place(episode),
            seed: record.seed,
            rewards: record.rewards.clone(),
        })
    })
}

/// Checks a filled episode, hashes it and narrows its rewards.
fn finish(
    robot: &Robot,
    slots: &EpisodeSlots,
    filled: &Filled,
    rewards_f32: &mut [f32],
) -> Result<(Episode, blake3::Hash), DatasetError> {
    for (narrow, &reward) in rewards_f32.iter_mut().zip(&filled.rewards) {
        *narrow = reward as f32;
    }
    let (observations, actions) = (&*slots.observations, &*slots.actions);
    check_values(&filled.place, robot, observations, actions, rewards_f32)?;
    check_ends(&filled.place, slots.terminations, slots.truncations)?;
    let hash = EpisodeArrays {
        observations: slots.observations,
        actions: slots.actions,
        rewards: &filled.rewards,
        terminations: slots.terminations,
        truncations: slots.truncations,
        success: slots.success,
    }
    .hash();
    let episode = Episode {
        first_step: 0,
        len: rewards_f32.len(),
        seed: filled.seed,
        return_true: filled.rewards.iter().sum(),
        success: slots.success.iter().any(|&solved| solved),
    };
    Ok((episode, hash))
}

fn take<'a, T>(rest: &mut &'a mut [T], len: usize) -> &'a mut [T] {
    let (head, tail) = std::mem::take(rest).split_at_mut(len);
    *rest = tail;
    head
}

#[cfg(test)]
mod tests {
    use super::super::fixtures::{SHAPE, records};
    use super::*;

    fn error(change: impl FnOnce(&mut EpisodeRecord)) -> String {
        let mut records = records(&[4, 6, 5]);
        change(&mut records[1]);
        Dataset::from_records("ted/x-v0", SHAPE, &records)
            .map(|_| ())
            .expect_err("must be refused")
            .to_string()
    }

    #[test]
    fn rows_run_ahead_of_steps_by_one_an_episode() {
        let records = records(&[4, 6, 5]);
        let dataset = Dataset::from_records("ted/x-v0", SHAPE, &records).unwrap();
        assert_eq!(dataset.step_count(), 15);
        assert_eq!(dataset.observations_row(3), 3);
        assert_eq!(dataset.observations_row(4), 5);
        assert_eq!(dataset.observations_row(14), 16);
        assert_eq!(
            dataset.observation(4),
            &records[1].observations[..SHAPE.observation]
        );
        assert_eq!(
            dataset.next_observation(3),
            &records[0].observations[4 * SHAPE.observation..]
        );
        assert_eq!(
            dataset.action(5),
            &records[1].actions[SHAPE.action..2 * SHAPE.action]
        );
        assert_eq!(dataset.episodes()[2].first_step, 10);
        assert_eq!(dataset.episodes()[2].return_true, records[2].return_true());
    }

    #[test]
    fn the_digest_changes_with_any_value_and_any_cut_between_episodes() {
        let digest = |records: &[EpisodeRecord]| {
            Dataset::from_records("ted/x-v0", SHAPE, records)
                .unwrap()
                .digest
        };
        let original = records(&[4, 6]);
        assert_eq!(digest(&original), digest(&records(&[4, 6])));
        let mut changed = original.clone();
        changed[1].rewards[2] += 1e-12;
        assert_ne!(digest(&original), digest(&changed));
        let mut changed = original.clone();
        changed[0].truncations[3] ^= true;
        assert_ne!(digest(&original), digest(&changed));
        let mut swapped = original.clone();
        swapped.swap(0, 1);
        assert_ne!(digest(&original), digest(&swapped));
    }

    #[test]
    fn an_action_that_no_policy_could_send_is_named_with_its_place() {
        let text = error(|r| r.actions[SHAPE.action * 2 + 3] = -1.0001);
        let place = "actions of episode 1 holds -1.0001 at row 2, channel action_3";
        assert!(text.starts_with(place), "{text}");
        let mut at_the_edge = records(&[4]);
        at_the_edge[0].actions[..2].copy_from_slice(&[1.0, -1.0]);
        assert!(Dataset::from_records("ted/x-v0", SHAPE, &at_the_edge).is_ok());
    }

    #[test]
    fn actions_of_any_range_are_learned_from_in_the_policy_s_and_kept_as_recorded() {
        let mut ranged = records(&[4]);
        for action in &mut ranged[0].actions {
            *action = 5.0 + 5.0 * *action;
        }
        let refused = Dataset::from_records("ted/x-v0", SHAPE, &ranged).unwrap_err();
        assert!(refused.to_string().contains("ted robot draft"), "{refused}");
        let robot = Robot::draft(SHAPE.observation, &[[0.0, 10.0]; SHAPE.action]);
        let dataset = Dataset::of_robot("ted/x-v0", robot, &ranged).unwrap();
        assert_eq!(dataset.actions_env(), ranged[0].actions);
        for (unit, original) in dataset.actions().iter().zip(&records(&[4])[0].actions) {
            assert!((unit - original).abs() < 1e-6, "{unit} {original}");
        }
        // The same numbers, seen in another range, are other data.
        let wider = Robot::draft(SHAPE.observation, &[[0.0, 20.0]; SHAPE.action]);
        let wider = Dataset::of_robot("ted/x-v0", wider, &ranged).unwrap();
        assert_ne!(dataset.digest(), wider.digest());
        assert!(wider.actions().iter().all(|action| *action <= 0.0));
    }

    #[test]
    fn an_end_inside_of_an_episode_is_named_with_its_place_and_what_it_means() {
        let text = error(|r| {
            r.truncations[4] = true;
            r.terminations[2] = true;
        });
        let place = "episode 1 has a termination at step 2 of 6, and goes on";
        assert!(text.starts_with(place), "{text}");
        assert!(
            text.contains("two recordings in one: `ted import FOLDER --drop after-end`"),
            "{text}"
        );
        let text = error(|r| {
            r.terminations[5] = false;
            r.truncations[3] = true;
        });
        let place = "episode 1 has a truncation at step 3 of 6, and goes on";
        assert!(text.starts_with(place), "{text}");
        assert!(text.contains("not in the order of time"), "{text}");
    }

    #[test]
    fn an_episode_whose_last_step_has_no_flag_is_one_whose_recording_ends_there() {
        let mut records = records(&[4, 6, 5]);
        records[1].terminations[5] = false;
        let dataset = Dataset::from_records("ted/x-v0", SHAPE, &records).unwrap();
        assert!(!dataset.terminations()[9] && !dataset.truncations()[9]);
    }

    #[test]
    fn wrong_shapes_and_numbers_that_are_not_finite_are_named_with_their_place() {
        assert!(
            error(|r| r.actions.truncate(3))
                .starts_with("actions of episode 1: expected 24 values for 6 steps, got 3")
        );
        assert!(error(|r| r.observations.push(0.0)).starts_with("observations of episode 1"));
        let text = error(|r| r.observations[SHAPE.observation * 2 + 3] = f32::NAN);
        assert!(
            text.starts_with("observations of episode 1 holds NaN at row 2, column 3"),
            "{text}"
        );
        assert!(
            error(|r| r.rewards[5] = f64::INFINITY)
                .starts_with("rewards of episode 1 holds inf at row 5")
        );
        assert!(error(|r| *r = EpisodeRecord::default()).starts_with("episode 1 has no steps"));
        assert!(Dataset::from_records("ted/x-v0", SHAPE, &[]).is_err());
    }
}
