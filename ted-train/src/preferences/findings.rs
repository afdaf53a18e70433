//! What is worth knowing of answers before hours are spent on them.

use serde::Serialize;

use super::account::listed;
use super::hearing::hear;
use super::{Answer, Numbered};

/// So many answers that all name the same side are no coincidence, where sides are drawn at random.
const ONE_SIDED: usize = 5;

/// Something that may not be meant.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Finding {
    /// What kind of thing.
    pub kind: FindingKind,
    /// The lines that it is about.
    pub lines: Vec<usize>,
    /// The same in words.
    pub says: String,
}

/// Kinds of findings.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum FindingKind {
    /// Answers to one question that are not the same.
    Contradiction,
    /// The same side everywhere.
    OneSide,
    /// Ties everywhere.
    AllTies,
    /// No answer at all.
    NoAnswer,
}

/// What these lines may not mean.
#[must_use]
pub fn findings(lines: &[Numbered]) -> Vec<Finding> {
    let mut found = contradictions(lines);
    let answers: Vec<Answer> = lines.iter().filter_map(|it| it.line.answer).collect();
    let all = |answer| answers.iter().all(|it| *it == answer);
    let count = answers.len();
    let side = |which: &str| {
        format!(
            "all {count} answers say that the {which} clip is better: was the side that it was shown on meant, or what it showed?"
        )
    };
    let everywhere = if lines.is_empty() {
        None
    } else if answers.is_empty() {
        Some((
            FindingKind::NoAnswer,
            "no line has an answer, and nothing can be learned from them".to_owned(),
        ))
    } else if count > 1 && all(Answer::Equal) {
        let says = format!("all {count} answers are ties, and nothing can be learned from them");
        Some((FindingKind::AllTies, says))
    } else if count >= ONE_SIDED && all(Answer::First) {
        Some((FindingKind::OneSide, side("first")))
    } else if count >= ONE_SIDED && all(Answer::Second) {
        Some((FindingKind::OneSide, side("second")))
    } else {
        None
    };
    found.extend(everywhere.map(|(kind, says)| Finding {
        kind,
        lines: lines.iter().map(|it| it.number).collect(),
        says,
    }));
    found
}

/// Pairs of clips to which different answers were given, each where it is first asked about.
fn contradictions(lines: &[Numbered]) -> Vec<Finding> {
    let mut found = Vec::new();
    for (index, first) in lines.iter().enumerate() {
        let clips = first.line.segments;
        let same = |other: &&Numbered| {
            other.line.digest == first.line.digest
                && other.line.about(clips).is_some()
                && !other.line.puts_off()
        };
        if lines[..index].iter().any(|other| same(&other)) {
            continue;
        }
        let about: Vec<Numbered> = lines[index..].iter().filter(same).cloned().collect();
        let mut said: Vec<Answer> = about
            .iter()
            .filter_map(|it| it.line.about(clips)?)
            .collect();
        said.dedup();
        if said.len() < 2 {
            continue;
        }
        let numbers: Vec<usize> = about.iter().map(|it| it.number).collect();
        let Some(heard) = hear(&about, clips, 0) else {
            continue;
        };
        let counts = match heard.said.answer {
            Some(Answer::First) => "the first is better",
            Some(Answer::Second) => "the second is better",
            Some(Answer::Equal) => "they are equal",
            None => "whoever was asked could not tell",
        };
        let why = match heard.lines.as_slice() {
            &[only] => format!(
                "{} counts, the first of {}",
                listed(&[numbers[only]]),
                heard.said.by
            ),
            _ => format!("{} are counted together", heard.said.by),
        };
        let [one, other] = clips;
        found.push(Finding {
            kind: FindingKind::Contradiction,
            says: format!(
                "{} contradict each other about {one} or {other}; a run that asks once is told that {counts}: {why}",
                listed(&numbers)
            ),
            lines: numbers,
        });
    }
    found
}
