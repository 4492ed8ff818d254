//! Amplitude and phase against frequency as they are shown: the table, the picture, the page.

use ieap_domain::number::significant;
use ieap_domain::quantiles::NORMAL_95;
use ieap_domain::tag::keys;
use ieap_domain::words::counted;
use ieap_domain::{Estimate, RunRecord};
use ieap_show::quantities::{ENVIRONMENT, Quantity, RUN, SAMPLE};
use ieap_show::{Block, Chart, Ink, Layer, Mark, Panel, Range, Sheet, Source, SourceOrigin, Table};
use ieap_show::{Value, rough};

use super::{FrequencyPoint, FrequencyRun, PerVolt};

/// mA/V of A/V.
const MILLI: f64 = 1e3;

const WAVEFORM: Quantity = Quantity::plain("waveform", "Voltage", "course of the voltage");
const AMPLITUDE: Quantity = Quantity::new("amplitude_v", "V", "amplitude of the voltage", "V");
const FREQUENCY: Quantity = Quantity::new("frequency_hz", "f", "frequency", "Hz");

/// One of the two responses: its name on an axis, its unit and number of a stored one, how it is read off a point, and the
/// columns of its size and phase, measured and by the fit.
struct Response {
    axis: &'static str,
    unit: &'static str,
    factor: f64,
    of: fn(&FrequencyPoint) -> Option<PerVolt>,
    columns: [Quantity; 4],
}

const RESPONSES: [Response; 2] = [
    Response {
        axis: "Current per volt",
        unit: "mA/V",
        factor: MILLI,
        of: |point| point.current,
        columns: [
            Quantity::new("current_ma_per_v", "|I/V|", "current per volt", "mA/V"),
            Quantity::new("current_phase_deg", "∠I/V", "phase of the current", "°"),
            Quantity::new(
                "model_current_ma_per_v",
                "|I/V| model",
                "current per volt by the fit",
                "mA/V",
            ),
            Quantity::new(
                "model_current_phase_deg",
                "∠I/V model",
                "phase of the current by the fit",
                "°",
            ),
        ],
    },
    Response {
        axis: "Curvature per volt",
        unit: "cm⁻¹ V⁻¹",
        factor: 1.0,
        of: |point| point.curvature,
        columns: [
            Quantity::new("curvature_per_cm_v", "|κ/V|", "curvature per volt", "cm⁻¹ V⁻¹"),
            Quantity::new("curvature_phase_deg", "∠κ/V", "phase of the curvature", "°"),
            Quantity::new(
                "model_curvature_per_cm_v",
                "|κ/V| model",
                "curvature per volt by the fit",
                "cm⁻¹ V⁻¹",
            ),
            Quantity::new(
                "model_curvature_phase_deg",
                "∠κ/V model",
                "phase of the curvature by the fit",
                "°",
            ),
        ],
    },
];

/// One row a run and frequency: table `frequency`.
pub fn table(found: &[FrequencyRun], runs: &[RunRecord]) -> Table {
    type At<'a> = (&'a FrequencyRun, Option<&'a RunRecord>, usize);
    let rows = found.iter().flat_map(|own| {
        let run = runs.iter().find(|run| run.id == own.run_id);
        (0..own.measured.len()).map(move |at| (own, run, at))
    });
    let tag = |row: &At, key| row.1.and_then(|run| run.tag(key)).map(Value::from);
    let mut sheet = Sheet::<At>::new("frequency", "Current and bending per volt against frequency", 1)
        .remarks(
            "Measured by least squares of a sine and a cosine of the voltage's own phase beside a slow trend: of a sine one for the whole run, of a chirp one for every two periods; intervals allow for correlated residuals. A phase is how far the response leads the voltage. The model is that of the run's fit, in closed form; nothing stands there where the fit leaves the circuit open.",
            "No run has a sine or a chirp for its voltage.",
        )
        .made_from(|row| vec![Source::of(SourceOrigin::Run(row.0.run_id), &row.0.path)])
        .column(RUN, |row| row.0.path.clone())
        .column(SAMPLE, move |row| tag(row, keys::SAMPLE))
        .column(ENVIRONMENT, move |row| tag(row, keys::ENVIRONMENT))
        .column(WAVEFORM, |row| row.0.waveform)
        .column(AMPLITUDE, |row| rough(row.0.amplitude_v))
        .column(FREQUENCY, |(own, _, at)| Value::Rough(own.measured[*at].frequency_hz, 4));
    for response in &RESPONSES {
        let (of, factor) = (response.of, response.factor);
        let [size, phase, model_size, model_phase] = response.columns;
        let measured = move |row: &At| of(&row.0.measured[row.2]);
        let modelled = move |row: &At| row.0.modelled.get(row.2).and_then(of);
        sheet = sheet
            .column(size, move |row| {
                measured(row).map(|own| within(factor * own.amplitude(), Some(factor * own.half_95)))
            })
            .column(phase, move |row| {
                measured(row).map(|own| within(own.phase_deg(), own.phase_half_deg()))
            })
            .column(model_size, move |row| {
                rough(modelled(row).map(|own| factor * own.amplitude()))
            })
            .column(model_phase, move |row| {
                rough(modelled(row).map(|own| own.phase_deg()))
            });
    }
    sheet.over(rows)
}

/// A number with the half-width of its 95 % interval.
fn within(value: f64, half_95: Option<f64>) -> Value {
    Value::Estimate(match half_95 {
        Some(half) => Estimate::determined(value, half / NORMAL_95, value - half, value + half),
        None => Estimate::not_determined("the response may be zero"),
    })
}

/// Size and phase of each response that was measured, with their intervals and the model's line: one picture a response.
pub fn charts(runs: &[FrequencyRun]) -> Vec<Chart> {
    let points = || runs.iter().flat_map(|run| &run.measured);
    let shown = RESPONSES
        .iter()
        .filter(|response| points().any(|point| (response.of)(point).is_some()));
    let chart = |response: &Response| {
        Chart::new(response.axis, panels(response, runs).into()).told(
            "Marks: measured, bars 95 %. Lines: the fitted model. A phase above 0° is ahead of the voltage.",
        )
    };
    shown.map(chart).collect()
}

/// Value and half-width of its interval at a point.
type Of<'a> = &'a dyn Fn(&FrequencyPoint) -> Option<(f64, f64)>;

fn panels(response: &Response, runs: &[FrequencyRun]) -> [Panel; 2] {
    let (of, factor) = (response.of, response.factor);
    let size = |point: &FrequencyPoint| {
        let own = of(point)?;
        Some((factor * own.amplitude(), factor * own.half_95))
    };
    let phase = |point: &FrequencyPoint| {
        let own = of(point)?;
        Some((own.phase_deg(), own.phase_half_deg()?))
    };
    let panel = |y: Range, of: Of| Panel {
        x: Range::log("Frequency", "Hz"),
        y,
        layers: runs
            .iter()
            .enumerate()
            .flat_map(|(at, run)| layers(at, run, of))
            .collect(),
    };
    [
        panel(Range::log("Amplitude", response.unit), &size),
        panel(Range::linear("Phase (°)", ""), &phase),
    ]
}

fn layers(at: usize, run: &FrequencyRun, of: Of) -> [Layer; 2] {
    let ink = Ink::Series(at);
    let line = run
        .line
        .iter()
        .filter_map(|point| Some((point.frequency_hz, of(point)?.0)));
    let told = || {
        run.measured
            .iter()
            .filter_map(|point| Some((point.frequency_hz, of(point)?)))
    };
    let bars = told()
        .map(|(_, (value, half))| (value - half, value + half))
        .collect();
    let marks = told().map(|(frequency_hz, (value, _))| (frequency_hz, value));
    let name = format!("{}, {}", run.path, run.waveform);
    [
        Layer::new("", Mark::Line, ink, line),
        Layer::new(name, Mark::Marks, ink, marks).with_bars(bars),
    ]
}

/// How many runs there are, over which frequencies, and how many of them have a model's line.
fn answer(runs: &[FrequencyRun]) -> String {
    let frequencies = runs
        .iter()
        .flat_map(|run| run.measured.iter().map(|point| point.frequency_hz));
    let (low, high) = ieap_domain::range_of(frequencies);
    let modelled = runs.iter().filter(|run| !run.line.is_empty()).count();
    let line = match modelled {
        0 => "of none the fit determines a circuit whose line could be drawn".to_owned(),
        all if all == runs.len() => "the lines are those of their fits".to_owned(),
        some => format!("of {some} the fit determines a circuit, whose line is drawn"),
    };
    let range = if high > low * 1.001 {
        format!("{} to {} Hz", significant(low, 3), significant(high, 3))
    } else {
        format!("{} Hz", significant(low, 3))
    };
    format!(
        "{} under a sine or a chirp, {range}; {line}.",
        counted(runs.len(), "run")
    )
}

/// The page.
pub fn view(found: &[FrequencyRun], runs: &[RunRecord]) -> Vec<Block> {
    let mut blocks = vec![Block::Say(answer(found))];
    blocks.extend(charts(found).into_iter().map(Block::Chart));
    blocks.push(Block::Table(table(found, runs)));
    blocks
}
