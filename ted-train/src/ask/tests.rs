//! A session with somebody who does as a list says: kept, gone on with, taken back, put off.

use std::collections::VecDeque;
use std::path::Path;

use firmware_sim::progress::Audience;

use super::person::{Person, Reply, Review, Turn, Verdict};
use super::{AskError, Session};
use crate::config::{Config, Overrides};
use crate::dataset::Dataset;
use crate::dataset::fixtures::{SHAPE, records};
use crate::preferences::{
    Answer, Interview, LogEntry, PreferenceLog, Query, ReplayTeacher, Teacher,
};
use crate::run::{DatasetReference, PREFERENCES, RunFolder};
use crate::train::questions;

/// Answers that are wanted.
const WANTED: usize = 6;

/// A dataset, a configuration and a folder.
struct Desk {
    folder: tempfile::TempDir,
    dataset: Dataset,
    config: Config,
}

impl Desk {
    fn new(episodes: usize) -> Self {
        let sets = [
            format!("reward.queries={WANTED}"),
            "reward.clone.steps=20".into(),
            "reward.clone.hidden=[8]".into(),
            "reward.pool=60".into(),
        ];
        let overrides = sets
            .iter()
            .try_fold(Overrides::default(), |all, set| all.set(set));
        Self {
            folder: tempfile::tempdir().unwrap(),
            dataset: Dataset::from_records("ted/x-v0", SHAPE, &records(&vec![30; episodes]))
                .unwrap(),
            config: overrides.unwrap().resolve(None, None).unwrap(),
        }
    }

    fn run(&self) -> RunFolder {
        let reference = DatasetReference {
            id: self.dataset.id().to_owned(),
            digest: self.dataset.digest().to_owned(),
            path: "x".into(),
        };
        RunFolder::begin(self.folder.path(), &self.config, &reference).unwrap()
    }

    fn hold(&self, person: &mut Script, by: &str) -> Result<usize, AskError> {
        let session = Session {
            dataset: &self.dataset,
            config: &self.config,
            folder: &self.run(),
            by,
            audience: Audience::Nobody,
        };
        person.log = Some(self.log());
        session.hold(person)
    }

    fn log(&self) -> std::path::PathBuf {
        self.folder.path().join(PREFERENCES)
    }

    fn entries(&self) -> Vec<LogEntry> {
        PreferenceLog::read(self.log(), &self.dataset).unwrap()
    }

    fn read(&self) -> String {
        std::fs::read_to_string(self.log()).unwrap()
    }

    /// What a run asks that answers from this log, to its end.
    fn replayed(&self, log: &Path) -> Vec<LogEntry> {
        let ask = questions(&self.dataset, &self.config, Audience::Nobody).unwrap();
        let own = tempfile::tempdir().unwrap();
        let path = own.path().join("log.jsonl");
        let mut teacher = ReplayTeacher::open(log, &self.dataset).unwrap();
        let teacher: &mut dyn Teacher = &mut teacher;
        let log = PreferenceLog::open(&path, &self.dataset).unwrap();
        let mut interview = Interview::new(&self.dataset, teacher, log);
        ask(&mut interview).unwrap();
        interview.entries().to_vec()
    }
}

/// Does as told, and afterwards answers that the episode of the larger number is better.
#[derive(Default)]
struct Script {
    replies: VecDeque<Reply>,
    verdicts: VecDeque<Verdict>,
    asked: Vec<(usize, Query)>,
    stuck: Vec<String>,
    log: Option<std::path::PathBuf>,
}

impl Script {
    fn of(replies: &[Reply], verdicts: &[Verdict]) -> Self {
        Self {
            replies: replies.iter().copied().collect(),
            verdicts: verdicts.iter().copied().collect(),
            ..Self::default()
        }
    }
}

fn larger(query: &Query) -> Answer {
    let [left, right] = query.segments.map(|it| it.episode());
    if left > right {
        Answer::First
    } else {
        Answer::Second
    }
}

impl Person for Script {
    fn answer(&mut self, turn: Turn<'_>) -> Reply {
        let query = turn.question.query;
        self.asked.push((turn.number, query));
        assert_eq!(turn.of, WANTED);
        let lines = std::fs::read_to_string(self.log.as_ref().unwrap()).unwrap();
        assert_eq!(
            lines.lines().count(),
            turn.before.len(),
            "all of it is on the disk"
        );
        self.replies
            .pop_front()
            .unwrap_or(Reply::Answer(larger(&query)))
    }

    fn review(&mut self, review: Review<'_>) -> Verdict {
        self.stuck.extend(review.stuck.map(str::to_owned));
        self.verdicts.pop_front().unwrap_or(Verdict::Done)
    }
}

const LEFT: Reply = Reply::Answer(Answer::First);

#[test]
fn an_answer_is_kept_at_once_and_who_comes_back_is_asked_only_what_is_open() {
    let desk = Desk::new(12);
    let mut first = Script::of(&[LEFT, LEFT, LEFT, Reply::Stop], &[]);
    let stopped = desk.hold(&mut first, "anna");
    assert!(matches!(stopped, Err(AskError::Stopped)));
    assert_eq!(desk.entries().len(), 3);
    let mut second = Script::default();
    assert_eq!(desk.hold(&mut second, "bert").unwrap(), WANTED);
    let numbers: Vec<usize> = second.asked.iter().map(|(number, _)| *number).collect();
    assert_eq!(numbers, [4, 5, 6]);
    assert_eq!(
        second.asked[0].1, first.asked[3].1,
        "the open one comes again"
    );
    let by: Vec<String> = desk
        .entries()
        .into_iter()
        .map(|entry| entry.said.by)
        .collect();
    assert_eq!(by, ["anna", "anna", "anna", "bert", "bert", "bert"]);
    assert_eq!(
        desk.replayed(&desk.log()),
        desk.entries(),
        "a run asks the same"
    );
    let mut third = Script::default();
    assert_eq!(desk.hold(&mut third, "anna").unwrap(), WANTED);
    assert!(third.asked.is_empty(), "nobody is asked twice");
}

#[test]
fn an_answer_that_is_taken_back_and_given_again_costs_no_other_answer() {
    let desk = Desk::new(12);
    desk.hold(&mut Script::default(), "anna").unwrap();
    let before = desk.read();
    let mut person = Script::of(&[], &[Verdict::Reopen(1)]);
    desk.hold(&mut person, "anna").unwrap();
    let again: Vec<usize> = person.asked.iter().map(|(number, _)| *number).collect();
    assert_eq!(again, [2], "the others are where they were");
    assert_eq!(desk.read(), before);
}

#[test]
fn a_changed_answer_is_asked_about_again_and_after_it_only_what_is_another_question() {
    let desk = Desk::new(12);
    desk.hold(&mut Script::default(), "anna").unwrap();
    let before = desk.entries();
    let changed = Reply::Answer(before[1].said.answer.unwrap().turned());
    let mut person = Script::of(&[changed], &[Verdict::Reopen(1)]);
    desk.hold(&mut person, "bert").unwrap();
    let after = desk.entries();
    assert_eq!(after.len(), WANTED);
    assert_eq!(
        (&after[0], after[1].question.query),
        (&before[0], before[1].question.query)
    );
    assert_eq!(
        after[1].said.answer,
        before[1].said.answer.map(Answer::turned)
    );
    for entry in &after[2..] {
        let query = entry.question.query;
        let known = before[2..].iter().find(|it| it.question.query == query);
        let asked = person.asked.iter().any(|(_, it)| *it == query);
        assert_eq!(asked, known.is_none(), "{query:?}");
        assert_eq!(entry.said.by, if asked { "bert" } else { "anna" });
    }
    assert_eq!(desk.replayed(&desk.log()), after);
}

#[test]
fn an_answer_is_taken_back_in_the_middle_and_the_question_before_it_too() {
    let desk = Desk::new(12);
    let undo = [LEFT, LEFT, Reply::Reopen(1), Reply::Reopen(0)];
    let mut person = Script::of(&undo, &[]);
    assert_eq!(desk.hold(&mut person, "anna").unwrap(), WANTED);
    let numbers: Vec<usize> = person.asked.iter().map(|(number, _)| *number).collect();
    assert_eq!(numbers[..5], [1, 2, 3, 2, 1]);
    assert_eq!(person.asked[0].1, person.asked[4].1);
    assert_eq!(
        desk.entries()[0].said.answer,
        Some(larger(&person.asked[0].1))
    );
    assert_eq!(desk.replayed(&desk.log()), desk.entries());
}

#[test]
fn a_question_that_is_put_off_is_followed_by_another_one_and_may_come_back() {
    let desk = Desk::new(3);
    let mut person = Script::of(&[Reply::Later, Reply::Later, LEFT, Reply::CannotTell], &[]);
    let held = desk.hold(&mut person, "anna");
    assert_eq!(held.unwrap(), WANTED);
    let said = desk.entries();
    let later: Vec<bool> = said.iter().map(|entry| entry.said.later).collect();
    assert_eq!(later[..4], [true, true, false, false]);
    let log = desk.read();
    let first = log.lines().next().unwrap();
    assert!(first.contains("\"answer\":null,\"later\":true"), "{first}");
    let pair = |entry: &LogEntry| {
        let mut pair = entry.question.query.segments.map(|it| it.episode());
        pair.sort_unstable();
        pair
    };
    assert_ne!(
        pair(&said[0]),
        pair(&said[1]),
        "another one is asked in its place"
    );
    let put_off = [pair(&said[0]), pair(&said[1])];
    assert!(!put_off.contains(&pair(&said[2])), "no answer came between");
    let mut others = said[3..].iter().map(pair);
    assert!(others.any(|it| put_off.contains(&it)), "one came back");
    assert!(
        said[4..].iter().all(|it| pair(it) != pair(&said[3])),
        "who cannot tell is not asked again"
    );
    assert_eq!(desk.replayed(&desk.log()), said);
}

#[test]
fn what_one_person_puts_off_another_one_answers_and_a_replay_says_who_said_what() {
    let desk = Desk::new(3);
    let mut anna = Script::of(&[Reply::Later, Reply::Later, Reply::Stop], &[]);
    let stopped = desk.hold(&mut anna, "anna");
    assert!(matches!(stopped, Err(AskError::Stopped)));
    assert_eq!(desk.hold(&mut Script::default(), "bert").unwrap(), WANTED);
    let said = desk.entries();
    let put_off = said[0].question.query.segments;
    let mut others = said[2..].iter();
    assert!(others.any(|entry| entry.question.query.is_about(put_off)));
    assert_eq!(desk.replayed(&desk.log()), said);
    let teacher = ReplayTeacher::open(desk.log(), &desk.dataset).unwrap();
    assert_eq!(teacher.first_other_answer(&said), None);
    assert!(teacher.account(&said).iter().all(|it| it.why_not.is_none()));
}

#[test]
fn what_was_put_off_after_an_answer_that_is_taken_back_and_given_again_is_put_off_as_before() {
    let desk = Desk::new(12);
    let replies = [LEFT, Reply::Later, LEFT, Reply::CannotTell];
    desk.hold(&mut Script::of(&replies, &[]), "anna").unwrap();
    let taken_back = desk.entries()[0].question.query.segments;
    // An editor has left an empty line in the middle.
    let before = desk.read();
    std::fs::write(desk.log(), before.replacen('\n', "\n\n", 1)).unwrap();
    let mut person = Script::of(&[LEFT], &[Verdict::Reopen(0)]);
    desk.hold(&mut person, "anna").unwrap();
    let again = person.asked.iter();
    let others: Vec<_> = again.filter(|(_, it)| !it.is_about(taken_back)).collect();
    assert!(others.is_empty(), "{others:?} of {before}");
    assert_eq!(desk.read(), before);
}

#[test]
fn who_can_tell_of_no_pair_is_told_and_can_change_their_mind() {
    let desk = Desk::new(2);
    let mut person = Script::of(&[Reply::CannotTell], &[Verdict::Reopen(0)]);
    assert_eq!(desk.hold(&mut person, "anna").unwrap(), WANTED);
    assert_eq!(person.stuck.len(), 1, "{:?}", person.stuck);
    assert!(person.stuck[0].contains("could not tell"));
}

#[test]
fn answers_that_a_run_has_learned_from_are_left_alone() {
    let desk = Desk::new(12);
    desk.hold(&mut Script::default(), "anna").unwrap();
    std::fs::write(desk.folder.path().join("reward.state"), b"").unwrap();
    let refused = desk.hold(&mut Script::default(), "anna").unwrap_err();
    assert!(refused.to_string().contains("--out"), "{refused}");
}
