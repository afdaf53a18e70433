//! The columns of an episode's Arrow file, copied into the slots of the dataset in memory.

use super::arrow_file::record_batches;
use super::numbers::{NotExact, widened};
use crate::dataset::assemble::EpisodeSlots;
use crate::dataset::{DatasetError, Shape};
use arrow_array::cast::AsArray;
use arrow_array::types::Float32Type;
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

    /// The first `count` values of a part in double precision. Each must be there.
    fn widened(
        &self,
        name: &str,
        expected: &str,
        part: &dyn Array,
        count: usize,
    ) -> Result<Vec<f64>, DatasetError> {
        let part = part.slice(0, count.min(part.len()));
        self.refuse_nulls(name, part.len(), &part)?;
        widened(&part).map_err(|why| match why {
            NotExact::NotNumbers => self.wrong(name, expected.into(), part.data_type()),
            NotExact::TooLarge { place, number } => DatasetError::WrongShape {
                place: self.place.into(),
                array: name.into(),
                expected: "numbers that double precision holds".into(),
                actual: format!("{number} as value {place}"),
            },
        })
    }

    /// Copies lists of `width` numbers until `slot` is full.
    fn copy_rows(
        &self,
        name: &'static str,
        width: usize,
        slot: &mut [f32],
    ) -> Result<(), DatasetError> {
        let mut slot = slot;
        for part in self.parts(name)? {
            let expected = format!("lists of {width} numbers");
            let wrong = || self.wrong(name, expected.clone(), part.data_type());
            let lists = part.as_fixed_size_list_opt().ok_or_else(wrong)?;
            if usize::try_from(lists.value_length()) != Ok(width) {
                return Err(wrong());
            }
            let count = lists.len().min(slot.len() / width);
            self.refuse_nulls(name, count, lists)?;
            let (head, tail) = slot.split_at_mut(count * width);
            slot = tail;
            let values = lists.values();
            if let Some(values) = values.as_primitive_opt::<Float32Type>() {
                self.refuse_nulls(name, head.len(), values)?;
                head.copy_from_slice(&values.values()[..head.len()]);
            } else {
                let values = self.widened(name, &expected, values, head.len())?;
                for (narrow, value) in head.iter_mut().zip(values) {
                    *narrow = value as f32;
                }
            }
        }
        Ok(())
    }

    fn copy_flags(&self, name: &'static str, slot: &mut [bool]) -> Result<(), DatasetError> {
        let mut slot = slot;
        for part in self.parts(name)? {
            let count = part.len().min(slot.len());
            let (head, tail) = slot.split_at_mut(count);
            slot = tail;
            self.flags(name, part, head)?;
        }
        Ok(())
    }

    /// The first values of a part as flags: true or false, or 0 or 1 in any type.
    fn flags(&self, name: &str, part: &dyn Array, slot: &mut [bool]) -> Result<(), DatasetError> {
        const EXPECTED: &str = "true or false, or 0 or 1";
        let values = self.widened(name, EXPECTED, part, slot.len())?;
        for (row, (flag, value)) in slot.iter_mut().zip(values).enumerate() {
            if value != 0.0 && value != 1.0 {
                return Err(DatasetError::WrongShape {
                    place: self.place.into(),
                    array: name.into(),
                    expected: EXPECTED.into(),
                    actual: format!("{value} in row {row}"),
                });
            }
            *flag = value == 1.0;
        }
        Ok(())
    }

    /// Row `t + 1` of the info `success` belongs to step `t`; a dataset without it leaves the slot at false.
    fn copy_success(&self, slot: &mut [bool]) -> Result<(), DatasetError> {
        let mut slot = slot;
        // The first row is that of the reset: what it says is about no step.
        let mut skip = 1;
        for batch in self.batches {
            let infos = batch
                .column_by_name("infos")
                .and_then(|infos| infos.as_struct_opt());
            let Some(success) =
                infos.and_then(|infos: &StructArray| infos.column_by_name("success"))
            else {
                return Ok(());
            };
            let first = skip.min(success.len());
            skip -= first;
            let (head, tail) = slot.split_at_mut(success.len() - first);
            slot = tail;
            self.flags("infos/success", &success.slice(first, head.len()), head)?;
        }
        Ok(())
    }

    fn numbers(&self, name: &'static str, steps: usize) -> Result<Vec<f64>, DatasetError> {
        let mut numbers = Vec::with_capacity(steps);
        for part in self.parts(name)? {
            let left = steps - numbers.len();
            numbers.extend(self.widened(name, "numbers", part, left)?);
        }
        Ok(numbers)
    }
}
