//! JSON as Python's `json` writes it: a number that is none stands there as `NaN`, `Infinity` or `-Infinity`, which JSON does not
//! know.

use serde::de::DeserializeOwned;
use std::borrow::Cow;

/// What Python writes and JSON does not know.
const NOT_JSON: [&[u8]; 3] = [b"NaN", b"Infinity", b"-Infinity"];

/// Reads such a text; a number that is none is null.
pub(super) fn parse<T: DeserializeOwned>(text: &[u8]) -> serde_json::Result<T> {
    serde_json::from_slice(&standard(text))
}

/// The same text with null in place of each number that is none.
fn standard(text: &[u8]) -> Cow<'_, [u8]> {
    if word_in(text).is_none() {
        return Cow::Borrowed(text);
    }
    let mut out = Vec::with_capacity(text.len());
    let (mut rest, mut quoted) = (text, false);
    while let Some((&byte, after)) = rest.split_first() {
        let word = NOT_JSON.iter().find_map(|word| rest.strip_prefix(*word));
        if let (Some(after), false) = (word, quoted) {
            out.extend_from_slice(b"null");
            rest = after;
            continue;
        }
        out.push(byte);
        rest = after;
        match (byte, rest.split_first()) {
            (b'"', _) => quoted = !quoted,
            (b'\\', Some((&escaped, after))) if quoted => {
                out.push(escaped);
                rest = after;
            }
            _ => {}
        }
    }
    Cow::Owned(out)
}

fn word_in(text: &[u8]) -> Option<&&[u8]> {
    let holds = |word: &&&[u8]| text.windows(word.len()).any(|part| part == **word);
    NOT_JSON.iter().find(holds)
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::{Value, json};

    #[test]
    fn numbers_that_are_none_are_null_and_words_stay_words() {
        let text =
            br#"{"a": NaN, "b": [Infinity, -Infinity, -1.5], "NaN \" Infinity": "-Infinity \\"}"#;
        let read: Value = parse(text).unwrap();
        assert_eq!(
            read,
            json!({"a": null, "b": [null, null, -1.5], "NaN \" Infinity": "-Infinity \\"})
        );
    }

    #[test]
    fn what_is_broken_in_another_way_is_refused() {
        for text in ["{\"a\": NaN", "{\"a\": nan}", "{\"a\": NaN0}", "\"\\"] {
            assert!(parse::<Value>(text.as_bytes()).is_err(), "{text}");
        }
    }
}
