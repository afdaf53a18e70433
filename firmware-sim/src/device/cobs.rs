//! Consistent overhead byte stuffing (Cheshire and Baker 1999), in place: bytes without a zero, so that a zero can end a frame.
//!
//! The data is cut after every zero and after 254 bytes without one. Each piece goes out without its zero, behind a byte
//! that says how long it is: 1 to 254 for a piece that had a zero, or is the last, 255 for one that had none.

const FULL: u8 = 0xff;

/// How many bytes [`stuff`] needs in front of `length` bytes of data, at least.
#[must_use]
pub const fn room(length: usize) -> usize {
    1 + length / (FULL as usize - 1)
}

/// Stuffs the `length` bytes of data at `start`, and moves them to the start of `buffer`. Returns the stuffed length;
/// nothing when there is less than [`room`] in front of them, or the buffer ends within them.
pub fn stuff(buffer: &mut [u8], start: usize, length: usize) -> Option<usize> {
    if start < room(length) {
        return None;
    }
    let (mut code_at, mut code, mut to) = (0, 1, 1);
    for from in start..start.checked_add(length)? {
        // Written bytes never overtake read ones: each piece adds one, and that is what the room is for.
        let byte = *buffer.get(from)?;
        if byte != 0 {
            *buffer.get_mut(to)? = byte;
            to += 1;
            code += 1;
        }
        if byte == 0 || code == FULL {
            *buffer.get_mut(code_at)? = code;
            (code_at, code) = (to, 1);
            to += 1;
        }
    }
    *buffer.get_mut(code_at)? = code;
    Some(to)
}

/// Takes the stuffing out of bytes without their final zero. Returns the length of the data, which is then at the
/// start; nothing when these bytes cannot have come from stuffing.
pub fn unstuff(stuffed: &mut [u8]) -> Option<usize> {
    let end = stuffed.len();
    let (mut from, mut to) = (0, 0);
    while from < end {
        let code = *stuffed.get(from)?;
        let next = from + usize::from(code);
        if code == 0 || next > end {
            return None;
        }
        for at in from + 1..next {
            let byte = *stuffed.get(at)?;
            if byte == 0 {
                return None;
            }
            *stuffed.get_mut(to)? = byte;
            to += 1;
        }
        if code != FULL && next < end {
            *stuffed.get_mut(to)? = 0;
            to += 1;
        }
        from = next;
    }
    Some(to)
}

#[cfg(test)]
mod tests {
    use std::vec::Vec;

    use proptest::collection::vec;
    use proptest::prelude::*;

    use super::*;

    fn stuffed(data: &[u8]) -> Vec<u8> {
        let mut buffer = [&std::vec![0xa5; room(data.len())], data].concat();
        let length = stuff(&mut buffer, room(data.len()), data.len()).unwrap();
        buffer.truncate(length);
        buffer
    }

    fn unstuffed(bytes: &[u8]) -> Option<Vec<u8>> {
        let mut bytes = bytes.to_vec();
        let length = unstuff(&mut bytes)?;
        bytes.truncate(length);
        Some(bytes)
    }

    #[test]
    fn the_examples_of_the_paper_s_successors_come_out() {
        assert_eq!(stuffed(&[]), [1]);
        assert_eq!(stuffed(&[0]), [1, 1]);
        assert_eq!(stuffed(&[0x11, 0x22, 0, 0x33]), [3, 0x11, 0x22, 2, 0x33]);
        assert_eq!(stuffed(&[0x11, 0, 0, 0]), [2, 0x11, 1, 1, 1]);
        let long: Vec<u8> = (1..=254).collect();
        assert_eq!(stuffed(&long)[..3], [255, 1, 2]);
    }

    proptest! {
        #[test]
        fn what_is_stuffed_has_no_zero_and_comes_back(
            mut data in vec(prop_oneof![Just(0), any::<u8>()], 0..700),
            bursts in vec((0..700_usize, 200..300_usize), 0..3),
        ) {
            for (start, length) in bursts {
                data.splice(start.min(data.len())..start.min(data.len()), std::iter::repeat_n(7, length));
            }
            let stuffed = stuffed(&data);
            prop_assert!(!stuffed.contains(&0));
            prop_assert!(stuffed.len() <= data.len() + room(data.len()));
            prop_assert_eq!(unstuffed(&stuffed), Some(data.clone()));
            prop_assert_eq!(::cobs::decode_vec(&stuffed).unwrap(), data.clone());
            prop_assert_eq!(unstuffed(&::cobs::encode_vec(&data)), Some(data));
        }

        #[test]
        fn any_bytes_are_taken_without_a_panic(bytes in vec(any::<u8>(), 0..700)) {
            let data = unstuffed(&bytes);
            prop_assert!(data.is_none_or(|data| data.len() <= bytes.len()));
        }
    }
}
