//! A teacher that says aloud what it is asked about whole episodes, why, and what it answers.

use firmware_sim::progress::Audience;

use crate::dataset::Dataset;
use crate::preferences::{Answer, LogEntry, PreferenceError, Query, Question, Said, Teacher};

/// Passes questions on to another teacher, and tells a person of each.
pub(super) struct Narrator<T> {
    teacher: T,
    audience: Audience,
    asked: u32,
}

impl<T: Teacher> Narrator<T> {
    pub(super) fn new(teacher: T, audience: Audience) -> Self {
        Self {
            teacher,
            audience,
            asked: 0,
        }
    }

    /// Questions that came here; those that a log answers do not.
    pub(super) fn asked(&self) -> u32 {
        self.asked
    }
}

impl<T: Teacher> Teacher for Narrator<T> {
    fn answer(
        &mut self,
        dataset: &Dataset,
        asked: &[LogEntry],
        question: &Question,
    ) -> Result<Said, PreferenceError> {
        let said = self.teacher.answer(dataset, asked, question)?;
        self.asked += 1;
        let number = asked.len() + 1;
        let line = sentence(dataset, &question.query, said.answer);
        self.audience
            .note(&format!("  question {number:>2}: {line}"));
        if let Some(why) = &question.why {
            self.audience
                .note(&format!("               asked because {why}"));
        }
        Ok(said)
    }
}

fn sentence(dataset: &Dataset, query: &Query, answer: Option<Answer>) -> String {
    let [first, second] = query
        .segments
        .map(|segment| format!("episode {}", segment.episode()));
    let [first_return, second_return] = query.segments.map(|segment| segment.return_true(dataset));
    let verdict = match answer {
        Some(Answer::First) => "the first is better",
        Some(Answer::Second) => "the second is better",
        Some(Answer::Equal) => "they are equal",
        None => "nobody can tell",
    };
    format!(
        "{first} or {second}? {verdict} (true returns {first_return:.1} and {second_return:.1})"
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dataset::Segment;
    use crate::dataset::fixtures::{SHAPE, records};
    use crate::preferences::{Context, ScriptedTeacher};

    #[test]
    fn the_narrator_answers_as_its_teacher_and_says_what_was_asked() {
        let mut episodes = records(&[4, 4]);
        episodes[0].rewards = vec![1.0, 1.0, 2.0, 0.25];
        episodes[1].rewards = vec![2.0, 0.0, 3.0, 0.0];
        let dataset = Dataset::from_records("ted/x-v0", SHAPE, &episodes).unwrap();
        let whole = |episode| Segment::new(&dataset, episode, 0, 4).unwrap();
        let query = Query {
            segments: [whole(0), whole(1)],
        };
        let context = Context {
            round: 0,
            member: None,
        };
        let question = Question {
            context,
            query,
            why: None,
        };
        let mut narrator = Narrator::new(ScriptedTeacher::truthful(), Audience::Nobody);
        let said = narrator.answer(&dataset, &[], &question).unwrap();
        assert_eq!(said.by, "teacher:true-return");
        let answer = said.answer;
        assert_eq!((answer, narrator.asked()), (Some(Answer::Second), 1));
        assert_eq!(
            sentence(&dataset, &query, answer),
            "episode 0 or episode 1? the second is better (true returns 4.2 and 5.0)"
        );
    }
}
