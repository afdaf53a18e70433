//! Tables of answers, and the exports of Uni-RLHF's platform: what is read, and what is refused by line.

use std::fs;

use super::*;
use crate::answers::import::{Shape, import};
use crate::dataset::Dataset;
use crate::dataset::fixtures::{SHAPE, records};

const HEADER: &str = "episode_1,start_1,length_1,episode_2,start_2,length_2,label";

/// What the answers in a folder with these files come to, in words.
fn imported(shape: Shape, files: &[(&str, &[u8])], named: &str) -> Result<Vec<String>, String> {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in files {
        fs::write(folder.path().join(name), bytes).unwrap();
    }
    let dataset = Dataset::from_records("ted/x-v0", SHAPE, &records(&[20, 30, 25])).unwrap();
    let source = Source {
        dataset: &dataset,
        by: "me",
        length: None,
    };
    let lines = import(shape, &folder.path().join(named), &source);
    let lines = lines.map_err(|error| error.to_string())?;
    let words = |line: Line| {
        assert_eq!(line.digest, dataset.digest());
        let [first, second] = line.segments;
        format!(
            "{first} or {second}: {:?} by {} at {:?}",
            line.answer, line.by, line.at
        )
    };
    Ok(lines.into_iter().map(words).collect())
}

fn of_table(text: &[u8]) -> Result<Vec<String>, String> {
    imported(Shape::Csv, &[("labels.csv", text)], "labels.csv")
}

#[test]
fn a_table_is_read_with_spaces_quotes_marks_and_columns_in_any_order() {
    let plain =
        format!("{HEADER}\n0,0,5,1,2,5,0\n0,15,5,2,20,5,1\n1,0,5,2,0,5,0.5\n1,0,5,2,1,5,\n");
    let expected = [
        "episode 0 steps 0..5 or episode 1 steps 2..7: Some(First) by me at None",
        "episode 0 steps 15..20 or episode 2 steps 20..25: Some(Second) by me at None",
        "episode 1 steps 0..5 or episode 2 steps 0..5: Some(Equal) by me at None",
        "episode 1 steps 0..5 or episode 2 steps 1..6: None by me at None",
    ];
    assert_eq!(of_table(plain.as_bytes()).unwrap(), expected);
    let marked = format!(
        "\u{feff}{}",
        plain.replace(',', " , ").replace('\n', "\r\n")
    );
    assert_eq!(of_table(marked.as_bytes()).unwrap(), expected);
    let wide: Vec<u8> = marked.encode_utf16().flat_map(u16::to_le_bytes).collect();
    assert_eq!(of_table(&wide).unwrap(), expected);
    let quoted = plain.replace(",5,0\n", ",5, \"0\" \n");
    assert_ne!(quoted, plain);
    assert_eq!(of_table(quoted.as_bytes()).unwrap(), expected);
    let named = "at,label,by,episode_1,start_1,length_1,episode_2,start_2,length_2\n\
                 \"May 1, 14:03\",1,\"Zoë\",0,0,5,1,2,5";
    let row = "episode 0 steps 0..5 or episode 1 steps 2..7: Some(Second) by Zoë at Some(\"May 1, 14:03\")";
    assert_eq!(of_table(named.as_bytes()).unwrap(), [row]);
}

#[test]
fn what_is_wrong_with_a_table_is_named_with_its_line() {
    let refused =
        |rows: &str| of_table(format!("{HEADER}\n0,0,5,1,2,5,0\n{rows}\n").as_bytes()).unwrap_err();
    for (rows, part) in [
        ("0,0,5,1,2,5,2", "the label 2 is not 0"),
        ("0,0,5,1,2,5,left", "invalid float"),
        ("0,0,5,1,2,-5,0", "invalid digit"),
        ("0,0,5,1,2,5", "fields"),
        ("7,0,5,1,2,5,0", "no episode 7: the dataset has 3"),
        ("0,16,5,1,2,5,0", "run past its end"),
    ] {
        let text = refused(rows);
        assert!(text.contains("line 3 of ") && text.contains(part), "{text}");
    }
    let header = |header: &str| of_table(header.as_bytes()).unwrap_err();
    assert!(header("episode_1,start_1\n0,0").contains("there is no column length_1"));
    assert!(header(&format!("{HEADER},mood\n")).contains("nothing is known of a column \"mood\""));
}

#[test]
fn an_export_of_the_platform_is_read_and_refused_by_line() {
    let metadata =
        br#"{"domain":"x","query_length":5,"query_num":2,"feedback_type":"comparative"}"#;
    let read = |metadata: &[u8], rows: &str| {
        let text = format!("id,start_indices_1,start_indices_2,label\n{rows}");
        let files = [
            ("meta_data.json", metadata),
            ("labels.csv", text.as_bytes()),
        ];
        imported(Shape::UniRlhf, &files, "")
    };
    let rows =
        "1,0,20,\"{'1': {'0': 0}}\"\n2,14,49,\"{'1': {'0': 2}}\"\n3,14,49,\"{'1': {'0': 1}}\"\n";
    let expected = [
        "episode 0 steps 0..5 or episode 1 steps 1..6: Some(First) by me at None",
        "episode 0 steps 14..19 or episode 2 steps 0..5: Some(Second) by me at None",
        "episode 0 steps 14..19 or episode 2 steps 0..5: Some(Equal) by me at None",
    ];
    assert_eq!(read(metadata, rows).unwrap(), expected);
    let text = read(metadata, "1,0,20,\"{'1': {'0': 0}}\"\n2,0,20,skipped\n").unwrap_err();
    assert!(
        text.contains("line 3 of ") && text.contains("the label skipped is not"),
        "{text}"
    );
    let text = read(br#"{"query_length":5,"feedback_type":"keypoint"}"#, rows).unwrap_err();
    assert!(text.contains("its feedback is keypoint"), "{text}");
}
