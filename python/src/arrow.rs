//! Arrow tables to and from other libraries by the PyCapsule interface: no library of theirs is needed, and nothing is copied.

use std::ffi::CStr;
use std::sync::Arc;

use arrow_array::cast::AsArray;
use arrow_array::ffi::{FFI_ArrowArray, FFI_ArrowSchema, from_ffi};
use arrow_array::ffi_stream::{FFI_ArrowArrayStream, RecordBatchStreamReader};
use arrow_array::{
    Array, ArrayRef, RecordBatch, RecordBatchIterator, RecordBatchOptions, RecordBatchReader, make_array,
};
use arrow_schema::{ArrowError, Field, Schema, SchemaRef};
use pyo3::prelude::*;
use pyo3::types::{PyCapsule, PyDict, PyList, PyTuple};

use crate::columns::{list_at, numbers, plain, text_at};
use crate::error::bad_argument;
use crate::numbers::Numbers;

// The names that the interface fixes.
const SCHEMA: &CStr = c"arrow_schema";
const ARRAY: &CStr = c"arrow_array";
const STREAM: &CStr = c"arrow_array_stream";

/// Columns that other libraries take as Arrow. Python has them as `ieap.Table`.
#[pyclass(frozen, module = "ieap._native")]
pub struct ArrowTable {
    batch: RecordBatch,
}

impl ArrowTable {
    /// A table of one batch.
    pub fn new(batch: RecordBatch) -> ArrowTable {
        ArrowTable { batch }
    }

    fn named(&self, py: Python<'_>, name: &str) -> PyResult<&ArrayRef> {
        self.batch.column_by_name(name).ok_or_else(|| {
            let remedy = format!("one of {}", self.column_names().join(", "));
            bad_argument(py, name, "the table has no such column", &remedy)
        })
    }
}

#[pymethods]
impl ArrowTable {
    #[getter]
    fn num_rows(&self) -> usize {
        self.batch.num_rows()
    }

    #[getter]
    fn column_names(&self) -> Vec<String> {
        let schema = self.batch.schema_ref();
        schema.fields().iter().map(|field| field.name().clone()).collect()
    }

    /// One column as a list; an empty cell is None.
    fn column<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        list_of(py, self.named(py, name)?)
    }

    /// The numbers of a column; none where it holds something else.
    fn numbers(&self, py: Python<'_>, name: &str) -> PyResult<Option<Numbers>> {
        Ok(Numbers::of(self.named(py, name)?))
    }

    #[pyo3(signature = (requested_schema = None))]
    fn __arrow_c_stream__<'py>(
        &self,
        py: Python<'py>,
        requested_schema: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyCapsule>> {
        // The interface lets a producer keep its own types.
        drop(requested_schema);
        stream(py, self.batch.clone())
    }

    fn __arrow_c_schema__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyCapsule>> {
        schema(py, self.batch.schema_ref())
    }
}

/// A table of results out of one that speaks Arrow.
#[pyfunction]
pub fn arrow_again(table: &Bound<'_, PyAny>) -> PyResult<ArrowTable> {
    let mut found = batches(table)?;
    Ok(ArrowTable::new(found.swap_remove(0)))
}

/// A column as a Python list: numbers, flags, words, lists of words or records.
fn list_of<'py>(py: Python<'py>, column: &ArrayRef) -> PyResult<Bound<'py, PyAny>> {
    let list = PyList::empty(py);
    let kind = column.data_type().clone();
    let is_whole = kind.is_integer();
    let is_flag = kind == arrow_schema::DataType::Boolean;
    let cells = numbers(column);
    for row in 0..column.len() {
        if column.is_null(row) {
            list.append(py.None())?;
        } else if let Some(cells) = &cells {
            match (is_flag, is_whole) {
                (true, _) => list.append(cells[row] != 0.0)?,
                (_, true) => list.append(cells[row] as i64)?,
                _ => list.append(cells[row])?,
            }
        } else if let Some(text) = text_at(column, row) {
            list.append(text)?;
        } else if let Some(items) = list_at(column, row) {
            list.append(list_of(py, &items)?)?;
        } else if let Some(record) = column.as_struct_opt() {
            let one = PyDict::new(py);
            for (field, part) in record.fields().iter().zip(record.columns()) {
                one.set_item(field.name(), list_of(py, &part.slice(row, 1))?.get_item(0)?)?;
            }
            list.append(one)?;
        } else {
            list.append(py.None())?;
        }
    }
    Ok(list.into_any())
}

fn stream<'py>(py: Python<'py>, batch: RecordBatch) -> PyResult<Bound<'py, PyCapsule>> {
    let schema = batch.schema();
    let reader = RecordBatchIterator::new([Ok(batch)], schema);
    PyCapsule::new_with_value(py, FFI_ArrowArrayStream::new(Box::new(reader)), STREAM)
}

fn schema<'py>(py: Python<'py>, schema: &SchemaRef) -> PyResult<Bound<'py, PyCapsule>> {
    let schema = FFI_ArrowSchema::try_from(schema.as_ref()).map_err(|error| unusable(py, &error))?;
    PyCapsule::new_with_value(py, schema, SCHEMA)
}

/// The batches of a table of any library that speaks Arrow, with every column's values in their rows.
///
/// # Errors
/// `InputError` where it does not, or hands on something else than a table.
pub fn batches(object: &Bound<'_, PyAny>) -> PyResult<Vec<RecordBatch>> {
    let told = |error: ArrowError| unusable(object.py(), &error);
    let handed = handed_on(object)?.into_iter();
    handed.map(|batch| unpacked(batch).map_err(told)).collect()
}

/// A batch whose columns hold their values themselves.
fn unpacked(batch: RecordBatch) -> Result<RecordBatch, ArrowError> {
    let columns: Vec<ArrayRef> = batch.columns().iter().map(plain).collect();
    let schema = batch.schema();
    let fields = schema.fields().iter().zip(&columns);
    let fields: Vec<Field> = fields
        .map(|(field, column)| {
            let field = field.as_ref().clone().with_data_type(column.data_type().clone());
            let may_be_empty = field.is_nullable() || column.null_count() > 0;
            field.with_nullable(may_be_empty)
        })
        .collect();
    let schema = Schema::new_with_metadata(fields, schema.metadata().clone());
    RecordBatch::try_new_with_options(
        Arc::new(schema),
        columns,
        &RecordBatchOptions::new().with_row_count(Some(batch.num_rows())),
    )
}

fn handed_on(object: &Bound<'_, PyAny>) -> PyResult<Vec<RecordBatch>> {
    let py = object.py();
    if object.hasattr("__arrow_c_stream__")? {
        let capsule = object
            .call_method0("__arrow_c_stream__")?
            .cast_into::<PyCapsule>()?;
        return of_stream(&capsule);
    }
    if object.hasattr("__arrow_c_array__")? {
        let pair = object.call_method0("__arrow_c_array__")?.cast_into::<PyTuple>()?;
        let schema = pair.get_item(0)?.cast_into::<PyCapsule>()?;
        let array = pair.get_item(1)?.cast_into::<PyCapsule>()?;
        return Ok(vec![of_array(&schema, &array)?]);
    }
    let kind = object.get_type().name()?.to_string();
    Err(bad_argument(
        py,
        "table",
        &format!("a {kind} does not speak Arrow (it has neither __arrow_c_stream__ nor __arrow_c_array__)"),
        "give a table of pyarrow, polars, pandas 2.2 or newer, or DuckDB",
    ))
}

#[expect(unsafe_code, reason = "the interface hands over C structures by pointer")]
fn of_stream(capsule: &Bound<'_, PyCapsule>) -> PyResult<Vec<RecordBatch>> {
    let pointer = capsule
        .pointer_checked(Some(STREAM))?
        .cast::<FFI_ArrowArrayStream>();
    // SAFETY: a capsule of that name holds a stream, and the capsule lives while this runs. The stream is moved out of
    // it, which leaves a released one behind, as the interface asks.
    let stream = unsafe { FFI_ArrowArrayStream::from_raw(pointer.as_ptr()) };
    let told = |error: ArrowError| unusable(capsule.py(), &error);
    let reader = RecordBatchStreamReader::try_new(stream).map_err(told)?;
    let schema = reader.schema();
    let mut batches = reader.collect::<Result<Vec<_>, _>>().map_err(told)?;
    if batches.is_empty() {
        batches.push(RecordBatch::new_empty(schema));
    }
    Ok(batches)
}

#[expect(unsafe_code, reason = "the interface hands over C structures by pointer")]
fn of_array(schema: &Bound<'_, PyCapsule>, array: &Bound<'_, PyCapsule>) -> PyResult<RecordBatch> {
    let told = |error: ArrowError| unusable(schema.py(), &error);
    let schema_pointer = schema.pointer_checked(Some(SCHEMA))?.cast::<FFI_ArrowSchema>();
    let array_pointer = array.pointer_checked(Some(ARRAY))?.cast::<FFI_ArrowArray>();
    // SAFETY: capsules of these names hold a schema and an array of it, and live while this runs. The array is moved out
    // of its capsule, which leaves a released one behind.
    let data = unsafe {
        let array = FFI_ArrowArray::from_raw(array_pointer.as_ptr());
        from_ffi(array, schema_pointer.as_ref())
    };
    let array = make_array(data.map_err(told)?);
    let Some(table) = array.as_struct_opt() else {
        return Err(bad_argument(
            schema.py(),
            "table",
            "a single column is no table",
            "give a table with columns",
        ));
    };
    Ok(RecordBatch::from(table.clone()))
}

fn unusable(py: Python<'_>, error: &ArrowError) -> PyErr {
    bad_argument(py, "table", &error.to_string(), "give a table with columns")
}
