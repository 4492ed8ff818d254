//! Fits used forward, and geometry: predictions, drives and conversions, each as the document that the program prints.

use std::collections::BTreeMap;

use ieap::domain::Drive;
use ieap::domain::typed_value::Measured;
use ieap::pipeline::standalone::convert::{MeasuredStrip, convert};
use ieap::pipeline::standalone::forward::{AskedStrip, DriveCourse, Predict, Wanted};
use pyo3::prelude::*;

use crate::error::failed;

/// Numbers by key, each with its standard error.
pub type Numbers = BTreeMap<String, (f64, f64)>;

fn measured(numbers: &Numbers, key: &str) -> Option<Measured> {
    let &(value, standard_error) = numbers.get(key)?;
    Some(Measured {
        value,
        standard_error,
    })
}

fn value(numbers: &Numbers, key: &str) -> Option<f64> {
    numbers.get(key).map(|number| number.0)
}

/// A strip and its surroundings: its sample, their environment, and a humidity that changes, rows of time (s) and percent.
pub type Strip = (String, Option<String>, Vec<(f64, f64)>);

fn strip((sample, environment, humidity_course): Strip, numbers: &Numbers) -> AskedStrip {
    AskedStrip {
        sample,
        environment,
        humidity_course,
        relative_humidity_percent: value(numbers, "relative_humidity_percent"),
        temperature_c: value(numbers, "temperature_c"),
        age_h: value(numbers, "age_h"),
        length_mm: measured(numbers, "length_mm"),
        width_mm: measured(numbers, "width_mm"),
        thickness_mm: measured(numbers, "thickness_mm"),
        modulus_mpa: measured(numbers, "modulus_mpa"),
        electrode_resistance_ohm_per_sq: value(numbers, "electrode_resistance_ohm_per_sq"),
    }
}

/// What is asked of `ieap predict`.
pub fn predict(of: Strip, numbers: &Numbers, drive: Drive, at_s: Vec<f64>) -> Predict {
    Predict {
        strip: strip(of, numbers),
        drive,
        at_s,
    }
}

/// What is asked of `ieap drive`; a course of one row is held for as long as its time says.
pub fn drive(of: Strip, numbers: &Numbers, course: Vec<(f64, f64)>) -> DriveCourse {
    let wanted = match course[..] {
        [(for_s, tip_mm)] => Wanted::Hold { tip_mm, for_s },
        _ => Wanted::Course(course),
    };
    DriveCourse {
        strip: strip(of, numbers),
        wanted,
        every_s: value(numbers, "every_s"),
        max_voltage_v: value(numbers, "max_voltage_v"),
        max_slope_v_per_s: value(numbers, "max_slope_v_per_s"),
        onset_v: measured(numbers, "onset_v"),
    }
}

/// What `ieap convert --json` prints.
#[pyfunction]
pub fn conversion(py: Python<'_>, given: &str, numbers: Numbers) -> PyResult<String> {
    let strip = MeasuredStrip {
        length_mm: measured(&numbers, "length_mm"),
        seen_at_mm: measured(&numbers, "seen_at_mm"),
        width_mm: measured(&numbers, "width_mm"),
        thickness_mm: measured(&numbers, "thickness_mm"),
        modulus_mpa: measured(&numbers, "modulus_mpa"),
        neutral_layer_shift_mm: measured(&numbers, "neutral_layer_shift_mm"),
        mean_elongation: measured(&numbers, "mean_elongation"),
    };
    let document = convert(given, &strip).map_err(|error| failed(py, &error))?;
    crate::error::json(py, &document)
}
