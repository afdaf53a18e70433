//! Seeds on a command line: `0..6`, or a list.

use std::str::FromStr;

/// The most seeds of one command: a slip of the finger is not a year of work.
const LIMIT: u64 = 10_000;

/// Seeds, each once, in the order given.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Seeds(pub(super) Vec<u64>);

impl FromStr for Seeds {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || {
            format!(
                "{text:?} names no seeds: write 0..6 for 0 to 5, 0..=5 for the same, or a list such as 0,3,7"
            )
        };
        let mut seeds = Vec::new();
        for part in text.split(',') {
            let number = |digits: &str| digits.trim().parse::<u64>().map_err(|_| wrong());
            let range = match (part.split_once("..="), part.split_once("..")) {
                (Some((first, last)), _) => {
                    number(first)?..number(last)?.checked_add(1).ok_or_else(wrong)?
                }
                (None, Some((first, end))) => number(first)?..number(end)?,
                (None, None) => {
                    let one = number(part)?;
                    one..one.checked_add(1).ok_or_else(wrong)?
                }
            };
            if range.end.saturating_sub(range.start) > LIMIT {
                return Err(format!("{part:?} are more than {LIMIT} seeds"));
            }
            seeds.extend(
                range
                    .filter(|seed| !seeds.contains(seed))
                    .collect::<Vec<_>>(),
            );
        }
        match seeds.is_empty() {
            true => Err(wrong()),
            false => Ok(Self(seeds)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_and_lists_name_seeds_once_each() {
        for (text, expected) in [
            ("0..3", vec![0, 1, 2]),
            ("2..=4", vec![2, 3, 4]),
            ("7", vec![7]),
            ("0,3,0, 5..7", vec![0, 3, 5, 6]),
        ] {
            assert_eq!(text.parse(), Ok(Seeds(expected)), "{text}");
        }
    }

    #[test]
    fn what_names_none_is_refused_with_the_way_to_write_it() {
        for text in [
            "",
            "x",
            "3..3",
            "5..1",
            "1..x",
            "-1",
            "1,,2",
            "18446744073709551615",
        ] {
            let error = text.parse::<Seeds>().unwrap_err();
            assert!(error.contains("0..6"), "{text}: {error}");
        }
        assert!(
            "0..1000000"
                .parse::<Seeds>()
                .unwrap_err()
                .contains("more than")
        );
    }
}
