//! The published pickles: what numpy writes, read without numpy, and what else a pickle may be.
//!
//! The arrays were written by numpy 2: `[0, 20, 44, 68]`, `[14, 49, 19, 60]`, and the labels `[0, 1, -1, 0]` as numbers, as rows, and as
//! a list with single numbers of numpy in it.

use std::fs;

use tempfile::TempDir;

use super::*;
use crate::dataset::Dataset;
use crate::dataset::fixtures::{SHAPE, records};
use crate::preferences::Span;

const FIRST: &[u8] = include_bytes!("fixtures/int64-protocol-2.pkl");
const SECOND: &[u8] = include_bytes!("fixtures/int32-protocol-5.pkl");
const LABELS: &[u8] = include_bytes!("fixtures/float64-protocol-4.pkl");
const ROWS: &[u8] = include_bytes!("fixtures/rows-protocol-3.pkl");
const LIST: &[u8] = include_bytes!("fixtures/list-protocol-0.pkl");

/// Two episodes whose recording ended, and the second of three, whose task did: 19, 30 and 24 steps in the count of d4rl.
fn dataset() -> Dataset {
    Dataset::from_records("ted/x-v0", SHAPE, &records(&[20, 30, 25])).unwrap()
}

fn folder(files: &[(&str, &[u8])]) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in files {
        fs::write(folder.path().join(name), bytes).unwrap();
    }
    folder
}

fn read_as(
    names: &Names,
    files: &[(&str, &[u8])],
    length: Option<u32>,
) -> Result<Vec<Line>, String> {
    let folder = folder(files);
    let dataset = dataset();
    let source = Source {
        dataset: &dataset,
        by: "people",
        length,
    };
    read(names, folder.path(), &source).map_err(|error| error.to_string())
}

/// What the arrays say of episodes.
fn expected() -> Vec<([Span; 2], Option<Answer>)> {
    let span = |episode, start| Span {
        episode,
        start,
        length: 5,
    };
    vec![
        ([span(0, 0), span(0, 14)], Some(Answer::First)),
        ([span(1, 1), span(2, 0)], Some(Answer::Second)),
        ([span(1, 25), span(1, 0)], Some(Answer::Equal)),
        ([span(2, 19), span(2, 11)], Some(Answer::First)),
    ]
}

fn said(lines: Vec<Line>) -> Vec<([Span; 2], Option<Answer>)> {
    assert!(lines.iter().all(|line| line.by == "people"));
    lines
        .into_iter()
        .map(|line| (line.segments, line.answer))
        .collect()
}

#[test]
fn the_pickles_of_both_are_read_into_episodes() {
    let pt = [
        ("indices_num4_q5", FIRST),
        ("indices_2_num4_q5", SECOND),
        ("label_human", LABELS),
    ];
    assert_eq!(said(read_as(&PT, &pt, None).unwrap()), expected());
    for labels in [LABELS, ROWS, LIST] {
        let uni = [
            ("indices_1_domain_x_env_y_num_4_len_5_0f.pkl", FIRST),
            ("indices_2_domain_x_env_y_num_4_len_5_0f.pkl", SECOND),
            ("human_label_domain_x_env_y_num_4_len_5_0f.pkl", labels),
        ];
        assert_eq!(said(read_as(&UNI_RLHF, &uni, None).unwrap()), expected());
    }
}

#[test]
fn what_cannot_be_read_is_refused_by_file_and_entry() {
    let refused = |first: (&str, &[u8]), labels: &[u8], length| {
        let files = [first, ("indices_2_num4", SECOND), ("label_human", labels)];
        read_as(&PT, &files, length).unwrap_err()
    };
    let short = ("indices_num4_q5", FIRST);
    let says = |text: String, parts: &[&str]| {
        assert!(parts.iter().all(|part| text.contains(part)), "{text}");
    };
    says(
        refused(short, SECOND, None),
        &["entry 1 of ", "label_human", "the label 14 is not 0"],
    );
    says(
        refused(("indices_num4_q6", FIRST), LABELS, None),
        &[
            "entry 1 of ",
            "indices_2_num4",
            "run past the end of episode 0",
        ],
    );
    says(
        refused(("indices_num4", FIRST), LABELS, None),
        &["say it with --length"],
    );
    says(
        refused(short, b"(lp0\nI0\na.", None),
        &["label_human", "it has 1 entries", "has 4"],
    );
    says(
        refused(short, b"torn", None),
        &["label_human", "it is no pickled array of numbers"],
    );
    let missing = read_as(&PT, &[short, ("label_human", LABELS)], None).unwrap_err();
    says(missing, &["0 files in it are called indices_2_num"]);
}

#[test]
fn a_pickle_that_names_anything_but_an_array_is_refused_and_not_run() {
    let place = tempfile::tempdir().unwrap();
    let sign = place.path().join("sign");
    let program = format!("cposix\nmkdir\n(S'{}'\ntR.", sign.display());
    let files = [
        ("indices_num4_q5", program.as_bytes()),
        ("indices_2_num4_q5", SECOND),
        ("label_human", LABELS),
    ];
    let refused = read_as(&PT, &files, None).unwrap_err();
    assert!(refused.contains("it names posix.mkdir"), "{refused}");
    assert!(!sign.exists());
}
