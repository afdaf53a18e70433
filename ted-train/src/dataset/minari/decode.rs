//! The columns of an episode's Arrow file, copied into the slots of the dataset in memory.

use super::arrow_file::record_batches;
use crate::dataset::assemble::EpisodeSlots;
use crate::dataset::{DatasetError, Shape};
use arrow_array::cast::AsArray;
use arrow_array::types::{Float32Type, Float64Type, Int64Type};
use arrow_array::{Array, ArrayRef, RecordBatch, StructArray};
use arrow_schema::DataType;

const COLUMNS: [&str; 6] = [
    "observations",
    "actions",
    "rewards",
    "terminations",
    "truncations",
    "infos",
];

/// Decodes the file at `place` into `slots` and returns its rewards.
pub(super) fn episode(
    bytes: Vec<u8>,
    place: &str,
    shape: Shape,
    slots: &mut EpisodeSlots,
) -> Result<Vec<f64>, DatasetError> {
    let batches = record_batches(bytes, &COLUMNS).map_err(|reason| DatasetError::Damaged {
        place: place.into(),
        reason,
    })?;
    let steps = slots.terminations.len();
    let rows: usize = batches.iter().map(RecordBatch::num_rows).sum();
    if rows != steps + 1 {
        return Err(DatasetError::WrongShape {
            place: place.into(),
            array: "row count".into(),
            expected: format!("{} rows for the {steps} steps of its metadata", steps + 1),
            actual: format!("{rows}"),
        });
    }
    let columns = Columns {
        place,
        batches: &batches,
    };
    columns.copy_rows("observations", shape.observation, slots.observations)?;
    columns.copy_rows("actions", shape.action, slots.actions)?;
    columns.copy_flags("terminations", slots.terminations)?;
    columns.copy_flags("truncations", slots.truncations)?;
    columns.copy_success(slots.success)?;
    columns.numbers("rewards", steps)
}

struct Columns<'a> {
    place: &'a str,
    batches: &'a [RecordBatch],
}

impl Columns<'_> {
    /// The parts of a column, one for each batch.
    fn parts(&self, name: &'static str) -> Result<Vec<&ArrayRef>, DatasetError> {
        self.batches
            .iter()
            .map(|batch| batch.column_by_name(name))
            .collect::<Option<_>>()
            .ok_or_else(|| DatasetError::MissingColumn {
                place: self.place.into(),
                column: name,
            })
    }

    fn wrong(&self, name: &str, expected: String, actual: &DataType) -> DatasetError {
        DatasetError::WrongShape {
            place: self.place.into(),
            array: name.into(),
            expected,
            actual: actual.to_string(),
        }
    }

    fn refuse_nulls(
        &self,
        name: &str,
        rows: usize,
        column: &dyn Array,
    ) -> Result<(), DatasetError> {
        match (0..rows).find(|&row| column.is_null(row)) {
            None => Ok(()),
            Some(row) => Err(DatasetError::WrongShape {
                place: self.place.into(),
                array: name.into(),
                expected: "a value in every row".into(),
                actual: format!("null in row {row}"),
            }),
        }
    }

    /// Copies lists of `width` floats until `slot` is full.
    fn copy_rows(
        &self,
        name: &'static str,
        width: usize,
        slot: &mut [f32],
    ) -> Result<(), DatasetError> {
        let mut slot = slot;
        for part in self.parts(name)? {
            let wrong = || self.wrong(name, format!("lists of {width} floats"), part.data_type());
            let lists = part.as_fixed_size_list_opt().ok_or_else(wrong)?;
            if usize::try_from(lists.value_length()) != Ok(width) {
                return Err(wrong());
            }
            let count = lists.len().min(slot.len() / width);
            self.refuse_nulls(name, count, lists)?;
            let (head, tail) = slot.split_at_mut(count * width);
            slot = tail;
            let values = lists.values();
            self.refuse_nulls(name, head.len(), values)?;
            if let Some(values) = values.as_primitive_opt::<Float32Type>() {
                head.copy_from_slice(&values.values()[..head.len()]);
            } else if let Some(values) = values.as_primitive_opt::<Float64Type>() {
                for (narrow, &value) in head.iter_mut().zip(values.values().iter()) {
                    *narrow = value as f32;
                }
            } else {
                return Err(wrong());
            }
        }
        Ok(())
    }

    fn copy_flags(&self, name: &'static str, slot: &mut [bool]) -> Result<(), DatasetError> {
        let mut slot = slot.iter_mut();
        for part in self.parts(name)? {
            let flags = part
                .as_boolean_opt()
                .ok_or_else(|| self.wrong(name, "true or false".into(), part.data_type()))?;
            self.refuse_nulls(name, slot.len().min(flags.len()), flags)?;
            // The slot comes first, so that a full slot takes nothing from the column.
            for (flag, value) in slot.by_ref().zip(flags.values().iter()) {
                *flag = value;
            }
        }
        Ok(())
    }

    /// Row `t + 1` of the info `success` belongs to step `t`; a dataset without it leaves the slot at false.
    fn copy_success(&self, slot: &mut [bool]) -> Result<(), DatasetError> {
        let mut solved = Vec::with_capacity(slot.len() + 1);
        for batch in self.batches {
            let infos = batch
                .column_by_name("infos")
                .and_then(|infos| infos.as_struct_opt());
            let Some(success) =
                infos.and_then(|infos: &StructArray| infos.column_by_name("success"))
            else {
                return Ok(());
            };
            self.refuse_nulls("infos/success", success.len(), success)?;
            if let Some(flags) = success.as_boolean_opt() {
                solved.extend(flags.values().iter());
            } else if let Some(numbers) = success.as_primitive_opt::<Float64Type>() {
                solved.extend(numbers.values().iter().map(|&number| number > 0.0));
            } else {
                let expected = "true or false, or 0.0 or 1.0".into();
                return Err(self.wrong("infos/success", expected, success.data_type()));
            }
        }
        slot.copy_from_slice(&solved[1..]);
        Ok(())
    }

    fn numbers(&self, name: &'static str, steps: usize) -> Result<Vec<f64>, DatasetError> {
        let mut numbers = Vec::with_capacity(steps + 1);
        for part in self.parts(name)? {
            self.refuse_nulls(name, part.len().min(steps - numbers.len().min(steps)), part)?;
            if let Some(part) = part.as_primitive_opt::<Float64Type>() {
                numbers.extend_from_slice(part.values());
            } else if let Some(part) = part.as_primitive_opt::<Float32Type>() {
                numbers.extend(part.values().iter().map(|&number| f64::from(number)));
            } else if let Some(part) = part.as_primitive_opt::<Int64Type>() {
                numbers.extend(part.values().iter().map(|&number| number as f64));
            } else {
                return Err(self.wrong(name, "numbers".into(), part.data_type()));
            }
        }
        numbers.truncate(steps);
        Ok(numbers)
    }
}
