//! Who answers queries, and the teacher that looks at the true rewards.

use super::{Answer, PreferenceError, Query};
use crate::dataset::Dataset;

/// Someone or something that answers queries.
pub trait Teacher {
    /// Who gave the latest answer, as the log will say, such as `teacher:true-return`.
    fn name(&self) -> &str;

    /// The answer to `query`.
    fn answer(&mut self, dataset: &Dataset, query: &Query) -> Result<Answer, PreferenceError>;
}

/// Prefers the segment with the larger sum of true rewards, and calls it equal when they differ by no more than a tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScriptedTeacher {
    tolerance: f64,
}

impl ScriptedTeacher {
    /// A teacher for whom segment returns within `tolerance` of each other are equal; 0 means exactly equal.
    pub fn new(tolerance: f64) -> Result<Self, PreferenceError> {
        if tolerance.is_finite() && tolerance >= 0.0 {
            Ok(Self { tolerance })
        } else {
            Err(PreferenceError::Tolerance { tolerance })
        }
    }
}

impl Teacher for ScriptedTeacher {
    fn name(&self) -> &str {
        "teacher:true-return"
    }

    fn answer(&mut self, dataset: &Dataset, query: &Query) -> Result<Answer, PreferenceError> {
        let [first, second] = query.segments.map(|segment| segment.return_true(dataset));
        Ok(if (first - second).abs() <= self.tolerance {
            Answer::Equal
        } else if first > second {
            Answer::First
        } else {
            Answer::Second
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dataset::Segment;
    use crate::dataset::fixtures::{SHAPE, records};

    #[test]
    fn the_scripted_teacher_prefers_the_larger_return_and_knows_ties() {
        let mut episodes = records(&[4, 4]);
        episodes[0].rewards = vec![1.0, 1.0, 2.0, 0.25];
        episodes[1].rewards = vec![2.0, 0.0, 3.0, 0.0];
        let dataset = Dataset::from_records("ted/x-v0", SHAPE, &episodes).unwrap();
        let segment = |episode, start| Segment::new(&dataset, episode, start, 2).unwrap();
        let answer = |tolerance, first, second| {
            let query = Query {
                segments: [first, second],
            };
            ScriptedTeacher::new(tolerance)
                .unwrap()
                .answer(&dataset, &query)
                .unwrap()
        };
        assert_eq!(answer(0.0, segment(0, 0), segment(1, 0)), Answer::Equal);
        assert_eq!(answer(0.0, segment(0, 1), segment(1, 0)), Answer::First);
        assert_eq!(answer(0.0, segment(0, 2), segment(1, 1)), Answer::Second);
        assert_eq!(answer(0.75, segment(0, 2), segment(1, 1)), Answer::Equal);
        assert_eq!(answer(0.74, segment(0, 2), segment(1, 1)), Answer::Second);
        assert!(ScriptedTeacher::new(f64::NAN).is_err() && ScriptedTeacher::new(-0.1).is_err());
    }
}
