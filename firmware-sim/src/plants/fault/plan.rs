//! Which fault strikes at which ticks, and how a person writes that: `nan@40`, `late@40+3`, `dropped~0.01`.

use std::fmt;
use std::str::FromStr;

use thiserror::Error;

use crate::splitmix::fraction;

/// What can be put between a plant and the controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Injected {
    /// One value is NaN.
    Nan,
    /// One value is infinite.
    Infinite,
    /// One value is finite but far out of any range.
    OutOfRange,
    /// The last value is missing.
    WrongLength,
    /// The frame is stamped a second ago.
    Stale,
    /// The frame is stamped a second ahead.
    Future,
    /// The frame before this one never arrived.
    Dropped,
    /// The frame before this one arrives again.
    Duplicated,
    /// The tick comes a second late.
    Late,
}

/// When a fault strikes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum When {
    /// For `count` ticks from `tick` on.
    At {
        /// The first tick, from zero.
        tick: u32,
        /// How many ticks.
        count: u32,
    },
    /// At every tick with this probability, from the injector's seed.
    Chance(f32),
}

/// A fault and when it strikes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaultPlan {
    /// What is injected.
    pub fault: Injected,
    /// At which ticks.
    pub when: When,
}

/// Text that is no fault plan.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error(
    "read the fault {text:?}: write KIND@TICK, KIND@TICK+COUNT or KIND~PROBABILITY, where KIND is one of {}",
    Injected::names()
)]
pub struct PlanError {
    text: String,
}

impl FaultPlan {
    /// Whether the fault strikes at this tick; `draw` decides where chance does.
    #[must_use]
    pub fn strikes(self, tick: u32, draw: u64) -> bool {
        match self.when {
            When::At { tick: first, count } => {
                tick.checked_sub(first).is_some_and(|after| after < count)
            }
            When::Chance(probability) => fraction(draw) < probability,
        }
    }
}

impl Injected {
    /// All of them.
    pub const ALL: [Self; 9] = [
        Self::Nan,
        Self::Infinite,
        Self::OutOfRange,
        Self::WrongLength,
        Self::Stale,
        Self::Future,
        Self::Dropped,
        Self::Duplicated,
        Self::Late,
    ];

    /// The name a person writes.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Nan => "nan",
            Self::Infinite => "infinite",
            Self::OutOfRange => "out-of-range",
            Self::WrongLength => "wrong-length",
            Self::Stale => "stale",
            Self::Future => "future",
            Self::Dropped => "dropped",
            Self::Duplicated => "duplicated",
            Self::Late => "late",
        }
    }

    fn names() -> String {
        Self::ALL.map(Self::name).join(", ")
    }
}

impl FromStr for FaultPlan {
    type Err = PlanError;

    fn from_str(text: &str) -> Result<Self, PlanError> {
        parse(text).ok_or_else(|| PlanError {
            text: text.to_owned(),
        })
    }
}

impl fmt::Display for FaultPlan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = self.fault.name();
        match self.when {
            When::At { tick, count: 1 } => write!(f, "{name}@{tick}"),
            When::At { tick, count } => write!(f, "{name}@{tick}+{count}"),
            When::Chance(probability) => write!(f, "{name}~{probability}"),
        }
    }
}

fn parse(text: &str) -> Option<FaultPlan> {
    let (name, when) = match (text.split_once('@'), text.split_once('~')) {
        (Some((name, ticks)), None) => {
            let (tick, count) = ticks.split_once('+').unwrap_or((ticks, "1"));
            (
                name,
                When::At {
                    tick: tick.parse().ok()?,
                    count: count.parse().ok()?,
                },
            )
        }
        (None, Some((name, chance))) => {
            let chance = chance
                .parse()
                .ok()
                .filter(|chance| (0.0..=1.0).contains(chance))?;
            (name, When::Chance(chance))
        }
        _ => return None,
    };
    let fault = Injected::ALL
        .into_iter()
        .find(|fault| fault.name() == name)?;
    Some(FaultPlan { fault, when })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plans_are_read_as_they_are_written() {
        for text in ["nan@40", "late@40+3", "dropped~0.01"] {
            assert_eq!(text.parse::<FaultPlan>().unwrap().to_string(), text);
        }
    }

    #[test]
    fn text_that_is_no_plan_is_answered_with_the_kinds() {
        for text in [
            "",
            "nan",
            "nan@",
            "nan@-1",
            "nan@1+x",
            "nan~2",
            "nan~nan",
            "gremlin@3",
            "nan@1~0.5",
        ] {
            let error = text.parse::<FaultPlan>().unwrap_err().to_string();
            assert!(error.contains("out-of-range"), "{error}");
        }
    }

    #[test]
    fn a_plan_strikes_for_its_ticks_only() {
        let plan: FaultPlan = "late@2+2".parse().unwrap();
        let struck: Vec<u32> = (0..6).filter(|&tick| plan.strikes(tick, 0)).collect();
        assert_eq!(struck, [2, 3]);
    }

    #[test]
    fn chance_strikes_as_often_as_it_says() {
        let plan: FaultPlan = "nan~0.25".parse().unwrap();
        let struck = (0..4000)
            .filter(|&index| plan.strikes(0, crate::splitmix::mix(1, index)))
            .count();
        assert!((900..1100).contains(&struck), "{struck}");
    }
}
