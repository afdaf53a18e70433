//! What a run will need in memory, compared with what there is, before anything is begun: a number with three zeros too many is a
//! message then, and no process that the system ends.

mod estimate;

use firmware_sim::memory::free_memory;
use firmware_sim::size::Size;

use crate::config::Config;
use crate::dataset::Dataset;
use estimate::Logs;

/// More than the machine has.
#[derive(Debug, thiserror::Error)]
pub enum TooMuch {
    /// A number is too large.
    #[error("{field} is {value}, which needs about {needed} of memory, and {free} are free: {}", way_out(*fits))]
    Number {
        /// Dotted path of the field, or the flag.
        field: String,
        /// The number.
        value: u64,
        /// What everything needs with it.
        needed: Size,
        /// What there is.
        free: Size,
        /// The largest that would do; none if there is none.
        fits: Option<u64>,
    },
    /// No number is larger than usual.
    #[error(
        "a run on {id} needs about {needed} of memory, and {free} are free: end other programs, or learn from fewer episodes"
    )]
    Logs {
        /// The dataset.
        id: String,
        /// What the run needs.
        needed: Size,
        /// What there is.
        free: Size,
    },
}

fn way_out(fits: Option<u64>) -> String {
    match fits {
        Some(fits) => format!("at most {fits} would do"),
        None => "end other programs, or choose smaller numbers".to_owned(),
    }
}

/// Whether this many runs of a configuration at a time have room beside this dataset, which is in memory already.
///
/// # Errors
/// When they have not; the number that is to blame is the one that is furthest above what its preset says.
pub fn check(dataset: &Dataset, config: &Config, runs: usize) -> Result<(), TooMuch> {
    check_within(free_memory() as f64, &Logs::of(dataset), config, runs)
}

fn check_within(free: f64, logs: &Logs<'_>, config: &Config, runs: usize) -> Result<(), TooMuch> {
    let needed = |config: &Config| runs as f64 * estimate::bytes(config, logs);
    let all = needed(config);
    if all <= free {
        return Ok(());
    }
    let usual = integers(&config.preset.config());
    let usual_of = |path: &[String]| usual.iter().find(|(known, _)| known == path);
    let mut numbers: Vec<_> = integers(config)
        .into_iter()
        // What makes no difference is not to blame.
        .filter(|(path, _)| with(config, path, 1).is_some_and(|less| needed(&less) < all))
        .map(|(path, value)| {
            let usual = usual_of(&path).map_or(1, |(_, usual)| *usual).max(1);
            (value as f64 / usual as f64, path, value)
        })
        .filter(|(times, ..)| *times > 1.0)
        .collect();
    numbers.sort_by(|(one, ..), (other, ..)| other.total_cmp(one));
    let Some((_, path, value)) = numbers.into_iter().next() else {
        return Err(TooMuch::Logs {
            id: logs.id.to_owned(),
            needed: Size(all),
            free: Size(free),
        });
    };
    let fits = |value: u64| with(config, &path, value).is_some_and(|it| needed(&it) <= free);
    Err(TooMuch::Number {
        field: path.join("."),
        value,
        needed: Size(all),
        free: Size(free),
        fits: largest(value, fits),
    })
}

/// Whether there is memory for `count` things of so many bytes each, which a flag of this name asked for.
///
/// # Errors
/// When there is not.
pub fn check_count(flag: &str, count: u64, each: f64) -> Result<(), TooMuch> {
    let (needed, free) = (count as f64 * each, free_memory() as f64);
    if needed <= free {
        return Ok(());
    }
    Err(TooMuch::Number {
        field: flag.to_owned(),
        value: count,
        needed: Size(needed),
        free: Size(free),
        fits: largest(count, |count| count as f64 * each <= free),
    })
}

/// The largest number from 1 to `most` that fits; whatever is below one that fits does, too.
fn largest(most: u64, fits: impl Fn(u64) -> bool) -> Option<u64> {
    let (mut good, mut bad) = (0, most);
    while bad - good > 1 {
        let middle = good + (bad - good) / 2;
        if fits(middle) {
            good = middle;
        } else {
            bad = middle;
        }
    }
    (good > 0).then_some(good)
}

/// Every whole number of a configuration above 0, with its path.
fn integers(config: &Config) -> Vec<(Vec<String>, u64)> {
    fn walk(value: &toml::Value, path: &[String], found: &mut Vec<(Vec<String>, u64)>) {
        match value {
            toml::Value::Integer(number) if *number > 0 => {
                found.push((path.to_vec(), number.unsigned_abs()));
            }
            toml::Value::Table(table) => {
                for (key, value) in table {
                    walk(value, &[path, std::slice::from_ref(key)].concat(), found);
                }
            }
            _ => {}
        }
    }
    let mut found = Vec::new();
    if let Ok(value) = toml::Value::try_from(config) {
        walk(&value, &[], &mut found);
    }
    found
}

/// The same configuration with another number at this path; none where it cannot be.
fn with(config: &Config, path: &[String], number: u64) -> Option<Config> {
    let mut value = toml::Value::try_from(config).ok()?;
    let mut at = &mut value;
    for key in path {
        at = at.get_mut(key)?;
    }
    *at = toml::Value::Integer(i64::try_from(number).ok()?);
    value.try_into().ok()
}

#[cfg(test)]
mod tests;
