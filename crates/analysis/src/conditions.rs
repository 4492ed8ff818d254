//! The conditions of a campaign: material x surroundings x voltage, and which runs were measured in each.

use std::collections::BTreeMap;

use ieap_domain::number::fixed;
use ieap_domain::surroundings::is_waterless;
use ieap_domain::tag::keys;
use ieap_domain::{Campaign, Drive, RunRecord};

/// Two neighbouring humidities further apart than this (percentage points) are different levels.
///
/// Humidity is measured, not set: the thesis's single air condition spans 28-38 %. Levels are therefore the
/// clusters of the measured values, not a grid.
pub const HUMIDITY_GAP_PERCENT: f64 = 5.0;

/// A level is no wider than this, percentage points: where humidities follow each other without gaps it is cut into equal parts.
/// Chosen: twice what the one air condition of the thesis spans.
const WIDEST_LEVEL_PERCENT: f64 = 20.0;

/// A humidity is known to this, percentage points: what makers of capacitive sensors state.
pub const HUMIDITY_KNOWN_TO_PERCENT: f64 = 2.0;

/// Voltages that agree when rounded to this step (V) are one condition: a measured level is never quite 2.5 V.
pub const VOLTAGE_STEP_V: f64 = 0.01;

/// Surroundings up to this humidity, percent, are dry.
pub const DRY_UP_TO_PERCENT: f64 = 5.0;

/// Readings of a response below which a run is none: it was aborted before anything was measured.
const FEWEST_READINGS: usize = 10;

/// A cluster of relative humidities.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HumidityLevel {
    /// Smallest humidity among the runs, percent.
    pub low_percent: f64,
    /// Largest humidity among the runs, percent.
    pub high_percent: f64,
}

/// An environment, at one humidity level where the humidity is known.
#[derive(Debug, Clone, PartialEq)]
pub struct Surroundings {
    /// Environment id.
    pub environment: String,
    /// Humidity level; none where no run states a humidity.
    pub humidity: Option<HumidityLevel>,
    /// Whether the environment was measured at more than one level, so that its name alone does not say which.
    pub humidity_varies: bool,
}

impl Surroundings {
    /// `28–38 % RH`; empty where no humidity is known.
    pub fn humidity_said(&self) -> String {
        let Some(level) = self.humidity else {
            return String::new();
        };
        let (low, high) = (fixed(level.low_percent, 0), fixed(level.high_percent, 0));
        if low == high {
            format!("{low} % RH")
        } else {
            format!("{low}–{high} % RH")
        }
    }

    /// `air (28–38 % RH)`
    pub fn said(&self) -> String {
        match self.humidity_said() {
            humidity if humidity.is_empty() => self.environment.clone(),
            humidity => format!("{} ({humidity})", self.environment),
        }
    }
}

/// The runs of one material in one surroundings at one voltage.
#[derive(Debug, Clone, PartialEq)]
pub struct Condition {
    /// Index in [`Conditions::materials`].
    pub material: usize,
    /// Index in [`Conditions::surroundings`].
    pub surroundings: usize,
    /// Index in [`Conditions::voltages_v`].
    pub voltage: usize,
    /// Indices of its runs, in the order of the runs; never empty.
    pub runs: Vec<usize>,
}

/// The table of conditions: its axes and the conditions that were measured.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Conditions {
    /// Materials that were measured, in campaign order; a sample that the campaign lacks stands for itself.
    pub materials: Vec<String>,
    /// Surroundings that were measured: campaign order of the environments, then rising humidity.
    pub surroundings: Vec<Surroundings>,
    /// Nominal voltages, V, rising.
    pub voltages_v: Vec<f64>,
    /// Measured conditions in the order material, surroundings, voltage.
    pub measured: Vec<Condition>,
    /// Indices of runs that belong to no condition, because a tag is missing or is no number, or because they were aborted
    /// after a few readings.
    pub unplaced: Vec<usize>,
}

impl Conditions {
    /// Whether the humidity of an environment was varied: by more than both ends are known to, whatever levels it falls into.
    pub fn varies_humidity(&self, environment: &str) -> bool {
        let own = self
            .surroundings
            .iter()
            .filter(|own| own.environment == environment);
        let levels: Vec<HumidityLevel> = own.filter_map(|own| own.humidity).collect();
        let low = levels.iter().map(|own| own.low_percent).reduce(f64::min);
        let high = levels.iter().map(|own| own.high_percent).reduce(f64::max);
        low.zip(high)
            .is_some_and(|(low, high)| high - low > 2.0 * HUMIDITY_KNOWN_TO_PERCENT)
    }

    /// The condition at these indices, if it was measured.
    pub fn at(&self, material: usize, surroundings: usize, voltage: usize) -> Option<&Condition> {
        self.measured.iter().find(|condition| {
            (condition.material, condition.surroundings, condition.voltage)
                == (material, surroundings, voltage)
        })
    }

    /// Where a run that is not among those of the table would stand: indices of its material, surroundings and voltage.
    /// None where no run of the table was measured with that material, at that voltage, or near that humidity.
    pub fn place_of(&self, run: &RunRecord, campaign: &Campaign) -> Option<(usize, usize, usize)> {
        let place = place(0, run, campaign)?;
        let material = self.materials.iter().position(|name| name == place.material)?;
        let of_voltage = |volts: &f64| (volts / VOLTAGE_STEP_V).round() as i64 == place.voltage_step;
        let voltage = self.voltages_v.iter().position(of_voltage)?;
        let apart = |surroundings: &Surroundings| surroundings.apart_percent(&place);
        let near = self.surroundings.iter().enumerate();
        let near = near.filter_map(|(at, surroundings)| Some((apart(surroundings)?, at)));
        let (_, surroundings) = near.min_by(|a, b| a.0.total_cmp(&b.0))?;
        Some((material, surroundings, voltage))
    }
}

/// Material of a run: that of its sample, or the sample's id where the campaign does not know the sample.
pub fn material<'a>(run: &'a RunRecord, campaign: &'a Campaign) -> Option<&'a str> {
    let sample = run.tag(keys::SAMPLE)?;
    Some(
        campaign
            .sample(sample)
            .map_or(sample, |known| known.material.as_str()),
    )
}

/// What stands for a run's material in comparisons: its class where `[compare] by` asks for one.
pub fn compared_material<'a>(run: &'a RunRecord, campaign: &'a Campaign) -> Option<&'a str> {
    material(run, campaign).map(|own| campaign.compared_as(own))
}

/// Nominal voltage of a run, V: its tag, or that of the drive; none of a voltage that moves all the time, which is no step of
/// any size.
pub fn nominal_voltage_v(run: &RunRecord) -> Option<f64> {
    if run.drive.as_ref().is_some_and(Drive::moves) {
        return None;
    }
    run.tag_number(keys::VOLTAGE_V)
        .or_else(|| run.drive.as_ref().map(|drive| drive.nominal_step_v()))
}

/// `2.0`, and `1.25` where one decimal does not tell it.
pub fn volts_number(voltage_v: f64) -> String {
    let is_told = (10.0 * voltage_v - (10.0 * voltage_v).round()).abs() < VOLTAGE_STEP_V;
    fixed(voltage_v, if is_told { 1 } else { 2 })
}

/// `2.0 V`
pub fn volts(voltage_v: f64) -> String {
    format!("{} V", volts_number(voltage_v))
}

/// What places one run in the table.
struct Place<'a> {
    run: usize,
    material: &'a str,
    environment: &'a str,
    humidity_percent: Option<f64>,
    voltage_step: i64,
}

/// The conditions with each material by itself, whatever `[compare] by` puts together: what is measured of one material
/// says nothing of another.
pub fn conditions_of_materials(runs: &[RunRecord], campaign: &Campaign) -> Conditions {
    let mut apart = campaign.clone();
    apart.compare.by = None;
    conditions(runs, &apart)
}

/// Sorts `runs` into the conditions of `campaign`.
pub fn conditions(runs: &[RunRecord], campaign: &Campaign) -> Conditions {
    let mut table = Conditions::default();
    let mut places = Vec::new();
    for (index, run) in runs.iter().enumerate() {
        match place(index, run, campaign) {
            Some(place) => places.push(place),
            None => table.unplaced.push(index),
        }
    }
    table.materials = materials(&places, campaign);
    table.surroundings = surroundings(&places, campaign);
    let mut steps: Vec<i64> = places.iter().map(|place| place.voltage_step).collect();
    steps.sort_unstable();
    steps.dedup();
    let mut measured: BTreeMap<(usize, usize, usize), Vec<usize>> = BTreeMap::new();
    for place in &places {
        let key = (
            position(&table.materials, |name| name == place.material),
            position(&table.surroundings, |surroundings| surroundings.holds(place)),
            position(&steps, |step| *step == place.voltage_step),
        );
        measured.entry(key).or_default().push(place.run);
    }
    table.measured = measured
        .into_iter()
        .map(|((material, surroundings, voltage), runs)| Condition {
            material,
            surroundings,
            voltage,
            runs,
        })
        .collect();
    table.voltages_v = steps
        .iter()
        .map(|&step| step as f64 / (1.0 / VOLTAGE_STEP_V))
        .collect();
    table
}

/// Whether a run was aborted before anything was measured: it would make a condition of its own.
pub fn is_too_short(run: &RunRecord) -> bool {
    let mut responses = run
        .channels
        .iter()
        .filter(|c| c.quantity.is_response())
        .peekable();
    run.fit.is_none() && responses.peek().is_some() && responses.all(|c| c.readings < FEWEST_READINGS)
}

fn place<'a>(index: usize, run: &'a RunRecord, campaign: &'a Campaign) -> Option<Place<'a>> {
    if is_too_short(run) {
        return None;
    }
    Some(Place {
        run: index,
        material: compared_material(run, campaign)?,
        environment: run.tag(keys::ENVIRONMENT)?,
        humidity_percent: run.tag_number(keys::RELATIVE_HUMIDITY_PERCENT),
        voltage_step: (nominal_voltage_v(run)? / VOLTAGE_STEP_V).round() as i64,
    })
}

fn materials(places: &[Place], campaign: &Campaign) -> Vec<String> {
    let stated = campaign
        .materials
        .iter()
        .map(|material| campaign.compared_as(&material.id));
    let of_samples = campaign
        .samples
        .iter()
        .map(|sample| campaign.compared_as(&sample.material));
    let order: Vec<&str> = stated.chain(of_samples).collect();
    ordered(places.iter().map(|place| place.material), &order)
}

fn surroundings(places: &[Place], campaign: &Campaign) -> Vec<Surroundings> {
    let order: Vec<&str> = campaign
        .environments
        .iter()
        .map(|environment| environment.id.as_str())
        .collect();
    let environments = ordered(places.iter().map(|place| place.environment), &order);
    environments
        .into_iter()
        .flat_map(|environment| levels(places, environment))
        .collect()
}

/// One entry per humidity level of the environment; one without a level for runs that state none.
fn levels(places: &[Place], environment: String) -> Vec<Surroundings> {
    let here = || places.iter().filter(|place| place.environment == environment);
    let mut stated: Vec<f64> = here().filter_map(|place| place.humidity_percent).collect();
    stated.sort_by(f64::total_cmp);
    let mut levels: Vec<Option<HumidityLevel>> = stated
        .chunk_by(|a, b| b - a <= HUMIDITY_GAP_PERCENT)
        .flat_map(narrow)
        .map(|cluster| {
            Some(HumidityLevel {
                low_percent: cluster[0],
                high_percent: cluster[cluster.len() - 1],
            })
        })
        .collect();
    if here().any(|place| place.humidity_percent.is_none()) {
        levels.push(None);
    }
    let humidity_varies = levels.len() > 1;
    let surroundings = |humidity| Surroundings {
        environment: environment.clone(),
        humidity,
        humidity_varies,
    };
    levels.into_iter().map(surroundings).collect()
}

/// A cluster as levels that are not too wide.
fn narrow(cluster: &[f64]) -> impl Iterator<Item = &[f64]> {
    let (low, width) = (cluster[0], cluster[cluster.len() - 1] - cluster[0]);
    let parts = (width / WIDEST_LEVEL_PERCENT).ceil().max(1.0);
    let part = move |own: f64| ((own - low) / width * parts).min(parts - 1.0) as usize;
    cluster.chunk_by(move |a, b| part(*a) == part(*b))
}

impl Surroundings {
    /// `28–38`; none where no humidity is known.
    pub fn humidity_text(&self) -> Option<String> {
        let level = self.humidity?;
        let (low, high) = (fixed(level.low_percent, 0), fixed(level.high_percent, 0));
        Some(if low == high {
            low
        } else {
            format!("{low}–{high}")
        })
    }

    /// `air`, or `air at 28–38 % RH` where the environment was measured at more than one humidity.
    pub fn text(&self) -> String {
        match (self.humidity_varies, self.humidity_text()) {
            (true, Some(humidity)) => format!("{} at {humidity} % RH", self.environment),
            _ => self.environment.clone(),
        }
    }

    /// Whether they hold no water: by their humidity, else by their name.
    pub fn is_dry(&self) -> bool {
        match self.humidity {
            Some(level) => level.high_percent <= DRY_UP_TO_PERCENT,
            None => is_waterless(&self.environment),
        }
    }

    /// How far a run's humidity lies outside the level, percentage points; none where it would be a level of its own.
    fn apart_percent(&self, place: &Place) -> Option<f64> {
        let apart = match (self.humidity, place.humidity_percent) {
            (Some(level), Some(percent)) => (level.low_percent - percent)
                .max(percent - level.high_percent)
                .max(0.0),
            (None, None) => 0.0,
            _ => return None,
        };
        (self.environment == place.environment && apart <= HUMIDITY_GAP_PERCENT).then_some(apart)
    }

    fn holds(&self, place: &Place) -> bool {
        let humidity_fits = match (self.humidity, place.humidity_percent) {
            (Some(level), Some(percent)) => (level.low_percent..=level.high_percent).contains(&percent),
            (None, None) => true,
            _ => false,
        };
        self.environment == place.environment && humidity_fits
    }
}

/// Distinct names: those in `order` first and in that order, the others by name.
fn ordered<'a>(names: impl Iterator<Item = &'a str>, order: &[&str]) -> Vec<String> {
    let mut distinct: Vec<&str> = names.collect();
    distinct.sort_by_key(|name| {
        (
            order
                .iter()
                .position(|known| known == name)
                .unwrap_or(order.len()),
            *name,
        )
    });
    distinct.dedup();
    distinct.into_iter().map(str::to_owned).collect()
}

/// Index of the entry that every place has by construction.
fn position<T>(entries: &[T], fits: impl Fn(&T) -> bool) -> usize {
    entries.iter().position(fits).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use ieap_domain::testing::{campaign, run};
    use ieap_domain::{Channel, Quantity};

    #[test]
    fn runs_are_sorted_into_campaign_order() {
        let runs = [
            run("b", "CPvf-01", "air", Some(34.0), 2.5),
            run("a", "CNaf-01", "air", Some(30.0), 1.2),
            run("c", "CNaf-01", "vacuum", None, 2.5),
            run("d", "CNaf-01", "air", Some(32.0), 1.2004),
        ];
        let table = conditions(&runs, &campaign());
        assert_eq!(table.materials, ["CNaf", "CPvf"]);
        assert_eq!(table.voltages_v, [1.2, 2.5]);
        let names: Vec<&str> = table
            .surroundings
            .iter()
            .map(|s| s.environment.as_str())
            .collect();
        assert_eq!(names, ["vacuum", "air"]);
        assert_eq!(table.at(0, 1, 0).unwrap().runs, [1, 3]);
        assert!(table.at(1, 0, 0).is_none());
        assert!(table.unplaced.is_empty());
    }

    #[test]
    fn an_aborted_run_of_three_readings_makes_no_condition() {
        let readings = |count: usize| {
            let series: std::sync::Arc<[f64]> = (0..count).map(|k| k as f64).collect();
            let channel = Channel::new(Quantity::Current, series.clone(), series);
            let mut run = run("r", "CNaf-01", "air", Some(30.0), 0.0);
            run.channels = vec![channel.summary()];
            run
        };
        let table = conditions(&[readings(3), readings(10)], &campaign());
        assert_eq!(table.unplaced, [0]);
        assert_eq!(table.measured[0].runs, [1]);
    }

    #[test]
    fn a_run_that_is_not_of_the_table_stands_where_the_others_of_its_condition_do() {
        let runs = [
            run("a", "CNaf-01", "air", Some(30.0), 1.2),
            run("b", "CNaf-01", "air", Some(60.0), 2.5),
            run("c", "CPvf-01", "vacuum", None, 2.5),
        ];
        let table = conditions(&runs, &campaign());
        let place = |sample, environment, percent, volts| {
            table.place_of(&run("odd", sample, environment, percent, volts), &campaign())
        };
        // Vacuum, then air at two levels; the levels stay as they are.
        assert_eq!(place("CNaf-01", "air", Some(34.0), 2.5), Some((0, 1, 1)));
        assert_eq!(place("CPvf-01", "air", Some(57.0), 1.2), Some((1, 2, 0)));
        assert_eq!(place("CNaf-01", "vacuum", None, 1.2), Some((0, 0, 0)));
        assert_eq!(place("CNaf-01", "air", Some(45.0), 2.5), None);
        assert_eq!(place("CNaf-01", "air", None, 2.5), None);
        assert_eq!(place("CNaf-01", "air", Some(30.0), 2.0), None);
        assert_eq!(place("CNaf-01", "inert", None, 2.5), None);
    }

    #[test]
    fn humidity_levels_are_clusters_and_the_thesis_range_is_one() {
        let humidities = [28.0, 31.0, 34.0, 38.0, 60.0, 61.0];
        let runs: Vec<RunRecord> = humidities
            .iter()
            .map(|&rh| run("r", "CNaf-01", "air", Some(rh), 2.0))
            .collect();
        let table = conditions(&runs, &campaign());
        let levels: Vec<(f64, f64)> = table
            .surroundings
            .iter()
            .filter_map(|s| s.humidity.map(|level| (level.low_percent, level.high_percent)))
            .collect();
        assert_eq!(levels, [(28.0, 38.0), (60.0, 61.0)]);
        assert!(table.surroundings.iter().all(|s| s.humidity_varies));
    }

    #[test]
    fn humidities_without_gaps_are_levels_too_and_were_varied() {
        let of = |all: Vec<f64>| {
            let runs: Vec<RunRecord> = (all.iter())
                .map(|&rh| run("r", "CNaf-01", "air", Some(rh), 2.0))
                .collect();
            conditions(&runs, &campaign())
        };
        let close = of((0..12).map(|k| 20.0 + 4.0 * f64::from(k)).collect());
        assert_eq!(close.surroundings.len(), 3, "{:?}", close.surroundings);
        assert!(close.varies_humidity("air") && !close.varies_humidity("vacuum"));
        assert!(of(vec![30.0, 33.0, 38.0]).varies_humidity("air"));
        assert!(!of(vec![30.0, 33.0]).varies_humidity("air"));
    }

    #[test]
    fn a_run_without_a_tag_is_unplaced_and_never_lost() {
        let mut untagged = run("u", "CNaf-01", "air", None, 2.0);
        untagged.tags.retain(|tag| tag.key != keys::ENVIRONMENT);
        let runs = [untagged, run("v", "unknown-sample", "my chamber", None, -0.0)];
        let table = conditions(&runs, &campaign());
        assert_eq!(table.unplaced, [0]);
        assert_eq!(table.materials, ["unknown-sample"]);
        assert_eq!(table.voltages_v, [0.0]);
    }

    #[test]
    fn every_run_is_in_exactly_one_place() {
        let runs: Vec<RunRecord> = (0..60)
            .map(|k| {
                let environment = ["vacuum", "inert", "air"][k % 3];
                run(
                    "r",
                    "CNaf-01",
                    environment,
                    Some((k * 7 % 80) as f64),
                    (k % 4) as f64 * 0.5,
                )
            })
            .collect();
        let table = conditions(&runs, &campaign());
        let mut seen: Vec<usize> = table.measured.iter().flat_map(|c| c.runs.clone()).collect();
        seen.extend(&table.unplaced);
        seen.sort_unstable();
        assert_eq!(seen, (0..60).collect::<Vec<_>>());
    }
}
