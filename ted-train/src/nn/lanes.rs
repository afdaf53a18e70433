//! Tensors whose first axis goes lane by lane: from numbers on the host, and back to one number a lane.

use burn::tensor::{Device, Tensor, TensorData};

/// Numbers in row-major order as `[lane, row, width]`; the width follows from how many there are.
pub(crate) fn tensor(data: &[f32], lanes: usize, rows: usize, device: &Device) -> Tensor<3> {
    let width = data.len() / (lanes * rows);
    let data = TensorData::new(data.to_vec(), [lanes, rows, width]);
    Tensor::from_data(data, device)
}

/// The mean of each lane's share.
pub(crate) fn means(tensor: Tensor<3>, lanes: usize) -> Vec<f32> {
    let share = tensor.shape().num_elements() / lanes;
    let means = tensor.reshape([lanes, share]).mean_dim(1);
    let means = means.into_data().try_to_vec();
    means.expect("a float tensor holds f32")
}
