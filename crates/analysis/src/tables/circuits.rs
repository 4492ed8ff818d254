//! Numbers of the circuits fitted to impedance spectra: one row a sweep, circuit and number.

use ieap_domain::tag::keys;
use ieap_domain::{CircuitFit, Parameter, SpectrumRun};

use super::TableInput;
use super::cells::estimate_cell;
use super::impedance::{described, sweeps};
use super::table::{Cell, Column, Content, Notes, Row, Source, SourceOrigin, Table};

/// Makes the table.
pub fn make(input: &TableInput) -> Table {
    let mut notes = Notes::default();
    let mut rows = Vec::new();
    for (spectrum, name, analysis) in sweeps(input.spectra) {
        for fit in &analysis.circuits {
            let verdict = described(analysis, fit);
            let of_number = |own: &Parameter| row(spectrum, (&name, verdict), fit, own, &mut notes);
            rows.extend(fit.parameters.iter().map(of_number));
        }
    }
    let remark = if rows.is_empty() {
        "No impedance spectrum is there: put files into impedance/ or beside the runs."
    } else {
        "The unit stands at the end of the number's name; values are those of the whole sample. Circuits as texts are those of [impedance] circuits in campaign.toml."
    };
    Table {
        title: "Numbers of the circuits fitted to the impedance spectra".to_owned(),
        columns: vec![
            Column::plain("spectrum", "Spectrum", "run of the spectrum"),
            Column::plain("circuit", "Circuit", "circuit, as its name or as a text"),
            Column::plain("number", "Number", "number of the circuit, with its unit"),
            Column::plain("value", "Value", "its value"),
            Column::plain("sample", "Sample", "sample"),
            Column::plain("environment", "Environment", "environment"),
            Column::of("relative_humidity_percent", "RH", "relative humidity", "%"),
            Column::plain(
                "describes",
                "Describes",
                "whether the circuit describes the spectrum",
            ),
            Column::of(
                "residual_percent",
                "Residual",
                "root mean square of what the circuit leaves, of |Z|",
                "%",
            ),
        ],
        stub: 3,
        rows,
        notes: notes.into_texts(),
        remarks: vec![remark.to_owned()],
        ..Table::default()
    }
}

fn row(
    spectrum: &SpectrumRun,
    (name, verdict): (&str, &str),
    fit: &CircuitFit,
    own: &Parameter,
    notes: &mut Notes,
) -> Row {
    let sources = || {
        vec![Source {
            origin: SourceOrigin::File,
            name: spectrum.run.path.clone(),
            key: Some(own.key.clone()),
            estimate: Some(own.estimate.clone()),
            left_out: None,
        }]
    };
    let tag = |key| spectrum.run.tag(key).map(str::to_owned);
    let humidity = spectrum.run.tag_number(keys::RELATIVE_HUMIDITY_PERCENT);
    Row {
        label: format!("{name}, {}, {}", fit.circuit, own.key),
        cells: vec![
            Cell::text(Some(name), sources()),
            Cell::text(Some(&fit.circuit), sources()),
            Cell::text(Some(&own.key), sources()),
            estimate_cell(&own.estimate, 1.0, sources(), notes),
            Cell::text(tag(keys::SAMPLE), sources()),
            Cell::text(tag(keys::ENVIRONMENT), sources()),
            Cell::exact(humidity, sources()),
            Cell::text(Some(verdict), sources()),
            Cell::new(Content::Rough(fit.residual_rms_percent, 3), sources()),
        ],
    }
}
