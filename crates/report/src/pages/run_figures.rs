//! The figures of one run: its responses with fit and residuals, and the drive where it changes more than once.

use ieap_domain::words::counted;
use std::collections::BTreeMap;

use serde::Serialize;

use crate::error::ReportError;
use crate::figures;
use crate::figures::response::{TimeView, response};
use crate::readings_file;
use ieap_domain::{Drive, Level, RunCurve};

/// A response, or the drive, with its figures.
#[derive(Debug, Serialize)]
pub struct Response {
    heading: String,
    /// Which readings of the file beside the page it shows; empty of the drive.
    readings: String,
    /// Ids of the figures.
    pub figures: Vec<String>,
    /// `480 of 36000 readings drawn.`
    note: String,
    /// Whether its figure stands in a row of its own.
    own_row: bool,
}

/// Whose responses are drawn.
#[derive(Debug, Clone, Copy)]
pub struct Subject<'a> {
    /// The run's name, which tells its figures from those of others.
    pub name: &'a str,
    /// Start of the ids of its figures.
    pub id: &'a str,
    /// What drives it.
    pub drive: Option<&'a Drive>,
    /// Its curves.
    pub curves: &'a [RunCurve],
    /// Whether no result is made from it.
    pub aside: bool,
}

/// The figures of a run, which go to `figures`, and what is drawn in them.
///
/// # Errors
/// [`ReportError::Figure`]: a fault of the program.
pub fn responses(
    of: &Subject,
    figures: &mut BTreeMap<String, String>,
) -> Result<(Vec<Response>, String), ReportError> {
    let views = views(of.drive, of.curves);
    let mut responses: Vec<Response> = Vec::new();
    responses.extend(voltage(of, figures)?);
    for curve in of.curves {
        let response = drawn(of, &views, curve, figures)?;
        if !response.figures.is_empty() {
            responses.push(response);
        }
    }
    Ok((responses, drawn_words(&views, of)))
}

fn drawn(
    of: &Subject,
    views: &[View],
    curve: &RunCurve,
    figures: &mut BTreeMap<String, String>,
) -> Result<Response, ReportError> {
    let quantity = curve.quantity;
    let (mut ids, mut shown) = (Vec::new(), 0);
    for &(suffix, view, words) in views {
        let id = format!("{}{}-{suffix}", of.id, quantity.key().replace('_', "-"));
        let title = format!("{}{words}, {}", quantity.label(), of.name);
        let figure = response(curve, view, &title, of.aside).map_err(ReportError::of_figure(&id))?;
        if let Some(figure) = figure {
            figures.insert(id.clone(), figure.svg);
            shown = shown.max(figure.drawn);
            ids.push(id);
        }
    }
    Ok(Response {
        heading: quantity.label().to_owned(),
        readings: readings_file::key(of.name, quantity),
        figures: ids,
        note: if shown < curve.readings {
            format!("{shown} of {} readings drawn.", curve.readings)
        } else {
            format!("{}, all drawn.", counted(curve.readings, "reading"))
        },
        own_row: false,
    })
}

/// The drive over the whole run, where it changes more than once.
fn voltage(of: &Subject, figures: &mut BTreeMap<String, String>) -> Result<Option<Response>, ReportError> {
    let id = format!("{}voltage", of.id);
    let Some(drive) = of.drive.filter(|drive| drive.segments.len() > 1) else {
        return Ok(None);
    };
    let times = || of.curves.iter().flat_map(|curve| curve.time_s.iter().copied());
    let (first_s, last_s) = (
        times().fold(f64::INFINITY, f64::min),
        times().fold(f64::NEG_INFINITY, f64::max),
    );
    if first_s >= last_s {
        return Ok(None);
    }
    let title = format!("Voltage over the whole run, {}", of.name);
    let drawn = figures::drive::drive(drive, (first_s, last_s), &title);
    let svg = drawn.map_err(ReportError::of_figure(&id))?;
    figures.insert(id.clone(), svg);
    let opens = drive
        .segments
        .iter()
        .any(|segment| segment.level == Level::OpenCircuit);
    Ok(Some(Response {
        heading: "Voltage".to_owned(),
        readings: String::new(),
        figures: vec![id],
        note: if opens {
            "What drives the run; no line where the circuit is open.".to_owned()
        } else {
            "What drives the run.".to_owned()
        },
        own_row: true,
    }))
}

/// What dots, lines and the time axis are, once for all responses of a page.
fn drawn_words(views: &[View], of: &Subject) -> String {
    let fitted = of.curves.iter().any(|curve| !curve.fitted.is_empty());
    let words = match (of.aside, fitted) {
        (false, true) => "Dots are readings, lines the fit; below, residuals over the noise.",
        (false, false) => "Dots are readings; nothing is fitted.",
        (true, true) => {
            "Open dots and dashed lines: readings and fit of a run that is set aside, in no result; below, residuals over the noise."
        }
        (true, false) => "Open dots: readings of a run that is set aside, in no result; nothing is fitted.",
    };
    let mut words = words.to_owned();
    if matches!(views, [(_, TimeView::AboutStep { .. }, _)]) {
        words.push_str(" Time is logarithmic after the step.");
    }
    if of.curves.iter().any(|curve| curve.time_s.len() < curve.readings) {
        words.push_str(
            " Of a long run the smallest and the largest reading of each stretch of time are drawn: no peak is lost, and residuals look wider than they are.",
        );
    }
    words
}

/// End of a figure's id, its view, and what the view is of where there are several.
type View = (&'static str, TimeView, &'static str);

/// The time axes of the responses: see [`crate::figures::response`].
fn views(drive: Option<&Drive>, curves: &[RunCurve]) -> Vec<View> {
    let segments = drive.map_or(&[][..], |drive| &drive.segments);
    let step_s = segments.first().map_or(0.0, |segment| segment.start_s());
    let about_step = TimeView::about_step(step_s, curves).filter(|_| segments.len() == 1);
    if let Some(view) = about_step {
        return vec![("step", view, "")];
    }
    if drive.is_some_and(Drive::moves) {
        return vec![("whole", TimeView::Whole, "")];
    }
    let since = TimeView::SinceStep {
        step_s,
        until_s: segments.get(1).map_or(f64::INFINITY, |next| next.start_s()),
    };
    vec![
        ("whole", TimeView::Whole, " over the whole run"),
        ("step", since, " over the logarithm of the time since the step"),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use ieap_domain::{Quantity, Segment};

    #[test]
    fn one_step_has_one_figure_and_a_logarithmic_view_ends_at_the_next_change_of_the_drive() {
        let curves = [RunCurve {
            quantity: Quantity::Current,
            time_s: vec![-1.0, 0.5, 600.0],
            measured: vec![0.0; 3],
            fitted: vec![],
            residual_sigma: vec![],
            readings: 3,
        }];
        let mut drive = Drive::step(2.5);
        let about = TimeView::AboutStep {
            step_s: 0.0,
            first_s: -1.0,
            next_s: 0.5,
            last_s: 600.0,
        };
        assert_eq!(views(Some(&drive), &curves)[0].1, about);
        drive.segments[0].edge = ieap_domain::Edge::at(10.0);
        drive.segments.push(Segment::at(300.0, Level::OpenCircuit));
        let since = |step_s, until_s| TimeView::SinceStep { step_s, until_s };
        assert_eq!(views(Some(&drive), &curves)[1].1, since(10.0, 300.0));
        assert_eq!(views(None, &curves)[1].1, since(0.0, f64::INFINITY));
    }
}
