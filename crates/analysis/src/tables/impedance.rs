//! Circuits fitted to impedance spectra: one row a sweep and circuit.

use super::TableInput;
use super::cells::{Shown, estimate_cell};
use super::table::{Cell, Column, Content, Notes, Row, Source, SourceOrigin, Table};
use ieap_domain::tag::keys;
use ieap_domain::{CircuitFit, Consistency, SpectrumAnalysis, SpectrumRun};

/// Numbers of the circuits.
const NUMBERS: [Shown; 11] = [
    Shown::new(
        "r1_ohm",
        "r1_ohm",
        "R₁",
        "resistance of the first chain",
        "Ω",
        1.0,
    ),
    Shown::new("c1_f", "c1_mf", "C₁", "capacitance of the first chain", "mF", 1e3),
    Shown::new(
        "r2_ohm",
        "r2_ohm",
        "R₂",
        "resistance of the second chain",
        "Ω",
        1.0,
    ),
    Shown::new(
        "c2_f",
        "c2_mf",
        "C₂",
        "capacitance of the second chain",
        "mF",
        1e3,
    ),
    Shown::new(
        "rss_ohm",
        "rss_kohm",
        "Rₛₛ",
        "steady-state resistance",
        "kΩ",
        1e-3,
    ),
    Shown::new(
        "c_total_f",
        "c_total_mf",
        "C_total",
        "total capacitance",
        "mF",
        1e3,
    ),
    Shown::new(
        "r_parallel_ohm",
        "r_parallel_ohm",
        "R∥",
        "resistance of the chains in parallel",
        "Ω",
        1.0,
    ),
    Shown::new(
        "cpe_exponent",
        "cpe_exponent",
        "n",
        "exponent of the constant-phase element",
        "",
        1.0,
    ),
    Shown::new(
        "cpe_s_sn",
        "cpe_s_sn",
        "Q",
        "size of the constant-phase element",
        "S sⁿ",
        1.0,
    ),
    Shown::new(
        "rw_ohm",
        "rw_ohm",
        "R_W",
        "resistance of the finite Warburg element",
        "Ω",
        1.0,
    ),
    Shown::new(
        "cw_f",
        "cw_mf",
        "C_W",
        "capacitance of the finite Warburg element",
        "mF",
        1e3,
    ),
];

/// Makes the table.
pub fn make(input: &TableInput) -> Table {
    let mut notes = Notes::default();
    let mut rows = Vec::new();
    for (spectrum, name, analysis) in sweeps(input.spectra) {
        let of_circuit = |fit: &CircuitFit| row(spectrum, &name, analysis, fit, &mut notes);
        rows.extend(analysis.circuits.iter().map(of_circuit));
    }
    let mut columns = vec![
        Column::plain("spectrum", "Spectrum", "run of the spectrum"),
        Column::plain("circuit", "Circuit", "circuit"),
        Column::plain("sample", "Sample", "sample"),
        Column::plain("environment", "Environment", "environment"),
        Column::of("relative_humidity_percent", "RH", "relative humidity", "%"),
        Column::plain(
            "kramers_kronig",
            "Kramers-Kronig",
            "whether it can be an impedance",
        ),
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
        Column::plain(
            "bic_above_best",
            "ΔBIC",
            "Bayesian information criterion above that of the best circuit",
        ),
    ];
    columns.extend(NUMBERS.iter().map(Shown::column));
    let remark = if rows.is_empty() {
        "No impedance spectrum is there: put files into impedance/ or beside the runs."
    } else {
        "Values are those of the whole sample, with their standard error; intervals and bounds are by the profile of the sum of squares, every reading weighted by 1/|Z|."
    };
    Table {
        title: "Circuits fitted to the impedance spectra".to_owned(),
        columns,
        stub: 2,
        rows,
        notes: notes.into_texts(),
        remarks: vec![remark.to_owned()],
        ..Table::default()
    }
}

/// Every sweep that is analysed, with its name.
pub(super) fn sweeps(
    spectra: &[SpectrumRun],
) -> impl Iterator<Item = (&SpectrumRun, String, &SpectrumAnalysis)> {
    spectra.iter().flat_map(|spectrum| {
        let sweeps = spectrum.sweeps.iter().enumerate();
        sweeps.filter_map(move |(at, sweep)| {
            let name = match at {
                0 => spectrum.run.path.clone(),
                _ => format!("{}, sweep {}", spectrum.run.path, at + 1),
            };
            Some((spectrum, name, sweep.analysis.as_ref().ok()?))
        })
    })
}

/// Whether a circuit describes its spectrum, in a word or two.
pub(super) fn described(analysis: &SpectrumAnalysis, fit: &CircuitFit) -> &'static str {
    match (fit.circuit == analysis.best, fit.describes) {
        (true, true) => "best",
        (true, false) => "best, but no",
        (false, true) => "yes",
        (false, false) => "no",
    }
}

fn row(
    spectrum: &SpectrumRun,
    name: &str,
    analysis: &SpectrumAnalysis,
    fit: &CircuitFit,
    notes: &mut Notes,
) -> Row {
    let source = |key: Option<&str>| Source {
        origin: SourceOrigin::File,
        name: spectrum.run.path.clone(),
        key: key.map(str::to_owned),
        estimate: key.and_then(|key| fit.parameter(key)).cloned(),
        left_out: None,
    };
    let sources = || vec![source(None)];
    let verdict = match analysis.kramers_kronig.verdict {
        Consistency::Consistent => "consistent",
        Consistency::Violated => "violated",
        Consistency::NotTested => "not tested",
    };
    let describes = described(analysis, fit);
    let tag = |key| spectrum.run.tag(key).map(str::to_owned);
    let mut cells = vec![
        Cell::text(Some(name), sources()),
        Cell::text(Some(&fit.circuit), sources()),
        Cell::text(tag(keys::SAMPLE), sources()),
        Cell::text(tag(keys::ENVIRONMENT), sources()),
        Cell::exact(
            spectrum.run.tag_number(keys::RELATIVE_HUMIDITY_PERCENT),
            sources(),
        ),
        Cell::text(Some(verdict), sources()),
        Cell::text(Some(describes), sources()),
        Cell::new(Content::Rough(fit.residual_rms_percent, 3), sources()),
        Cell::new(Content::Rough(fit.bic_above_best, 3), sources()),
    ];
    cells.extend(NUMBERS.iter().map(|shown| {
        let sources = vec![source(Some(shown.key))];
        match fit.parameter(shown.key) {
            Some(own) => estimate_cell(own, shown.factor, sources, notes),
            None => Cell::new(Content::Missing, sources),
        }
    }));
    Row {
        label: format!("{name}, {}", fit.circuit),
        cells,
    }
}
