//! How many of something a person may ask for where nothing but time would stop them: more is a slip of the finger.

use std::num::NonZeroUsize;
use std::ops::RangeInclusive;

/// Episodes of a flight.
pub const EPISODES: RangeInclusive<i64> = 1..=1_000_000;

/// Processes or runs side by side.
const MOST_AT_A_TIME: usize = 1024;

/// Reads a number of processes or runs side by side.
///
/// # Errors
/// When it is none, or not from 1 to 1024.
pub fn at_a_time(text: &str) -> Result<NonZeroUsize, String> {
    let number = text.parse::<NonZeroUsize>().ok();
    number
        .filter(|number| number.get() <= MOST_AT_A_TIME)
        .ok_or_else(|| format!("{text} is not in 1..={MOST_AT_A_TIME}"))
}

#[cfg(test)]
mod tests {
    use super::at_a_time;

    #[test]
    fn there_is_at_least_one_and_no_more_than_a_machine_could_start() {
        assert_eq!(at_a_time("1").map(usize::from), Ok(1));
        assert_eq!(at_a_time("1024").map(usize::from), Ok(1024));
        for text in [
            "0",
            "-1",
            "1025",
            "4000000000",
            "many",
            "99999999999999999999",
        ] {
            assert_eq!(at_a_time(text), Err(format!("{text} is not in 1..=1024")));
        }
    }
}
