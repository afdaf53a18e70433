//! Text as it lies in an artefact.

use core::fmt;

use serde::de::{Deserialize, Deserializer, Error, Visitor};
use serde::{Serialize, Serializer};

/// Borrowed UTF-8. A device compares and counts its bytes; only people need it as `str`, for whom it is checked again, by
/// the standard library, whose way takes 600 bytes of flash.
#[derive(Clone, Copy, Default, PartialEq, Eq)]
pub struct Text<'a>(&'a [u8]);

impl<'a> Text<'a> {
    /// These bytes, if they are UTF-8.
    #[must_use]
    pub fn new(bytes: &'a [u8]) -> Option<Self> {
        is_utf8(bytes).then_some(Self(bytes))
    }

    /// Its bytes.
    #[must_use]
    pub const fn as_bytes(self) -> &'a [u8] {
        self.0
    }

    /// Whether there is nothing.
    #[must_use]
    pub const fn is_empty(self) -> bool {
        self.0.is_empty()
    }

    /// As a string.
    #[must_use]
    pub fn as_str(self) -> &'a str {
        // It is UTF-8, or there would be no such text.
        core::str::from_utf8(self.0).unwrap_or_default()
    }

    /// The longest beginning of whole characters that takes at most `limit` bytes.
    #[must_use]
    pub fn beginning(self, limit: usize) -> Self {
        let mut end = limit.min(self.0.len());
        while self.0.get(end).is_some_and(|byte| is_continuation(*byte)) {
            end -= 1;
        }
        Self(self.0.get(..end).unwrap_or_default())
    }
}

impl<'a> From<&'a str> for Text<'a> {
    fn from(text: &'a str) -> Self {
        Self(text.as_bytes())
    }
}

impl fmt::Display for Text<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.as_str())
    }
}

impl fmt::Debug for Text<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Debug::fmt(self.as_str(), f)
    }
}

impl Serialize for Text<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        // The same on this wire as a string.
        serializer.serialize_bytes(self.0)
    }
}

impl<'de: 'a, 'a> Deserialize<'de> for Text<'a> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_bytes(Utf8)
    }
}

struct Utf8;

impl<'de> Visitor<'de> for Utf8 {
    type Value = Text<'de>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("UTF-8 text")
    }

    fn visit_borrowed_bytes<E: Error>(self, bytes: &'de [u8]) -> Result<Text<'de>, E> {
        Text::new(bytes).ok_or_else(|| E::custom("text is not UTF-8"))
    }
}

const fn is_continuation(byte: u8) -> bool {
    byte & 0xc0 == 0x80
}

/// Whether these bytes are UTF-8 (RFC 3629), one character after the other.
fn is_utf8(bytes: &[u8]) -> bool {
    let mut bytes = bytes.iter().copied();
    while let Some(first) = bytes.next() {
        // How many bytes follow, and the smallest character that needs them: a shorter one must not be written so long.
        let (following, least) = match first {
            0x00..=0x7f => continue,
            0xc0..=0xdf => (1, 0x80),
            0xe0..=0xef => (2, 0x800),
            0xf0..=0xf7 => (3, 0x1_0000),
            _ => return false,
        };
        let mut character = u32::from(first) & (0x3f >> following);
        for _ in 0..following {
            match bytes.next() {
                Some(byte) if is_continuation(byte) => {
                    character = character << 6 | u32::from(byte & 0x3f);
                }
                _ => return false,
            }
        }
        if character < least || char::from_u32(character).is_none() {
            return false;
        }
    }
    true
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn what_the_standard_library_takes_for_utf8_is_and_nothing_else() {
        // Every sequence of up to three bytes, and those of four at the edges of what they may be.
        for value in 0..1_u32 << 24 {
            let [a, b, c, _] = value.to_le_bytes();
            let bytes = [a, b, c];
            assert_eq!(
                is_utf8(&bytes),
                core::str::from_utf8(&bytes).is_ok(),
                "{bytes:02x?}"
            );
        }
        for first in 0xec..=0xff {
            for value in 0..1_u32 << 18 {
                let byte = |at: u32| 0x70 + (value >> (6 * at) & 0x3f) as u8 * 2;
                let bytes = [first, byte(0), byte(1), byte(2)];
                assert_eq!(
                    is_utf8(&bytes),
                    core::str::from_utf8(&bytes).is_ok(),
                    "{bytes:02x?}"
                );
            }
        }
    }

    proptest! {
        #[test]
        fn a_beginning_ends_between_characters(text: std::string::String, limit in 0..20_usize) {
            let beginning = Text::from(text.as_str()).beginning(limit);
            prop_assert_eq!(beginning.as_str(), &text[..text.floor_char_boundary(limit)]);
        }
    }
}
