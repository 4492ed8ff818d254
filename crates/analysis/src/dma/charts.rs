//! Pictures of modulus logs.

use ieap_domain::modulus::step_keys;
use ieap_domain::quantiles::NORMAL_95_ROUNDED;
use ieap_domain::words::counted;
use ieap_domain::{ModulusAnalysis, ModulusLog, Quantity, RunCurve};
use ieap_show::{Chart, Form, Ink, Layer, Mark, Panel, Range};

use super::levels::{HeldLevel, levels};
use super::sheet::PER_MINUTE;
use super::view::{analysed, name};

/// Logs drawn in one figure: as many as there are colours.
const MOST_DRAWN: usize = Ink::COLOURS;

fn curve(found: &ModulusAnalysis, quantity: Quantity) -> Option<&RunCurve> {
    found.curves.iter().find(|curve| curve.quantity == quantity)
}

/// |E*| of the logs relative to its value before the first humidity step, with the humidity below: the thesis's
/// figure 24. None where no log has a step.
pub fn normalised(logs: &[ModulusLog]) -> Option<Chart> {
    let (mut modulus, mut humidity) = (Vec::new(), Vec::new());
    for (log, found) in analysed(logs) {
        let of_log = || {
            let step = found.steps.first()?;
            let whole_mpa = step.estimate(step_keys::MODULUS_BEFORE)?.value?;
            Some((step.start_s, whole_mpa, curve(found, Quantity::ComplexModulus)?))
        };
        let Some((start_s, whole_mpa, complex)) = of_log() else {
            continue;
        };
        let layer = |curve: &RunCurve, factor: f64| {
            let points = curve.time_s.iter().zip(&curve.measured);
            let points = points.map(|(t, value)| ((t - start_s) * PER_MINUTE, factor * value));
            Layer::new(name(log), Mark::MarkedLine, Ink::Series(modulus.len()), points)
        };
        let below = curve(found, Quantity::RelativeHumidity).map(|curve| layer(curve, 1.0));
        let above = layer(complex, 100.0 / whole_mpa);
        humidity.extend(below);
        modulus.push(above);
    }
    let left_out = modulus.len().saturating_sub(MOST_DRAWN);
    modulus.truncate(MOST_DRAWN);
    humidity.retain(|layer| modulus.iter().any(|drawn| drawn.ink == layer.ink));
    let panel = |y, layers| Panel {
        x: Range::linear("Time since the first humidity step (min)", ""),
        y: Range::linear(y, ""),
        layers,
    };
    if modulus.is_empty() {
        return None;
    }
    let mut panels = vec![panel("|E*| relative to before (%)", modulus)];
    if !humidity.is_empty() {
        panels.push(panel("RH (%)", humidity));
    }
    let chart = Chart::new("Normalised complex modulus under humidity", panels).formed(Form::Wide);
    Some(match left_out {
        0 => chart,
        more => chart.told(format!(
            "{} more are not drawn here; each has its own figure.",
            counted(more, "log")
        )),
    })
}

/// Short name and unit of what a log holds.
const CHANNELS: [(Quantity, &str); 6] = [
    (Quantity::ComplexModulus, "|E*| (MPa)"),
    (Quantity::StorageModulus, "E′ (MPa)"),
    (Quantity::LossModulus, "E″ (MPa)"),
    (Quantity::LossFactor, "tan δ"),
    (Quantity::RelativeHumidity, "RH (%)"),
    (Quantity::Temperature, "T (°C)"),
];

/// Every channel of a log over its time, with the fitted relaxations and lines at the humidity steps.
pub fn of_log(found: &ModulusAnalysis) -> Chart {
    let panel = |(quantity, title): (Quantity, &'static str)| {
        let curve = curve(found, quantity)?;
        let minutes: Vec<f64> = curve.time_s.iter().map(|t| t * PER_MINUTE).collect();
        let steps = found.steps.iter().map(|step| step.start_s * PER_MINUTE);
        let mut layers = vec![
            Layer::guides(Mark::Upright, steps),
            Layer::over(
                "Readings",
                Mark::Readings,
                Ink::Readings,
                &minutes,
                &curve.measured,
            ),
        ];
        if curve.fitted.iter().any(|value| value.is_finite()) {
            layers.push(Layer::over(
                "Relaxation",
                Mark::Line,
                Ink::SECOND,
                &minutes,
                &curve.fitted,
            ));
        }
        Some(Panel {
            x: Range::linear("Time (min)", ""),
            y: Range::linear(title, ""),
            layers,
        })
    };
    Chart::new("Modulus log", CHANNELS.into_iter().filter_map(panel).collect())
        .formed(Form::Wide)
        .told("Dashed lines: the humidity steps.")
}

/// |E*| over the humidity, on the way up and on the way down; none where fewer than two levels were held.
pub fn over_humidity(name: &str, found: &ModulusAnalysis) -> Option<Chart> {
    let levels = levels(found).filter(|levels| levels.len() > 1)?;
    let layer = |(direction, (name, ink)): (i8, (&str, Ink))| {
        let of: Vec<&HeldLevel> = levels.iter().filter(|own| own.direction == direction).collect();
        let reach = |own: &HeldLevel| NORMAL_95_ROUNDED * own.standard_error_mpa;
        let bars = of
            .iter()
            .map(|own| (own.modulus_mpa - reach(own), own.modulus_mpa + reach(own)));
        let points = of
            .iter()
            .map(|own| (own.relative_humidity_percent, own.modulus_mpa));
        Layer::new(name, Mark::Marks, ink, points).with_bars(bars.collect())
    };
    let ways = [
        (0, ("At the start", Ink::FIRST)),
        (1, ("After a rise", Ink::SECOND)),
        (-1, ("After a fall", Ink::THIRD)),
    ];
    let panel = Panel {
        x: Range::linear("Relative humidity (%)", ""),
        y: Range::linear("|E*| (MPa)", ""),
        layers: ways
            .into_iter()
            .map(layer)
            .filter(|layer| !layer.points.is_empty())
            .collect(),
    };
    Some(Chart::new(name, vec![panel]))
}
