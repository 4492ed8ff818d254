//! Arrow columns as numbers and words.

use arrow_array::cast::AsArray;
use arrow_array::types::{
    ArrowPrimitiveType, Float32Type, Float64Type, Int8Type, Int16Type, Int32Type, Int64Type, UInt8Type,
    UInt16Type, UInt32Type, UInt64Type,
};
use arrow_array::{Array, ArrayRef, PrimitiveArray};
use arrow_schema::DataType;

/// The cells of a column of numbers or flags; an empty one is NaN. None where the column holds something else.
pub fn numbers(array: &dyn Array) -> Option<Vec<f64>> {
    use DataType as T;
    Some(match array.data_type() {
        T::Float64 => of(array.as_primitive::<Float64Type>(), |x| x),
        T::Float32 => of(array.as_primitive::<Float32Type>(), f64::from),
        T::Int8 => of(array.as_primitive::<Int8Type>(), f64::from),
        T::Int16 => of(array.as_primitive::<Int16Type>(), f64::from),
        T::Int32 => of(array.as_primitive::<Int32Type>(), f64::from),
        T::Int64 => of(array.as_primitive::<Int64Type>(), |x| x as f64),
        T::UInt8 => of(array.as_primitive::<UInt8Type>(), f64::from),
        T::UInt16 => of(array.as_primitive::<UInt16Type>(), f64::from),
        T::UInt32 => of(array.as_primitive::<UInt32Type>(), f64::from),
        T::UInt64 => of(array.as_primitive::<UInt64Type>(), |x| x as f64),
        T::Boolean => {
            let flags = array.as_boolean().iter();
            flags
                .map(|flag| flag.map_or(f64::NAN, |flag| f64::from(u8::from(flag))))
                .collect()
        }
        T::Null => vec![f64::NAN; array.len()],
        _ => return None,
    })
}

fn of<T: ArrowPrimitiveType>(array: &PrimitiveArray<T>, number: fn(T::Native) -> f64) -> Vec<f64> {
    match array.null_count() {
        0 => array.values().iter().map(|&value| number(value)).collect(),
        _ => array.iter().map(|value| value.map_or(f64::NAN, number)).collect(),
    }
}

/// The word in a row of a column of texts; none where the cell is empty or the column holds something else.
pub fn text_at(array: &dyn Array, row: usize) -> Option<&str> {
    if array.is_null(row) {
        return None;
    }
    match array.data_type() {
        DataType::Utf8 => Some(array.as_string::<i32>().value(row)),
        DataType::LargeUtf8 => Some(array.as_string::<i64>().value(row)),
        DataType::Utf8View => Some(array.as_string_view().value(row)),
        _ => None,
    }
}

/// Whether a column holds texts.
pub fn is_text(kind: &DataType) -> bool {
    matches!(kind, DataType::Utf8 | DataType::LargeUtf8 | DataType::Utf8View)
}

/// Whether a column holds a list in each row.
pub fn is_list(kind: &DataType) -> bool {
    matches!(
        kind,
        DataType::List(_) | DataType::LargeList(_) | DataType::FixedSizeList(_, _)
    )
}

/// The list in a row; none where the cell is empty.
pub fn list_at(array: &dyn Array, row: usize) -> Option<ArrayRef> {
    if array.is_null(row) {
        return None;
    }
    match array.data_type() {
        DataType::List(_) => Some(array.as_list::<i32>().value(row)),
        DataType::LargeList(_) => Some(array.as_list::<i64>().value(row)),
        DataType::FixedSizeList(_, _) => Some(array.as_fixed_size_list().value(row)),
        _ => None,
    }
}
