//! Who is heard, what became of each line, and what is pointed out beforehand.

use super::*;
use crate::dataset::Dataset;
use crate::dataset::fixtures::{SHAPE, records};
use crate::preferences::account::account;
use crate::preferences::findings::{FindingKind, findings};
use crate::preferences::{Context, Line, LogEntry, Query, Question};

const FIRST: Option<Answer> = Some(Answer::First);
const SECOND: Option<Answer> = Some(Answer::Second);
const EQUAL: Option<Answer> = Some(Answer::Equal);

fn dataset() -> Dataset {
    Dataset::from_records("ted/x-v0", SHAPE, &records(&[9, 9, 9, 9, 9, 9])).unwrap()
}

fn whole(episode: u32) -> Span {
    Span {
        episode,
        start: 0,
        length: 9,
    }
}

/// Lines of a file: two episodes, an answer, and whose it is.
fn lines(said: &[(u32, u32, Option<Answer>, &str)]) -> Vec<Numbered> {
    let line = |(number, (first, second, answer, by)): (usize, &(u32, u32, _, &str))| Numbered {
        number,
        line: Line {
            dataset: "ted/x-v0".to_owned(),
            digest: dataset().digest().to_owned(),
            round: 0,
            member: None,
            segments: [whole(*first), whole(*second)],
            why: None,
            answer: *answer,
            later: false,
            by: (*by).to_owned(),
            at: None,
        },
    };
    (1..).zip(said).map(line).collect()
}

/// The same lines, of which those without an answer put the question off.
fn putting_off(mut lines: Vec<Numbered>) -> Vec<Numbered> {
    for it in &mut lines {
        it.line.later = it.line.answer.is_none();
    }
    lines
}

/// A question that a run has asked.
fn asked(first: u32, second: u32) -> LogEntry {
    let dataset = dataset();
    LogEntry {
        question: Question {
            context: Context {
                round: 0,
                member: None,
            },
            query: Query {
                segments: [first, second].map(|it| whole(it).of(&dataset).unwrap()),
            },
            why: None,
        },
        said: Said {
            answer: None,
            later: false,
            by: String::new(),
            at: None,
        },
    }
}

#[test]
fn a_line_is_heard_wherever_it_stands_and_whichever_clip_it_names_first() {
    let lines = lines(&[
        (0, 1, FIRST, "me"),
        (3, 2, SECOND, "me"),
        (4, 5, None, "me"),
    ]);
    let answer =
        |first, second| hear(&lines, [whole(first), whole(second)], 0).map(|it| it.said.answer);
    assert_eq!(answer(3, 2), Some(SECOND));
    assert_eq!(answer(2, 3), Some(FIRST));
    assert_eq!(answer(5, 4), Some(None));
    assert_eq!(answer(0, 2), None);
}

#[test]
fn a_run_that_asks_again_hears_the_next_line_of_the_same_person_and_in_the_end_the_last() {
    let lines = lines(&[(0, 1, FIRST, "me"), (1, 0, FIRST, "me")]);
    let answers = [0, 1, 2].map(|before| {
        let heard = hear(&lines, [whole(0), whole(1)], before).unwrap();
        (heard.said.answer, heard.lines)
    });
    assert_eq!(
        answers,
        [(FIRST, vec![0]), (SECOND, vec![1]), (SECOND, vec![1])]
    );
}

#[test]
fn people_are_heard_together_and_as_many_votes_for_either_are_a_tie() {
    let together = |answers: &[Option<Answer>]| {
        let people = ["anna", "ben", "cleo"];
        let said: Vec<_> = answers
            .iter()
            .zip(people)
            .map(|(&it, by)| (0, 1, it, by))
            .collect();
        hear(&lines(&said), [whole(0), whole(1)], 0).unwrap().said
    };
    let said = together(&[FIRST, SECOND]);
    assert_eq!((said.answer, said.by.as_str()), (EQUAL, "anna, ben"));
    assert_eq!(together(&[FIRST, SECOND, FIRST]).answer, FIRST);
    assert_eq!(together(&[EQUAL, SECOND]).answer, SECOND);
    assert_eq!(together(&[None, SECOND]).answer, SECOND);
    assert_eq!(together(&[None, None]).answer, None);
}

#[test]
fn a_line_that_puts_a_question_off_is_heard_alone_at_its_turn_and_never_again() {
    let heard = |lines: &[Numbered], before| {
        let heard = hear(lines, [whole(1), whole(0)], before)?;
        assert_eq!(heard.said.later, heard.said.answer.is_none());
        Some((heard.said.answer, heard.said.by, heard.lines))
    };
    let said = |answer, by: &str, lines: &[usize]| Some((answer, by.to_owned(), lines.to_vec()));
    // Put off by one and answered by the other, as a run's log has it.
    let log = putting_off(lines(&[(0, 1, None, "anna"), (1, 0, FIRST, "ben")]));
    assert_eq!(heard(&log, 0), said(None, "anna", &[0]));
    assert_eq!(heard(&log, 1), said(FIRST, "ben", &[1]));
    assert_eq!(heard(&log, 2), said(FIRST, "ben", &[1]));
    // Asked by two members of an ensemble, each of which was put off.
    let twice = [None, FIRST, None, SECOND].map(|answer| (1, 0, answer, "anna"));
    let log = putting_off(lines(&twice));
    let answers = [0, 1, 2, 3].map(|before| heard(&log, before).unwrap().0);
    assert_eq!(answers, [None, FIRST, None, SECOND]);
    // It is no vote, and nobody answers for who only puts off.
    let votes = [
        (1, 0, FIRST, "ben"),
        (1, 0, None, "anna"),
        (1, 0, FIRST, "cleo"),
    ];
    let votes = putting_off(lines(&votes));
    assert_eq!(heard(&votes, 0), said(FIRST, "ben, cleo", &[0, 2]));
    let off = putting_off(lines(&[(1, 0, None, "anna")]));
    assert_eq!(heard(&off, 0), said(None, "anna", &[0]));
    assert_eq!(heard(&off, 1), None);
    // Beside an answer it says nothing.
    let mut answered = lines(&[(1, 0, FIRST, "anna")]);
    answered[0].line.later = true;
    assert_eq!(heard(&answered, 0), said(FIRST, "anna", &[0]));
}

#[test]
fn lines_that_put_a_question_off_are_accounted_for_and_contradict_nobody() {
    let lines = putting_off(lines(&[
        (0, 1, None, "anna"),
        (0, 1, None, "anna"),
        (0, 1, FIRST, "anna"),
        (0, 1, FIRST, "ben"),
    ]));
    assert_eq!(findings(&lines), []);
    let uses = |times| -> Vec<_> {
        let uses = account(&lines, &vec![asked(1, 0); times]).into_iter();
        uses.map(|it| (it.questions, it.why_not.unwrap_or_default()))
            .collect()
    };
    let unused = |why: &str| (vec![], why.to_owned());
    let used = |number| (vec![number], String::new());
    let never = "the run does not ask about its two clips";
    assert_eq!(
        uses(0),
        [
            unused(never),
            unused("anna says the same in line 1"),
            unused("anna says something else in line 2, and the run asks no more often"),
            unused(never),
        ]
    );
    assert_eq!(
        uses(1),
        [
            used(1),
            unused("anna says the same in line 1"),
            unused("anna says something else in line 2, and the run asks no more often"),
            unused("the question was put off, and the run asks no more often"),
        ]
    );
    assert_eq!(uses(3), [used(1), used(2), used(3), used(3)]);
}

#[test]
fn every_line_is_accounted_for() {
    let lines = lines(&[
        (0, 1, FIRST, "me"),
        (2, 3, SECOND, "me"),
        (3, 2, SECOND, "me"),
        (1, 0, SECOND, "me"),
        (4, 5, FIRST, "me"),
        (0, 1, SECOND, "ben"),
    ]);
    let uses = account(&lines, &[asked(0, 1), asked(2, 3)]);
    let of = |line: usize| {
        (
            uses[line - 1].questions.as_slice(),
            uses[line - 1].why_not.as_deref(),
        )
    };
    assert_eq!(of(1), ([1].as_slice(), None));
    assert_eq!(of(2), ([2].as_slice(), None));
    let unused = |why| ([].as_slice(), Some(why));
    assert_eq!(
        of(3),
        unused("me says something else in line 2, and the run asks no more often")
    );
    assert_eq!(of(4), unused("me says the same in line 1"));
    assert_eq!(of(5), unused("the run does not ask about its two clips"));
    assert_eq!(of(6), ([1].as_slice(), None));
    let twice = account(
        &lines,
        &[asked(0, 1), asked(2, 3), asked(3, 2), asked(2, 3)],
    );
    assert_eq!(
        (&twice[1].questions, &twice[2].questions),
        (&vec![2], &vec![3, 4])
    );
    assert_eq!(
        crate::preferences::in_words(&uses),
        "3 of 6 lines are used; not line 3: me says something else in line 2, and the run asks no more often; \
         not line 4: me says the same in line 1; not line 5: the run does not ask about its two clips"
    );
}

#[test]
fn contradictions_one_side_ties_and_no_answers_are_pointed_out() {
    let found = |said: &[(u32, u32, Option<Answer>, &str)]| -> Vec<_> {
        let found = findings(&lines(said)).into_iter();
        found.map(|it| (it.kind, it.lines, it.says)).collect()
    };
    let kinds = |said: &[(u32, u32, Option<Answer>, &str)]| -> Vec<FindingKind> {
        found(said).into_iter().map(|(kind, ..)| kind).collect()
    };
    let one_side =
        |answer, count| -> Vec<_> { (1..=count).map(|it| (0, it, answer, "me")).collect() };
    assert_eq!(kinds(&one_side(FIRST, 5)), [FindingKind::OneSide]);
    assert_eq!(kinds(&one_side(SECOND, 5)), [FindingKind::OneSide]);
    assert_eq!(kinds(&one_side(SECOND, 4)), []);
    assert_eq!(kinds(&one_side(EQUAL, 2)), [FindingKind::AllTies]);
    assert_eq!(kinds(&one_side(None, 2)), [FindingKind::NoAnswer]);
    assert_eq!(kinds(&[]), []);
    // The same answer to the clips in the other order is none, and who cannot tell contradicts nobody.
    let agreeing = [
        (0, 1, FIRST, "me"),
        (1, 0, SECOND, "ben"),
        (0, 1, None, "cleo"),
    ];
    assert_eq!(kinds(&agreeing), []);
    let (kind, of, says) = found(&[
        (0, 1, FIRST, "me"),
        (2, 3, FIRST, "me"),
        (1, 0, FIRST, "me"),
    ])
    .remove(0);
    assert_eq!((kind, of), (FindingKind::Contradiction, vec![1, 3]));
    assert_eq!(
        says,
        "lines 1, 3 contradict each other about episode 0 steps 0..9 or episode 1 steps 0..9; a run that asks once is told that \
         the first is better: line 1 counts, the first of me"
    );
    let (.., says) = found(&[(0, 1, FIRST, "me"), (1, 0, FIRST, "ben")]).remove(0);
    assert!(
        says.ends_with("is told that they are equal: me, ben are counted together"),
        "{says}"
    );
}
