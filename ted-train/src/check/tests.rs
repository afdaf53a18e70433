//! Datasets that something is odd about, and what is said of them.

use std::path::Path;

use super::{Check, Decides, Grade};
use crate::dataset::fixtures::{SHAPE, records};
use crate::dataset::{Dataset, EpisodeRecord};

const WIDTH: usize = SHAPE.observation;

fn checked(records: &[EpisodeRecord]) -> Check {
    let dataset = Dataset::from_records("ted/x-v0", SHAPE, records).unwrap();
    Check::of(&dataset, Path::new("logs"))
}

/// All that is said of logs that were changed in this way.
fn said(change: impl FnOnce(&mut Vec<EpisodeRecord>)) -> String {
    let mut records = records(&[40, 30, 20]);
    change(&mut records);
    let findings = checked(&records).findings;
    let lines: Vec<_> = findings.into_iter().map(|it| it.words).collect();
    lines.join("\n")
}

/// Sets a channel of every observation.
fn column(record: &mut EpisodeRecord, channel: usize, value: impl Fn(usize) -> f32) {
    let rows = record.observations.chunks_exact_mut(WIDTH).enumerate();
    rows.for_each(|(step, row)| row[channel] = value(step));
}

#[test]
fn of_logs_without_a_fault_only_what_nobody_declared_is_said() {
    let check = checked(&records(&[40, 40, 40]));
    let [finding] = check.findings.as_slice() else {
        panic!("{:?}", check.findings);
    };
    assert_eq!(finding.grade, Grade::Note);
    assert!(finding.words.starts_with("no robot is declared"));
    assert_eq!(check.period_us, None);
    assert_eq!(check.episodes.steps, [40; 3]);
    assert_eq!(
        (check.episodes.terminated, check.episodes.truncated),
        (1, 2)
    );
    assert_eq!(check.episodes.successes, 2);
    assert_eq!(check.episodes.beginnings, 3);
}

#[test]
fn what_is_said_of_a_channel_is_what_a_hand_counts() {
    let mut logs = records(&[40, 40]);
    for record in &mut logs {
        // Four steps at 0, then up by a quarter, and ten frames at the top.
        column(record, 1, |step| (step as f32 - 3.0).clamp(0.0, 28.0) / 4.0);
        column(record, 2, |_| -3.0);
    }
    let check = checked(&logs);
    let moves = &check.observations[1].moves;
    assert_eq!((moves.low, moves.high), (0.0, 7.0));
    assert_eq!(moves.resolution, Some(0.25));
    assert_eq!(moves.constant, 12.0 / 40.0);
    // Four frames at the bottom and ten at the top of 41.
    assert_eq!(moves.saturated, 14.0 / 41.0);
    assert_eq!(check.observations[1].divisor_by, Decides::Deviation);
    let rests = &check.observations[2];
    assert_eq!((rests.moves.resolution, rests.moves.constant), (None, 1.0));
    assert_eq!(
        (rests.divisor_by, rests.guard_by),
        (Decides::Floor, Decides::Floor)
    );
    let rest = "1 of 7 channels of an observation never change, so nothing is learned from them: observation_2";
    assert!(check.findings.iter().any(|it| it.words == rest));
}

#[test]
fn a_glitch_is_named_with_episode_observation_value_and_what_is_usual() {
    let mut logs = records(&[40, 30, 20]);
    logs[1].observations[7 * WIDTH + 2] = 1e6;
    let check = checked(&logs);
    let words = &check.findings[0].words;
    let start =
        "1 glitch: the first is 1.000e6 in observation_2 of episode 1, observation 7, where ";
    assert!(words.starts_with(start), "{words}");
    assert_eq!(check.observations[2].glitches, 1);
    assert!(check.observations[2].moves.high <= 1.0);
    let away = check.glitches[0].deviations.unwrap();
    assert!((1e6..1e7).contains(&away), "{away}");
}

#[test]
fn logs_without_rewards_are_for_a_person_and_that_comes_first() {
    let text = said(|logs| {
        for record in logs.iter_mut() {
            record.rewards.fill(0.5);
        }
        logs[0].observations[7 * WIDTH] = 1e6;
    });
    let start = "no rewards (each is 0.5): nobody but a person can answer, with `ted ask`";
    assert!(text.starts_with(start), "{text}");
}

#[test]
fn episodes_that_are_there_twice_begin_alike_or_stop_without_a_flag_are_said() {
    let text = said(|logs| logs.push(logs[1].clone()));
    assert!(text.contains("episodes 1, 3 are the same"), "{text}");
    let text = said(|logs| {
        for record in logs {
            record.observations[..WIDTH].fill(0.25);
            record.truncations.fill(false);
        }
    });
    assert!(
        text.contains("all episodes begin with the same observation"),
        "{text}"
    );
    assert!(
        text.contains("2 episodes end without a termination"),
        "{text}"
    );
    assert!(text.contains("episodes have 20 to 40 steps"), "{text}");
    let text = said(|logs| logs.truncate(1));
    assert!(
        text.contains("one episode: there is no other one"),
        "{text}"
    );
}

#[test]
fn actions_that_never_change_or_are_cut_off_are_said() {
    let width = SHAPE.action;
    let text = said(|logs| {
        for row in logs
            .iter_mut()
            .flat_map(|it| it.actions.chunks_exact_mut(width))
        {
            row[0] = 0.5;
            row[1] = if row[1] > 0.6 { 1.0 } else { row[1].max(-0.9) };
            row[2] = 1.0_f32.copysign(row[2]);
        }
        let first = logs[2].actions[..width].to_vec();
        logs[2].actions = first.repeat(20);
    });
    assert!(
        text.contains("the action action_0 is always 0.5000"),
        "{text}"
    );
    assert!(
        text.contains("the action action_2 is at an end of its range in"),
        "{text}"
    );
    assert!(!text.contains("the action action_1"), "{text}");
    assert!(
        text.contains("in 1 episode every action is the same: 2"),
        "{text}"
    );
}

#[test]
fn a_few_values_that_decide_a_range_are_said() {
    let mut logs = records(&[1500, 1500]);
    for step in 100..103 {
        logs[0].observations[step * WIDTH + 4] = 15.0;
    }
    let check = checked(&logs);
    assert_eq!(check.glitches.len(), 0);
    assert_eq!(check.observations[4].guard_by, Decides::Outliers);
    let words = &check.findings[0].words;
    assert!(words.starts_with("observation_4 is within -"), "{words}");
}

#[test]
fn neither_a_glitch_nor_the_unit_shows_in_what_a_guard_accepts() {
    let logs = records(&[40, 30, 20]);
    let guards = |logs: &[EpisodeRecord]| {
        let check = checked(logs);
        let guards = check.observations.iter().map(|it| it.guard.unwrap());
        guards.collect::<Vec<_>>()
    };
    let clean = guards(&logs);
    let mut broken = logs.clone();
    let glitch = &mut broken[1].observations[7 * WIDTH + 2];
    assert!(
        glitch.abs() < 0.9,
        "inside of what the others are: {glitch}"
    );
    *glitch = 1e6;
    assert_eq!(guards(&broken), clean);
    let scaled = |factor: f32| {
        let mut logs = logs.clone();
        for record in &mut logs {
            column(record, 3, |_| 5.0);
            record.observations.iter_mut().for_each(|x| *x *= factor);
        }
        guards(&logs)
    };
    let (metres, larger) = (scaled(1.0), scaled(2.0_f32.powi(-17)));
    let back: Vec<_> = larger
        .iter()
        .map(|ends| ends.map(|x| x * 131_072.0))
        .collect();
    assert_eq!(back, metres, "to the bit");
    // One that rests may tremble by a thousandth of what it is.
    assert_eq!(metres[3], [4.995, 5.005]);
}
