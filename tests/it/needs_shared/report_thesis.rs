//! The thesis's table 5 through the comparison: the findings that it must reproduce.

use std::path::Path;

use ieap::analysis::laws::doubt::Doubts;
use ieap::analysis::{Contrast, conditions, contrasts};
use ieap::domain::tag::keys;
use ieap::domain::{Estimate, RunRecord};

use super::shared;
use crate::report_fixture::{campaign, run, tag};

/// Relative standard error given to the thesis's values, which it prints without one.
const RELATIVE_ERROR: f64 = 0.05;

/// One run per row of the table with the thesis's R_ss, alpha and lambda.
fn thesis_runs(table: &Path) -> Vec<RunRecord> {
    let mut reader = csv::Reader::from_path(table).expect("the table");
    let rows = reader.records().map(|row| row.expect("a row"));
    rows.enumerate()
        .map(|(index, row)| thesis_run(index, &row))
        .collect()
}

fn thesis_run(index: usize, row: &csv::StringRecord) -> RunRecord {
    let number = |column: usize| row[column].parse::<f64>().expect("a number");
    let mut made = run(index, &row[0], 0, number(2), 1);
    made.tags.retain(|tag| tag.key != keys::ENVIRONMENT);
    made.tags.push(tag(keys::ENVIRONMENT, &row[1]));
    let fit = made.fit.as_mut().expect("fitted");
    for (key, value) in [
        ("rss_ohm_cm2", 1e3 * number(7)),
        ("alpha_per_c_cm", number(9)),
        ("lambda_per_s", number(10)),
    ] {
        let parameter = fit
            .parameters
            .iter_mut()
            .find(|p| p.key == key)
            .expect("the parameter");
        let error = RELATIVE_ERROR * value;
        parameter.estimate = if value > 0.0 {
            Estimate::determined(value, error, value - 1.96 * error, value + 1.96 * error)
        } else {
            Estimate::not_determined("the thesis prints 0")
        };
    }
    made
}

/// Material, environment and voltage tag of a run.
fn place(run: &RunRecord) -> (&str, &str) {
    (
        run.tag(keys::ENVIRONMENT).expect("tagged"),
        run.tag(keys::VOLTAGE_V).expect("tagged"),
    )
}

#[test]
fn the_thesis_findings_come_out() {
    let Some(table) = shared("reference/thesis_table5.csv") else {
        return;
    };
    let runs = thesis_runs(&table);
    let campaign = campaign(&["CNaf", "CPvf"]);
    let table = conditions(&runs, &campaign);
    assert_eq!(
        (
            table.materials.len(),
            table.surroundings.len(),
            table.measured.len()
        ),
        (2, 3, 18)
    );
    let of = |key: &str, material: usize| match &contrasts(&runs, &table, key, &Doubts::default())[material] {
        Contrast::Differs {
            low_run,
            high_run,
            ratio: Some(ratio),
            at_least: false,
            ..
        } => (place(&runs[*low_run]), place(&runs[*high_run]), *ratio),
        other => panic!("{key} of material {material}: {other:?}"),
    };
    let (_, high, ratio) = of("lambda_per_s", 0);
    assert_eq!(
        high,
        ("air", "2.5"),
        "CNaf relaxes fastest in air at the highest voltage"
    );
    assert!(ratio > 10.0, "more than tenfold over dry: {ratio}");
    let (low, high, ratio) = of("rss_ohm_cm2", 0);
    assert_eq!(low, ("air", "2.5"), "electrolysis");
    assert!(
        high.0 != "air" && ratio > 10.0,
        "more than an order of magnitude: {ratio}"
    );
    let (low, high, ratio) = of("alpha_per_c_cm", 1);
    assert_eq!((low.0, high.0), ("vacuum", "inert"));
    assert!(
        (1.8..2.8).contains(&ratio),
        "CPvf's coupling halves in vacuum: {ratio}"
    );
}
