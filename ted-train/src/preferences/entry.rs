//! One line of the preference log.
//!
//! ```json
//! {"dataset":"ted/x-v0","digest":"9f...","round":0,"member":3,"segments":[{"episode":4,"start":120,"length":50},
//!  {"episode":9,"start":7,"length":50}],"answer":0.5,"by":"teacher:true-return"}
//! ```
//! (on one line). `answer` is the label: 0 when the first segment is better, 1 when the second is, 0.5 when they are equal.
//! `member` is the reward-ensemble member that asked for itself alone, and null for a question shared by all.

use super::{Answer, Query};
use crate::dataset::{Dataset, Segment, SegmentError};
use serde::{Deserialize, Serialize};

/// Which part of the procedure asks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Context {
    /// The round of questions, 0 for the initial ones.
    pub round: u32,
    /// The ensemble member that asks for itself alone; none when all share the answer.
    pub member: Option<u32>,
}

/// A question that was asked, and its answer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LogEntry {
    /// Which part of the procedure asked.
    pub context: Context,
    /// The question.
    pub query: Query,
    /// The answer.
    pub answer: Answer,
    /// Who answered.
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
    pub answer: serde_json::Number,
    by: String,
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct LineSegment {
    episode: u32,
    start: u32,
    length: u32,
}

impl Line {
    /// The line that stands for `entry`.
    pub(super) fn new(dataset: &Dataset, entry: &LogEntry) -> Self {
        Self {
            dataset: dataset.id().into(),
            digest: dataset.digest().into(),
            round: entry.context.round,
            member: entry.context.member,
            segments: entry.query.segments.map(|segment| LineSegment {
                episode: segment.episode(),
                start: segment.start(),
                length: segment.len(),
            }),
            answer: match entry.answer {
                Answer::First => 0.into(),
                Answer::Second => 1.into(),
                Answer::Equal => serde_json::Number::from_f64(0.5).expect("0.5 is finite"),
            },
            by: entry.by.clone(),
        }
    }

    /// The line's text with its end.
    pub(super) fn text(&self) -> String {
        let mut text = serde_json::to_string(self).expect("strings and numbers always serialise");
        text.push('\n');
        text
    }

    /// The answer, or the number that is none.
    pub(super) fn answer(&self) -> Result<Answer, f64> {
        let label = self.answer.as_f64().unwrap_or(f64::NAN);
        Answer::from_label(label).ok_or(label)
    }

    /// The question, on the dataset that the line names.
    pub(super) fn query(&self, dataset: &Dataset) -> Result<Query, SegmentError> {
        let segment = |segment: LineSegment| {
            Segment::new(dataset, segment.episode, segment.start, segment.length)
        };
        let [first, second] = self.segments;
        Ok(Query {
            segments: [segment(first)?, segment(second)?],
        })
    }

    /// Which part of the procedure asked, and who answered.
    pub(super) fn context(self) -> (Context, String) {
        (
            Context {
                round: self.round,
                member: self.member,
            },
            self.by,
        )
    }
}
