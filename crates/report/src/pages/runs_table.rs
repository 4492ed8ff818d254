//! Every run of the campaign in one table: tags, parameters, and what is to be known of it.

use serde::Serialize;

use super::wording::{EstimateText, RunLink, estimate_of, has_warnings, why_unfitted};
use crate::number::significant;
use crate::site::Site;
use crate::sparkline::Sparks;
use ieap_analysis::ParameterInfo;
use ieap_analysis::conditions::nominal_voltage_v;
use ieap_analysis::parameters::COMPARED;

/// Runs listed on the overview: a page of thousands opens slowly. The pages of the groups have all.
const MOST: usize = 500;

/// The table.
#[derive(Debug, Serialize)]
pub struct RunsTable {
    columns: Vec<Column>,
    rows: Vec<Row>,
    /// Whether responses are drawn beside them.
    is_drawn: bool,
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
    values: Vec<EstimateText>,
    sparks: Sparks,
    /// `fitted`, `warned` or `unfitted`: class.
    state: &'static str,
    /// What is to be known, in words.
    flag: String,
}

/// The runs that came in last first.
pub fn runs_table(site: &Site) -> RunsTable {
    let parameters: Vec<&ParameterInfo> = COMPARED.iter().filter_map(|key| ParameterInfo::of(key)).collect();
    let columns = parameters.iter().map(|info| Column {
        symbol: info.symbol,
        name: info.name,
        unit: info.shown_unit,
    });
    let runs = &site.input.runs;
    let mut order: Vec<usize> = (0..runs.len()).collect();
    order.sort_by(|&a, &b| {
        let (a, b) = (&runs[a], &runs[b]);
        b.ingested_at
            .cmp(&a.ingested_at)
            .then_with(|| a.path.cmp(&b.path))
    });
    let left = order.len().saturating_sub(MOST);
    order.truncate(MOST);
    let rows = order.into_iter().map(|run| row(site, run, &parameters));
    RunsTable {
        columns: columns.collect(),
        rows: rows.collect(),
        is_drawn: !site.sparks.is_empty(),
        left,
    }
}

fn row(site: &Site, run: usize, parameters: &[&ParameterInfo]) -> Row {
    let record = &site.input.runs[run];
    let tag = |key: &str| record.tag(key).unwrap_or_default().to_owned();
    let (state, flag) = match (&record.fit, has_warnings(record)) {
        (None, _) => ("unfitted", why_unfitted(record).to_owned()),
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
        when: site.zone().moment(&record.ingested_at),
        sparks: site.sparks.get(&run).cloned().unwrap_or_default(),
        values: parameters.iter().map(|info| estimate_of(record, info)).collect(),
        state,
        flag,
    }
}
