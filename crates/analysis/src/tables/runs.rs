//! Every run: what was measured, when, and how well it is fitted.

use super::TableInput;
use super::of_run::{OfRun, Own, of_runs_and_what};
use crate::conditions::nominal_voltage_v;
use ieap_domain::tag::keys;
use ieap_domain::{Fit, RunRecord};
use ieap_show::quantities::{HUMIDITY, Quantity, R_SQUARED_CURRENT, R_SQUARED_CURVATURE, VOLTAGE};
use ieap_show::{Table, Value};

const TEMPERATURE: Quantity = Quantity::new("temperature_c", "T", "temperature", "°C");
const STARTED: Quantity = Quantity::plain("started_at", "Started", "start, in the campaign's time zone");
const STATE: Quantity = Quantity::plain("state", "State", "what became of it");
const MODEL: Quantity = Quantity::plain("model", "Model", "model of its fit");

/// Makes the table.
pub fn make(input: &TableInput) -> Table {
    let zone = input.campaign.timezone.as_deref();
    // Sensors are good to a few tenths at best: a mean over a run has more digits than that.
    let tenths = |run: &RunRecord, key| run.tag_number(key).map(|number| (10.0 * number).round() / 10.0);
    // Nothing is said of the fit of a run that no result is made from.
    fn fit(run: &RunRecord) -> Option<&Fit> {
        run.fit.as_ref().filter(|_| run.standing.speaks())
    }
    let score = |run: &RunRecord, of: fn(&Fit) -> Option<f64>| {
        fit(run)
            .filter(|fit| fit.converged)
            .and_then(of)
            .map(Value::Score)
    };
    type Of<'a> = Own<'a, &'a RunRecord>;
    let sheet = of_runs_and_what("runs", "Runs")
        .column(HUMIDITY, move |(_, run): &Of| {
            tenths(run, keys::RELATIVE_HUMIDITY_PERCENT)
        })
        .column(TEMPERATURE, move |(_, run)| tenths(run, keys::TEMPERATURE_C))
        .column(VOLTAGE, |(_, run)| nominal_voltage_v(run))
        .column(STARTED, |(_, run)| started(run, zone))
        .column(STATE, |(_, run)| {
            if run.standing.speaks() {
                state(run).to_owned()
            } else {
                format!("set aside: {}", run.standing.reason())
            }
        })
        .column(MODEL, |(_, run)| fit(run).map(|fit| fit.model.clone()))
        .column(R_SQUARED_CURRENT, move |(_, run)| {
            score(run, |fit| fit.r_squared_current)
        })
        .column(R_SQUARED_CURVATURE, move |(_, run)| {
            score(run, |fit| fit.r_squared_curvature)
        });
    let runs = input.runs.iter().chain(input.set_aside);
    sheet.over(runs.map(|run| (OfRun::of(input.campaign, run), run)))
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
