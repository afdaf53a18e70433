//! A session with somebody who does as a list says: kept, gone on with, taken back, put off.

use std::cell::Cell;
use std::collections::VecDeque;
use std::path::{Path, PathBuf};

use firmware_sim::progress::Audience;

use super::person::{Person, Reply, Review, Turn, Verdict};
use super::{AskError, Did, Session, begin};
use crate::config::{Config, Overrides};
use crate::dataset::Dataset;
use crate::dataset::fixtures::{SHAPE, records};
use crate::preferences::{
    Answer, Interview, LogEntry, PreferenceLog, Query, ReplayTeacher, Teacher,
};
use crate::run::{DatasetReference, PREFERENCES, RunError, RunFolder};
use crate::train::questions;

/// Answers that are wanted.
const WANTED: usize = 6;

/// A dataset, a configuration and a folder.
struct Desk {
    folder: tempfile::TempDir,
    dataset: Dataset,
    config: Config,
    /// How many answers the folder wants by now.
    wanted: Cell<usize>,
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
            wanted: Cell::new(WANTED),
        }
    }

    fn begin(&self, config: &Config) -> Result<(RunFolder, Config), RunError> {
        let reference = DatasetReference {
            id: self.dataset.id().to_owned(),
            digest: self.dataset.digest().to_owned(),
            path: "x".into(),
        };
        begin(self.folder.path(), config, &reference)
    }

    /// Returns how many answers are wanted in the end.
    fn hold(&self, person: &mut Script, by: &str) -> Result<usize, AskError> {
        let (folder, config) = self.begin(&self.config).unwrap();
        let session = Session {
            dataset: &self.dataset,
            config: &config,
            least: WANTED,
            folder: &folder,
            by,
            audience: Audience::Nobody,
        };
        person.log = Some(self.log());
        person.config = Some(folder.config_path());
        let held = session.hold(person);
        let config = Config::read(&folder.config_path()).unwrap();
        assert!(held.as_ref().is_ok_and(|held| *held == config) || held.is_err());
        self.wanted.set(config.answers());
        held.map(|config| config.answers())
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

    /// What a run asks that answers from this log, to its end, and wants as many answers as the folder.
    fn replayed(&self, log: &Path) -> Vec<LogEntry> {
        let questions = questions(&self.dataset, &self.config, Audience::Nobody).unwrap();
        let own = tempfile::tempdir().unwrap();
        let path = own.path().join("log.jsonl");
        let mut teacher = ReplayTeacher::open(log, &self.dataset).unwrap();
        let teacher: &mut dyn Teacher = &mut teacher;
        let log = PreferenceLog::open(&path, &self.dataset).unwrap();
        let mut interview = Interview::new(&self.dataset, teacher, log);
        questions.ask(&mut interview, self.wanted.get()).unwrap();
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
    /// What it was told that the answers did, before each question and at the end.
    did: Vec<Did>,
    log: Option<PathBuf>,
    config: Option<PathBuf>,
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
        let config = Config::read(self.config.as_ref().unwrap()).unwrap();
        assert_eq!(turn.of, config.answers(), "that is on the disk, too");
        let lines = std::fs::read_to_string(self.log.as_ref().unwrap()).unwrap();
        assert_eq!(
            lines.lines().count(),
            turn.before.len(),
            "all of it is on the disk"
        );
        self.did.push(turn.did());
        self.replies
            .pop_front()
            .unwrap_or(Reply::Answer(larger(&query)))
    }

    fn review(&mut self, review: Review<'_>) -> Verdict {
        self.did.push(review.did());
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

#[test]
fn more_answers_are_asked_for_after_the_last_and_leave_those_before_as_they_were() {
    let desk = Desk::new(12);
    desk.hold(&mut Script::default(), "anna").unwrap();
    let before = desk.read();
    let mut person = Script::of(&[], &[Verdict::More]);
    assert_eq!(desk.hold(&mut person, "anna").unwrap(), WANTED + 5);
    let numbers: Vec<usize> = person.asked.iter().map(|(number, _)| *number).collect();
    assert_eq!(numbers, [7, 8, 9, 10, 11]);
    assert!(desk.read().starts_with(&before));
    assert_eq!(desk.replayed(&desk.log()), desk.entries());
}

#[test]
fn who_wants_more_and_is_killed_in_the_middle_goes_on_there_with_the_same_command() {
    let desk = Desk::new(12);
    let mut person = Script::of(&[LEFT, Reply::More, LEFT, Reply::More], &[]);
    assert_eq!(desk.hold(&mut person, "anna").unwrap(), WANTED + 10);
    assert_eq!(
        person.asked[1], person.asked[2],
        "the open question is the same"
    );
    let more = desk.read();
    let kept: String = more.split_inclusive('\n').take(9).collect();
    std::fs::write(desk.log(), kept).unwrap();
    let mut again = Script::default();
    assert_eq!(desk.hold(&mut again, "anna").unwrap(), WANTED + 10);
    assert_eq!(again.asked[0].0, 10);
    assert_eq!(desk.read(), more);
}

#[test]
fn who_wanted_more_may_have_enough_but_not_before_there_are_as_many_as_were_wanted() {
    let desk = Desk::new(12);
    let replies = [
        vec![Reply::More, Reply::Enough],
        vec![LEFT; WANTED + 2],
        vec![Reply::CannotTell, Reply::Enough],
    ];
    let mut person = Script::of(&replies.concat(), &[]);
    // With the first word there are no answers at all yet.
    assert!(matches!(
        desk.hold(&mut person, "anna"),
        Ok(answers) if answers == WANTED
    ));
    assert_eq!(person.asked.len(), 2 + WANTED);
    let mut person = Script::of(&[LEFT, Reply::CannotTell, Reply::Enough], &[Verdict::More]);
    assert_eq!(desk.hold(&mut person, "anna").unwrap(), WANTED + 1);
    let told = desk.entries();
    assert_eq!(told.len(), WANTED + 2, "and one that nobody could tell");
    let answered = |all: &[LogEntry]| -> Vec<LogEntry> {
        let all = all.iter().filter(|it| it.said.answer.is_some());
        all.cloned().collect()
    };
    assert_eq!(desk.replayed(&desk.log()), answered(&told));
    // It is asked for more where it ended, and nobody is asked twice.
    let mut person = Script::of(&[], &[Verdict::More]);
    assert_eq!(desk.hold(&mut person, "anna").unwrap(), WANTED + 6);
    assert_eq!(person.asked.len(), 5);
    assert_eq!(desk.replayed(&desk.log()), desk.entries());
}

#[test]
fn the_larger_number_of_answers_counts_until_something_is_learned_from_them() {
    let desk = Desk::new(12);
    let answers = |wanted: usize| {
        let begun = desk.begin(&desk.config.asking(wanted));
        begun.map(|(_, config)| config.answers())
    };
    assert_eq!(answers(7).unwrap(), 7);
    assert_eq!(answers(6).unwrap(), 7);
    assert_eq!(answers(12).unwrap(), 12);
    let mut other = desk.config.clone();
    other.seed += 1;
    assert!(matches!(desk.begin(&other), Err(RunError::OtherRun { .. })));
    std::fs::write(desk.folder.path().join("reward.state"), b"").unwrap();
    assert_eq!(answers(12).unwrap(), 12);
    assert_eq!(answers(3).unwrap(), 12);
    let refused = answers(13).unwrap_err().to_string();
    assert!(
        refused.contains("learned from 12 answers, and 13 are wanted"),
        "{refused}"
    );
}

#[test]
fn whoever_looks_at_what_the_answers_did_is_told_of_all_before_and_changes_nothing() {
    let desk = Desk::new(12);
    let mut person = Script::of(&[LEFT, LEFT, Reply::Later], &[]);
    desk.hold(&mut person, "anna").unwrap();
    let told: Vec<&str> = person.did.iter().map(|did| did.says[0].as_str()).collect();
    assert!(told[0].starts_with("Without an answer"), "{told:?}");
    // The third question was put off, and another one asked in its place.
    for (place, answers) in [(1, 1), (2, 2), (3, 2), (4, 3), (WANTED + 1, WANTED)] {
        let by = format!("By {answers} answers");
        assert!(told[place].starts_with(&by), "{place}: {told:?}");
    }
    assert_eq!(told.len(), WANTED + 2);
    assert!(person.did.iter().all(|did| did.pairs.len() == 5));
    assert_eq!(desk.replayed(&desk.log()), desk.entries());
}
