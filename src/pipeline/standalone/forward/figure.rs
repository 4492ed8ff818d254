//! Predictions and found drives as figures for print.

use super::document::PredictedRow;
use super::{DriveDocument, PredictionDocument};
use crate::analysis::forecast::Forecast;
use crate::pipeline::PipelineError;
use crate::report::print_figures::predicted::{Course, courses};
use crate::report::print_figures::{Print, figure_format_named};

/// Width, mm, and resolution, dots per inch.
const WIDTH_MM: f64 = 85.0;
const DOTS_PER_INCH: f64 = 600.0;
const MILLI: f64 = 1e3;

/// The prediction over time, with its intervals, in the format of that name.
///
/// # Errors
/// There is no such format, or the drawing library's message.
pub fn prediction_figure(
    document: &PredictionDocument,
    notice: Option<&str>,
    format: &str,
) -> Result<Vec<u8>, PipelineError> {
    let series = |title: &str, unit: &str, scale: f64, of: &dyn Fn(&PredictedRow) -> Option<Forecast>| {
        let values = document
            .course
            .iter()
            .filter_map(|row| Some((row.time_s, of(row)?)));
        course(title, unit, scale, values, Vec::new())
    };
    let all = [
        series("Current", "mA", MILLI, &|row| Some(row.current_a)),
        series("Charge", "mC", MILLI, &|row| Some(row.charge_c)),
        series("Curvature", "cm⁻¹", 1.0, &|row| row.curvature_per_cm),
        series("Tip displacement", "mm", 1.0, &|row| row.tip_displacement_mm),
        series("Blocked moment", "mN mm", 1.0, &|row| row.blocked_moment_mn_mm),
    ];
    let strip = &document.strip;
    let title = format!(
        "Predicted for {} in {}, {} mm by {} mm, with 95 % intervals of a further run",
        document.sample, document.environment, strip.length_mm, strip.width_mm
    );
    written(&title, notice, &all, format)
}

/// The found drive, the wanted and the reached course, in the format of that name.
///
/// # Errors
/// There is no such format, or the drawing library's message.
pub fn course_figure(
    document: &DriveDocument,
    notice: Option<&str>,
    format: &str,
) -> Result<Vec<u8>, PipelineError> {
    let rows = &document.course;
    let wanted = rows.iter().map(|row| (row.time_s, row.wanted_mm)).collect();
    let reached = rows.iter().map(|row| (row.time_s, row.reached_mm));
    let voltage = Course {
        quantity: "Voltage".to_owned(),
        unit: "V".to_owned(),
        points: rows.iter().map(|row| (row.time_s, row.voltage_v)).collect(),
        band: Vec::new(),
        wanted: Vec::new(),
    };
    let all = [voltage, course("Tip displacement", "mm", 1.0, reached, wanted)];
    let title = format!(
        "Drive for {} in {}, and what it reaches",
        document.sample, document.environment
    );
    written(&title, notice, &all, format)
}

fn course(
    quantity: &str,
    unit: &str,
    scale: f64,
    values: impl Iterator<Item = (f64, Forecast)>,
    wanted: Vec<(f64, f64)>,
) -> Course {
    let (mut points, mut band) = (Vec::new(), Vec::new());
    for (time_s, predicted) in values {
        points.push((time_s, scale * predicted.value));
        band.push((scale * predicted.low_95, scale * predicted.high_95));
    }
    Course {
        quantity: quantity.to_owned(),
        unit: unit.to_owned(),
        points,
        band,
        wanted,
    }
}

fn written(
    title: &str,
    notice: Option<&str>,
    all: &[Course],
    format: &str,
) -> Result<Vec<u8>, PipelineError> {
    let format = figure_format_named(format).ok_or_else(|| PipelineError::BadArgument {
        what: "--output",
        found: format!("a file that ends in .{format}"),
        needed: "one that ends in .csv, .svg, .png or .pdf".to_owned(),
    })?;
    let failed = |reason| PipelineError::Figure {
        figure: "prediction",
        reason,
    };
    let drawing = courses(Print::pixels(WIDTH_MM), all).map_err(failed)?;
    let print = Print {
        title: title.to_owned(),
        notice: notice.map(str::to_owned),
        drawing,
        width_mm: WIDTH_MM,
    };
    (format.write)(&print, DOTS_PER_INCH).map_err(failed)
}
