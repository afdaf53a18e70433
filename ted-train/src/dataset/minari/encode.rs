//! An episode as one Arrow record batch, in the layout of Minari's Arrow storage.
//!
//! All columns have `T + 1` rows: the observations do, so actions, rewards and flags are padded by one row of zeros. The info
//! `success` starts with false (nothing has happened at reset), so that row `t + 1` belongs to step `t`, as Gymnasium counts.

use crate::dataset::{EpisodeRecord, Shape};
use arrow_array::types::{ArrowPrimitiveType, Float32Type, Float64Type};
use arrow_array::{
    ArrayRef, BooleanArray, FixedSizeListArray, Float64Array, PrimitiveArray, RecordBatch,
    StructArray,
};
use arrow_buffer::ScalarBuffer;
use arrow_ipc::writer::FileWriter;
use arrow_schema::{ArrowError, Field, Schema};
use std::collections::HashMap;
use std::sync::Arc;

/// The bytes of the Arrow file of `record`, whose shapes have been checked. They are a function of the record alone.
pub(super) fn episode_file(record: &EpisodeRecord, shape: Shape) -> Result<Vec<u8>, ArrowError> {
    let (_, observations) =
        rows::<Float32Type>("observations", &record.observations, shape.observation, 0)?;
    let (_, actions) = rows::<Float32Type>("actions", &record.actions, shape.action, 1)?;
    let mut rewards = record.rewards.clone();
    rewards.push(0.0);
    let columns: [(&str, ArrayRef); 6] = [
        ("observations", observations),
        ("actions", actions),
        ("rewards", Arc::new(Float64Array::from(rewards))),
        ("terminations", flags_then_false(&record.terminations)),
        ("truncations", flags_then_false(&record.truncations)),
        ("infos", infos(record)?),
    ];
    let fields: Vec<_> = columns
        .iter()
        .map(|(name, column)| Field::new(*name, column.data_type().clone(), true))
        .collect();
    let schema = Arc::new(Schema::new(fields));
    let batch = RecordBatch::try_new(
        schema.clone(),
        columns.into_iter().map(|(_, column)| column).collect(),
    )?;
    let mut writer = FileWriter::try_new(Vec::new(), &schema)?;
    writer.write(&batch)?;
    writer.into_inner()
}

/// `success` and the record's own columns as a struct.
fn infos(record: &EpisodeRecord) -> Result<ArrayRef, ArrowError> {
    let success: BooleanArray = std::iter::once(false)
        .chain(record.success.iter().copied())
        .map(Some)
        .collect();
    let success: ArrayRef = Arc::new(success);
    let mut fields = vec![Arc::new(Field::new(
        "success",
        success.data_type().clone(),
        true,
    ))];
    let mut columns = vec![success];
    for info in &record.infos {
        let (field, column) = rows::<Float64Type>(&info.name, &info.values, info.width, 0)?;
        // Minari restores the shape of an info from this entry.
        let shape = HashMap::from([("shape".to_string(), info.width.to_string())]);
        fields.push(Arc::new(field.with_metadata(shape)));
        columns.push(column);
    }
    Ok(Arc::new(StructArray::try_new(
        fields.into(),
        columns,
        None,
    )?))
}

/// Row-major `values` as a column of fixed-size lists, and `padding` rows of zeros after them.
fn rows<T: ArrowPrimitiveType>(
    name: &str,
    values: &[T::Native],
    width: usize,
    padding: usize,
) -> Result<(Field, ArrayRef), ArrowError> {
    let width_i32 = i32::try_from(width)
        .map_err(|_| ArrowError::InvalidArgumentError(format!("{name} is too wide")))?;
    let mut padded = Vec::with_capacity(values.len() + padding * width);
    padded.extend_from_slice(values);
    padded.resize(values.len() + padding * width, T::Native::default());
    let item = Arc::new(Field::new("item", T::DATA_TYPE, true));
    let values = Arc::new(PrimitiveArray::<T>::new(ScalarBuffer::from(padded), None));
    let column: ArrayRef = Arc::new(FixedSizeListArray::try_new(item, width_i32, values, None)?);
    Ok((Field::new(name, column.data_type().clone(), true), column))
}

fn flags_then_false(flags: &[bool]) -> ArrayRef {
    let column: BooleanArray = flags.iter().copied().chain([false]).map(Some).collect();
    Arc::new(column)
}
