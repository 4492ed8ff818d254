//! Pictures of one run along its strip: curvature over time at a few places, voltage along the strip at a few times.

use ieap_domain::number::plain;
use ieap_domain::words::counted;
use ieap_domain::{AlongCurve, AlongStrip};
use ieap_show::{Chart, Ink, Layer, Mark, Panel, Range};

use super::{millimetres, seconds};

/// Places drawn at most: the map shows all.
const PLACES: usize = 6;

/// The time of maps and charts: by its logarithm since the step, for charging takes seconds and creeping back hours; where
/// the drive changes again, linear.
pub fn time(strip: &AlongStrip) -> Range {
    let title = match strip.step_s {
        0.0 => "Time since the step".to_owned(),
        step_s => format!("Time since the step at {} s", plain(step_s)),
    };
    if strip.changes_again {
        Range::linear("Time", "s")
    } else {
        Range::log(title, "s")
    }
}

/// Frames of a curve that are shown, each with its number on the axis of time.
pub fn frames(strip: &AlongStrip, curve: &AlongCurve) -> Vec<(usize, f64)> {
    let since_s = if strip.changes_again { 0.0 } else { strip.step_s };
    let frames = curve.time_s.iter().map(|time_s| time_s - since_s).enumerate();
    frames
        .filter(|(_, at)| strip.changes_again || *at > 0.0)
        .collect()
}

/// Curvature over time at a few places; none where fewer than two frames can be shown.
pub fn places(strip: &AlongStrip) -> Option<Chart> {
    let curve = strip.curvature.as_ref()?;
    let frames = Some(frames(strip, curve)).filter(|frames| frames.len() > 1)?;
    let last = curve.places().saturating_sub(1);
    let most = PLACES.min(curve.places());
    // Evenly among all, the outermost ones with them.
    let mut shown: Vec<usize> = (0..most).map(|k| k * last / (most - 1).max(1)).collect();
    shown.dedup();
    let layers = shown.iter().enumerate().flat_map(|(k, &place)| {
        let points = |values: &[f64]| -> Vec<(f64, f64)> {
            let points = frames.iter().map(|(frame, at)| Some((*at, *values.get(*frame)?)));
            points.flatten().collect()
        };
        let word = millimetres(curve.position_mm[place]);
        let (measured, fitted) = (curve.measured_at(place), curve.fitted_at(place));
        pair(
            &word,
            Ink::Ordered(k, shown.len()),
            points(measured),
            points(fitted),
        )
    });
    let panel = Panel {
        x: time(strip),
        y: Range::linear("Curvature", "1/cm").with(0.0),
        layers: layers.collect(),
    };
    Some(Chart::new("Curvature at places", vec![panel]).told(format!(
        "At {} of {}, by their distance from the clamp. Dots are readings{}.",
        shown.len(),
        counted(curve.places(), "place"),
        lines(curve),
    )))
}

/// Voltage between the electrodes along the strip at a few times; none where none is known.
pub fn voltages(strip: &AlongStrip) -> Option<Chart> {
    let voltage = strip
        .voltage
        .as_ref()
        .filter(|_| !strip.voltage_frames.is_empty())?;
    // Where the model speaks of all places its line is smooth; else it joins the places of the readings.
    let even = strip.voltage_profile.as_ref();
    let even = even
        .filter(|even| even.time_s == voltage.time_s)
        .unwrap_or(voltage);
    let count = strip.voltage_frames.len();
    let layers = strip.voltage_frames.iter().enumerate().flat_map(|(k, &frame)| {
        let profile = |curve: &AlongCurve, of: for<'c> fn(&'c AlongCurve, usize) -> &'c [f64]| {
            let place = |place: usize| Some((curve.position_mm[place], *of(curve, place).get(frame)?));
            (0..curve.places()).filter_map(place).collect::<Vec<_>>()
        };
        let word = seconds(voltage.time_s[frame] - strip.step_s);
        let (measured, fitted) = (
            profile(voltage, AlongCurve::measured_at),
            profile(even, AlongCurve::fitted_at),
        );
        pair(&word, Ink::Ordered(k, count), measured, fitted)
    });
    let last_mm = voltage.position_mm[voltage.places() - 1];
    let length_mm = strip.length_mm.unwrap_or(last_mm).max(last_mm);
    let panel = Panel {
        x: Range::linear("Position", "mm").with(0.0).with(length_mm),
        y: Range::linear("Voltage", "V").with(0.0),
        layers: layers.collect(),
    };
    Some(Chart::new("Voltage along the strip", vec![panel]).told(format!(
        "Between the electrodes at a few times; position counts from the clamp. Dots are readings{}.",
        lines(voltage),
    )))
}

/// Readings as dots and, where there is a fit, its line in the same ink.
fn pair(word: &str, ink: Ink, measured: Vec<(f64, f64)>, fitted: Vec<(f64, f64)>) -> Vec<Layer> {
    let readings = Layer::new(word, Mark::Readings, ink, measured);
    let line = Layer::new(format!("{word}, simulated"), Mark::Line, ink, fitted);
    let line = Some(line).filter(|line| !line.points.is_empty());
    [readings].into_iter().chain(line).collect()
}

fn lines(curve: &AlongCurve) -> &'static str {
    if curve.fitted.is_empty() {
        ""
    } else {
        ", lines are simulated"
    }
}
