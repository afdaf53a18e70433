//! A part of the study, for one of several machines.

use std::collections::HashMap;
use std::fmt;
use std::num::NonZeroUsize;
use std::str::FromStr;

use super::Planned;

/// The `index`-th of `of` parts, counted from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    index: NonZeroUsize,
    of: NonZeroUsize,
}

/// The most parts: many more than the study has runs.
const MOST: usize = 10_000;

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.index, self.of)
    }
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || {
            format!("{text:?} names no part: write 2/8 for the second of eight, from 1/8 to 8/8")
        };
        let (index, of) = text.split_once('/').ok_or_else(wrong)?;
        let number = |digits: &str| digits.trim().parse::<NonZeroUsize>().map_err(|_| wrong());
        let (index, of) = (number(index)?, number(of)?);
        match (index <= of, of.get() <= MOST) {
            (true, true) => Ok(Self { index, of }),
            (true, false) => Err(format!("{text:?} is a part of more than {MOST}")),
            (false, _) => Err(wrong()),
        }
    }
}

impl Shard {
    /// Its name in the name of a file.
    #[must_use]
    pub fn suffix(self) -> String {
        format!("{}-of-{}", self.index, self.of)
    }

    /// The runs of this part, in their order. All parts together have each run once, and about as much work each. Runs on the
    /// same dataset stay together, which is read and collected once then, unless they are more than a third of a part: so no part has
    /// more than a third too much.
    #[must_use]
    pub fn of(self, runs: Vec<Planned>) -> Vec<Planned> {
        let all: f64 = runs.iter().map(|one| one.method.minutes()).sum();
        let most = all / (3.0 * self.of.get() as f64);
        let mut pieces: Vec<(f64, Vec<usize>)> = Vec::new();
        let mut open: HashMap<&str, usize> = HashMap::new();
        for (place, one) in runs.iter().enumerate() {
            let (dataset, minutes) = (one.run.dataset.as_str(), one.method.minutes());
            match open.get(dataset) {
                Some(&at) if pieces[at].0 + minutes <= most => {
                    pieces[at].0 += minutes;
                    pieces[at].1.push(place);
                }
                _ => {
                    open.insert(dataset, pieces.len());
                    pieces.push((minutes, vec![place]));
                }
            }
        }
        // The largest first, each to whoever has least: what is left for the end is small.
        pieces.sort_by(|(one, _), (other, _)| other.total_cmp(one));
        let mut parts = vec![(0.0_f64, Vec::new()); self.of.get()];
        for (minutes, piece) in pieces {
            let least = parts
                .iter_mut()
                .min_by(|(one, _), (other, _)| one.total_cmp(other));
            if let Some((sum, part)) = least {
                *sum += minutes;
                part.extend(piece);
            }
        }
        let mine = &parts[self.index.get() - 1].1;
        let runs = runs.iter().enumerate();
        let runs = runs.filter(|(place, _)| mine.contains(place));
        runs.map(|(_, one)| one.clone()).collect()
    }
}
