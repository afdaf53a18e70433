//! What touches every parameter once: an optimiser's step and the averaging of a target network.

use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;

use crate::nn::adam::AdamStep;

use super::layout::{Layout, Row, ZERO};

/// Rows that are handed out at a time.
const CHUNK: usize = 1024;

/// One step of Adam on every row.
pub(super) fn adam(
    step: AdamStep,
    parameters: &mut [Row],
    firsts: &mut [Row],
    seconds: &mut [Row],
    gradients: &[Row],
) {
    let arch = Arch::new();
    parameters
        .par_chunks_mut(CHUNK)
        .zip(firsts.par_chunks_mut(CHUNK))
        .zip(seconds.par_chunks_mut(CHUNK))
        .zip(gradients.par_chunks(CHUNK))
        .for_each(|(((parameters, firsts), seconds), gradients)| {
            arch.dispatch(Adam {
                step,
                parameters,
                firsts,
                seconds,
                gradients,
            });
        });
}

/// `old <- (1 - rate) old + rate new` in every row.
pub(super) fn polyak(old: &mut [Row], new: &[Row], rate: f32) {
    let arch = Arch::new();
    old.par_chunks_mut(CHUNK)
        .zip(new.par_chunks(CHUNK))
        .for_each(|(old, new)| arch.dispatch(Polyak { old, new, rate }));
}

/// `velocity <- momentum velocity + gradient`, then `parameter <- parameter - rate velocity`, in every row.
pub(super) fn descend(
    parameters: &mut [Row],
    velocities: &mut [Row],
    gradients: &[Row],
    [momentum, rate]: [f32; 2],
) {
    let rows = parameters.par_iter_mut().zip(velocities).zip(gradients);
    rows.with_min_len(CHUNK).for_each(|((p, v), g)| {
        for ((p, v), g) in p.0.iter_mut().zip(&mut v.0).zip(&g.0) {
            *v = momentum * *v + g;
            *p -= rate * *v;
        }
    });
}

/// Shrinks each weight matrix of a member whose Frobenius norm is above `limit` to that norm.
pub(super) fn project(layout: &Layout, rows: &mut [Row], limit: f64) {
    for layer in &layout.layers {
        let rows = &mut rows[layer.rows.clone()];
        // Columns are summed side by side, and what fills up a panel is zero.
        let mut squares = ZERO;
        for panel in rows.chunks_exact(layer.panel_rows()) {
            for row in &panel[..panel.len() - 1] {
                for (sum, weight) in squares.0.iter_mut().zip(&row.0) {
                    *sum += weight * weight;
                }
            }
        }
        let norm = squares.0.iter().map(|&sum| f64::from(sum)).sum::<f64>();
        let norm = norm.sqrt();
        if norm <= limit {
            continue;
        }
        let factor = (limit / norm) as f32;
        for panel in rows.chunks_exact_mut(layer.panel_rows()) {
            let weights = panel.len() - 1;
            for weight in panel[..weights].iter_mut().flat_map(|row| &mut row.0) {
                *weight *= factor;
            }
        }
    }
}

struct Adam<'a> {
    step: AdamStep,
    parameters: &'a mut [Row],
    firsts: &'a mut [Row],
    seconds: &'a mut [Row],
    gradients: &'a [Row],
}

impl WithSimd for Adam<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let moments = self.firsts.iter_mut().zip(self.seconds);
        let rows = self.parameters.iter_mut().zip(moments);
        for ((p, (m, v)), g) in rows.zip(self.gradients) {
            let moments = m.0.iter_mut().zip(&mut v.0);
            for ((p, (m, v)), g) in p.0.iter_mut().zip(moments).zip(&g.0) {
                self.step.apply(p, m, v, *g);
            }
        }
    }
}

struct Polyak<'a> {
    old: &'a mut [Row],
    new: &'a [Row],
    rate: f32,
}

impl WithSimd for Polyak<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        for (old, new) in self.old.iter_mut().zip(self.new) {
            for (old, new) in old.0.iter_mut().zip(&new.0) {
                *old = (1.0 - self.rate) * *old + self.rate * new;
            }
        }
    }
}
