//! A step and a spectrum of one strip in one likelihood: three rows a pair, the step, the spectrum, and both.

use ieap_domain::tag::keys;
use ieap_domain::{Estimate, RunRecord};

use super::TableInput;
use super::cells::{Shown, contribution, run_source};
use crate::impedance::{Both, OneLikelihood};
use crate::parameters::ParameterInfo;
use ieap_show::sheet::of_estimate;
use ieap_show::{Cell, Column, Content, Notes, Row, Table};

/// What is shown of each.
const SHOWN: [&str; 9] = [
    "r1_ohm_cm2",
    "c1_f_per_cm2",
    "r2_ohm_cm2",
    "c2_f_per_cm2",
    "rss_ohm_cm2",
    "c_total_f_per_cm2",
    "r_parallel_ohm_cm2",
    "alpha_per_c_cm",
    "lambda_per_s",
];

const REMARK: &str = "Both: one circuit for the readings of the step and of the spectrum, each weighted by its noise; that of the spectrum is what the same circuit leaves of it alone. p: chance of a difference as large where both have one circuit; below 0.05 the numbers of both are those of no strip. Steps at the lowest voltage, at which they are nearest to a spectrum.";

/// Makes the table.
pub fn make(input: &TableInput) -> Table {
    let mut notes = Notes::default();
    let of_pair = |own: &OneLikelihood| {
        let run = input.runs.iter().find(|run| run.id == own.run_id);
        rows(input, own, run, &mut notes)
    };
    let rows: Vec<Row> = input.one_likelihood.iter().flat_map(of_pair).collect();
    let remark = if rows.is_empty() {
        "No spectrum has a step of the same sample and condition beside it."
    } else {
        REMARK
    };
    let mut columns = vec![
        Column::plain("run", "Step", "run of the step"),
        Column::plain("spectrum", "Spectrum", "run of the spectrum"),
        Column::plain("sample", "Sample", "sample"),
        Column::of("voltage_v", "V₀", "step voltage", "V"),
        Column::plain("from", "From", "what tells"),
        Column::plain("agrees", "One circuit", "whether both can have one circuit"),
        Column::plain("p", "p", "chance of a difference as large"),
    ];
    columns.extend(shown().map(|shown| shown.column()));
    Table {
        title: "Steps and spectra in one likelihood".to_owned(),
        columns,
        stub: 2,
        rows,
        notes: notes.into_texts(),
        remarks: vec![remark.to_owned()],
        ..Table::default()
    }
}

fn shown() -> impl Iterator<Item = Shown<'static>> {
    SHOWN
        .iter()
        .filter_map(|key| ParameterInfo::of(key).map(Shown::parameter))
}

fn rows(input: &TableInput, own: &OneLikelihood, run: Option<&RunRecord>, notes: &mut Notes) -> Vec<Row> {
    let source = run_source(own.run_id, &own.path);
    let mut row =
        |from: &str, verdict: Option<&Both>, of: &dyn Fn(&str) -> Option<Estimate>, why: Option<&str>| {
            let of_run = || vec![source.clone()];
            let text = |text: Option<&str>| Cell::text(text, of_run());
            let volts = run.and_then(|run| run.tag_number(keys::VOLTAGE_V));
            let agrees = verdict.map(|both| if both.agrees() { "yes" } else { "no" });
            let mut agrees = text(agrees);
            if let Some(why) = why {
                agrees = agrees.noted(notes.at(why));
            }
            let p = verdict.map_or(Content::Missing, |both| Content::Rough(both.p, 2));
            let mut cells = vec![
                text(Some(&own.path)),
                text(Some(&own.spectrum)),
                text(run.and_then(|run| run.tag(keys::SAMPLE))),
                Cell::exact(volts, of_run()),
                text(Some(from)),
                agrees,
                Cell::new(p, of_run()),
            ];
            for shown in shown() {
                cells.push(match of(shown.key) {
                    Some(estimate) => of_estimate(&estimate, shown.factor, of_run(), notes),
                    None => Cell::new(Content::Missing, of_run()),
                });
            }
            Row {
                label: format!("{}, {}, {from}", own.path, own.spectrum),
                cells,
            }
        };
    let of_step = |key: &str| {
        let own = contribution(input.doubts, run?, key).estimate.ok()?;
        Some(own.into_owned())
    };
    let of_spectrum = |key: &str| {
        let found = own.of_spectrum.iter().find(|(own, _)| *own == key);
        found.map(|(_, estimate)| estimate.clone())
    };
    let both = own.both.as_ref();
    let of_both = |key: &str| {
        let found = both.ok()?.parameters.iter().find(|own| own.key == key);
        found.map(|own| own.estimate.clone())
    };
    vec![
        row("step", None, &of_step, None),
        row("spectrum", None, &of_spectrum, None),
        row("both", both.ok(), &of_both, both.err().map(String::as_str)),
    ]
}
