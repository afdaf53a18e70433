//! What is odd about a dataset, in plain words, the worst first.

use serde::Serialize;

use super::{ActionCheck, Check, ObservationCheck};

/// How bad it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Grade {
    /// Something that a person may want to do will be refused.
    Stops,
    /// What is learned may not be what was meant.
    Doubtful,
    /// Worth knowing.
    Note,
}

/// Something odd.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Finding {
    /// How bad it is.
    pub grade: Grade,
    /// What it is, and what to do about it.
    pub words: String,
}

/// Things of a kind that are named; of more, only how many there are.
const NAMED: usize = 3;

/// A channel of actions that is at an end of its range for more than this share of the steps has no room there.
const SATURATED: f64 = 0.5;

/// What is odd about it. `unflyable` is why no controller can fly a policy for it.
pub(super) fn findings(check: &Check, unflyable: Option<String>) -> Vec<Finding> {
    let episodes = &check.episodes;
    let count = check.dataset.episodes;
    let mut findings = Vec::new();
    let mut say = |grade, words: String| findings.push(Finding { grade, words });

    if let Some(why) = unflyable {
        say(Grade::Stops, format!("no controller can fly on it: {why}"));
    }
    if let Some(reward) = episodes.only_reward {
        say(
            Grade::Stops,
            format!(
                "no rewards (each is {reward}): nobody but a person can answer, with `ted ask` or `ted train --ask`, or in a file with \
                 --preferences"
            ),
        );
    }
    if count < 2 {
        say(
            Grade::Stops,
            "one episode: there is no other one to compare it with, so answers say nothing; record more".to_owned(),
        );
    }
    if let Some(first) = check.glitches.first() {
        let glitch = &first.glitch;
        let away = first.deviations.map_or_else(String::new, |it| {
            format!(", {:.0} deviations away", it.abs())
        });
        say(
            Grade::Doubtful,
            format!(
                "{}: the first is {} in {} of episode {}, observation {}, where {} is usual{away}. Nothing is learned from them; look \
                 at the sensor, since a controller stops there",
                counted(check.glitches.len(), "glitch", "glitches"),
                short(glitch.value),
                check.observations[glitch.channel].name,
                glitch.episode,
                glitch.step,
                short(glitch.usual),
            ),
        );
    }
    for channel in check.observations.iter().filter(|it| it.moves.outlying()) {
        let [low, high] = channel.moves.bulk.map(short);
        say(
            Grade::Note,
            format!(
                "{} is within {low} and {high} but for two values in a thousand, which reach from {} to {}: they decide its scale and \
                 what the guard accepts",
                channel.name,
                short(channel.moves.low),
                short(channel.moves.high),
            ),
        );
    }
    for group in episodes.duplicates.iter().take(NAMED) {
        say(
            Grade::Doubtful,
            format!(
                "episodes {} are the same: each counts again, so leave all but one out",
                listed(group)
            ),
        );
    }
    if let Some(more) = episodes
        .duplicates
        .len()
        .checked_sub(NAMED)
        .filter(|&it| it > 0)
    {
        say(
            Grade::Doubtful,
            format!("{more} more groups of episodes are the same"),
        );
    }
    let still = |it: &&ActionCheck| it.moves.low == it.moves.high;
    for channel in check.actions.iter().filter(still) {
        say(
            Grade::Doubtful,
            format!(
                "the action {} is always {}: a policy learns to send that",
                channel.name,
                short(channel.moves.low)
            ),
        );
    }
    for channel in check
        .actions
        .iter()
        .filter(|it| it.moves.saturated > SATURATED)
    {
        say(
            Grade::Doubtful,
            format!(
                "the action {} is at an end of its range in {:.0} % of the steps: either it switches, or its range was cut off",
                channel.name,
                100.0 * channel.moves.saturated
            ),
        );
    }
    if !episodes.constant_actions.is_empty() {
        say(
            Grade::Doubtful,
            format!(
                "in {} every action is the same: {}",
                counted(episodes.constant_actions.len(), "episode", "episodes"),
                listed(&episodes.constant_actions)
            ),
        );
    }
    if !check.robot_declared {
        say(
            Grade::Note,
            "no robot is declared: names, units, the period and what is sent on a fault are guesses; `ted robot draft` writes a file to \
             correct".to_owned(),
        );
    }
    let rest = |it: &&ObservationCheck| it.moves.low == it.moves.high;
    let resting: Vec<_> = check.observations.iter().filter(rest).collect();
    if !resting.is_empty() {
        let names: Vec<_> = resting.iter().map(|it| it.name.as_str()).collect();
        say(
            Grade::Note,
            format!(
                "{} of {} channels of an observation never change, so nothing is learned from them: {}",
                names.len(),
                check.observations.len(),
                listed(&names)
            ),
        );
    }
    if count > 1 && episodes.beginnings == 1 {
        say(
            Grade::Note,
            "all episodes begin with the same observation: a policy sees no other beginning"
                .to_owned(),
        );
    }
    if episodes.unflagged > 0 {
        say(
            Grade::Note,
            format!(
                "{} without a termination or a truncation at the last step: taken as the end of the recording",
                counted(episodes.unflagged, "episode ends", "episodes end")
            ),
        );
    }
    if let [shortest, _, longest] = episodes.steps
        && shortest != longest
    {
        say(
            Grade::Note,
            format!(
                "episodes have {shortest} to {longest} steps: presets that compare whole episodes by their sums need equal lengths"
            ),
        );
    }
    findings.sort_by_key(|it| it.grade);
    findings
}

/// So many of something.
fn counted(count: usize, one: &str, many: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { many })
}

/// The first of some things, and how many there are beside.
fn listed(things: &[impl ToString]) -> String {
    let named: Vec<_> = things.iter().take(NAMED).map(ToString::to_string).collect();
    let named = named.join(", ");
    match things.len().checked_sub(NAMED) {
        Some(more) if more > 0 => format!("{named} and {more} more"),
        _ => named,
    }
}

/// A number as people write it: four digits that count.
#[must_use]
pub fn short(value: f32) -> String {
    let size = value.abs();
    match size {
        0.0 => "0".to_owned(),
        _ if !(1e-3..1e5).contains(&size) => format!("{value:.3e}"),
        _ => {
            let digits = (3 - size.log10().floor() as i32).clamp(0, 6) as usize;
            format!("{value:.digits$}")
        }
    }
}
