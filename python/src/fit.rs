//! Fits and diagnoses of single calls.

use std::sync::{Arc, OnceLock};
use std::time::Instant;

use arrow_array::{ArrayRef, Float64Array, RecordBatch};
use arrow_schema::{DataType, Field, Schema};
use ieap::diagnose::Draws;
use ieap::domain::known_parameter::NotKnown;
use ieap::domain::{self, ChannelNoise, Issue, KnownParameter, Quantity};
use ieap::fit::FitOptions;
use ieap::pipeline::standalone::forward::fitted_covariance;
use ieap::pipeline::standalone::in_memory::{self, FitAtHand, RunAtHand};
use ieap::pipeline::{DiagnoseChoice, FitChoice};
use pyo3::prelude::*;

use crate::arrow::ArrowTable;
use crate::error::{bad_argument, failed, fault, json, refused};
use crate::readings::Readings;
use crate::stated::{Stated, over, segments_of};
use crate::work::interruptible;

/// A fit of one run.
#[pyclass(frozen, module = "ieap._native")]
pub struct Fit {
    pub fit: domain::Fit,
    pub stated: FitAtHand,
    pub run: RunAtHand,
    options: FitOptions<'static>,
    known: Vec<KnownParameter>,
    seconds: f64,
    /// The noise with its memory, growth and steps, which take several times as long as the fit: made when asked for.
    described: OnceLock<Vec<ChannelNoise>>,
}

impl Fit {
    fn described(&self, py: Python<'_>) -> &Vec<ChannelNoise> {
        let describe = || {
            let options = FitOptions {
                describes_noise: true,
                whole_curves: false,
                ..self.options
            };
            // The same fit again, which went well.
            let again = in_memory::fit(&self.run, &options, &self.known);
            again.map_or_else(|_| self.fit.noise.clone(), |(fit, _)| fit.noise)
        };
        py.detach(|| self.described.get_or_init(describe))
    }
}

#[pymethods]
impl Fit {
    /// Time that the engine took, s.
    #[getter]
    fn seconds(&self) -> f64 {
        self.seconds
    }

    /// The fit as `ieap fit --json` states it, less what only a campaign knows, and less what noise is like unless `whole`.
    fn document(&self, py: Python<'_>, whole: bool) -> PyResult<String> {
        if !whole {
            return json(py, &self.stated);
        }
        let stated = FitAtHand {
            noise: self.described(py).clone(),
            ..self.stated.clone()
        };
        json(py, &stated)
    }

    /// Keys of the parameters that simulating the fit needs.
    #[getter]
    fn needed_keys(&self) -> Vec<&str> {
        in_memory::needed_keys(&self.fit)
    }

    /// Places whose curvatures were fitted, mm from the clamp; none but of the distributed model.
    #[getter]
    fn places_mm(&self) -> Vec<f64> {
        in_memory::fitted_places_mm(&self.fit, &self.run)
    }

    /// Active area, cm2.
    #[getter]
    fn area_cm2(&self) -> f64 {
        self.run.area_cm2()
    }

    /// Free length, mm.
    #[getter]
    fn length_mm(&self) -> Option<f64> {
        self.run.length_cm().map(|length_cm| length_cm * 10.0)
    }

    /// Voltage held before the drive, V, and start (s) and voltage (V, None: open circuit) of each segment.
    #[getter]
    fn drive(&self) -> (f64, Vec<(f64, Option<f64>)>) {
        let drive = self.run.drive();
        (drive.baseline_v, segments_of(Some(drive)))
    }

    /// The same with the edges where the fit takes them to be, of those that only readings tell.
    fn drive_as_fitted(&self, py: Python<'_>) -> (f64, Vec<(f64, Option<f64>)>) {
        let drive = py.detach(|| in_memory::drive_as_fitted(&self.run, &self.options));
        (drive.baseline_v, segments_of(Some(&drive)))
    }

    /// Parameters that were searched, and Akaike's and the Bayesian information criterion; None where the noise is not known.
    fn criteria(&self, py: Python<'_>) -> Option<(usize, f64, f64)> {
        let fit = domain::Fit {
            noise: self.described(py).clone(),
            ..self.fit.clone()
        };
        let found = in_memory::criteria(&fit, &self.run)?;
        Some((found.parameters, found.aic, found.bic))
    }

    /// Keys of the determined parameters and their covariance, a row each; None where the model is no lumped one.
    fn covariance(&self) -> Option<(Vec<String>, Vec<Vec<f64>>)> {
        fitted_covariance(&self.fit, self.run.drive(), self.run.area_cm2())
    }

    /// Where the readings of a quantity lie in memory, for tests that nothing is copied.
    fn _address(&self, quantity: &str) -> Option<usize> {
        let asked = Quantity::from_key(quantity)?;
        let channel = self.run.channels().iter().find(|own| own.quantity == asked)?;
        Some(channel.values.as_ptr() as usize)
    }

    /// The drawn readings of `current` or `curvature` with the fitted values; None where it was not measured.
    fn curve(&self, py: Python<'_>, quantity: &str) -> PyResult<Option<ArrowTable>> {
        let Some(asked) = Quantity::from_key(quantity) else {
            return Err(bad_argument(
                py,
                "quantity",
                &format!("found {quantity:?}"),
                "current or curvature",
            ));
        };
        let Some(curve) = self.fit.curves.iter().find(|curve| curve.quantity == asked) else {
            return Ok(None);
        };
        let pairs = curve.measured.iter().zip(&curve.fitted);
        let left: Vec<f64> = pairs.map(|(measured, fitted)| measured - fitted).collect();
        let columns: [(&str, &Vec<f64>); 5] = [
            ("time_s", &curve.time_s),
            (asked.column(), &curve.measured),
            ("fitted", &curve.fitted),
            ("residual", &left),
            ("residual_sigma", &curve.residual_sigma),
        ];
        // What was drawn and not fitted has no fitted values.
        let there = columns
            .into_iter()
            .filter(|(_, numbers)| numbers.len() == curve.time_s.len());
        let (fields, columns): (Vec<Field>, Vec<ArrayRef>) = there
            .map(|(name, numbers)| {
                let column: ArrayRef = Arc::new(Float64Array::from(numbers.clone()));
                (Field::new(name, DataType::Float64, false), column)
            })
            .unzip();
        let batch = RecordBatch::try_new(Arc::new(Schema::new(fields)), columns);
        let batch = batch.map_err(|error| fault(py, "a curve", &error.to_string()))?;
        Ok(Some(ArrowTable::new(batch)))
    }
}

/// How runs are fitted.
pub fn choice(
    model: Option<String>,
    method: Option<String>,
    simultaneous: bool,
    seed: Option<u64>,
) -> FitChoice {
    FitChoice {
        model,
        method,
        simultaneous,
        seed,
        known: Vec::new(),
    }
}

/// What is known of parameters, as `ieap fit --set` states it.
pub fn known(py: Python<'_>, said: &[String]) -> PyResult<Vec<KnownParameter>> {
    let parse = |text: &String| {
        let refuse =
            |error: NotKnown| refused(py, &Issue::error("bad-argument", error.to_string()).at("known"));
        KnownParameter::parse(text).map_err(refuse)
    };
    said.iter().map(parse).collect()
}

pub fn run_of(py: Python<'_>, name: &str, table: &Readings, stated: &Stated) -> PyResult<RunAtHand> {
    let stated = over(&stated.inner, table.stated.as_deref());
    RunAtHand::new(name, &table.read, &stated).map_err(|issue| refused(py, &issue))
}

/// Fits one run.
#[pyfunction]
#[pyo3(signature = (name, table, stated, model = None, method = None, simultaneous = false, seed = None, known = Vec::new()))]
#[expect(clippy::too_many_arguments, reason = "one for each thing that Python states")]
pub fn fit(
    py: Python<'_>,
    name: &str,
    table: &Readings,
    stated: &Stated,
    model: Option<String>,
    method: Option<String>,
    simultaneous: bool,
    seed: Option<u64>,
    known: Vec<String>,
) -> PyResult<Fit> {
    let chosen = FitChoice {
        known: self::known(py, &known)?,
        ..choice(model, method, simultaneous, seed)
    };
    let begun = Instant::now();
    let mut options = in_memory::fit_options(&chosen).map_err(|issue| refused(py, &issue))?;
    // Who fits one run looks at its residuals, all of them.
    options.whole_curves = true;
    options.describes_noise = false;
    let run = run_of(py, name, table, stated)?;
    let (fit, stated) = py
        .detach(|| in_memory::fit(&run, &options, &chosen.known))
        .map_err(|issue| refused(py, &issue))?;
    Ok(Fit {
        seconds: begun.elapsed().as_secs_f64(),
        fit,
        stated,
        run,
        options,
        known: chosen.known,
        described: OnceLock::new(),
    })
}

/// The draws that are asked for, between the ends that the program takes.
pub fn draws_of(py: Python<'_>, draws: Option<usize>) -> PyResult<Option<usize>> {
    let known = draws.map(Draws::new).transpose();
    let known = known.map(|draws| draws.map(Draws::count));
    known.map_err(|needed| bad_argument(py, "draws", &needed, "give another number, or none"))
}

/// Diagnoses runs as one group; the finding as `ieap diagnose --json` states it.
#[pyfunction]
#[pyo3(signature = (group, runs, model = None, draws = None, seed = None, threads = None))]
pub fn diagnose(
    py: Python<'_>,
    group: &str,
    runs: Vec<(String, Py<Readings>, Py<Stated>)>,
    model: Option<String>,
    draws: Option<usize>,
    seed: Option<u64>,
    threads: Option<usize>,
) -> PyResult<String> {
    let runs = runs
        .iter()
        .map(|(name, table, stated)| run_of(py, name, table.get(), stated.get()))
        .collect::<PyResult<Vec<RunAtHand>>>()?;
    let draws = draws_of(py, draws)?;
    let choice = DiagnoseChoice { model, draws, seed };
    let found = interruptible(py, threads, || {
        in_memory::diagnose(group, &runs.iter().collect::<Vec<_>>(), &choice)
    })?;
    let entry = found
        .map_err(|error| failed(py, &error))?
        .map_err(|issue| refused(py, &issue))?;
    json(py, &entry)
}
