//! Current and bending per volt against frequency: one row a run and frequency.

use ieap_domain::RunRecord;
use ieap_domain::tag::keys;

use super::TableInput;
use super::cells::run_source;
use crate::frequency::{FrequencyPoint, FrequencyRun, PerVolt};
use ieap_domain::quantiles::NORMAL_95;
use ieap_show::{Cell, Column, Content, Measured, Row, Table};

/// mA/V of A/V.
const MILLI: f64 = 1e3;

/// One of the two responses of a point.
type Part = fn(&FrequencyPoint) -> Option<PerVolt>;

/// Makes the table.
pub fn make(input: &TableInput) -> Table {
    let rows = input.frequency.iter().flat_map(|own| {
        let run = input.runs.iter().find(|run| run.id == own.run_id);
        (0..own.measured.len()).map(move |at| row(own, run, at))
    });
    let rows: Vec<Row> = rows.collect();
    let remark = if rows.is_empty() {
        "No run has a sine or a chirp for its voltage."
    } else {
        "Measured by least squares of a sine and a cosine of the voltage's own phase beside a trend; intervals allow for correlated residuals. A phase is how far the response leads the voltage. The model is that of the run's fit, in closed form; nothing stands there where the fit leaves the circuit open."
    };
    Table {
        title: "Current and bending per volt against frequency".to_owned(),
        columns: columns(),
        stub: 1,
        rows,
        remarks: vec![remark.to_owned()],
        ..Table::default()
    }
}

fn columns() -> Vec<Column> {
    vec![
        Column::plain("run", "Run", "run"),
        Column::plain("sample", "Sample", "sample"),
        Column::plain("environment", "Environment", "environment"),
        Column::plain("waveform", "Voltage", "course of the voltage"),
        Column::of("amplitude_v", "V", "amplitude of the voltage", "V"),
        Column::of("frequency_hz", "f", "frequency", "Hz"),
        Column::of("current_ma_per_v", "|I/V|", "current per volt", "mA/V"),
        Column::of("current_phase_deg", "∠I/V", "phase of the current", "°"),
        Column::of(
            "model_current_ma_per_v",
            "|I/V| model",
            "current per volt by the fit",
            "mA/V",
        ),
        Column::of(
            "model_current_phase_deg",
            "∠I/V model",
            "phase of the current by the fit",
            "°",
        ),
        Column::of("curvature_per_cm_v", "|κ/V|", "curvature per volt", "cm⁻¹ V⁻¹"),
        Column::of("curvature_phase_deg", "∠κ/V", "phase of the curvature", "°"),
        Column::of(
            "model_curvature_per_cm_v",
            "|κ/V| model",
            "curvature per volt by the fit",
            "cm⁻¹ V⁻¹",
        ),
        Column::of(
            "model_curvature_phase_deg",
            "∠κ/V model",
            "phase of the curvature by the fit",
            "°",
        ),
    ]
}

fn row(own: &FrequencyRun, run: Option<&RunRecord>, at: usize) -> Row {
    let sources = || vec![run_source(own.run_id, &own.path)];
    let tag = |key| run.and_then(|run| run.tag(key)).map(str::to_owned);
    let (measured, modelled) = (&own.measured[at], own.modelled.get(at));
    let mut cells = vec![
        Cell::text(Some(own.path.clone()), sources()),
        Cell::text(tag(keys::SAMPLE), sources()),
        Cell::text(tag(keys::ENVIRONMENT), sources()),
        Cell::text(Some(own.waveform), sources()),
        Cell::new(Content::Rough(own.amplitude_v, 3), sources()),
        Cell::new(Content::Rough(measured.frequency_hz, 4), sources()),
    ];
    let parts: [(Part, f64); 2] = [(|point| point.current, MILLI), (|point| point.curvature, 1.0)];
    for (part, factor) in parts {
        let found = part(measured);
        let model = modelled.and_then(part);
        let amplitude = found.map(|found| content(factor * found.amplitude(), factor * found.half_95));
        let phase = found.map(|found| match found.phase_half_deg() {
            Some(half) => content(found.phase_deg(), half),
            None => Content::NotDetermined,
        });
        let rough = |value: Option<f64>| value.map_or(Content::Missing, |value| Content::Rough(value, 3));
        cells.extend(
            [
                amplitude.unwrap_or(Content::Missing),
                phase.unwrap_or(Content::Missing),
                rough(model.map(|model| factor * model.amplitude())),
                rough(model.map(|model| model.phase_deg())),
            ]
            .map(|content| Cell::new(content, sources())),
        );
    }
    Row {
        label: format!("{}, {:.3e} Hz", own.path, measured.frequency_hz),
        cells,
    }
}

fn content(value: f64, half_95: f64) -> Content {
    Content::Measured(Measured {
        value,
        standard_error: Some(half_95 / NORMAL_95),
        low_95: Some(value - half_95),
        high_95: Some(value + half_95),
        pooled: None,
    })
}
