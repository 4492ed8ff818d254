//! What a caller states of readings: the strip, the drive, tags.

use std::collections::BTreeMap;

use ieap::domain::tag::keys;
use ieap::domain::Drive;
use ieap::pipeline::standalone::in_memory;
use pyo3::prelude::*;

use crate::error::refused;

/// What a caller states of readings.
#[pyclass(frozen, module = "ieap._native")]
pub struct Stated {
    pub inner: in_memory::Stated,
}

#[pymethods]
impl Stated {
    #[new]
    #[pyo3(signature = (area_cm2 = None, length_mm = None, width_mm = None, electrode_resistance_ohm_per_sq = None,
                        baseline_v = 0.0, drive = Vec::new(), tags = BTreeMap::new()))]
    #[expect(clippy::too_many_arguments, reason = "one for each thing that Python states")]
    fn new(
        area_cm2: Option<f64>,
        length_mm: Option<f64>,
        width_mm: Option<f64>,
        electrode_resistance_ohm_per_sq: Option<f64>,
        baseline_v: f64,
        drive: Vec<(f64, Option<f64>)>,
        tags: BTreeMap<String, String>,
        py: Python<'_>,
    ) -> PyResult<Stated> {
        let strip = in_memory::Strip {
            area_cm2,
            length_mm,
            width_mm,
            electrode_resistance_ohm_per_sq,
        };
        let inner = in_memory::Stated {
            strip,
            drive: drive_of(baseline_v, &drive),
            tags,
        };
        let wrong = inner.contradiction().or_else(|| inner.misspelt().next());
        match wrong {
            Some(issue) => Err(refused(py, &issue)),
            None => Ok(Stated { inner }),
        }
    }

    /// For `pickle` and `copy`.
    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, (String,))> {
        let again = py.import("ieap._native")?.getattr("stated_again")?;
        Ok((again, (serde_json::json!(self.inner).to_string(),)))
    }
}

/// A drive of segments, start (s) and voltage (V, none: open circuit), each known exactly; none without a segment.
pub fn drive_of(baseline_v: f64, segments: &[(f64, Option<f64>)]) -> Option<Drive> {
    (!segments.is_empty()).then(|| Drive::of_levels(baseline_v, segments.iter().copied()))
}

/// Start (s) and voltage (V, none: open circuit) of each segment.
pub fn segments_of(drive: Option<&Drive>) -> Vec<(f64, Option<f64>)> {
    drive.into_iter().flat_map(Drive::levels).collect()
}

/// What is stated now over what came with the readings.
pub fn over(own: &in_memory::Stated, before: Option<&in_memory::Stated>) -> in_memory::Stated {
    let Some(before) = before else {
        return own.clone();
    };
    let (strip, earlier) = (own.strip, before.strip);
    let has_size = strip.area_cm2.is_some() || (strip.length_mm.is_some() && strip.width_mm.is_some());
    let has_drive = own.drive.is_some() || own.tags.contains_key(keys::VOLTAGE_V);
    let drive = if has_drive { own } else { before };
    let mut tags = before.tags.clone();
    tags.extend(own.tags.clone());
    in_memory::Stated {
        strip: in_memory::Strip {
            // An area that came with the readings does not stand beside a length and width stated now.
            area_cm2: if has_size {
                strip.area_cm2
            } else {
                earlier.area_cm2
            },
            length_mm: strip.length_mm.or(earlier.length_mm),
            width_mm: strip.width_mm.or(earlier.width_mm),
            electrode_resistance_ohm_per_sq: strip
                .electrode_resistance_ohm_per_sq
                .or(earlier.electrode_resistance_ohm_per_sq),
        },
        drive: drive.drive.clone(),
        tags,
    }
}
