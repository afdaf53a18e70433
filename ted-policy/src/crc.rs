//! The checksum of everything here that crosses a wire or a power cut: CRC-32 of Ethernet, zlib and PNG.
//!
//! It goes by half bytes: a table for whole ones takes 1 KiB, and all of a firmware image may have 32.

/// The polynomial, its lowest power in the highest bit.
const POLYNOMIAL: u32 = 0xedb8_8320;

const HALF: u32 = 4;

/// What each half byte leaves behind when it is shifted out.
static REMAINDERS: [u32; 1 << HALF] = remainders();

const fn remainders() -> [u32; 1 << HALF] {
    let mut remainders = [0; 1 << HALF];
    let mut half_byte = 0;
    while half_byte < remainders.len() {
        let (mut remainder, mut bit) = (half_byte as u32, 0);
        while bit < HALF {
            let odd = remainder & 1 == 1;
            remainder = (remainder >> 1) ^ if odd { POLYNOMIAL } else { 0 };
            bit += 1;
        }
        remainders[half_byte] = remainder;
        half_byte += 1;
    }
    remainders
}

/// The CRC-32 of the parts, one after the other.
#[must_use]
pub fn crc32(parts: &[&[u8]]) -> u32 {
    let mut crc = u32::MAX;
    for byte in parts.iter().copied().flatten() {
        crc ^= u32::from(*byte);
        for _ in 0..u8::BITS / HALF {
            let leaves = REMAINDERS.get(crc as usize % REMAINDERS.len());
            crc = (crc >> HALF) ^ leaves.copied().unwrap_or_default();
        }
    }
    !crc
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_check_value_of_the_format_document_comes_out() {
        assert_eq!(crc32(&[b"123456789"]), 0xcbf4_3926);
    }

    #[test]
    fn parts_count_as_one() {
        assert_eq!(crc32(&[b"1234", b"", b"56789"]), crc32(&[b"123456789"]));
    }
}
