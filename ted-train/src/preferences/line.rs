//! One line of the preference log, as it stands there: its dataset may not be at hand.
//!
//! ```json
//! {"dataset":"ted/x-v0","digest":"9f...","round":0,"member":3,"segments":[{"episode":4,"start":120,"length":50},
//!  {"episode":9,"start":7,"length":50}],"answer":0.5,"by":"teacher:true-return"}
//! ```
//! (on one line). `answer` is the label: 0 when the first segment is better, 1 when the second is, 0.5 when they are equal, and
//! null when whoever was asked could not tell: then another question was asked in its place. With `"later":true` beside it they
//! only put the question off, and it may be asked again after others. The first segment is the one that was shown on the left.
//! `member` is the reward-ensemble member that asked for itself alone, and null for a question shared by all. A strategy that has
//! a reason for its question says it in `why`; otherwise there is no such field. `at` is when the answer was given, in words of
//! whoever wrote it down; simulated teachers give none, so that a run is the same whenever it is made.

use std::fmt;

use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::Number;

use super::{Answer, Context, LogEntry, Query, Question, Said};
use crate::dataset::{Dataset, Segment, SegmentError};

/// A line of a log.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Line {
    /// Id of the dataset that was asked about.
    pub dataset: String,
    /// Its digest.
    pub digest: String,
    /// The round of questions.
    pub round: u32,
    /// The ensemble member that asked for itself alone.
    pub member: Option<u32>,
    /// The two clips, in the order in which they were shown.
    pub segments: [Span; 2],
    /// Why this was asked of all things.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub why: Option<String>,
    /// The answer; none when whoever was asked could not tell.
    #[serde(serialize_with = "label", deserialize_with = "answer")]
    pub answer: Option<Answer>,
    /// Whether the question was put off; beside an answer it says nothing.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub later: bool,
    /// Who was asked.
    pub by: String,
    /// When the answer was given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub at: Option<String>,
}

/// Consecutive steps of an episode that a dataset may have or not.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Span {
    /// The episode.
    pub episode: u32,
    /// Its first step.
    pub start: u32,
    /// Its number of steps.
    pub length: u32,
}

impl From<Segment> for Span {
    fn from(segment: Segment) -> Self {
        Self {
            episode: segment.episode(),
            start: segment.start(),
            length: segment.len(),
        }
    }
}

impl Span {
    /// The same clip, if the dataset has it.
    ///
    /// # Errors
    /// When it has not.
    pub fn of(self, dataset: &Dataset) -> Result<Segment, SegmentError> {
        Segment::new(dataset, self.episode, self.start, self.length)
    }
}

impl fmt::Display for Span {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let end = u64::from(self.start) + u64::from(self.length);
        write!(f, "episode {} steps {}..{end}", self.episode, self.start)
    }
}

/// Why a line says nothing about a dataset.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Misfit {
    /// It is about another one.
    #[error("it is about {logged}, and this is {actual}")]
    OtherDataset {
        /// Id and digest of the dataset in the line.
        logged: String,
        /// Id and digest of the dataset at hand.
        actual: String,
    },
    /// It is about steps that the dataset does not have.
    #[error(transparent)]
    Segment(#[from] SegmentError),
}

impl Line {
    /// The line that stands for a question about this dataset and what was said to it.
    #[must_use]
    pub fn new(dataset: &Dataset, LogEntry { question, said }: &LogEntry) -> Self {
        Self {
            dataset: dataset.id().into(),
            digest: dataset.digest().into(),
            round: question.context.round,
            member: question.context.member,
            segments: question.query.segments.map(Span::from),
            why: question.why.clone(),
            answer: said.answer,
            later: said.later,
            by: said.by.clone(),
            at: said.at.clone(),
        }
    }

    /// Its text, without an end of line.
    ///
    /// # Panics
    /// Never: strings and numbers always serialise.
    #[must_use]
    pub fn text(&self) -> String {
        serde_json::to_string(self).expect("strings and numbers always serialise")
    }

    /// The question on this dataset, and what was said.
    ///
    /// # Errors
    /// When the line is about another dataset, or about steps that this one does not have.
    pub fn entry(&self, dataset: &Dataset) -> Result<LogEntry, Misfit> {
        if self.digest != dataset.digest() {
            return Err(Misfit::OtherDataset {
                logged: identity(&self.dataset, &self.digest),
                actual: identity(dataset.id(), dataset.digest()),
            });
        }
        let [first, second] = self.segments;
        let question = Question {
            context: Context {
                round: self.round,
                member: self.member,
            },
            query: Query {
                segments: [first.of(dataset)?, second.of(dataset)?],
            },
            why: self.why.clone(),
        };
        let said = self.said();
        Ok(LogEntry { question, said })
    }

    /// What was said.
    #[must_use]
    pub fn said(&self) -> Said {
        Said {
            answer: self.answer,
            later: self.puts_off(),
            by: self.by.clone(),
            at: self.at.clone(),
        }
    }

    /// Whether it puts the question off.
    #[must_use]
    pub fn puts_off(&self) -> bool {
        self.later && self.answer.is_none()
    }

    /// What it says of these two clips, in this order; none when it is about others.
    #[must_use]
    pub fn about(&self, [first, second]: [Span; 2]) -> Option<Option<Answer>> {
        if self.segments == [first, second] {
            Some(self.answer)
        } else if self.segments == [second, first] {
            Some(self.answer.map(Answer::turned))
        } else {
            None
        }
    }
}

fn identity(id: &str, digest: &str) -> String {
    format!("the dataset {id} with digest {digest}")
}

fn label<S: Serializer>(answer: &Option<Answer>, to: S) -> Result<S::Ok, S::Error> {
    let number = answer.map(|answer| match answer {
        Answer::First => 0.into(),
        Answer::Second => 1.into(),
        Answer::Equal => Number::from_f64(0.5).expect("0.5 is finite"),
    });
    number.serialize(to)
}

/// A label or null, but not nothing at all: a line without an answer is a mistake and nobody's word.
fn answer<'de, D: Deserializer<'de>>(from: D) -> Result<Option<Answer>, D::Error> {
    let Some(number) = Option::<Number>::deserialize(from)? else {
        return Ok(None);
    };
    let answer = number.as_f64().and_then(Answer::from_label);
    answer.map(Some).ok_or_else(|| {
        D::Error::custom(format!(
            "the answer {number} is not 0 (first better), 1 (second better), 0.5 (equal) or null (whoever was asked could not tell)"
        ))
    })
}
