//! Which sensor a series is of, where it stands, and which runs it speaks for.

use ieap_domain::surroundings::{is_waterless, kind_of};
use ieap_domain::{Campaign, ClimateQuantity, LogSeries, SensorStatement};

/// Folder of the climate logs in a campaign.
pub const FOLDER: &str = "ambient";
/// Folder of the tables of a four-point probe; they are logs, too.
pub const PROBE_FOLDER: &str = "probe";
/// Folders of logs.
pub const FOLDERS: [&str; 2] = [FOLDER, PROBE_FOLDER];

/// A sensor as the campaign knows it.
#[derive(Debug, Clone, PartialEq)]
pub struct Identity<'a> {
    /// Its name: the statement's id or what the file says.
    pub sensor: String,
    /// Where it stands; empty: not stated.
    pub place: String,
    /// What campaign.toml says of it.
    pub statement: Option<&'a SensorStatement>,
}

/// The sensor of a series: a statement that names its files, else one that has its id, else what the file says.
pub fn identity<'a>(campaign: &'a Campaign, series: &LogSeries) -> Identity<'a> {
    let below = series
        .path
        .strip_prefix(FOLDER)
        .map_or(series.path.as_str(), |rest| rest.trim_start_matches('/'));
    let by_files = campaign.sensors.iter().find(|stated| {
        let files = stated.files.as_deref().filter(|files| !files.is_empty());
        files.is_some_and(|files| below.starts_with(files))
    });
    let (base, part) = match series.sensor.split_once('/') {
        Some((base, part)) => (base, Some(part)),
        None => (series.sensor.as_str(), None),
    };
    let has_id = |id: &str| campaign.sensors.iter().find(|stated| stated.id == id);
    let statement = by_files
        .or_else(|| has_id(&series.sensor))
        .or_else(|| has_id(base));
    let sensor = match (by_files, part) {
        (Some(stated), Some(part)) => format!("{}/{part}", stated.id),
        (Some(stated), None) => stated.id.clone(),
        (None, _) => series.sensor.clone(),
    };
    let folder = below.rsplit_once('/').map_or("", |(folder, _)| folder);
    Identity {
        sensor,
        place: statement
            .and_then(|stated| stated.place.clone())
            .unwrap_or_else(|| folder.to_owned()),
        statement,
    }
}

/// Whether a sensor speaks for a run of a sample in an environment.
///
/// A sensor of which nothing is stated stands in the room: it knows nothing of the humidity in a vacuum chamber or
/// in inert gas, but its temperature is that of their walls. An analyser of oxygen or water in ppm stands at a box of
/// inert gas.
pub fn speaks_for(
    statement: Option<&SensorStatement>,
    quantity: ClimateQuantity,
    environment: Option<&str>,
    sample: Option<&str>,
) -> bool {
    let (environments, samples) = statement.map_or((&[][..], &[][..]), |stated| {
        (stated.environments.as_slice(), stated.samples.as_slice())
    });
    let of_sample = samples.is_empty() || sample.is_some_and(|sample| samples.iter().any(|s| s == sample));
    let of_environment = match (environments.is_empty(), environment) {
        // Traces in ppm are measured in the gas of a glove box.
        (true, environment) if matches!(quantity, ClimateQuantity::Oxygen | ClimateQuantity::Water) => {
            environment.and_then(kind_of) == Some("inert")
        }
        (true, Some(environment)) if is_waterless(environment) => quantity == ClimateQuantity::Temperature,
        (true, _) => true,
        (false, Some(environment)) => environments.iter().any(|e| e == environment),
        (false, None) => false,
    };
    of_sample && of_environment
}

/// Place of a sensor in the order in which sensors are asked: those of campaign.toml first, in its order; then by
/// name. The order in which files arrive does not count.
pub fn rank(campaign: &Campaign, identity: &Identity<'_>) -> (usize, String) {
    let stated = identity.statement.and_then(|statement| {
        campaign
            .sensors
            .iter()
            .position(|sensor| sensor.id == statement.id)
    });
    (stated.unwrap_or(usize::MAX), identity.sensor.clone())
}

/// Stated accuracy of a sensor for a quantity.
pub fn accuracy(statement: Option<&SensorStatement>, quantity: ClimateQuantity) -> Option<f64> {
    match quantity {
        ClimateQuantity::RelativeHumidity => statement?.relative_humidity_accuracy_percent,
        ClimateQuantity::Temperature => statement?.temperature_accuracy_c,
        _ => None,
    }
}

/// Correction that is added to a sensor's readings.
pub fn correction(statement: Option<&SensorStatement>, quantity: ClimateQuantity) -> Option<f64> {
    match quantity {
        ClimateQuantity::RelativeHumidity => statement?.relative_humidity_correction_percent,
        ClimateQuantity::Temperature => statement?.temperature_correction_c,
        _ => None,
    }
}
