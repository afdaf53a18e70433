//! What the assembly of the integer loop does, instruction by instruction, in plain code.

use super::{AllPairs, COLUMNS, ROWS};

/// Adds to each sum the dot product of its row of 8-bit weights with as many activations in pairs.
pub(crate) fn add_dot_i8(rows: &[i8], inputs: usize, pairs: &AllPairs, sums: &mut [i32; ROWS]) {
    assert!(inputs >= COLUMNS && rows.len() == ROWS * inputs);
    for (sum, row) in sums.iter_mut().zip(rows.chunks_exact(inputs)) {
        let whole = row.chunks_exact(COLUMNS);
        let last = (!inputs.is_multiple_of(COLUMNS)).then(|| &row[inputs - COLUMNS..]);
        for (word, [even, odd]) in whole.chain(last).zip(pairs) {
            let word = u32::from_le_bytes([0, 1, 2, 3].map(|k| word[k] as u8));
            *sum = smlad(sxtb16(word), *even, *sum);
            *sum = smlad(sxtb16(word.rotate_right(8)), *odd, *sum);
        }
    }
}

/// The lowest and the third byte of a word, as numbers of 16 bits.
fn sxtb16(word: u32) -> [i32; 2] {
    [i32::from(word as i8), i32::from((word >> 16) as i8)]
}

/// Two products of 16 bits, added to a sum.
fn smlad([a, c]: [i32; 2], pair: u32, sum: i32) -> i32 {
    sum + a * i32::from(pair as i16) + c * i32::from((pair >> 16) as i16)
}
