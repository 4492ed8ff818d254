//! Simulated readings as a table.

use std::collections::BTreeMap;
use std::sync::Arc;

use ieap::domain::Quantity;
use ieap::pipeline::standalone::in_memory::{self, CurvesAsked};
use ieap::pipeline::standalone::simulate::Noise;
use ieap::truth::HiddenEffect;
use pyo3::prelude::*;

use crate::error::refused;
use crate::readings::Readings;
use crate::stated::{Stated, segments_of};
use crate::work::interruptible;

/// Simulates readings at `time_s` (s); `noise` is that of the current (A), of the curvature (1/cm), and the correlation of
/// neighbouring readings; `places_mm` are those at which the distributed model gives the curvature.
#[pyfunction]
#[pyo3(signature = (model, parameters, stated, effects, time_s, noise = (0.0, 0.0, 0.0), seed = 1, places_mm = Vec::new()))]
#[expect(clippy::too_many_arguments, reason = "one for each thing that Python states")]
pub fn simulate(
    py: Python<'_>,
    model: String,
    parameters: BTreeMap<String, f64>,
    stated: &Stated,
    effects: Vec<(String, Option<String>, BTreeMap<String, f64>)>,
    time_s: Vec<f64>,
    noise: (f64, f64, f64),
    seed: u64,
    places_mm: Vec<f64>,
) -> PyResult<Readings> {
    let hidden = |(id, variant, parameters)| HiddenEffect {
        id,
        variant,
        parameters,
    };
    let asked = CurvesAsked {
        model,
        parameters,
        strip: stated.inner.strip,
        baseline_v: stated.inner.drive.as_ref().map_or(0.0, |drive| drive.baseline_v),
        drive: segments_of(stated.inner.drive.as_ref()),
        effects: effects.into_iter().map(hidden).collect(),
        noise: Noise {
            current_a: noise.0,
            curvature_per_cm: noise.1,
            autocorrelation: noise.2,
            ..Noise::default()
        },
        seed,
        time_s,
        places_mm,
    };
    let curves =
        interruptible(py, Some(1), || in_memory::simulate(&asked))?.map_err(|issue| refused(py, &issue))?;
    let mut columns = vec![
        ("time_s".to_owned(), curves.time_s),
        ("voltage_v".to_owned(), curves.voltage_v),
        ("current_a".to_owned(), curves.current_a),
    ];
    columns.extend(curves.curvatures.into_iter().map(|own| {
        let place = own.place_mm.map_or(String::new(), |place| format!("@{place} mm"));
        (format!("{}{place}", Quantity::Curvature.column()), own.per_cm)
    }));
    if curves.is_open.contains(&true) {
        let open = curves.is_open.iter().map(|&is_open| f64::from(u8::from(is_open)));
        columns.push(("open_circuit".to_owned(), open.collect()));
    }
    let columns = columns
        .into_iter()
        .map(|(name, numbers)| in_memory::Column::new(name, numbers));
    let read = in_memory::arrays(columns.collect()).map_err(|issue| refused(py, &issue))?;
    Ok(Readings {
        // What was stated of the simulation is known of its readings: the strip, and when the voltage changed.
        stated: Some(Arc::new(stated.inner.clone())),
        ..Readings::new(read, "simulated, not measured".to_owned())
    })
}
