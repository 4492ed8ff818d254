//! The table of parameters: rows and columns of the thesis's table 5, each cell with its uncertainty.

use std::collections::BTreeMap;

use serde::Serialize;

use super::Content;
use super::wording::{RunLink, counted, estimate_of, humidity_label, voltage_labels};
use crate::analysis::parameters::PARAMETERS;
use crate::domain::RunRecord;
use crate::report::error::ReportError;
use crate::report::number::significant;
use crate::report::site::Site;

/// Keys of the columns from the current, then of those from the curvature.
const ELECTRICAL: [&str; 5] = [
    "r1_ohm_cm2",
    "c1_f_per_cm2",
    "r2_ohm_cm2",
    "c2_f_per_cm2",
    "rss_ohm_cm2",
];
const MECHANICAL: [&str; 2] = ["alpha_per_c_cm", "lambda_per_s"];

#[derive(Debug, Serialize)]
struct Table {
    columns: Vec<Column>,
    materials: Vec<Material>,
    footnotes: Vec<Footnote>,
    unplaced: String,
}

#[derive(Debug, Serialize)]
struct Column {
    symbol: String,
    unit: String,
}

#[derive(Debug, Serialize)]
struct Material {
    name: String,
    rows: Vec<Row>,
}

/// One run. Environment and voltage are set in the first row of their kind only.
#[derive(Debug, Serialize)]
struct Row {
    environment: String,
    humidity: String,
    voltage: String,
    link: RunLink,
    cells: Vec<Cell>,
    starts_environment: bool,
}

#[derive(Debug, Serialize)]
struct Cell {
    text: String,
    /// Standard error, to stand below the value; empty where there is none.
    error: String,
    /// 95 % interval and reason, shown on hover.
    hover: String,
    kind: &'static str,
    /// Letter of the footnote that gives the reason: a figure beside a power of ten would be misread.
    footnote: Option<String>,
}

#[derive(Debug, Serialize)]
struct Footnote {
    letter: String,
    text: String,
}

/// Makes the page.
pub fn content(site: &Site) -> Result<Content, ReportError> {
    let mut reasons: Vec<String> = Vec::new();
    let names = site.conditions.materials.iter().enumerate();
    let materials = names
        .map(|(material, name)| Material {
            name: name.clone(),
            rows: rows(site, material, &mut reasons),
        })
        .collect();
    let footnotes = reasons.into_iter().enumerate();
    let unplaced = site.conditions.unplaced.len();
    let table = Table {
        columns: columns(),
        materials,
        footnotes: footnotes
            .map(|(k, text)| Footnote {
                letter: letter(k),
                text,
            })
            .collect(),
        unplaced: match unplaced {
            0 => String::new(),
            _ => format!(
                "{} without sample, environment or voltage left out.",
                counted(unplaced, "run")
            ),
        },
    };
    Content::new("table5.html", &table, BTreeMap::new())
}

fn columns() -> Vec<Column> {
    let of_keys = |keys: &[&str]| -> Vec<Column> {
        let known = PARAMETERS
            .iter()
            .filter(|parameter| keys.contains(&parameter.key));
        known
            .map(|parameter| Column {
                symbol: parameter.symbol.to_owned(),
                unit: parameter.shown_unit.to_owned(),
            })
            .collect()
    };
    let r_squared = |of: &str| Column {
        symbol: "R²".to_owned(),
        unit: of.to_owned(),
    };
    let mut columns = of_keys(&ELECTRICAL);
    columns.push(r_squared("current"));
    columns.extend(of_keys(&MECHANICAL));
    columns.push(r_squared("curvature"));
    columns
}

fn rows(site: &Site, material: usize, reasons: &mut Vec<String>) -> Vec<Row> {
    let conditions = &site.conditions;
    let voltages = voltage_labels(&conditions.voltages_v);
    let mut rows = Vec::new();
    let mut environment_before = None;
    for condition in conditions
        .measured
        .iter()
        .filter(|condition| condition.material == material)
    {
        let surroundings = &conditions.surroundings[condition.surroundings];
        for (repeat, &run) in condition.runs.iter().enumerate() {
            let starts_environment = environment_before != Some(condition.surroundings);
            environment_before = Some(condition.surroundings);
            let first = |text: String, is_first: bool| if is_first { text } else { String::new() };
            rows.push(Row {
                environment: first(surroundings.environment.clone(), starts_environment),
                humidity: first(humidity_label(surroundings), starts_environment),
                voltage: first(voltages[condition.voltage].clone(), repeat == 0),
                link: RunLink::to(site, run),
                cells: cells(&site.input.runs[run], reasons),
                starts_environment,
            });
        }
    }
    rows
}

fn cells(run: &RunRecord, reasons: &mut Vec<String>) -> Vec<Cell> {
    let fit = run.fit.as_ref();
    let mut cells: Vec<Cell> = ELECTRICAL.iter().map(|key| cell(run, key, reasons)).collect();
    cells.push(r_squared(fit.and_then(|fit| fit.r_squared_current)));
    cells.extend(MECHANICAL.iter().map(|key| cell(run, key, reasons)));
    cells.push(r_squared(fit.and_then(|fit| fit.r_squared_curvature)));
    cells
}

fn cell(run: &RunRecord, key: &str, reasons: &mut Vec<String>) -> Cell {
    let Some(parameter) = PARAMETERS.iter().find(|parameter| parameter.key == key) else {
        return r_squared(None);
    };
    let estimate = estimate_of(run, parameter);
    let interval = match estimate.interval.is_empty() {
        true => String::new(),
        false => format!("95 %: {} {}", estimate.interval, parameter.shown_unit),
    };
    let hover: Vec<&str> = [interval.as_str(), estimate.reason.as_str()]
        .into_iter()
        .filter(|part| !part.is_empty())
        .collect();
    Cell {
        hover: hover.join("; "),
        footnote: (!estimate.reason.is_empty()).then(|| footnote(&estimate.reason, reasons)),
        text: estimate.stacked.0,
        error: estimate.stacked.1,
        kind: estimate.kind,
    }
}

/// Letter of the footnote with that text, made where it is new.
fn footnote(reason: &str, reasons: &mut Vec<String>) -> String {
    let known = reasons.iter().position(|text| text == reason);
    letter(known.unwrap_or_else(|| {
        reasons.push(reason.to_owned());
        reasons.len() - 1
    }))
}

/// `a` to `z`, then `aa`, `ab`, ...
fn letter(index: usize) -> String {
    let last = char::from(b'a' + (index % 26) as u8);
    match index / 26 {
        0 => last.to_string(),
        before => format!("{}{last}", letter(before - 1)),
    }
}

fn r_squared(value: Option<f64>) -> Cell {
    Cell {
        // Three decimals as in the thesis; a value that rounds to 1 keeps the digits that differ.
        text: value.map_or_else(|| "–".to_owned(), r_squared_text),
        error: String::new(),
        hover: String::new(),
        kind: if value.is_some() { "value" } else { "missing" },
        footnote: None,
    }
}

/// `0.996`; from 0.9995 on, the digits up to the second that differs from 9.
pub fn r_squared_text(value: f64) -> String {
    let short_of_one = 1.0 - value;
    if (1e-9..5e-4).contains(&short_of_one) {
        let decimals = (1 - short_of_one.log10().floor() as i32).max(3) as usize;
        return crate::report::number::fixed(value, decimals);
    }
    match value.is_finite() && value.abs() < 1000.0 {
        true => crate::report::number::fixed(value, 3),
        false => significant(value, 3),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn r_squared_never_pretends_to_be_one() {
        assert_eq!(r_squared_text(0.9961), "0.996");
        assert_eq!(r_squared_text(0.99984), "0.99984");
        assert_eq!(r_squared_text(0.999_999_7), "0.99999970");
        assert_eq!(r_squared_text(1.0), "1.000");
        assert_eq!(r_squared_text(-3.2), "−3.200");
    }

    #[test]
    fn equal_reasons_share_a_footnote() {
        let mut reasons = vec![];
        let letters: Vec<String> = ["a", "b", "a"]
            .iter()
            .map(|reason| footnote(reason, &mut reasons))
            .collect();
        assert_eq!((letters.join(" "), reasons.len()), ("a b a".to_owned(), 2));
        assert_eq!(
            (letter(25), letter(26), letter(52)),
            ("z".to_owned(), "aa".to_owned(), "ba".to_owned())
        );
    }
}
