//! Curves of runs as several figures show them: measured as dots, simulated as a line of the same colour.

use super::FigureInput;
use crate::site::Site;
use ieap_domain::tag::keys;
use ieap_domain::{Level, Quantity, RunCurve, RunRecord};
use ieap_show::{Chart, Ink, Layer, Mark, Panel, Range};

const MILLI: f64 = 1e3;
/// Readings of a run without a fit that have a mark, about.
const MARKED: usize = 5;

/// One response of one run.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    /// Colour and marker.
    pub style: usize,
    /// Time since the step, s, and value as measured.
    pub measured: Vec<(f64, f64)>,
    /// The same as simulated; empty without a fit.
    pub fitted: Vec<(f64, f64)>,
    /// Number of the run among all that have a page.
    pub run: usize,
    /// Whether no result is made from it.
    pub aside: bool,
}

/// Responses of a run of that quantity: currents per area in mA cm⁻², curvatures in cm⁻¹, displacements in mm.
///
/// Fits are of curvatures, so that displacements are those of the strip's circle at its free length.
///
/// # Errors
/// The curves cannot be read.
pub fn lines(input: &FigureInput, run: usize, quantity: Quantity, style: usize) -> Result<Vec<Line>, String> {
    let record = input.site.input.record(run);
    let curves = input.curves.curves(record.id)?;
    let step_s = step_s(record);
    let of = |drawn: Quantity, shown: &dyn Fn(f64) -> f64| -> Vec<Line> {
        let of_quantity = curves.iter().filter(|curve| curve.quantity == drawn);
        of_quantity
            .map(|curve| Line {
                run,
                aside: !record.standing.speaks(),
                ..line(curve, style, step_s, shown)
            })
            .collect()
    };
    Ok(match quantity {
        // Without an area or a length there is nothing to relate to, and no place beside the others.
        Quantity::Current => (record.area_cm2).map_or(vec![], |area_cm2| {
            of(Quantity::Current, &|ampere| ampere * MILLI / area_cm2)
        }),
        Quantity::TipDisplacement => length_cm(input, record).map_or(vec![], |length_cm| {
            of(Quantity::Curvature, &|per_cm| displacement_mm(per_cm, length_cm))
        }),
        _ => of(quantity, &|value| value),
    })
}

/// Responses of the condemned runs that `style` gives a style from the indices of their material, surroundings and voltage.
///
/// # Errors
/// The curves cannot be read.
pub fn aside_lines(
    input: &FigureInput,
    quantity: Quantity,
    style: impl Fn((usize, usize, usize)) -> Option<usize>,
) -> Result<Vec<Line>, String> {
    let mut found = Vec::new();
    for aside in &input.site.aside {
        if let Some(style) = aside.condition.and_then(&style) {
            found.extend(lines(input, aside.run, quantity, style)?);
        }
    }
    Ok(found)
}

impl Line {
    /// Readings and what is simulated, which the legend calls `name`. A run that no result is made from is called by its own.
    fn layers(self, site: &Site, name: &str) -> [Layer; 2] {
        let ink = Ink::Series(self.style);
        // What tells lines apart without colour stands on the readings where nothing is fitted.
        let line = if self.fitted.is_empty() && !self.aside {
            let few = (self.measured.len() / MARKED).max(1);
            let marked: Vec<(f64, f64)> = self.measured.iter().skip(few / 2).step_by(few).copied().collect();
            Layer::new(name, Mark::Marks, ink, marked)
        } else {
            Layer::new(name, Mark::MarkedLine, ink, self.fitted)
        };
        let readings = Layer::new("", Mark::Readings, ink, self.measured);
        if !self.aside {
            return [readings, line];
        }
        let reason = site.input.record(self.run).standing.reason();
        let name = format!("{} ({reason})", site.run_name(self.run));
        [readings, line].map(|own| Layer {
            name: name.clone(),
            ..own.aside()
        })
    }

    /// Whether results are made from it and there is something to draw.
    pub fn is_shown(&self) -> bool {
        !self.aside && !self.measured.is_empty()
    }
}

/// A chart of lines, which the legend calls by the names of their styles; none without one that results are made from.
pub fn chart(
    site: &Site,
    title: String,
    (x, y): (Range, Range),
    lines: Vec<Line>,
    names: &[String],
) -> Option<Chart> {
    if !lines.iter().any(Line::is_shown) {
        return None;
    }
    let layers = |line: Line| {
        let name = names[line.style].as_str();
        line.layers(site, name)
    };
    let layers = lines.into_iter().flat_map(layers).collect();
    Some(Chart::new(title, vec![Panel { x, y, layers }]))
}

/// Free length of the run's sample, cm.
fn length_cm(input: &FigureInput, run: &RunRecord) -> Option<f64> {
    let sample = run.tag(keys::SAMPLE)?;
    let sample = input.site.input.campaign.sample(sample)?;
    sample.length_mm.map(|length_mm| length_mm / 10.0)
}

/// Displacement beside a point `length_cm` ahead of the clamp, mm: the thesis's (3) turned round on the first quarter of
/// the circle, which gives a displacement that the curvature was made of back. NaN where the circle does not reach it.
fn displacement_mm(curvature_per_cm: f64, length_cm: f64) -> f64 {
    let turn = curvature_per_cm * length_cm;
    10.0 * turn * length_cm / (1.0 + ((1.0 - turn) * (1.0 + turn)).sqrt())
}

/// When the voltage first leaves the baseline, s.
fn step_s(run: &RunRecord) -> f64 {
    let Some(drive) = &run.drive else { return 0.0 };
    let leaves = |level: Level| matches!(level, Level::Voltage(volts) if volts != drive.baseline_v);
    let first = drive.segments.iter().find(|segment| leaves(segment.level));
    first.map_or(0.0, |segment| segment.start_s())
}

fn line(curve: &RunCurve, style: usize, step_s: f64, shown: &dyn Fn(f64) -> f64) -> Line {
    let points = |values: &[f64]| -> Vec<(f64, f64)> {
        let pairs = curve.time_s.iter().zip(values);
        let points = pairs.map(|(time_s, value)| (time_s - step_s, shown(*value)));
        points
            .filter(|point| point.0.is_finite() && point.1.is_finite())
            .collect()
    };
    Line {
        style,
        measured: points(&curve.measured),
        fitted: points(&curve.fitted),
        run: 0,
        aside: false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_displacement_comes_back_from_the_curvature_it_was_made_of() {
        for (d_cm, length_cm) in [(0.02, 0.5), (-0.3, 0.5), (0.5, 0.5)] {
            let curvature = 2.0 * d_cm / (length_cm * length_cm + d_cm * d_cm);
            let back = displacement_mm(curvature, length_cm);
            assert!((back - 10.0 * d_cm).abs() < 1e-7, "{back} of {d_cm}");
        }
        assert!(displacement_mm(2.1, 0.5).is_nan());
    }
}
