//! What the answers did so far, as somebody is told who asks.

use serde::Serialize;

use super::words::{filled, said_line, word};
use crate::preferences::LogEntry;
use crate::reward::{Ranked, Standing};

/// Episodes of the best, and of the worst, that are shown.
const SHOWN: usize = 5;

/// What the answers did.
#[derive(Clone, Debug, PartialEq)]
pub struct Did {
    /// How sure it is and how far the ranking moved; or why nobody can say.
    pub says: Vec<String>,
    /// Episodes that are held to be good and bad: the best and the worst of all, the next ones, and so on. None where nobody can say.
    pub pairs: Vec<[Ranked; 2]>,
    /// Answers that do not go with the others.
    pub odd: Vec<Odd>,
}

/// An answer that does not go with the others.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Odd {
    /// Its place in the log.
    pub place: usize,
    /// What was said, and what says otherwise.
    pub says: String,
}

impl Did {
    /// What these answers did, by what the learner says of them.
    #[must_use]
    pub fn of(said: &[LogEntry], standing: Option<&Standing>) -> Self {
        let odd = odd(said, standing.map_or(&[], |it| &it.slips));
        match standing {
            None => Self {
                says: vec![word("did-unknown").to_owned()],
                pairs: Vec::new(),
                odd,
            },
            Some(standing) => Self {
                says: vec![sure(standing), moved(standing)],
                pairs: pairs(&standing.ranking),
                odd,
            },
        }
    }
}

/// The best and the worst, no episode twice.
fn pairs(ranking: &[Ranked]) -> Vec<[Ranked; 2]> {
    let shown = SHOWN.min(ranking.len() / 2);
    let best = ranking.iter().take(shown).copied();
    let worst = ranking.iter().rev().take(shown).copied();
    best.zip(worst).map(<[Ranked; 2]>::from).collect()
}

/// The learner's own words as a sentence.
fn sure(standing: &Standing) -> String {
    let words = standing.confidence.in_words();
    let mut rest = words.chars();
    let first = rest.next().into_iter().flat_map(char::to_uppercase);
    first.chain(rest).chain(['.']).collect()
}

/// How far the answers moved the ranking.
fn moved(standing: &Standing) -> String {
    /// From here on down it moved somewhat, and much.
    const SOMEWHAT: f64 = 0.95;
    const MUCH: f64 = 0.7;
    let answers = standing.confidence.answers;
    let Some(like_before) = standing.like_before else {
        return word("did-no-order").to_owned();
    };
    if answers == 0 {
        return word("did-no-answer").to_owned();
    }
    let how = match like_before {
        much if much < MUCH => "did-much",
        somewhat if somewhat < SOMEWHAT => "did-somewhat",
        _ => "did-hardly",
    };
    // Else a small negative number is said as -0.00.
    let rounded = (100.0 * like_before).round() / 100.0 + 0.0;
    let values = [
        ("answers", answers.to_string()),
        ("how", word(how).to_owned()),
        ("correlation", format!("{rounded:.2}")),
    ];
    filled(
        "did-moved",
        &values.each_ref().map(|(key, value)| (*key, value.as_str())),
    )
}

/// Answers to the same two clips that differ, and those that are held to be slips.
fn odd(said: &[LogEntry], slips: &[usize]) -> Vec<Odd> {
    let why = |(place, entry): (usize, &LogEntry)| {
        let other = said.iter().position(|it| it.contradicts(entry));
        let why = match other {
            Some(other) => filled("odd-differs", &[("other", &(other + 1).to_string())]),
            None if slips.contains(&place) => word("odd-slip").to_owned(),
            None => return None,
        };
        let says = format!("{}. {why}", said_line(entry));
        Some(Odd { place, says })
    };
    said.iter().enumerate().filter_map(why).collect()
}

#[cfg(test)]
#[path = "did_tests.rs"]
mod tests;
