//! What measured one quantity of the climate all through a run: columns of its own file, sensors with logs.

use super::asked::{Asked, SURROUNDINGS_S, margin};
use super::gather::{Around, around, groups};
use super::shelf::Shelf;
use crate::analysis::climate::join::{NoClimate, Statistics};
use crate::analysis::climate::sensors::accuracy;
use crate::analysis::climate::{Window, speaks_for, statistics};
use crate::domain::surroundings::kind_of;
use crate::domain::{Campaign, ClimateQuantity, ClimateRules, Issue, RunClimate};
use crate::numerics::robust::median_step;
use crate::pipeline::{Context, PipelineError};

/// A sensor that covers the run.
pub(super) struct Covering {
    /// Where it stands: sensors of one place are compared.
    pub place: Place,
    /// Readings during the run and around it.
    pub series: Around,
    /// Statistics over the run.
    pub found: RunClimate,
}

/// Where a sensor stands.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum Place {
    /// At the run: it is a column of the run's file.
    Own,
    /// As campaign.toml or the folder says.
    Named(String),
}

/// The columns of the run's own file that hold this quantity, in the order of the file. `span` is the run.
pub(super) fn of_own_columns(
    asked: &Asked<'_>,
    span: Window,
    quantity: ClimateQuantity,
    rules: &ClimateRules,
    reasons: &mut Vec<String>,
) -> Vec<Covering> {
    let mut found = Vec::new();
    let of_quantity = asked.own.iter().filter(|channel| {
        ClimateQuantity::measured(channel.quantity) == Some(quantity) && channel.is_whole(channel.quantity)
    });
    for channel in of_quantity {
        let (time_s, values) = channel.included();
        let shift_s = span.from_s - asked.times.map_or(0.0, |(first_s, _)| first_s);
        let series = Around {
            times_s: time_s.iter().map(|time| time + shift_s).collect(),
            values: values.to_vec(),
            interval_s: median_step(&time_s).unwrap_or(0.0),
        };
        let sensor = RunClimate::own_column(&channel.raw_name);
        match over(&series, span, rules.longest_gap_s) {
            Ok(statistics) => found.push(Covering {
                place: Place::Own,
                found: statistics.of_run(&sensor, quantity, false, None),
                series,
            }),
            Err(reason) => reasons.push(format!("{sensor} {}", reason.words(rules.longest_gap_s))),
        }
    }
    found
}

fn over(series: &Around, span: Window, longest_gap_s: f64) -> Result<Statistics, NoClimate> {
    let readings = (&series.times_s[..], &series.values[..]);
    statistics(readings, span, series.interval_s, longest_gap_s)
}

/// The sensors whose logs cover the run, in the order in which they are asked.
///
/// # Errors
/// The database cannot be read.
pub(super) fn of_logs(
    context: &Context,
    shelf: &Shelf,
    window: Window,
    asked: &Asked<'_>,
    quantity: ClimateQuantity,
    (reasons, issues): (&mut Vec<String>, &mut Vec<Issue>),
) -> Result<Vec<Covering>, PipelineError> {
    let campaign = &context.campaign;
    let longest_gap_s = campaign.climate.longest_gap_s;
    let near = shelf.near(window, longest_gap_s + SURROUNDINGS_S);
    let groups = groups(
        shelf,
        campaign,
        near.filter(|&at| shelf.series[at].quantity == quantity),
    );
    let mut found: Vec<Covering> = Vec::new();
    for numbers in groups.values() {
        let identity = shelf.identity(campaign, numbers[0]);
        let sensor = &identity.sensor;
        if !speaks_for(identity.statement, quantity, asked.environment, asked.sample) {
            continue;
        }
        let margin_s = margin(window).max(longest_gap_s);
        let Some(series) = around(&context.store, campaign, shelf, numbers, (window, margin_s))? else {
            reasons.push(format!("{sensor}: nothing states the time zone of its clock"));
            continue;
        };
        let is_of_room = identity
            .statement
            .is_none_or(|stated| stated.environments.is_empty());
        let stated = stated_of(campaign, asked.environment, quantity).filter(|_| is_of_room);
        match over(&series, window, longest_gap_s) {
            // What campaign.toml states of an environment of its own is no default beside a sensor of the room.
            Ok(statistics) if stated.is_some() => {
                let differs = stated.filter(|stated| !quantity.agree(*stated, statistics.mean));
                issues.extend(
                    differs
                        .and(asked.environment)
                        .map(|environment| not_of(environment, sensor, quantity)),
                );
            }
            Ok(statistics) => {
                let accuracy = accuracy(identity.statement, quantity);
                found.push(Covering {
                    found: statistics.of_run(sensor, quantity, false, accuracy),
                    place: Place::Named(identity.place.clone()),
                    series,
                });
            }
            Err(NoClimate::Empty) => {}
            Err(reason) => reasons.push(format!("the log of {sensor} {}", reason.words(longest_gap_s))),
        }
    }
    Ok(found)
}

/// What campaign.toml states of a quantity in an environment that is not the room's air.
fn stated_of(campaign: &Campaign, environment: Option<&str>, quantity: ClimateQuantity) -> Option<f64> {
    let environment = environment.filter(|id| kind_of(id) != Some("air"))?;
    let stated = campaign.environment(environment)?;
    match quantity {
        ClimateQuantity::RelativeHumidity => stated.relative_humidity_percent,
        ClimateQuantity::Temperature => stated.temperature_c,
        ClimateQuantity::Pressure => stated.pressure_pa,
        _ => None,
    }
}

/// Code of the question whether a sensor stands in an environment of which campaign.toml states something else.
pub const ENVIRONMENT_STATED: &str = "climate-environment-stated";

/// The same words for all runs of an environment: it is one question.
fn not_of(environment: &str, sensor: &str, quantity: ClimateQuantity) -> Issue {
    let message = format!(
        "campaign.toml states the {} of the environment \"{environment}\", and the sensor {sensor}, of which nothing says \
         where it stands, reads otherwise: what is stated counts",
        quantity.label().to_lowercase()
    );
    Issue::warning(ENVIRONMENT_STATED, message).at(quantity.key()).mend(format!(
        "does it stand there? then [[sensor]] id = \"{sensor}\" with environments = [\"{environment}\"] in campaign.toml; \
         does it stand in the room? then environments = [\"air\"]"
    ))
}
