//! Pictures of the climate: the logs of a whole campaign, and the air around one run.

use ieap_domain::{ClimateAssessment, ClimateCurve, ClimateQuantity, SensorSummary, range_of};
use ieap_show::{Chart, Form, Ink, Layer, Mark, Panel, Range};

/// A line is not drawn over a step this many times longer than most.
const GAP: f64 = 6.0;
/// Shorter times around a run are told in minutes, s.
const IN_HOURS_FROM_S: f64 = 10_800.0;

/// All sensors over time, a panel a quantity, with the runs (start and end, s since 1970 UTC) shaded; none without readings.
pub fn over_time(climate: &ClimateAssessment, runs_s: &[(f64, f64)]) -> Option<Chart> {
    let is_drawn = |sensor: &&SensorSummary| sensor.not_used.is_none() && !sensor.curve.0.is_empty();
    let drawn: Vec<&SensorSummary> = climate.sensors.iter().filter(is_drawn).collect();
    let ink = inks(drawn.iter().map(|sensor| sensor.sensor.as_str()));
    let (first_s, last_s) = range_of(drawn.iter().flat_map(|sensor| sensor.curve.0.iter().copied()));
    let within = runs_s
        .iter()
        .filter(|(from, to)| *to >= first_s && *from <= last_s);
    let within: Vec<(f64, f64)> = within.copied().collect();
    let line = |sensor: &SensorSummary| {
        let (times, values) = &sensor.curve;
        readings(&sensor.sensor, ink(&sensor.sensor), times, values)
    };
    let panel = |quantity: ClimateQuantity| {
        let own = drawn.iter().filter(|sensor| sensor.quantity == quantity);
        let mut lines: Vec<Layer> = own.map(|sensor| line(sensor)).collect();
        // Those without a colour of their own lie below the others.
        lines.sort_by_key(|line| line.ink != Ink::Guide);
        (!lines.is_empty()).then(|| shaded(quantity, Range::calendar(), &within, lines))
    };
    let panels: Vec<Panel> = ClimateQuantity::MEASURED.into_iter().filter_map(panel).collect();
    let chart = || Chart::new("All sensors over time", panels.clone()).formed(Form::Wide);
    (!panels.is_empty()).then(|| chart().told("Shaded: runs."))
}

/// The climate around a run of that length, a panel a quantity; none without readings.
pub fn around_run(curves: &[ClimateCurve], length_s: f64) -> Option<Chart> {
    if curves.iter().all(|curve| curve.time_s.len() < 2) {
        return None;
    }
    let times = || curves.iter().flat_map(|curve| curve.time_s.iter().copied());
    let (low, high) = range_of(times().chain([0.0, length_s]));
    let (unit, factor) = match high - low {
        short if short < IN_HOURS_FROM_S => ("min", 60.0),
        _ => ("h", 3600.0),
    };
    let x = Range::linear(format!("Time since the start of the run ({unit})"), "");
    let x = x.with(0.0).with(length_s / factor);
    let ink = inks(curves.iter().map(|curve| curve.sensor.as_str()));
    let panel = |curve: &ClimateCurve| {
        let time: Vec<f64> = curve.time_s.iter().map(|t| t / factor).collect();
        let line = readings(&curve.sensor, ink(&curve.sensor), &time, &curve.values);
        let run = [(0.0, length_s / factor)];
        shaded(curve.quantity, x.clone(), &run, vec![line])
    };
    let chart = Chart::new("Around the run", curves.iter().map(panel).collect());
    Some(chart.told("Shaded: the run."))
}

/// One colour a sensor in all panels; what is beyond them all has that of guides.
fn inks<'n>(sensors: impl Iterator<Item = &'n str>) -> impl Fn(&str) -> Ink + 'n {
    let mut names: Vec<&str> = Vec::new();
    for name in sensors {
        if !names.contains(&name) {
            names.push(name);
        }
    }
    move |sensor| match names.iter().position(|name| *name == sensor) {
        Some(at) if at < Ink::COLOURS => Ink::Series(at),
        _ => Ink::Guide,
    }
}

/// Lines over what is shaded. A steady climate is not blown up to fill the axis.
fn shaded(quantity: ClimateQuantity, x: Range, spans: &[(f64, f64)], lines: Vec<Layer>) -> Panel {
    let numbers = lines.iter().flat_map(|line| line.points.iter().map(|at| at.1));
    let (low, high) = range_of(numbers.filter(|number| number.is_finite()));
    let least_span = match quantity {
        ClimateQuantity::RelativeHumidity => 4.0,
        ClimateQuantity::Pressure => (0.02 * high.abs()).max(1e-6),
        ClimateQuantity::Oxygen | ClimateQuantity::Water => 0.1,
        _ => 2.0,
    };
    let room = (0.5 * (least_span - (high - low))).max(0.0);
    let title = format!("{} ({})", quantity.label(), quantity.unit());
    let spans = Layer {
        bars_across: spans.to_vec(),
        ..Layer::new("", Mark::Span, Ink::Guide, [])
    };
    Panel {
        x,
        y: Range::linear(title, "").with(low - room).with(high + room),
        layers: [spans].into_iter().chain(lines).collect(),
    }
}

/// A line through readings, broken at gaps.
fn readings(name: &str, ink: Ink, times: &[f64], values: &[f64]) -> Layer {
    let mut steps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
    steps.sort_by(f64::total_cmp);
    let usual = steps.get(steps.len() * 3 / 4).copied().unwrap_or(0.0);
    let mut points = Vec::with_capacity(times.len());
    for (at, (time, value)) in times.iter().zip(values).enumerate() {
        if at > 0 && time - times[at - 1] > GAP * usual {
            points.push((*time, f64::NAN));
        }
        points.push((*time, *value));
    }
    Layer::new(name, Mark::Line, ink, points)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(quantity: ClimateQuantity) -> ClimateCurve {
        ClimateCurve {
            sensor: "10173910".into(),
            quantity,
            time_s: (-60..120).map(|k| f64::from(k) * 60.0).collect(),
            values: (-60..120).map(|k| 50.0 + f64::from(k) / 500.0).collect(),
        }
    }

    #[test]
    fn a_run_has_a_panel_a_quantity_and_a_steady_climate_is_not_blown_up() {
        let curves = [
            curve(ClimateQuantity::RelativeHumidity),
            curve(ClimateQuantity::Temperature),
        ];
        let chart = around_run(&curves, 3600.0).unwrap();
        assert_eq!(chart.panels[0].y.quantity, "Relative humidity (%)");
        assert_eq!(
            chart.panels[1].x.quantity,
            "Time since the start of the run (min)"
        );
        let ends = &chart.panels[0].y.always;
        assert!((ends[1] - ends[0] - 4.0).abs() < 1e-9, "{ends:?}");
        assert_eq!(around_run(&[], 10.0), None);
    }

    #[test]
    fn lines_break_at_gaps() {
        let times: Vec<f64> = (0..200)
            .map(|k| f64::from(k) * 600.0 + if k > 99 { 5e5 } else { 0.0 })
            .collect();
        let line = readings("a", Ink::FIRST, &times, &[40.0; 200]);
        assert_eq!(line.points.iter().filter(|at| at.1.is_nan()).count(), 1);
        assert_eq!(over_time(&ClimateAssessment::default(), &[]), None);
    }
}
