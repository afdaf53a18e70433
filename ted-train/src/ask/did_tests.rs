//! What somebody is told of answers that agree, differ, and say nothing yet.

use super::*;
use crate::dataset::fixtures::{SHAPE, records};
use crate::dataset::{Dataset, Segment};
use crate::preferences::{Answer, Context, Query, Question, Said};
use crate::reward::episodes::Confidence;

fn segment(episode: u32) -> Segment {
    let dataset = Dataset::from_records("ted/x-v0", SHAPE, &records(&[9; 13])).unwrap();
    Segment::new(&dataset, episode, 0, 9).unwrap()
}

fn entry(episodes: [u32; 2], answer: Option<Answer>) -> LogEntry {
    LogEntry {
        question: Question {
            context: Context {
                round: 0,
                member: None,
            },
            query: Query {
                segments: episodes.map(segment),
            },
            why: None,
        },
        said: Said {
            answer,
            later: false,
            by: "anna".to_owned(),
            at: None,
        },
    }
}

/// So many episodes, the first of them the best.
fn standing(episodes: u32, answers: usize, like_before: Option<f64>) -> Standing {
    Standing {
        ranking: (0..episodes)
            .map(|episode| Ranked {
                segment: segment(episode),
                above: -f64::from(episode),
            })
            .collect(),
        confidence: Confidence {
            answers,
            agreeing: answers,
            gain: 1.5,
            range: [1.0, 2.0],
            better: 0.99,
            leaves_the_logs: true,
        },
        like_before,
        slips: Vec::new(),
    }
}

#[test]
fn the_best_are_shown_beside_the_worst_and_no_episode_twice() {
    let shown = |episodes| -> Vec<[u32; 2]> {
        let did = Did::of(&[], Some(&standing(episodes, 0, None)));
        let pairs = did.pairs.iter();
        pairs
            .map(|both| both.map(|it| it.segment.episode()))
            .collect()
    };
    assert_eq!(shown(13), [[0, 12], [1, 11], [2, 10], [3, 9], [4, 8]]);
    assert_eq!(shown(3), [[0, 2]]);
    assert_eq!(shown(1), [[0; 2]; 0]);
}

#[test]
fn how_sure_it_is_and_how_far_the_ranking_moved_are_sentences() {
    let says = |answers, like_before| Did::of(&[], Some(&standing(4, answers, like_before))).says;
    let [sure, moved] = says(10, Some(0.634)).try_into().unwrap();
    assert!(
        sure.starts_with("By 10 answers, 10 of which agree") && sure.ends_with("imitates them."),
        "{sure}"
    );
    assert_eq!(
        moved,
        "By the answers so far (10) the ranking of the episodes moved a lot: its rank correlation with what was believed before \
         them is 0.63."
    );
    for (like_before, how) in [
        (1.0, "hardly moved: "),
        (0.95, "hardly moved: "),
        (0.94, "moved somewhat: "),
        (0.7, "moved somewhat: "),
        (-0.001, "moved a lot: "),
    ] {
        let [_, moved] = says(3, Some(like_before)).try_into().unwrap();
        assert!(moved.contains(how) && !moved.contains("-0.00"), "{moved}");
    }
    assert!(says(0, Some(1.0))[1].starts_with("There is no answer yet"));
    assert!(says(10, None)[1].contains("nothing told the episodes apart"));
}

#[test]
fn answers_that_differ_and_those_held_to_be_slips_are_named_with_what_says_otherwise() {
    let first = Some(Answer::First);
    let said = [
        entry([0, 1], first),
        entry([2, 3], None),
        entry([1, 0], first),
        entry([2, 4], Some(Answer::Second)),
        entry([5, 4], first),
    ];
    let standing = Standing {
        slips: vec![2, 3],
        ..standing(13, 4, Some(0.9))
    };
    let odd = Did::of(&said, Some(&standing)).odd;
    let says: Vec<(usize, &str)> = odd.iter().map(|it| (it.place, it.says.as_str())).collect();
    assert_eq!(
        says,
        [
            (
                0,
                "episode 0 or 1: left is better (anna). Answer 3 about the same two says otherwise."
            ),
            (
                2,
                "episode 1 or 0: left is better (anna). Answer 1 about the same two says otherwise."
            ),
            (
                3,
                "episode 2 or 4: right is better (anna). The other answers together say the opposite."
            ),
        ]
    );
    // Who learns later knows of no slip, and sees as well as anybody where two answers differ.
    let unknown = Did::of(&said, None);
    assert!(unknown.pairs.is_empty());
    assert!(unknown.says[0].starts_with("This preset has a ranking of the episodes only after"));
    let places: Vec<usize> = unknown.odd.iter().map(|it| it.place).collect();
    assert_eq!(places, [0, 2]);
}
