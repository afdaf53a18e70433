//! Numbers of every type that Python tools write, in double precision: exactly, or not at all.

use arrow_array::cast::AsArray;
use arrow_array::types::{
    Float16Type, Float32Type, Float64Type, Int8Type, Int16Type, Int32Type, Int64Type, UInt8Type,
    UInt16Type, UInt32Type, UInt64Type,
};
use arrow_array::{Array, ArrowPrimitiveType};
use arrow_schema::DataType;

/// Why a column cannot be taken for numbers.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum NotExact {
    /// It holds something else.
    NotNumbers,
    /// A whole number beyond what double precision tells apart, and its place.
    TooLarge { place: usize, number: i128 },
}

/// All values of a column; false is 0, and true is 1. What a null holds is anything.
pub(super) fn widened(values: &dyn Array) -> Result<Vec<f64>, NotExact> {
    match values.data_type() {
        DataType::Boolean => {
            let flags = values.as_boolean().values();
            Ok(flags.iter().map(|flag| f64::from(u8::from(flag))).collect())
        }
        DataType::Float16 => Ok(each::<Float16Type>(values)),
        DataType::Float32 => Ok(each::<Float32Type>(values)),
        DataType::Float64 => Ok(each::<Float64Type>(values)),
        DataType::Int8 => Ok(each::<Int8Type>(values)),
        DataType::Int16 => Ok(each::<Int16Type>(values)),
        DataType::Int32 => Ok(each::<Int32Type>(values)),
        DataType::UInt8 => Ok(each::<UInt8Type>(values)),
        DataType::UInt16 => Ok(each::<UInt16Type>(values)),
        DataType::UInt32 => Ok(each::<UInt32Type>(values)),
        DataType::Int64 => whole::<Int64Type>(values),
        DataType::UInt64 => whole::<UInt64Type>(values),
        _ => Err(NotExact::NotNumbers),
    }
}

/// Values of a type that double precision holds all of.
fn each<T: ArrowPrimitiveType<Native: Into<f64>>>(values: &dyn Array) -> Vec<f64> {
    let values = values.as_primitive::<T>().values().iter();
    values.map(|&value| value.into()).collect()
}

/// Whole numbers of 64 bits, of which it holds those up to 2^53 and some beyond.
fn whole<T: ArrowPrimitiveType<Native: Into<i128>>>(
    values: &dyn Array,
) -> Result<Vec<f64>, NotExact> {
    let values = values.as_primitive::<T>().values().iter();
    let exact = values.enumerate().map(|(place, &value)| {
        let number: i128 = value.into();
        let wide = number as f64;
        let exact = wide as i128 == number;
        exact
            .then_some(wide)
            .ok_or(NotExact::TooLarge { place, number })
    });
    exact.collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use arrow_array::{
        BooleanArray, Float32Array, Int8Array, Int64Array, PrimitiveArray, StringArray, UInt64Array,
    };

    #[test]
    fn every_numeric_type_is_widened_to_what_it_holds() {
        let half = <Float16Type as ArrowPrimitiveType>::Native::from_f32(-0.25);
        let columns: [&dyn Array; 6] = [
            &PrimitiveArray::<Float16Type>::from_value(half, 1),
            &Float32Array::from(vec![0.1]),
            &Int8Array::from(vec![-128]),
            &Int64Array::from(vec![-(1 << 53)]),
            &UInt64Array::from(vec![1 << 63]),
            &BooleanArray::from(vec![true]),
        ];
        let widened: Vec<_> = columns.iter().map(|it| widened(*it).unwrap()[0]).collect();
        let exact = [
            -0.25,
            f64::from(0.1_f32),
            -128.0,
            -9_007_199_254_740_992.0,
            9_223_372_036_854_775_808.0,
            1.0,
        ];
        assert_eq!(widened, exact);
    }

    #[test]
    fn a_whole_number_that_double_precision_does_not_hold_is_named_with_its_place() {
        let number = (1 << 53) + 1;
        let place = 2;
        assert_eq!(
            widened(&Int64Array::from(vec![0, 1, number])),
            Err(NotExact::TooLarge {
                place,
                number: number.into()
            })
        );
        let number = u64::MAX;
        assert_eq!(
            widened(&UInt64Array::from(vec![0, 1, number])),
            Err(NotExact::TooLarge {
                place,
                number: number.into()
            })
        );
        let text = StringArray::from(vec!["1"]);
        assert_eq!(widened(&text), Err(NotExact::NotNumbers));
    }
}
