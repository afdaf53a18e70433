//! Many episodes on several workers: complete, the same whoever plays them, and a worker's death costs nothing.

use std::ops::ControlFlow;

use firmware_sim::bridge::{BridgeError, Episode, EpisodeJob, Pool};

use crate::fake::{Fake, job};

fn play(pool: &mut Pool, jobs: &[EpisodeJob]) -> Result<Vec<Option<Episode>>, BridgeError> {
    let mut episodes = vec![None; jobs.len()];
    pool.run(jobs, |index, episode| {
        assert!(episodes[index].is_none(), "each episode comes once");
        episodes[index] = Some(episode);
        ControlFlow::Continue(())
    })?;
    Ok(episodes)
}

fn jobs(count: u64) -> Vec<EpisodeJob> {
    (0..count).map(job).collect()
}

#[test]
fn every_job_is_delivered_once_whatever_the_number_of_workers() {
    let fake = Fake::new("good");
    let one = play(&mut Pool::new(&fake.environment(), 1), &jobs(7)).expect("all are played");
    let three = play(&mut Pool::new(&fake.environment(), 3), &jobs(7)).expect("all are played");
    assert!(one.iter().all(Option::is_some));
    assert_eq!(one, three);
    assert!(fake.all_ended());
}

#[test]
fn workers_stay_for_the_next_list_and_no_more_are_started_than_there_are_jobs() {
    let fake = Fake::new("good");
    let mut pool = Pool::new(&fake.environment(), 3);
    play(&mut pool, &jobs(1)).expect("it is played");
    assert_eq!(fake.starts(), 1);
    play(&mut pool, &jobs(1)).expect("it is played");
    assert_eq!(fake.starts(), 1);
}

#[test]
fn an_empty_list_starts_nothing() {
    let fake = Fake::new("good");
    play(&mut Pool::new(&fake.environment(), 2), &[]).expect("there is nothing to fail");
    assert_eq!(fake.starts(), 0);
}

#[test]
fn an_episode_whose_worker_dies_is_played_again_on_a_fresh_one_with_the_same_result() {
    let good = play(
        &mut Pool::new(&Fake::new("good").environment(), 1),
        &jobs(3),
    );
    let fake = Fake::new("dies once");
    let episodes =
        play(&mut Pool::new(&fake.environment(), 1), &jobs(3)).expect("the second worker lives");
    assert_eq!(episodes, good.expect("all are played"));
    assert_eq!(fake.starts(), 2);
}

#[test]
fn an_episode_that_kills_two_workers_is_an_error_with_their_last_words() {
    let fake = Fake::new("dies always");
    let error = play(&mut Pool::new(&fake.environment(), 1), &jobs(3)).expect_err("it dies again");
    assert!(matches!(&error, BridgeError::FailedTwice { seed: 0, .. }));
    assert_eq!(
        error.to_string().matches("the simulator exploded").count(),
        2,
        "{error}"
    );
    assert_eq!(fake.starts(), 2);
}

#[test]
fn a_second_worker_that_does_not_start_does_not_hide_how_the_first_one_died() {
    let fake = Fake::new("dies once and never starts again");
    let error = play(&mut Pool::new(&fake.environment(), 1), &jobs(3)).expect_err("it is over");
    let words = error.to_string();
    assert!(
        matches!(&error, BridgeError::FailedTwice { second, .. }
            if matches!(**second, BridgeError::CannotStart { .. })),
        "{words}"
    );
    assert!(words.contains("the simulator exploded"), "{words}");
}

#[test]
fn a_refusal_is_not_tried_again() {
    let fake = Fake::new("refuses");
    let error = play(&mut Pool::new(&fake.environment(), 1), &jobs(3)).expect_err("it refuses");
    assert!(matches!(error, BridgeError::Refused { .. }));
    assert_eq!(fake.starts(), 1);
}

#[test]
fn a_receiver_that_has_enough_stops_the_rest() {
    let fake = Fake::new("good");
    let mut received = 0;
    let result = Pool::new(&fake.environment(), 2).run(&jobs(50), |_, _| {
        received += 1;
        if received == 3 {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    });
    assert!(result.is_ok());
    assert_eq!(received, 3);
}

#[test]
fn a_receiver_that_panics_does_not_hang_the_workers() {
    let fake = Fake::new("good");
    let environment = fake.environment();
    let panicked = std::panic::catch_unwind(|| {
        Pool::new(&environment, 2).run(&jobs(50), |_, _| panic!("the disk is on fire"))
    });
    assert!(panicked.is_err());
    assert!(fake.all_ended());
}
