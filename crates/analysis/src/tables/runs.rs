//! Every run: what was measured, when, and how well it is fitted.

use super::TableInput;
use super::cells::{run_sources, score_cell};
use crate::conditions::{material, nominal_voltage_v};
use ieap_domain::RunRecord;
use ieap_domain::tag::keys;
use ieap_show::{Cell, Column, Row, Table};

/// Makes the table.
pub fn make(input: &TableInput) -> Table {
    let columns = vec![
        Column::plain("run", "Run", "run"),
        Column::plain("sample", "Sample", "sample"),
        Column::plain("material", "Material", "material"),
        Column::plain("environment", "Environment", "environment"),
        Column::of("relative_humidity_percent", "RH", "relative humidity", "%"),
        Column::of("temperature_c", "T", "temperature", "°C"),
        Column::of("voltage_v", "V₀", "step voltage", "V"),
        Column::plain("started_at", "Started", "start, in the campaign's time zone"),
        Column::plain("state", "State", "what became of it"),
        Column::plain("model", "Model", "model of its fit"),
        Column::plain(
            "r_squared_current",
            "R² (current)",
            "coefficient of determination of the current",
        ),
        Column::plain(
            "r_squared_curvature",
            "R² (curvature)",
            "coefficient of determination of the curvature",
        ),
    ];
    Table {
        title: "Runs".to_owned(),
        columns,
        stub: 1,
        rows: (0..input.runs.len())
            .map(|run| row(input, run))
            .chain(input.set_aside.iter().map(|run| set_aside(input, run)))
            .collect(),
        ..Table::default()
    }
}

fn row(input: &TableInput, index: usize) -> Row {
    let run = &input.runs[index];
    let sources = || run_sources(input, &[index]);
    let text = |text: Option<&str>| Cell::text(text, sources());
    // Sensors are good to a few tenths at best: a mean over a run has more digits than that.
    let tenths = |number: f64| (10.0 * number).round() / 10.0;
    let number = |key: &str| Cell::exact(run.tag_number(key).map(tenths), sources());
    let cells = vec![
        text(Some(&run.path)),
        text(run.tag(keys::SAMPLE)),
        text(material(run, input.campaign)),
        text(run.tag(keys::ENVIRONMENT)),
        number(keys::RELATIVE_HUMIDITY_PERCENT),
        number(keys::TEMPERATURE_C),
        Cell::exact(nominal_voltage_v(run), sources()),
        Cell::text(started(run, input.campaign.timezone.as_deref()), sources()),
        text(Some(state(run))),
        text(run.fit.as_ref().map(|fit| fit.model.as_str())),
        score_cell(input, &[index], |fit| fit.r_squared_current),
        score_cell(input, &[index], |fit| fit.r_squared_curvature),
    ];
    Row {
        label: run.path.clone(),
        cells,
    }
}

/// A run that no result is made from: what it is, and why; nothing of its fit.
fn set_aside(input: &TableInput, run: &RunRecord) -> Row {
    let text = |text: Option<&str>| Cell::text(text, Vec::new());
    let number = |key: &str| Cell::exact(run.tag_number(key), Vec::new());
    let state = format!("set aside: {}", run.standing.reason());
    let cells = vec![
        text(Some(&run.path)),
        text(run.tag(keys::SAMPLE)),
        text(material(run, input.campaign)),
        text(run.tag(keys::ENVIRONMENT)),
        number(keys::RELATIVE_HUMIDITY_PERCENT),
        number(keys::TEMPERATURE_C),
        Cell::exact(nominal_voltage_v(run), Vec::new()),
        Cell::text(started(run, input.campaign.timezone.as_deref()), Vec::new()),
        text(Some(&state)),
        text(None),
        text(None),
        text(None),
    ];
    Row {
        label: run.path.clone(),
        cells,
    }
}

fn state(run: &RunRecord) -> &'static str {
    match &run.fit {
        Some(fit) if fit.converged => "fitted",
        Some(_) => "fit did not converge",
        None => match run.state {
            ieap_domain::RunState::Ready => "not fitted yet",
            ieap_domain::RunState::Untagged => "lacks tags",
            ieap_domain::RunState::NotFitted => "cannot be fitted",
            ieap_domain::RunState::NoSteps => "no steps",
        },
    }
}

/// `2026-03-02 10:00 +02:00` in the campaign's zone; a text that is no time stays as it is.
fn started(run: &RunRecord, zone: Option<&str>) -> Option<String> {
    let stated = run.tag(keys::STARTED_AT)?;
    let Ok(moment) = stated.parse::<jiff::Timestamp>() else {
        return Some(stated.to_owned());
    };
    let zone = zone.and_then(|name| jiff::tz::TimeZone::get(name).ok());
    let local = moment.to_zoned(zone.unwrap_or(jiff::tz::TimeZone::UTC));
    Some(local.strftime("%Y-%m-%d %H:%M %:z").to_string())
}

#[cfg(test)]
mod tests {
    use super::*;
    use ieap_domain::testing::{run, tag};

    #[test]
    fn a_start_is_shown_with_its_zone_on_both_sides_of_a_clock_change() {
        let at = |text: &str, zone| {
            let mut made = run("r", "CNaf-01", "air", None, 2.0);
            made.tags.push(tag(keys::STARTED_AT, text));
            started(&made, zone).unwrap()
        };
        let tallinn = Some("Europe/Tallinn");
        assert_eq!(at("2026-03-02T08:00:00Z", tallinn), "2026-03-02 10:00 +02:00");
        assert_eq!(at("2026-07-02T08:00:00Z", tallinn), "2026-07-02 11:00 +03:00");
        assert_eq!(at("2026-07-02T08:00:00Z", None), "2026-07-02 08:00 +00:00");
        assert_eq!(at("yesterday", tallinn), "yesterday");
    }
}
