//! How observations are scaled before a model of rewards sees them.

use serde::{Deserialize, Serialize};

use crate::dataset::ObservationStatistics;

/// How the inputs of a model of rewards are scaled; independent of the RL networks' standardisation.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum InputScaling {
    /// As recorded, in metres and quaternion components.
    Raw {},
    /// Minus the dataset's mean, divided by its standard deviation, which is not taken smaller than `floor`.
    Standard {
        /// Smallest standard deviation, which keeps nearly constant channels from becoming noise: in the unit of a channel whose own
        /// floor is 0.001, and in proportion where that is another one ([`ObservationStatistics::at_least`]).
        floor: f32,
    },
}

impl InputScaling {
    /// What is subtracted from each channel of an observation, and what it is multiplied with then.
    #[must_use]
    pub fn shift_and_scale(self, statistics: &ObservationStatistics) -> [Vec<f32>; 2] {
        let channels = statistics.mean.len();
        match self {
            Self::Raw {} => [vec![0.0; channels], vec![1.0; channels]],
            Self::Standard { floor } => [
                statistics.mean.clone(),
                (statistics.std.iter().zip(statistics.at_least(floor)))
                    .map(|(std, floor)| 1.0 / std.max(floor))
                    .collect(),
            ],
        }
    }
}
