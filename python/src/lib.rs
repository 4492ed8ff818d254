//! The compiled half of the Python package `ieap`: it converts, and calls the doors of `ieap::pipeline::standalone::in_memory`.
//!
//! What a Python user sees (names, defaults, docstrings, types) stands in `ieap/*.py` beside this.

mod alone;
mod arrow;
mod campaign;
mod campaign_rows;
mod columns;
mod error;
mod fit;
mod forward;
mod many;
mod numbers;
mod pickled;
mod readings;
mod results;
mod rows;
mod simulate;
mod stated;
mod work;

use std::ffi::OsString;

use pyo3::prelude::*;

/// The program `ieap` with these arguments, its own name first; its exit status.
#[pyfunction]
fn program(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
    py.detach(|| ieap::cli::status_after(arguments))
}

/// The compiled half of `ieap`.
#[pymodule]
fn _native(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("version", ieap::pipeline::CODE_VERSION)?;
    module.add_class::<arrow::ArrowTable>()?;
    module.add_class::<campaign::Campaign>()?;
    module.add_class::<fit::Fit>()?;
    module.add_class::<stated::Stated>()?;
    module.add_class::<numbers::Numbers>()?;
    module.add_class::<readings::Readings>()?;
    module.add_function(wrap_pyfunction!(program, module)?)?;
    module.add_function(wrap_pyfunction!(alone::impedance, module)?)?;
    module.add_function(wrap_pyfunction!(alone::cycles, module)?)?;
    module.add_function(wrap_pyfunction!(alone::schema, module)?)?;
    module.add_function(wrap_pyfunction!(alone::unit_of_key, module)?)?;
    module.add_function(wrap_pyfunction!(readings::read, module)?)?;
    module.add_function(wrap_pyfunction!(readings::arrays, module)?)?;
    module.add_function(wrap_pyfunction!(readings::unit_of, module)?)?;
    module.add_function(wrap_pyfunction!(readings::from_arrow, module)?)?;
    module.add_function(wrap_pyfunction!(fit::fit, module)?)?;
    module.add_function(wrap_pyfunction!(fit::diagnose, module)?)?;
    module.add_function(wrap_pyfunction!(simulate::simulate, module)?)?;
    module.add_function(wrap_pyfunction!(forward::conversion, module)?)?;
    module.add_function(wrap_pyfunction!(many::fit_many, module)?)?;
    module.add_function(wrap_pyfunction!(many::diagnose_rows, module)?)?;
    module.add_function(wrap_pyfunction!(arrow::arrow_again, module)?)?;
    module.add_function(wrap_pyfunction!(pickled::table_again, module)?)?;
    module.add_function(wrap_pyfunction!(pickled::stated_again, module)?)?;
    Ok(())
}
