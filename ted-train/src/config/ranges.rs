//! Ranges of numbers, and the error that names the field, the number and the range.

use crate::nn::{Adam, AdamW};

use super::ConfigError;

/// A table of the configuration, by its name there; its checks take the names of its fields.
#[derive(Clone, Copy)]
pub(super) struct Table(pub(super) &'static str);

impl Table {
    pub(super) fn adam(self, field: &str, adam: Adam) -> Result<(), ConfigError> {
        self.below_one(&format!("{field}.beta1"), adam.beta1)?;
        self.below_one(&format!("{field}.beta2"), adam.beta2)?;
        // Where every gradient was zero, the step is divided by it.
        self.small(&format!("{field}.epsilon"), adam.epsilon)
    }

    pub(super) fn adamw(self, field: &str, adamw: AdamW) -> Result<(), ConfigError> {
        self.not_negative(&format!("{field}.weight_decay"), adamw.weight_decay)?;
        self.adam(&format!("{field}.adam"), adamw.adam)
    }

    pub(super) fn at_least_one(self, field: &str, value: f64) -> Result<(), ConfigError> {
        self.within(field, value, value >= 1.0, "at least 1")
    }

    /// How often something is done that takes time and no memory: more is a slip of the finger.
    pub(super) fn repeated(self, field: &str, value: f64) -> Result<(), ConfigError> {
        self.at_least_one(field, value)?;
        self.at_most(field, value, 1e9)
    }

    /// How many answers somebody is asked for.
    pub(super) fn answers(self, field: &str, value: f64) -> Result<(), ConfigError> {
        self.at_most(field, value, 1e5)
    }

    pub(super) fn at_most(self, field: &str, value: f64, most: f64) -> Result<(), ConfigError> {
        self.within(field, value, value <= most, &format!("at most {most}"))
    }

    /// A number such as a rate of decay.
    pub(super) fn below_one(self, field: &str, value: f64) -> Result<(), ConfigError> {
        self.within(field, value, (0.0..1.0).contains(&value), "in [0, 1)")
    }

    /// Heads, and a width of at least `least` that they share equally.
    pub(super) fn heads(self, heads: usize, width: usize, least: usize) -> Result<(), ConfigError> {
        self.at_least_one("heads", heads as f64)?;
        let holds = width >= least && width.is_multiple_of(heads);
        let range = format!("at least {least} and a multiple of {}.heads", self.0);
        self.within("width", width as f64, holds, &range)
    }

    pub(super) fn not_negative(self, field: &str, value: f64) -> Result<(), ConfigError> {
        let holds = value >= 0.0 && value.is_finite();
        self.within(field, value, holds, "in [0, inf)")
    }

    pub(super) fn percent(self, field: &str, value: f64) -> Result<(), ConfigError> {
        self.within(field, value, (0.0..=100.0).contains(&value), "in [0, 100]")
    }

    pub(super) fn positive(self, field: &str, value: f64) -> Result<(), ConfigError> {
        let holds = value > 0.0 && value.is_finite();
        self.within(field, value, holds, "in (0, inf)")
    }

    pub(super) fn share(self, field: &str, value: f64) -> Result<(), ConfigError> {
        self.within(field, value, (0.0..=1.0).contains(&value), "in [0, 1]")
    }

    /// What single precision can divide by.
    pub(super) fn small(self, field: &str, value: f64) -> Result<(), ConfigError> {
        let holds = (1e-30..f64::INFINITY).contains(&value);
        self.within(field, value, holds, "in [1e-30, inf)")
    }

    pub(super) fn within(
        self,
        field: &str,
        value: f64,
        holds: bool,
        range: &str,
    ) -> Result<(), ConfigError> {
        if holds {
            Ok(())
        } else {
            Err(ConfigError::OutOfRange {
                field: self.path(field),
                value,
                range: range.to_owned(),
            })
        }
    }

    /// The controller's core has room for this many layers of this width.
    pub(super) fn widths(self, field: &str, hidden: &[usize]) -> Result<(), ConfigError> {
        let fits = hidden.iter().all(|w| (1..=ted_core::MAX_WIDTH).contains(w))
            && hidden.len() < ted_core::MAX_LAYERS;
        if fits {
            Ok(())
        } else {
            Err(ConfigError::Widths {
                field: self.path(field),
                hidden: hidden.to_vec(),
            })
        }
    }

    fn path(self, field: &str) -> String {
        format!("{}.{field}", self.0)
    }
}

/// The double with the digits of a single: 1.01 stays 1.01 in a message.
pub(super) fn as_written(value: f32) -> f64 {
    value.to_string().parse().unwrap_or(value.into())
}
