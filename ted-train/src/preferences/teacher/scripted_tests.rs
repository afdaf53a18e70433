//! What teachers of every kind say.

use super::*;
use crate::dataset::fixtures::{SHAPE, records};
use crate::dataset::{Clip, Segment, SegmentSampler};
use crate::preferences::{Context, RandomPair};

fn question(segments: [Segment; 2]) -> Question {
    Question {
        context: Context {
            round: 0,
            member: None,
        },
        query: Query { segments },
        why: None,
    }
}

fn teacher(config: TeacherConfig) -> ScriptedTeacher {
    ScriptedTeacher::new(config, Seed::root(3))
}

/// Two episodes whose mean rewards are 1 and 2: their deviation is 0.5.
fn known() -> Dataset {
    let mut episodes = records(&[4, 4]);
    episodes[0].rewards = vec![1.0, 1.0, 2.0, 0.0];
    episodes[1].rewards = vec![2.0, 0.0, 4.0, 2.0];
    Dataset::from_records("ted/x-v0", SHAPE, &episodes).unwrap()
}

#[test]
fn the_larger_return_is_better_and_ties_are_within_the_tolerance() {
    let dataset = known();
    let segment = |episode, start| Segment::new(&dataset, episode, start, 2).unwrap();
    let answer = |tolerance, segments| {
        let config = TeacherConfig {
            tolerance,
            ..TeacherConfig::default()
        };
        let said = teacher(config).answer(&dataset, &[], &question(segments));
        said.unwrap().answer.unwrap()
    };
    let tie = [segment(0, 0), segment(1, 0)];
    let first = [segment(0, 1), segment(1, 0)];
    let second = [segment(0, 2), segment(1, 1)];
    assert_eq!(answer(0.0, tie), Answer::Equal);
    assert_eq!(answer(0.0, first), Answer::First);
    assert_eq!(answer(0.0, second), Answer::Second);
    // Returns of two steps deviate by 1: these differ by 1 and by 2.
    assert_eq!(answer(0.99, first), Answer::First);
    assert_eq!(answer(1.0, first), Answer::Equal);
    assert_eq!(answer(1.99, second), Answer::Second);
    assert_eq!(answer(2.0, second), Answer::Equal);
}

/// What is said to many random questions, in order.
fn said(config: TeacherConfig) -> Vec<Option<Answer>> {
    let dataset = Dataset::from_records("ted/x-v0", SHAPE, &records(&[40, 40])).unwrap();
    let sampler = SegmentSampler::new(&dataset, Clip::Steps(5)).unwrap();
    let mut rng = Seed::root(8).rng();
    let teacher = teacher(config);
    let ask = |number| {
        let question = question(RandomPair.draw(&sampler, &mut rng));
        teacher.say(&dataset, number, &question.query)
    };
    (1..=2000).map(ask).collect()
}

fn says(says: Says) -> TeacherConfig {
    TeacherConfig {
        says,
        ..TeacherConfig::default()
    }
}

#[test]
fn each_kind_says_what_it_is_called() {
    let truth = said(says(Says::TrueReturn));
    let turned = |answers: &[Option<Answer>]| -> Vec<_> {
        answers.iter().map(|it| it.map(Answer::turned)).collect()
    };
    assert_eq!(said(says(Says::Reversed)), turned(&truth));
    let all = |answer| vec![Some(answer); 2000];
    assert_eq!(said(says(Says::First)), all(Answer::First));
    assert_eq!(said(says(Says::Equal)), all(Answer::Equal));
    for kind in [
        Says::TrueReturn,
        Says::Reversed,
        Says::Random,
        Says::First,
        Says::Equal,
    ] {
        assert_eq!(serde_json::to_value(kind).unwrap(), kind.name());
    }
    let coins = said(says(Says::Random));
    let share = |of: &[Option<Answer>], like: &dyn Fn(usize) -> Option<Answer>| {
        let alike = of.iter().enumerate().filter(|(i, it)| **it == like(*i));
        alike.count() as f64 / 2000.0
    };
    let first = share(&coins, &|_| Some(Answer::First));
    let right = share(&coins, &|i| truth[i]);
    assert!((first - 0.5).abs() < 0.05 && (right - 0.5).abs() < 0.05);
}

#[test]
fn so_many_answers_are_turned_round_and_so_many_are_missing() {
    let truth = said(says(Says::TrueReturn));
    let wrong = |errs| -> Vec<usize> {
        let config = TeacherConfig {
            errs,
            ..TeacherConfig::default()
        };
        let said = said(config);
        (0..2000).filter(|&i| said[i] != truth[i]).collect()
    };
    let (few, many) = (wrong(0.1), wrong(0.2));
    assert!((150..250).contains(&few.len()), "{}", few.len());
    assert!((340..460).contains(&many.len()), "{}", many.len());
    assert!(few.iter().all(|slip| many.contains(slip)));
    assert!(wrong(0.0).is_empty());
    assert_eq!(wrong(1.0).len(), 2000);
    let silent = TeacherConfig {
        cannot_tell: 0.5,
        ..TeacherConfig::default()
    };
    let said = said(silent);
    let told: Vec<usize> = (0..2000).filter(|&i| said[i].is_some()).collect();
    assert!((900..1100).contains(&told.len()), "{}", told.len());
    assert!(told.iter().all(|&i| said[i] == truth[i]));
}

#[test]
fn an_answer_depends_on_seed_number_and_question_and_on_nothing_before() {
    let dataset = known();
    let segment = |episode, start| Segment::new(&dataset, episode, start, 2).unwrap();
    let question = question([segment(0, 0), segment(1, 0)]);
    let of = |seed, numbers: std::ops::Range<usize>| -> Vec<_> {
        let teacher = ScriptedTeacher::new(says(Says::Random), Seed::root(seed));
        let answer = |number| teacher.say(&dataset, number, &question.query);
        numbers.map(answer).collect()
    };
    let all = of(3, 1..65);
    assert_eq!(of(3, 33..65), all[32..], "begun again half way");
    assert_ne!(of(4, 1..65), all, "another seed");
    assert!(all.contains(&Some(Answer::First)) && all.contains(&Some(Answer::Second)));
}

#[test]
fn the_name_says_what_is_not_as_it_should_be() {
    let name = |config: TeacherConfig| teacher(config).name;
    assert_eq!(name(TeacherConfig::default()), "teacher:true-return");
    assert_eq!(name(says(Says::Random)), "teacher:random");
    let bad = TeacherConfig {
        says: Says::Reversed,
        errs: 0.1,
        tolerance: 2.0,
        cannot_tell: 0.5,
    };
    assert_eq!(
        name(bad),
        "teacher:reversed,errs=0.1,tolerance=2,cannot_tell=0.5"
    );
}

#[test]
fn rewards_that_are_all_the_same_are_nothing_to_go_by() {
    let mut episodes = records(&[4, 4]);
    episodes.iter_mut().for_each(|it| it.rewards.fill(0.5));
    let dataset = Dataset::from_records("ted/x-v0", SHAPE, &episodes).unwrap();
    for kind in [Says::TrueReturn, Says::Reversed] {
        let refused = teacher(says(kind)).check(&dataset).unwrap_err().to_string();
        assert!(
            refused.starts_with("the true rewards of ted/x-v0 are all 0.5")
                && refused.contains("--preferences"),
            "{refused}"
        );
        assert!(teacher(says(kind)).check(&known()).is_ok());
    }
    for kind in [Says::Random, Says::First, Says::Equal] {
        assert!(teacher(says(kind)).check(&dataset).is_ok());
    }
}
