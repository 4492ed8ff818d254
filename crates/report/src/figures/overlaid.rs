//! One response of all runs of a group on one axis, a line for each.

use ieap_domain::RunCurve;
use ieap_show::{Chart, Ink, Layer, Mark, Panel, Range};

use crate::blocks::chart::inline;

/// Shortest time that the axis tells apart, as a fraction of the longest.
const SHORTEST: f64 = 1e-6;

/// A run in the figure.
#[derive(Debug, Clone, Copy)]
pub struct Line<'a> {
    /// What its key says: the voltage.
    pub name: &'a str,
    /// Colour.
    pub ink: Ink,
    /// Its response.
    pub curve: &'a RunCurve,
    /// When its voltage stepped, s.
    pub step_s: f64,
}

impl Line<'_> {
    /// What is drawn: the fit, where there is one, for readings of several runs would hide each other.
    fn values(&self) -> &[f64] {
        if self.curve.fitted.len() == self.curve.time_s.len() {
            &self.curve.fitted
        } else {
            &self.curve.measured
        }
    }

    fn after_step(&self) -> impl Iterator<Item = (f64, f64)> {
        let times = self.curve.time_s.iter().map(|time_s| time_s - self.step_s);
        times
            .zip(self.values().iter().copied())
            .filter(|(t, y)| *t >= 0.0 && y.is_finite())
    }
}

/// Draws `lines`, which are of one quantity. None where there are fewer than two to draw.
///
/// # Errors
/// The message of the drawing library.
pub fn overlaid(lines: &[Line], title: &str, desc: &str) -> Result<Option<String>, String> {
    let lines: Vec<&Line> = lines
        .iter()
        .filter(|line| line.after_step().count() > 1)
        .collect();
    let Some(first) = lines.first().filter(|_| lines.len() > 1) else {
        return Ok(None);
    };
    let times_s = lines.iter().flat_map(|line| line.after_step()).map(|(t, _)| t);
    let quantity = first.curve.quantity;
    let layer = |line: &&Line| Layer::new(line.name, Mark::Line, line.ink, line.after_step());
    let panel = Panel {
        x: Range::since_step(times_s, SHORTEST),
        y: Range::linear(quantity.label(), quantity.unit()),
        layers: lines.iter().map(layer).collect(),
    };
    inline(&Chart::new(title, vec![panel]), title, desc).map(Some)
}

#[cfg(test)]
mod tests {
    use super::*;
    use ieap_domain::Quantity;

    fn curve(level: f64) -> RunCurve {
        let time_s: Vec<f64> = (0..200).map(|k| f64::from(k) - 2.0).collect();
        RunCurve {
            quantity: Quantity::Current,
            measured: time_s
                .iter()
                .map(|t| level * (-t.max(0.0) / 30.0).exp())
                .collect(),
            time_s,
            fitted: Vec::new(),
            residual_sigma: Vec::new(),
            readings: 200,
        }
    }

    #[test]
    fn every_run_is_a_line_on_one_axis() {
        let curves = [curve(1e-3), curve(2e-3)];
        let line = |name, at: usize| Line {
            name,
            ink: Ink::Ordered(at, 2),
            curve: &curves[at],
            step_s: 0.0,
        };
        let drawn = overlaid(&[line("1.2 V", 0), line("2.0 V", 1)], "t", "d")
            .unwrap()
            .unwrap();
        for name in ["1.2 V", "2.0 V"] {
            assert_eq!(drawn.matches(&format!("data-s=\"{name}\"")).count(), 1, "{drawn}");
        }
        assert_eq!(drawn.matches("data-f=").count(), 1);
        assert!(drawn.len() < 3_000, "{} bytes", drawn.len());
        assert_eq!(overlaid(&[line("1.2 V", 0)], "t", "d").unwrap(), None);
    }
}
