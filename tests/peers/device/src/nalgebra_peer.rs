//! nalgebra: the product of a static matrix and a static vector.

use alloc::boxed::Box;
use alloc::vec::Vec;
use core::hint::black_box;

use nalgebra::{SMatrix, SVector};

use crate::network::Layer;
use crate::section;

/// The action in f32.
#[inline(never)]
pub fn f32(layers: &[Layer], x: &[f32]) -> Vec<f32> {
    let [first, second, last] = layers else {
        unreachable!()
    };
    let (w1, b1) = parameters::<39, 256>(first);
    let (w2, b2) = parameters::<256, 256>(second);
    let (w3, b3) = parameters::<256, 4>(last);
    let x = SVector::<f32, 39>::from_column_slice(x);
    let (w1, w2, w3, x) = black_box((&w1, &w2, &w3, &x));
    let relu = |v: f32| if v > 0.0 { v } else { 0.0 };
    section::rest();
    let a = (&**w1 * x + b1).map(relu);
    let b = (&**w2 * a + b2).map(relu);
    let action = (&**w3 * b + b3).map(libm::tanhf);
    section::nalgebra_f32();
    action.iter().copied().collect()
}

fn parameters<const I: usize, const O: usize>(
    layer: &Layer,
) -> (Box<SMatrix<f32, O, I>>, SVector<f32, O>) {
    let weights = Box::new(SMatrix::from_row_slice(&layer.weights));
    (weights, SVector::from_column_slice(&layer.bias))
}
