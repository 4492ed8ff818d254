//! Peaks of the distribution of relaxation times of impedance spectra: one row a sweep and peak.

use ieap_domain::tag::keys;
use ieap_domain::{RelaxationPeak, RelaxationTimes, SpectrumRun};

use super::TableInput;
use super::impedance::sweeps;
use super::table::{Cell, Column, Content, Row, Source, SourceOrigin, Table};

/// Digits that a peak is told by: its place and height depend on the regularisation.
const DIGITS: i32 = 3;

/// Makes the table.
pub fn make(input: &TableInput) -> Table {
    let mut rows = Vec::new();
    for (spectrum, name, analysis) in sweeps(input.spectra) {
        let Some(found) = &analysis.relaxation else {
            continue;
        };
        let peaks = found.peaks.iter().enumerate();
        rows.extend(peaks.map(|(at, peak)| row(spectrum, &name, found, (at + 1, peak))));
    }
    let remark = if rows.is_empty() {
        "No impedance spectrum has a peak of relaxation times."
    } else {
        "The smoothest distribution (Tikhonov, of the second derivative) that leaves no more than the readings scatter; a peak has no interval, for its width is that of the regularisation."
    };
    Table {
        title: "Relaxation times of the impedance spectra".to_owned(),
        columns: vec![
            Column::plain("spectrum", "Spectrum", "run of the spectrum"),
            Column::plain("peak", "Peak", "number of the peak, from the fastest"),
            Column::plain("sample", "Sample", "sample"),
            Column::plain("environment", "Environment", "environment"),
            Column::of("relative_humidity_percent", "RH", "relative humidity", "%"),
            Column::of("tau_s", "τ", "time constant of the peak", "s"),
            Column::of("resistance_ohm", "R", "resistance of the peak", "Ω"),
            Column::of("from_s", "from", "least value before the peak", "s"),
            Column::of("to_s", "to", "least value behind the peak", "s"),
            Column::plain("regularisation", "λ", "strength of the regularisation"),
            Column::of(
                "residual_percent",
                "Residual",
                "root mean square of what the distribution leaves, of |Z|",
                "%",
            ),
        ],
        stub: 2,
        rows,
        remarks: vec![remark.to_owned()],
        ..Table::default()
    }
}

fn row(
    spectrum: &SpectrumRun,
    name: &str,
    found: &RelaxationTimes,
    (at, peak): (usize, &RelaxationPeak),
) -> Row {
    let sources = || {
        vec![Source {
            origin: SourceOrigin::File,
            name: spectrum.run.path.clone(),
            key: None,
            estimate: None,
            left_out: None,
        }]
    };
    let tag = |key| spectrum.run.tag(key).map(str::to_owned);
    let humidity = spectrum.run.tag_number(keys::RELATIVE_HUMIDITY_PERCENT);
    let rough = |number: f64| Cell::new(Content::Rough(number, DIGITS), sources());
    let mut cells = vec![
        Cell::text(Some(name), sources()),
        Cell::exact(Some(at as f64), sources()),
        Cell::text(tag(keys::SAMPLE), sources()),
        Cell::text(tag(keys::ENVIRONMENT), sources()),
        Cell::exact(humidity, sources()),
    ];
    let numbers = [
        peak.tau_s,
        peak.resistance_ohm,
        peak.from_s,
        peak.to_s,
        found.regularisation,
        found.residual_rms_percent,
    ];
    cells.extend(numbers.map(rough));
    Row {
        label: format!("{name}, peak {at}"),
        cells,
    }
}
