//! What editors and other programs make of a text file: marks at its beginning, other encodings, other ends of lines.

/// The mark that some editors put before UTF-8.
pub(super) const MARK: &[u8] = b"\xEF\xBB\xBF";

/// Whether these bytes begin as UTF-16 does.
pub(super) fn is_utf16(bytes: &[u8]) -> bool {
    bytes.starts_with(b"\xFF\xFE") || bytes.starts_with(b"\xFE\xFF")
}

/// The text of a file in UTF-8 or, where a mark says so, in UTF-16; the mark is no part of it.
///
/// # Errors
/// With the reason, when it is neither.
pub fn decode(bytes: &[u8]) -> Result<String, String> {
    if is_utf16(bytes) {
        let little = bytes[0] == 0xFF;
        let (pairs, rest) = bytes[2..].as_chunks::<2>();
        let units = pairs.iter().map(|&pair| match little {
            true => u16::from_le_bytes(pair),
            false => u16::from_be_bytes(pair),
        });
        let text: Result<String, _> = char::decode_utf16(units).collect();
        return match (text, rest) {
            (Ok(text), []) => Ok(text),
            _ => Err("it begins as UTF-16 and is none further on".to_owned()),
        };
    }
    let bytes = bytes.strip_prefix(MARK).unwrap_or(bytes);
    match std::str::from_utf8(bytes) {
        Ok(text) if text.contains('\0') => {
            Err("it has zero bytes, as UTF-16 without a mark has".to_owned())
        }
        Ok(text) => Ok(text.to_owned()),
        Err(error) => Err(format!("it is not UTF-8 at byte {}", error.valid_up_to())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn utf_8_and_utf_16_are_read_with_their_marks_and_anything_else_is_refused() {
        let text = "{\"by\":\"Zoë 🙂\"}\r\n";
        let wide = |order: fn(u16) -> [u8; 2]| -> Vec<u8> {
            let units = text.encode_utf16();
            [0xFEFF].into_iter().chain(units).flat_map(order).collect()
        };
        let marked = [MARK, text.as_bytes()].concat();
        let (little, big) = (wide(u16::to_le_bytes), wide(u16::to_be_bytes));
        for bytes in [text.as_bytes(), &marked, &little, &big] {
            assert_eq!(decode(bytes).as_deref(), Ok(text));
        }
        let refused = |bytes: &[u8]| decode(bytes).unwrap_err();
        assert!(refused(&little[..little.len() - 1]).contains("UTF-16"));
        assert!(
            refused(&little[2..]).contains("UTF-16 without a mark")
                || refused(&little[2..]).contains("not UTF-8")
        );
        assert_eq!(refused(b"{\xE9}"), "it is not UTF-8 at byte 1");
    }
}
