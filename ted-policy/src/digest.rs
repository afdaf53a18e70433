//! A 256-bit digest, written as hexadecimal.

use core::fmt;
use core::str::FromStr;

use serde::{Deserialize, Serialize};

/// A 256-bit digest of a file or of a dataset (BLAKE3 in everything this project writes).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Digest(pub [u8; 32]);

/// A text that is not 64 hexadecimal digits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DigestError {
    /// Number of hexadecimal digits in a digest.
    pub expected: usize,
    /// Length of the text, in bytes.
    pub actual: usize,
}

impl fmt::Display for DigestError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "expected {} hexadecimal digits, found {} bytes that are not that",
            self.expected, self.actual
        )
    }
}

impl core::error::Error for DigestError {}

impl fmt::Display for Digest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}

impl FromStr for Digest {
    type Err = DigestError;

    fn from_str(text: &str) -> Result<Self, DigestError> {
        let error = DigestError {
            expected: 64,
            actual: text.len(),
        };
        let (pairs, rest) = text.as_bytes().as_chunks::<2>();
        let mut digest = [0; 32];
        if pairs.len() != digest.len() || !rest.is_empty() {
            return Err(error);
        }
        let digit = |byte: u8| (byte as char).to_digit(16).ok_or(error);
        for (byte, [high, low]) in digest.iter_mut().zip(pairs) {
            *byte = (digit(*high)? << 4 | digit(*low)?) as u8;
        }
        Ok(Self(digest))
    }
}

#[cfg(test)]
mod tests {
    use std::string::ToString;

    use super::*;

    #[test]
    fn a_digest_is_written_and_read_as_hexadecimal() {
        let mut digest = Digest::default();
        digest.0[0] = 0xab;
        digest.0[31] = 0x0f;
        let text = digest.to_string();
        assert!(text.starts_with("ab00") && text.ends_with("000f") && text.len() == 64);
        assert_eq!(text.parse(), Ok(digest));
        assert_eq!(text.to_uppercase().parse(), Ok(digest));
    }

    #[test]
    fn a_text_that_is_no_digest_is_refused() {
        let good = Digest::default().to_string();
        let bad = [
            &good[1..],
            &good.replace('0', "g"),
            "",
            &good.replacen("00", "+0", 1),
            &"ä".repeat(32),
        ];
        for text in bad {
            assert_eq!(
                text.parse::<Digest>(),
                Err(DigestError {
                    expected: 64,
                    actual: text.len()
                })
            );
        }
    }
}
