//! The numbers of a column where they lie, for numpy to look at and for who has none to copy.

use arrow_array::cast::AsArray;
use arrow_array::types::{Float64Type, Int64Type};
use arrow_array::{Array, ArrayRef};
use arrow_buffer::Buffer;
use arrow_schema::DataType;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

use crate::columns::numbers;

/// Numbers of eight bytes in one place. The interface of numpy, for the stable ABI of CPython 3.10 has no buffers.
#[pyclass(frozen, module = "ieap._native")]
pub struct Numbers {
    buffer: Buffer,
    is_whole: bool,
}

impl Numbers {
    /// Those of a column, in their place where no cell is empty; an empty one is NaN. None where it holds no numbers, or flags.
    pub fn of(column: &ArrayRef) -> Option<Numbers> {
        let whole = column.as_primitive_opt::<Int64Type>();
        let doubles = column.as_primitive_opt::<Float64Type>();
        let buffer = match (column.null_count(), whole, doubles) {
            (0, Some(whole), _) => whole.values().inner().clone(),
            (0, _, Some(doubles)) => doubles.values().inner().clone(),
            _ if *column.data_type() == DataType::Boolean => return None,
            _ => Buffer::from_vec(numbers(column)?),
        };
        Some(Numbers {
            buffer,
            is_whole: column.null_count() == 0 && whole.is_some(),
        })
    }
}

#[pymethods]
impl Numbers {
    /// As `array.array` of the standard library names them.
    #[getter]
    fn typecode(&self) -> &'static str {
        if self.is_whole { "q" } else { "d" }
    }

    fn tobytes<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        PyBytes::new(py, &self.buffer)
    }

    /// Read-only: Arrow shares the memory.
    #[getter]
    fn __array_interface__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let order = if cfg!(target_endian = "big") { ">" } else { "<" };
        let interface = PyDict::new(py);
        interface.set_item("version", 3)?;
        interface.set_item("shape", (self.buffer.len() / 8,))?;
        interface.set_item(
            "typestr",
            format!("{order}{}8", if self.is_whole { "i" } else { "f" }),
        )?;
        interface.set_item("data", (self.buffer.as_ptr() as usize, true))?;
        Ok(interface)
    }
}
