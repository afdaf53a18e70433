//! Ranges of numbers, and the error that names the field, the number and the range.

use crate::nn::Adam;

use super::ConfigError;

pub(super) fn adam(fields: [&'static str; 3], adam: Adam) -> Result<(), ConfigError> {
    let [beta1, beta2, epsilon] = fields;
    let decay = |field, value| within(field, value, (0.0..1.0).contains(&value), "in [0, 1)");
    decay(beta1, adam.beta1)?;
    decay(beta2, adam.beta2)?;
    // Where every gradient was zero, the step is divided by it.
    small(epsilon, adam.epsilon)
}

pub(super) fn at_least_one(field: &'static str, value: f64) -> Result<(), ConfigError> {
    within(field, value, value >= 1.0, "at least 1")
}

pub(super) fn positive(field: &'static str, value: f64) -> Result<(), ConfigError> {
    within(
        field,
        value,
        value > 0.0 && value.is_finite(),
        "in (0, inf)",
    )
}

/// What single precision can divide by.
pub(super) fn small(field: &'static str, value: f64) -> Result<(), ConfigError> {
    let holds = (1e-30..f64::INFINITY).contains(&value);
    within(field, value, holds, "in [1e-30, inf)")
}

pub(super) fn within(
    field: &'static str,
    value: f64,
    holds: bool,
    range: &'static str,
) -> Result<(), ConfigError> {
    if holds {
        Ok(())
    } else {
        Err(ConfigError::OutOfRange {
            field,
            value,
            range,
        })
    }
}

/// The double with the digits of a single: 1.01 stays 1.01 in a message.
pub(super) fn as_written(value: f32) -> f64 {
    value.to_string().parse().unwrap_or(value.into())
}

/// The controller's core has room for this many layers of this width.
pub(super) fn widths(field: &'static str, hidden: &[usize]) -> Result<(), ConfigError> {
    let fits = hidden.iter().all(|w| (1..=ted_core::MAX_WIDTH).contains(w))
        && hidden.len() < ted_core::MAX_LAYERS;
    if fits {
        Ok(())
    } else {
        Err(ConfigError::Widths {
            field,
            hidden: hidden.to_vec(),
        })
    }
}
