//! One line of the preference log.
//!
//! ```json
//! {"dataset":"ted/x-v0","digest":"9f...","round":0,"member":3,"segments":[{"episode":4,"start":120,"length":50},
//!  {"episode":9,"start":7,"length":50}],"answer":0.5,"by":"teacher:true-return"}
//! ```
//! (on one line). `answer` is the label: 0 when the first segment is better, 1 when the second is, 0.5 when they are equal, and
//! null when whoever was asked could not tell: then another question was asked in its place. With `"later":true` beside it they
//! only put the question off, and it may be asked again after others. The first segment is the one that was shown on the left.
//! `member` is the reward-ensemble member that asked for itself alone, and null for a question shared by all. A strategy that has
//! a reason for its question says it in `why`; otherwise there is no such field.

use super::{Answer, Query, Question};
use crate::dataset::{Dataset, Segment, SegmentError};
use serde::{Deserialize, Deserializer, Serialize};
use serde_json::Number;

/// Which part of the procedure asks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Context {
    /// The round of questions, 0 for the initial ones.
    pub round: u32,
    /// The ensemble member that asks for itself alone; none when all share the answer.
    pub member: Option<u32>,
}

/// A question that was asked, and what was said.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LogEntry {
    /// The question.
    pub question: Question,
    /// The answer; none when whoever was asked could not tell.
    pub answer: Option<Answer>,
    /// Whether there is no answer because the question was put off.
    pub later: bool,
    /// Who was asked.
    pub by: String,
}

/// The JSON object of a line.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Line {
    pub dataset: String,
    pub digest: String,
    round: u32,
    member: Option<u32>,
    segments: [LineSegment; 2],
    #[serde(default, skip_serializing_if = "Option::is_none")]
    why: Option<String>,
    #[serde(deserialize_with = "written")]
    answer: Option<Number>,
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub later: bool,
    by: String,
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct LineSegment {
    episode: u32,
    start: u32,
    length: u32,
}

/// A number or null, but not nothing at all: a line without an answer is a mistake and nobody's word.
fn written<'de, D: Deserializer<'de>>(from: D) -> Result<Option<Number>, D::Error> {
    Option::deserialize(from)
}

impl Line {
    /// The line that stands for `entry`.
    pub(super) fn new(dataset: &Dataset, entry: &LogEntry) -> Self {
        let Question {
            context,
            query,
            why,
        } = &entry.question;
        Self {
            dataset: dataset.id().into(),
            digest: dataset.digest().into(),
            round: context.round,
            member: context.member,
            segments: query.segments.map(|segment| LineSegment {
                episode: segment.episode(),
                start: segment.start(),
                length: segment.len(),
            }),
            why: why.clone(),
            answer: entry.answer.map(|answer| match answer {
                Answer::First => 0.into(),
                Answer::Second => 1.into(),
                Answer::Equal => Number::from_f64(0.5).expect("0.5 is finite"),
            }),
            later: entry.later,
            by: entry.by.clone(),
        }
    }

    /// The line's text, without its end.
    pub(super) fn text(&self) -> String {
        serde_json::to_string(self).expect("strings and numbers always serialise")
    }

    /// The answer, if there is one, or the number that is none.
    pub(super) fn answer(&self) -> Result<Option<Answer>, f64> {
        let answer = self.answer.as_ref().map(|number| {
            let label = number.as_f64().unwrap_or(f64::NAN);
            Answer::from_label(label).ok_or(label)
        });
        answer.transpose()
    }

    /// The question, on the dataset that the line names, and who was asked.
    pub(super) fn question(self, dataset: &Dataset) -> Result<(Question, String), SegmentError> {
        let segment = |segment: LineSegment| {
            Segment::new(dataset, segment.episode, segment.start, segment.length)
        };
        let [first, second] = self.segments;
        let question = Question {
            context: Context {
                round: self.round,
                member: self.member,
            },
            query: Query {
                segments: [segment(first)?, segment(second)?],
            },
            why: self.why,
        };
        Ok((question, self.by))
    }
}
