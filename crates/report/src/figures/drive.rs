//! The voltage that drives a run, where it changes more than once: what current and bending answer to.

use plotters::element::PathElement;
use plotters::style::Color;

use super::axis::Axis;
use super::canvas::{Ink, svg};
use super::group::series;
use super::panel::{Margins, panel};
use ieap_domain::Drive;

/// Size, px: as wide as a response.
const SIZE: (u32, u32) = (super::shape::PAGE_WIDTH, 160);

/// Draws `drive` from `first_s` to `last_s` over the same axis as responses of the whole run. Where the source is
/// disconnected there is no line.
///
/// # Errors
/// The message of the drawing library.
pub fn drive(drive: &Drive, (first_s, last_s): (f64, f64), title: &str) -> Result<String, String> {
    let lines = held(drive, first_s, last_s);
    let levels = || lines.iter().flatten().map(|(_, voltage_v)| *voltage_v);
    let (low, high) = (levels().fold(0.0, f64::min), levels().fold(0.0, f64::max));
    let margin = 0.08 * (high - low).max(1e-3);
    let y = Axis::linear(low - margin, high + margin, "Voltage", "V", 4);
    let x = Axis::whole(first_s, last_s);
    svg(SIZE, title, "", |area| {
        let margins = Margins {
            left: 62,
            right: 16,
            top: 8,
            bottom: 42,
        };
        let mut chart = panel(area, margins, &x, &y, true)?;
        series(&mut chart, "Voltage", |chart| {
            let paths = lines
                .into_iter()
                .map(|line| PathElement::new(line, Ink::Vermillion.color().stroke_width(16)));
            chart
                .draw_series(paths)
                .map(|_| ())
                .map_err(|error| error.to_string())
        })
    })
}

/// Corners of the voltage over time, one line for each stretch in which it is held.
fn held(drive: &Drive, first_s: f64, last_s: f64) -> Vec<Vec<(f64, f64)>> {
    let mut lines = Vec::new();
    let mut line: Vec<(f64, f64)> = Vec::new();
    let mut level = Some(drive.baseline_v);
    let mut from_s = first_s;
    for (until_s, next) in drive.levels().chain([(last_s, None)]) {
        let until_s = until_s.clamp(from_s, last_s.max(from_s));
        match level {
            Some(voltage_v) => line.extend([(from_s, voltage_v), (until_s, voltage_v)]),
            None => lines.push(std::mem::take(&mut line)),
        }
        (level, from_s) = (next, until_s);
    }
    lines.push(line);
    lines.retain(|line| line.len() > 1);
    lines
}

#[cfg(test)]
mod tests {
    use super::*;
    use ieap_domain::{Level, Segment};

    #[test]
    fn a_voltage_is_a_line_and_an_open_circuit_a_gap() {
        let segment = |start_s, level| Segment::at(start_s, level);
        let pulses = Drive {
            baseline_v: 0.0,
            segments: vec![
                segment(0.0, Level::Voltage(2.0)),
                segment(60.0, Level::OpenCircuit),
                segment(90.0, Level::Voltage(-2.0)),
            ],
        };
        assert_eq!(
            held(&pulses, -5.0, 120.0),
            [
                vec![(-5.0, 0.0), (0.0, 0.0), (0.0, 2.0), (60.0, 2.0)],
                vec![(90.0, -2.0), (120.0, -2.0)],
            ]
        );
        let drawn = drive(&pulses, (-5.0, 120.0), "Voltage over the whole run").unwrap();
        assert!(drawn.contains("Voltage (V)") && !drawn.contains("NaN"), "{drawn}");
    }
}
