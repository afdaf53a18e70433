//! What became of every line of a file of answers: which question it answered, or why it answered none.

use serde::{Deserialize, Serialize};

use super::hearing::hear;
use super::{LogEntry, Numbered, Query, Span};

/// What became of a line.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Use {
    /// The line, counted from 1.
    pub line: usize,
    /// The numbers of the questions that it answered, counted from 1.
    pub questions: Vec<usize>,
    /// Why it answered none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub why_not: Option<String>,
}

/// What became of these lines in a run that has asked these questions, or is about to ask more.
#[must_use]
pub fn account(lines: &[Numbered], asked: &[LogEntry]) -> Vec<Use> {
    let mut questions = vec![Vec::new(); lines.len()];
    for (index, entry) in asked.iter().enumerate() {
        let before = times(&asked[..index], &entry.question.query);
        let heard = hear(lines, clips(&entry.question.query), before);
        for line in heard.into_iter().flat_map(|heard| heard.lines) {
            questions[line].push(index + 1);
        }
    }
    let why_not = |own: &Numbered| {
        let same = |other: &&Numbered| {
            other.line.by == own.line.by && other.line.about(own.line.segments).is_some()
        };
        let says = |it: &Numbered| (it.line.about(own.line.segments), it.line.puts_off());
        let is_asked = |entry: &LogEntry| own.line.about(clips(&entry.question.query)).is_some();
        let earlier = lines.iter().take_while(|other| other.number < own.number);
        match earlier.filter(same).last() {
            Some(first) if says(first) == says(own) => {
                format!("{} says the same in line {}", own.line.by, first.number)
            }
            Some(first) => format!(
                "{} says something else in line {}, and the run asks no more often",
                own.line.by, first.number
            ),
            None if asked.iter().any(is_asked) => {
                "the question was put off, and the run asks no more often".to_owned()
            }
            None => "the run does not ask about its two clips".to_owned(),
        }
    };
    let of_line = |(own, questions): (&Numbered, Vec<usize>)| Use {
        line: own.number,
        why_not: questions.is_empty().then(|| why_not(own)),
        questions,
    };
    lines.iter().zip(questions).map(of_line).collect()
}

/// An account in words, reasons and the lines that they are of.
#[must_use]
pub fn in_words(account: &[Use]) -> String {
    let used = account.iter().filter(|it| it.why_not.is_none()).count();
    let mut reasons: Vec<(&str, Vec<usize>)> = Vec::new();
    for it in account {
        let Some(why) = it.why_not.as_deref() else {
            continue;
        };
        match reasons.iter_mut().find(|(known, _)| *known == why) {
            Some((_, lines)) => lines.push(it.line),
            None => reasons.push((why, vec![it.line])),
        }
    }
    let mut words = format!("{used} of {} lines are used", account.len());
    for (why, lines) in reasons {
        words.push_str(&format!("; not {}: {why}", listed(&lines)));
    }
    words
}

/// Lines by their numbers, runs of them as one: `line 3`, or `lines 3, 5 to 9`.
pub(super) fn listed(lines: &[usize]) -> String {
    let mut runs: Vec<(usize, usize)> = Vec::new();
    for &line in lines {
        match runs.last_mut() {
            Some((_, last)) if *last + 1 == line => *last = line,
            _ => runs.push((line, line)),
        }
    }
    let text = |&(first, last): &(usize, usize)| match last - first {
        0 => first.to_string(),
        1 => format!("{first}, {last}"),
        _ => format!("{first} to {last}"),
    };
    let text: Vec<String> = runs.iter().map(text).collect();
    let noun = if lines.len() == 1 { "line" } else { "lines" };
    format!("{noun} {}", text.join(", "))
}

/// How often the two clips of a query are among these questions, whichever was shown first.
pub(super) fn times(asked: &[LogEntry], query: &Query) -> usize {
    let same = |entry: &&LogEntry| entry.question.query.is_about(query.segments);
    asked.iter().filter(same).count()
}

/// The clips of a query, as lines name them.
pub(super) fn clips(query: &Query) -> [Span; 2] {
    query.segments.map(Span::from)
}
