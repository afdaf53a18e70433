//! A robot about which nothing is known but how many numbers it has: every fact in it is a guess and marked as one.

use super::{Actuator, Fact, OnFault, Robot, Role, Sensor};

/// Time from one action to the next where nobody says: slow enough to look at.
const PERIOD_US: u32 = 50_000;

impl Robot {
    /// Of a robot with this many observation channels and these ranges of its actions.
    #[must_use]
    pub fn draft(observation: usize, action: &[[f32; 2]]) -> Self {
        Self {
            name: "my robot".to_owned(),
            period_us: PERIOD_US,
            max_observation_age_us: 2 * PERIOD_US,
            guessed: vec![Fact::Name, Fact::PeriodUs, Fact::MaxObservationAgeUs],
            observation: (0..observation)
                .map(|i| Sensor {
                    name: format!("observation_{i}"),
                    unit: String::new(),
                    range: None,
                    resolution: None,
                    role: Role::None,
                    guessed: vec![Fact::Name, Fact::Unit, Fact::Role],
                })
                .collect(),
            action: (action.iter().enumerate())
                .map(|(i, &range)| Actuator {
                    name: format!("action_{i}"),
                    unit: String::new(),
                    range,
                    slew_per_tick: None,
                    on_fault: if (range[0]..=range[1]).contains(&0.0) {
                        OnFault::ZERO
                    } else {
                        OnFault::HOLD
                    },
                    guessed: vec![Fact::Name, Fact::Unit, Fact::Range, Fact::OnFault],
                })
                .collect(),
        }
    }
}
