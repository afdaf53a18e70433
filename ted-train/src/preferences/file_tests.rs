//! Files of answers as editors leave them.

use std::fs;

use super::*;

const LINE: &str = r#"{"dataset":"ted/x-v0","digest":"9f","round":0,"member":null,"segments":[{"episode":4,"start":12,"length":5},{"episode":9,"start":7,"length":5}],"answer":0.5,"by":"me","at":"today"}"#;

fn read(bytes: &[u8]) -> Result<AnswerFile, PreferenceError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("answers.jsonl");
    fs::write(&path, bytes).unwrap();
    AnswerFile::read(&path)
}

#[test]
fn marks_other_encodings_other_ends_and_empty_lines_lose_no_answer() {
    let other = LINE.replace("0.5", "null");
    let text = format!("{LINE}\n{other}\n");
    let crlf = text.replace('\n', "\r\n");
    let wide: Vec<u8> = format!("\u{feff}{crlf}")
        .encode_utf16()
        .flat_map(u16::to_le_bytes)
        .collect();
    for bytes in [
        text.as_bytes(),
        text.trim_end().as_bytes(),
        crlf.as_bytes(),
        format!("\u{feff}{crlf}").as_bytes(),
        &wide,
    ] {
        let lines = read(bytes).unwrap().whole().unwrap();
        assert_eq!(lines.iter().map(|it| it.number).collect::<Vec<_>>(), [1, 2]);
        let texts: Vec<String> = lines.iter().map(|it| it.line.text()).collect();
        assert_eq!(texts, [LINE, &other]);
    }
    let spaced = read(format!("\n{LINE}\n \n{other}").as_bytes()).unwrap();
    let numbers: Vec<usize> = spaced.lines.iter().map(|it| it.number).collect();
    assert_eq!((numbers, spaced.faults.len()), (vec![2, 4], 0));
}

#[test]
fn a_line_that_is_cut_off_is_named_and_the_others_are_read() {
    let file = read(format!("{LINE}\n{}", &LINE[..70]).as_bytes()).unwrap();
    assert_eq!(file.lines.len(), 1);
    let fault = file.whole().unwrap_err().to_string();
    assert!(
        fault.starts_with("line 2 of ") && fault.contains("is not a preference: EOF"),
        "{fault}"
    );
    let fault = read(b"{\"by\":\"Zo\xEB\"}\n").unwrap_err().to_string();
    assert!(
        fault.contains("it is not UTF-8 at byte 9; save it as UTF-8"),
        "{fault}"
    );
}
