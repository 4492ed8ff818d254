//! Every run of the campaign in one table: tags, parameters, and what is to be known of it.

use std::cmp::Ordering;

use serde::Serialize;

use super::wording::{EstimateText, RunLink, estimate_of, has_warnings};
use crate::moved::{Numbers, Said};
use crate::pages::policy::MOST_RUNS_LISTED;
use crate::site::Site;
use crate::sparkline::Sparks;
use ieap_analysis::conditions::nominal_voltage_v;
use ieap_analysis::parameters::COMPARED;
use ieap_analysis::zone::order_s;
use ieap_domain::ParameterInfo;
use ieap_domain::RunRecord;
use ieap_domain::number::significant;
use ieap_domain::tag::keys;

/// The table.
#[derive(Debug, Serialize)]
pub struct RunsTable {
    columns: Vec<Column>,
    rows: Vec<Row>,
    /// Whether responses are drawn beside them, and whether any of them moves.
    is_drawn: bool,
    is_moving: bool,
    /// Whether any row has something to be known, or a humidity.
    is_flagged: bool,
    is_humid: bool,
    /// What the times are: `Measured` or `Taken in`, and whose clock they keep.
    when: &'static str,
    zone: String,
    /// Runs that are not listed.
    left: usize,
}

#[derive(Debug, Serialize)]
struct Column {
    symbol: &'static str,
    name: &'static str,
    unit: &'static str,
}

#[derive(Debug, Serialize)]
struct Row {
    link: RunLink,
    sample: String,
    environment: String,
    humidity: String,
    voltage: String,
    when: String,
    values: Vec<Value>,
    sparks: Sparks,
    /// `fitted`, `warned` or `unfitted`: class.
    state: &'static str,
    /// What is to be known, in words.
    flag: String,
}

/// A parameter of a run.
#[derive(Debug, Serialize)]
struct Value {
    #[serde(flatten)]
    text: EstimateText,
    /// `was 24.6 ± 0.3`, where it moved not long ago.
    #[serde(skip_serializing_if = "String::is_empty")]
    was: String,
}

/// The runs of the table: those that were measured last first; where one does not say when it was, those that came in last.
pub fn listed(site: &Site) -> Vec<usize> {
    let runs = &site.input.runs;
    let starts: Vec<Option<f64>> = runs.iter().map(start_s).collect();
    let are_dated = starts.iter().all(Option::is_some);
    let mut order: Vec<usize> = (0..runs.len()).collect();
    order.sort_by(|&a, &b| {
        let later = if are_dated {
            starts[b].partial_cmp(&starts[a]).unwrap_or(Ordering::Equal)
        } else {
            runs[b].ingested_at.cmp(&runs[a].ingested_at)
        };
        later.then_with(|| runs[a].path.cmp(&runs[b].path))
    });
    order.truncate(MOST_RUNS_LISTED);
    order
}

/// What the table says of every run, with what the report before said.
pub fn numbers(site: &Site) -> Numbers {
    let parameters = || COMPARED.iter().filter_map(|key| ParameterInfo::of(key));
    let fitted = site.input.runs.iter().filter(|run| run.fit.is_some());
    let said = fitted.map(|run| {
        let said = |info: &ParameterInfo| Said {
            text: estimate_of(site, run, info).text,
            measured: run
                .fit
                .as_ref()
                .and_then(|fit| fit.parameter(info.key))
                .and_then(|own| own.value.zip(own.standard_error)),
        };
        let said = parameters().map(|info| (info.key.to_owned(), said(info)));
        (run.path.clone(), said.collect())
    });
    Numbers::after(&site.input.before, said)
}

/// Whether every run says when it was.
fn are_dated(site: &Site) -> bool {
    site.input.runs.iter().all(|run| start_s(run).is_some())
}

fn start_s(run: &RunRecord) -> Option<f64> {
    order_s(run.tag(keys::STARTED_AT)?)
}

/// The table of the runs that are listed.
pub fn runs_table(site: &Site) -> RunsTable {
    // A column without a number says nothing.
    let is_known = |info: &&ParameterInfo| {
        let mut runs = site.input.runs.iter();
        runs.any(|run| estimate_of(site, run, info).kind != "missing")
    };
    let parameters: Vec<&ParameterInfo> = COMPARED
        .iter()
        .filter_map(|key| ParameterInfo::of(key))
        .filter(is_known)
        .collect();
    let columns = parameters.iter().map(|info| Column {
        symbol: info.symbol,
        name: info.name,
        unit: info.shown_unit(),
    });
    let are_dated = are_dated(site);
    let rows: Vec<Row> = listed(site)
        .into_iter()
        .map(|run| row(site, run, &parameters, are_dated))
        .collect();
    RunsTable {
        columns: columns.collect(),
        is_drawn: rows.iter().any(|row| row.sparks.is_drawn()),
        is_moving: rows.iter().any(|row| row.sparks.is_moving()),
        is_flagged: rows.iter().any(|row| !row.flag.is_empty()),
        is_humid: rows.iter().any(|row| !row.humidity.is_empty()),
        when: if are_dated { "Measured" } else { "Taken in" },
        zone: site.zone().name().to_owned(),
        left: site.input.runs.len() - rows.len(),
        rows,
    }
}

fn row(site: &Site, run: usize, parameters: &[&ParameterInfo], are_dated: bool) -> Row {
    let record = &site.input.runs[run];
    let tag = |key: &str| record.tag(key).unwrap_or_default().to_owned();
    let (state, flag) = match (&record.fit, has_warnings(record)) {
        (None, _) => ("unfitted", record.state.why_unfitted().to_owned()),
        (Some(fit), _) if !fit.converged => ("warned", "fit did not converge".to_owned()),
        (Some(_), true) => ("warned", "warnings".to_owned()),
        (Some(_), false) => ("fitted", String::new()),
    };
    Row {
        link: RunLink::to(site, run),
        sample: tag("sample"),
        environment: tag("environment"),
        humidity: tag("relative_humidity_percent"),
        voltage: nominal_voltage_v(record).map_or_else(String::new, |volts| significant(volts, 3)),
        when: site
            .zone()
            .short(match record.tag(keys::STARTED_AT).filter(|_| are_dated) {
                Some(start) => start,
                None => &record.ingested_at,
            }),
        sparks: site.sparks.get(&run).cloned().unwrap_or_default(),
        values: parameters
            .iter()
            .map(|info| Value {
                text: estimate_of(site, record, info),
                was: match site.numbers.was(&record.path, info.key) {
                    Some(was) => format!("was {}", was.text),
                    None => String::new(),
                },
            })
            .collect(),
        state,
        flag,
    }
}
