//! The runs of a page side by side: what they differ by, and what was fitted to each.

use ieap_domain::words::capital;
use serde::Serialize;

use super::run_fit::{residual_over_noise, symbol_of};
use super::wording::{EstimateText, voltage_label};
use crate::site::Site;
use ieap_analysis::conditions::nominal_voltage_v;
use ieap_analysis::parameters::shown_in;
use ieap_domain::ParameterInfo;
use ieap_domain::number::{score, significant};
use ieap_domain::tag::keys;
use ieap_domain::{Quantity, RunRecord};
use ieap_show::{Column, Sheet, Source, Table};

/// Most columns of tags: more make a table that nobody reads.
const MOST_TAGS: usize = 5;
/// Longest value of a tag in a table, characters.
const LONGEST: usize = 24;

/// The fitted parameters of the runs.
#[derive(Debug, Serialize)]
pub struct ParametersTable {
    columns: Vec<ParameterColumn>,
    rows: Vec<ParameterRow>,
}

#[derive(Debug, Serialize)]
struct ParameterColumn {
    symbol: String,
    name: String,
    unit: &'static str,
}

#[derive(Debug, Serialize)]
struct ParameterRow {
    /// What tells it from the other runs.
    name: String,
    cells: Vec<ParameterCell>,
}

#[derive(Debug, Serialize)]
struct ParameterCell {
    text: String,
    interval: String,
    kind: &'static str,
}

/// What the runs differ by, and how well each is described.
pub fn runs_table(site: &Site, runs: &[usize]) -> Table {
    let records: Vec<&RunRecord> = runs.iter().map(|&run| site.input.record(run)).collect();
    let sheet = Sheet::<&RunRecord>::new("runs", "", 1)
        .made_from(|run| vec![Source::file(&run.path)])
        .plain("Run", |run| site.input.campaign.run_name(&run.path))
        .plain("Voltage", |run| nominal_voltage_v(run).map(voltage_label))
        .plain("Start", |run| {
            run.tag(keys::STARTED_AT).map(|start| site.zone().moment(start))
        });
    let sheet = differing_tags(&records).into_iter().fold(sheet, with_tag);
    let sheet = [Quantity::Current, Quantity::Curvature]
        .into_iter()
        .fold(sheet, |sheet, quantity| {
            let head = Column::of(quantity.key(), quantity.label(), "", "residual / noise");
            sheet.column_under(head, move |run| residual_over_noise(run.fit.as_ref()?, quantity))
        });
    let r_squared = |of| Column::of("r_squared", "R²", "", of);
    sheet
        .column_under(r_squared("current"), |run| {
            run.fit.as_ref()?.r_squared_current.map(score)
        })
        .column_under(r_squared("curvature"), |run| {
            run.fit.as_ref()?.r_squared_curvature.map(score)
        })
        .over(records)
}

/// Tags that not all runs have alike, except those with columns of their own and those too long for one.
fn differing_tags<'a>(runs: &[&'a RunRecord]) -> Vec<&'a str> {
    const SHOWN_ELSEWHERE: [&str; 3] = [keys::VOLTAGE_V, keys::STARTED_AT, keys::NOTE];
    let mut found: Vec<&str> = runs
        .iter()
        .flat_map(|run| run.tags.iter().map(|tag| tag.key.as_str()))
        .collect();
    found.sort_unstable();
    found.dedup();
    let differs = |key: &&str| {
        let mut values = runs.iter().map(|run| run.tag(key));
        let first = values.next().flatten();
        let short = |value: Option<&str>| value.is_none_or(|value| value.chars().count() <= LONGEST);
        short(first) && values.clone().all(short) && values.any(|value| value != first)
    };
    let wanted = found.into_iter().filter(|key| !SHOWN_ELSEWHERE.contains(key));
    wanted.filter(differs).take(MOST_TAGS).collect()
}

/// The sheet with a column for that tag.
fn with_tag<'s, 'a: 's>(sheet: Sheet<'s, &'a RunRecord>, key: &'s str) -> Sheet<'s, &'a RunRecord> {
    let (title, unit) = match key {
        keys::RELATIVE_HUMIDITY_PERCENT => ("Humidity".to_owned(), "% RH"),
        keys::TEMPERATURE_C => ("Temperature".to_owned(), "°C"),
        other => (capital(&other.replace('_', " ")), ""),
    };
    sheet.column_under(Column::of(key, &title, "", unit), move |run| match unit {
        "" => run.tag(key).map(str::to_owned),
        _ => run.tag_number(key).map(|number| significant(number, 3)),
    })
}

/// Names without the beginning that all of them share, cut where a word ends, and without an extension that they share;
/// in full where one would be empty.
fn shortened<'a>(names: &[&'a str]) -> Vec<&'a str> {
    let Some((first, others)) = names.split_first().filter(|(_, others)| !others.is_empty()) else {
        return names.to_vec();
    };
    let same = |other: &&str| {
        first
            .bytes()
            .zip(other.bytes())
            .take_while(|(a, b)| a == b)
            .count()
    };
    let shared = others.iter().map(same).min().unwrap_or(0);
    let start = first.as_bytes()[..shared]
        .iter()
        .rposition(|byte| b"_- /".contains(byte))
        .map_or(0, |last| last + 1);
    let extension = first.rfind('.').map_or("", |dot| &first[dot..]);
    let is_extension = !extension.contains(|c: char| c.is_ascii_digit());
    let all = is_extension && names.iter().all(|name| name.ends_with(extension));
    let end = if all { extension.len() } else { 0 };
    let short: Option<Vec<&str>> = names
        .iter()
        .map(|name| {
            name.get(start..name.len() - end)
                .filter(|short| !short.is_empty())
        })
        .collect();
    short.unwrap_or_else(|| names.to_vec())
}

/// The fitted parameters of `runs`; none where no run is fitted.
pub fn parameters_table(site: &Site, runs: &[usize]) -> Option<ParametersTable> {
    let mut columns: Vec<(&str, &'static str, f64)> = Vec::new();
    for fit in runs.iter().filter_map(|&run| site.input.record(run).fit.as_ref()) {
        for parameter in &fit.parameters {
            let known = ParameterInfo::of(&parameter.key);
            let (unit, factor) = known.map_or(("", 1.0), |known| shown_in(known, fit));
            if !columns
                .iter()
                .any(|column| (column.0, column.1) == (parameter.key.as_str(), unit))
            {
                columns.push((&parameter.key, unit, factor));
            }
        }
    }
    if columns.is_empty() {
        return None;
    }
    let cell = |run: &RunRecord, &(key, unit, factor): &(&str, &'static str, f64)| {
        let here = run.fit.as_ref().filter(|fit| {
            let known = ParameterInfo::of(key);
            known.map_or("", |known| shown_in(known, fit).0) == unit
        });
        let estimate = here.and_then(|fit| Some((fit.parameter(key)?, fit.converged)));
        let Some((estimate, converged)) = estimate else {
            return ParameterCell {
                text: "–".to_owned(),
                interval: String::new(),
                kind: "missing",
            };
        };
        let stated = site.input.doubts.stated(&run.path, key, estimate);
        let text = EstimateText::of(&stated, factor);
        ParameterCell {
            text: text.text,
            interval: text.interval,
            kind: if converged { text.kind } else { "doubtful" },
        }
    };
    let names: Vec<&str> = runs.iter().map(|&run| site.run_name(run)).collect();
    let row = |(&run, name): (&usize, &str)| {
        let record = site.input.record(run);
        ParameterRow {
            name: name.to_owned(),
            cells: columns.iter().map(|column| cell(record, column)).collect(),
        }
    };
    let rows = runs.iter().zip(shortened(&names)).map(row).collect();
    let head = |&(key, unit, _): &(&str, &'static str, f64)| ParameterColumn {
        symbol: symbol_of(key),
        name: ParameterInfo::of(key).map_or_else(String::new, |known| known.name.to_owned()),
        unit,
    };
    Some(ParametersTable {
        columns: columns.iter().map(head).collect(),
        rows,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_shortened_to_what_tells_them_apart() {
        let names = ["S-1_air_1.2V_1.csv", "S-1_air_1.2V_2.csv", "S-1_air_1.6V_1.csv"];
        assert_eq!(shortened(&names), ["1.2V_1", "1.2V_2", "1.6V_1"]);
        assert_eq!(shortened(&["a_1.5", "a_2.5"]), ["1.5", "2.5"]);
        assert_eq!(shortened(&["a_.csv", "a_b.csv"]), ["a_.csv", "a_b.csv"]);
        assert_eq!(shortened(&["é.csv", "è.csv"]), ["é", "è"]);
        assert_eq!(shortened(&["only.csv"]), ["only.csv"]);
    }
}
