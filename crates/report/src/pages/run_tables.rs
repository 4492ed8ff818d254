//! The runs of a page side by side: what they differ by, and what was fitted to each.

use ieap_domain::words::capital;
use serde::Serialize;

use super::run_fit::{residual_over_noise, symbol_of};
use super::wording::{EstimateText, voltage_label};
use crate::site::Site;
use ieap_analysis::ParameterInfo;
use ieap_analysis::conditions::nominal_voltage_v;
use ieap_domain::number::{score, significant};
use ieap_domain::tag::keys;
use ieap_domain::{Quantity, RunRecord};

/// Most columns of tags: more make a table that nobody reads.
const MOST_TAGS: usize = 5;
/// Longest value of a tag in a table, characters.
const LONGEST: usize = 24;

/// What the runs differ by, and how well each is described.
#[derive(Debug, Serialize)]
pub struct RunsTable {
    columns: Vec<Column>,
    rows: Vec<RunRow>,
}

#[derive(Debug, Serialize)]
struct Column {
    title: String,
    small: String,
    is_number: bool,
}

#[derive(Debug, Serialize)]
struct RunRow {
    anchor: String,
    name: String,
    cells: Vec<String>,
}

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

/// A column before it is known whether any run has something in it.
type Filled = (Column, Vec<String>);

/// The table of `runs`.
pub fn runs_table(site: &Site, runs: &[usize]) -> RunsTable {
    let records: Vec<&RunRecord> = runs.iter().map(|&run| site.input.record(run)).collect();
    let zone = site.zone();
    let mut filled = vec![filled("Voltage", "", true, &records, |run| {
        nominal_voltage_v(run).map(voltage_label)
    })];
    filled.push(self::filled("Start", "", false, &records, |run| {
        run.tag(keys::STARTED_AT).map(|start| zone.moment(start))
    }));
    filled.extend(differing_tags(&records));
    for quantity in [Quantity::Current, Quantity::Curvature] {
        let of = quantity.label();
        filled.push(self::filled(of, "residual / noise", true, &records, |run| {
            residual_over_noise(run.fit.as_ref()?, quantity)
        }));
    }
    for (of, which) in [("current", Quantity::Current), ("curvature", Quantity::Curvature)] {
        filled.push(self::filled("R²", of, true, &records, |run| {
            let fit = run.fit.as_ref()?;
            let value = match which {
                Quantity::Current => fit.r_squared_current,
                _ => fit.r_squared_curvature,
            };
            value.map(score)
        }));
    }
    filled.retain(|(_, cells)| cells.iter().any(|cell| !cell.is_empty()));
    let row = |(at, &run): (usize, &usize)| RunRow {
        anchor: site.run_slug(run).to_owned(),
        name: site.run_name(run).to_owned(),
        cells: filled.iter().map(|(_, cells)| cells[at].clone()).collect(),
    };
    RunsTable {
        rows: runs.iter().enumerate().map(row).collect(),
        columns: filled.into_iter().map(|(column, _)| column).collect(),
    }
}

fn filled(
    title: &str,
    small: &str,
    is_number: bool,
    runs: &[&RunRecord],
    cell: impl Fn(&RunRecord) -> Option<String>,
) -> Filled {
    let column = Column {
        title: title.to_owned(),
        small: small.to_owned(),
        is_number,
    };
    (
        column,
        runs.iter().map(|run| cell(run).unwrap_or_default()).collect(),
    )
}

/// Tags that not all runs have alike, except those with columns of their own and those too long for one.
fn differing_tags(runs: &[&RunRecord]) -> Vec<Filled> {
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
    let column = |key: &str| {
        let (title, unit) = match key {
            keys::RELATIVE_HUMIDITY_PERCENT => ("Humidity".to_owned(), "% RH"),
            keys::TEMPERATURE_C => ("Temperature".to_owned(), "°C"),
            other => (capital(&other.replace('_', " ")), ""),
        };
        let is_number = runs
            .iter()
            .all(|run| run.tag(key).is_none() || run.tag_number(key).is_some());
        filled(&title, unit, is_number, runs, |run| match unit {
            "" => run.tag(key).map(str::to_owned),
            _ => run.tag_number(key).map(|number| significant(number, 3)),
        })
    };
    let wanted = found.into_iter().filter(|key| !SHOWN_ELSEWHERE.contains(key));
    wanted.filter(differs).take(MOST_TAGS).map(column).collect()
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
            let (unit, factor) = known.map_or(("", 1.0), |known| known.shown_in(fit));
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
            known.map_or("", |known| known.shown_in(fit).0) == unit
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
