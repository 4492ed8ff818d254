//! Refusals as exceptions of `ieap._errors`, with place, reason and remedy kept apart.

use std::io::ErrorKind;

use ieap::domain::{Fault, Issue};
use ieap::pipeline::PipelineError;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// An input was refused.
pub fn refused(py: Python<'_>, issue: &Issue) -> PyErr {
    raised(
        py,
        "InputError",
        [&issue.message, &issue.place, &issue.mend, &issue.code],
    )
}

/// An argument makes no sense.
pub fn bad_argument(py: Python<'_>, place: &str, reason: &str, remedy: &str) -> PyErr {
    raised(py, "InputError", [reason, place, remedy, "bad-argument"])
}

/// A verb could not do its work.
pub fn failed(py: Python<'_>, error: &PipelineError) -> PyErr {
    let class = match error {
        error if error.is_fault() => "EngineFault",
        PipelineError::File { path, source, .. } if source.kind() == ErrorKind::NotFound => {
            let place = path.display().to_string();
            let parts = [
                "there is no such file",
                &place,
                "correct the path",
                "no-such-file",
            ];
            return raised(py, "MissingFileError", parts);
        }
        // An argument of the program has the name of that of Python.
        PipelineError::BadArgument { what, found, needed } => {
            let (found, needed) = (format!("found {found}"), format!("give {needed}"));
            let place = what.trim_start_matches('-').replace('-', "_");
            return bad_argument(py, &place, &found, &needed);
        }
        error if error.is_storage() => "CampaignError",
        _ => "InputError",
    };
    // The engine's sentences say place, reason and remedy in one.
    raised(py, class, [&error.to_string(), "", "", ""])
}

/// A fault of the program.
pub fn fault(py: Python<'_>, step: &str, reason: &str) -> PyErr {
    let fault = Fault {
        place: step.to_owned(),
        runs: Vec::new(),
        reason: reason.to_owned(),
    };
    raised(
        py,
        "EngineFault",
        [&fault.sentence(), "", "report it with the readings", "fault"],
    )
}

/// A document as its JSON.
pub fn json(py: Python<'_>, document: &impl serde::Serialize) -> PyResult<String> {
    serde_json::to_string(document).map_err(|error| fault(py, "a document", &error.to_string()))
}

fn raised(py: Python<'_>, class: &str, parts: [&str; 4]) -> PyErr {
    let made = || -> PyResult<PyErr> {
        let [reason, place, remedy, code] = parts;
        let class = py.import("ieap._errors")?.getattr(class)?;
        Ok(PyErr::from_value(class.call1((reason, place, remedy, code))?))
    };
    // Without the Python half of the package the reason at least is said.
    made().unwrap_or_else(|_| PyValueError::new_err(parts[0].to_owned()))
}
