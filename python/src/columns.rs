//! Arrow columns as numbers and words.

use std::sync::Arc;

use arrow_array::cast::AsArray;
use arrow_array::types::{
    ArrowPrimitiveType, Decimal32Type, Decimal64Type, Decimal128Type, DurationMicrosecondType,
    DurationMillisecondType, DurationNanosecondType, DurationSecondType, Float16Type, Float32Type,
    Float64Type, Int8Type, Int16Type, Int32Type, Int64Type, UInt8Type, UInt16Type, UInt32Type, UInt64Type,
};
use arrow_array::{Array, ArrayRef, Float64Array, PrimitiveArray, StringArray};
use arrow_schema::{DataType, TimeUnit};

/// The cells of a column of numbers, flags or durations (s); an empty one is NaN. None where the column holds something else.
pub fn numbers(array: &dyn Array) -> Option<Vec<f64>> {
    use DataType as T;
    Some(match array.data_type() {
        T::Float16 => of(array.as_primitive::<Float16Type>(), f64::from),
        T::Decimal32(_, scale) => fixed(array.as_primitive::<Decimal32Type>(), *scale, |x| f64::from(x)),
        T::Decimal64(_, scale) => fixed(array.as_primitive::<Decimal64Type>(), *scale, |x| x as f64),
        T::Decimal128(_, scale) => fixed(array.as_primitive::<Decimal128Type>(), *scale, |x| x as f64),
        T::Duration(unit) => durations(array, *unit),
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

/// Numbers of fixed point: whole ones over a power of ten, which rounds once.
fn fixed<T: ArrowPrimitiveType>(
    array: &PrimitiveArray<T>,
    scale: i8,
    number: fn(T::Native) -> f64,
) -> Vec<f64> {
    let ten = 10f64.powi(i32::from(scale.unsigned_abs()));
    let at_scale = |whole: f64| if scale < 0 { whole * ten } else { whole / ten };
    of(array, number).into_iter().map(at_scale).collect()
}

fn durations(array: &dyn Array, unit: TimeUnit) -> Vec<f64> {
    let (numbers, per_s) = match unit {
        TimeUnit::Second => (of(array.as_primitive::<DurationSecondType>(), |x| x as f64), 1.0),
        TimeUnit::Millisecond => (
            of(array.as_primitive::<DurationMillisecondType>(), |x| x as f64),
            1e3,
        ),
        TimeUnit::Microsecond => (
            of(array.as_primitive::<DurationMicrosecondType>(), |x| x as f64),
            1e6,
        ),
        TimeUnit::Nanosecond => (
            of(array.as_primitive::<DurationNanosecondType>(), |x| x as f64),
            1e9,
        ),
    };
    numbers.into_iter().map(|number| number / per_s).collect()
}

/// A column that names its values by their number among a few, as the values themselves; any other as it is.
pub fn plain(column: &ArrayRef) -> ArrayRef {
    let DataType::Dictionary(_, _) = column.data_type() else {
        return column.clone();
    };
    let dictionary = column.as_any_dictionary();
    let values = dictionary.values();
    if values.is_empty() {
        return Arc::new(Float64Array::new_null(column.len()));
    }
    let keys = dictionary.normalized_keys();
    let key = |row: usize| (!column.is_null(row)).then(|| keys[row]);
    let rows = 0..column.len();
    if is_text(values.data_type()) {
        let texts = rows.map(|row| key(row).and_then(|key| text_at(values, key)));
        return Arc::new(texts.collect::<StringArray>());
    }
    match numbers(values) {
        Some(numbers) => Arc::new(
            rows.map(|row| key(row).map(|key| numbers[key]))
                .collect::<Float64Array>(),
        ),
        None => column.clone(),
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

/// Whether a column holds durations, which have a unit of their own.
pub fn is_duration(kind: &DataType) -> bool {
    matches!(kind, DataType::Duration(_))
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

/// The list in a row, with its values in their places; none where the cell is empty.
pub fn list_at(array: &dyn Array, row: usize) -> Option<ArrayRef> {
    if array.is_null(row) {
        return None;
    }
    let list = match array.data_type() {
        DataType::List(_) => array.as_list::<i32>().value(row),
        DataType::LargeList(_) => array.as_list::<i64>().value(row),
        DataType::FixedSizeList(_, _) => array.as_fixed_size_list().value(row),
        _ => return None,
    };
    Some(plain(&list))
}
