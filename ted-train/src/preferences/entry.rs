//! A question that was asked, and what was said: what a run remembers of an answer.

use super::{Answer, Question};

/// Which part of the procedure asks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Context {
    /// The round of questions, 0 for the initial ones.
    pub round: u32,
    /// The ensemble member that asks for itself alone; none when all share the answer.
    pub member: Option<u32>,
}

/// What was said to a question.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Said {
    /// The answer; none when whoever was asked could not tell.
    pub answer: Option<Answer>,
    /// Whether there is no answer because the question was put off.
    pub later: bool,
    /// Who was asked.
    pub by: String,
    /// When, as whoever wrote it down put it; none where nobody did.
    pub at: Option<String>,
}

/// A question that was asked, and what was said.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LogEntry {
    /// The question.
    pub question: Question,
    /// What was said to it.
    pub said: Said,
}

impl LogEntry {
    /// Whether both are about the same two clips, whichever was shown first, and have answers that differ.
    #[must_use]
    pub fn contradicts(&self, other: &Self) -> bool {
        let [own, others] = [self, other].map(|it| it.question.query.segments);
        let turned = others != own;
        let of_other = other
            .said
            .answer
            .map(|it| if turned { it.turned() } else { it });
        let about = self.question.query.is_about(others);
        about
            && self
                .said
                .answer
                .zip(of_other)
                .is_some_and(|(own, it)| own != it)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dataset::fixtures::{SHAPE, records};
    use crate::dataset::{Dataset, Segment};
    use crate::preferences::Query;

    #[test]
    fn answers_contradict_each_other_about_the_same_clips_alone_whichever_was_shown_first() {
        let dataset = Dataset::from_records("ted/x-v0", SHAPE, &records(&[9, 9, 9])).unwrap();
        let entry = |episodes: [u32; 2], answer| LogEntry {
            question: Question {
                context: Context {
                    round: 0,
                    member: None,
                },
                query: Query {
                    segments: episodes.map(|it| Segment::new(&dataset, it, 0, 9).unwrap()),
                },
                why: None,
            },
            said: Said {
                answer,
                later: false,
                by: "me".to_owned(),
                at: None,
            },
        };
        let (first, second) = (Some(Answer::First), Some(Answer::Second));
        let own = entry([0, 1], first);
        for (episodes, answer, contradicts) in [
            ([0, 1], second, true),
            ([1, 0], first, true),
            ([0, 1], Some(Answer::Equal), true),
            ([0, 1], first, false),
            ([1, 0], second, false),
            ([0, 1], None, false),
            ([0, 2], second, false),
        ] {
            let other = entry(episodes, answer);
            assert_eq!(own.contradicts(&other), contradicts, "{other:?}");
            assert_eq!(other.contradicts(&own), contradicts, "{other:?}");
        }
    }
}
