//! Activations, with the same bits on every machine.

/// `v` where it is positive, otherwise positive zero (also for NaN and negative zero).
#[inline]
#[must_use]
pub fn relu(v: f32) -> f32 {
    if v > 0.0 { v } else { 0.0 }
}

/// Hyperbolic tangent from `libm`, never from the platform, whose last bits differ between systems.
#[inline]
#[must_use]
pub fn tanh(v: f32) -> f32 {
    libm::tanhf(v)
}
