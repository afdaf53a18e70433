//! All words that a person who answers reads, on the page and in the terminal: they stand in one file.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use crate::preferences::{Answer, LogEntry};

/// The file, as the page gets it.
pub(super) const FILE: &str = include_str!("web/assets/words.json");

static WORDS: LazyLock<BTreeMap<String, String>> =
    LazyLock::new(|| serde_json::from_str(FILE).unwrap_or_default());

/// The words of this name; the name itself where there are none.
pub(super) fn word(name: &str) -> &str {
    WORDS.get(name).map_or(name, String::as_str)
}

/// The words of this name with `{key}` replaced by each value.
pub(super) fn filled(name: &str, values: &[(&str, &str)]) -> String {
    values
        .iter()
        .fold(word(name).to_owned(), |text, (key, value)| {
            text.replace(&format!("{{{key}}}"), value)
        })
}

/// A question that was asked, and what was said.
pub(super) fn said_line(entry: &LogEntry) -> String {
    let segments = entry.question.query.segments;
    let [left, right] = segments.map(|it| it.episode().to_string());
    let said = match entry.said.answer {
        Some(Answer::First) => "said-left",
        Some(Answer::Second) => "said-right",
        Some(Answer::Equal) => "said-equal",
        None if entry.said.later => "said-later",
        None => "said-cannot-tell",
    };
    let line = [
        ("left", left.as_str()),
        ("right", &right),
        ("said", word(said)),
        ("by", &entry.said.by),
    ];
    filled("said-line", &line)
}

/// Why a question is asked, by the sides on which its segments are shown.
pub(super) fn why(logged: &str) -> String {
    logged
        .replace("the first", word("left-clip"))
        .replace("the second", word("right-clip"))
}
