//! What the logs come to together: sensors, their comparison, exposure of samples. Made again when anything that it
//! rests on changed.

use std::collections::BTreeMap;
use std::rc::Rc;

use super::gather::groups;
use super::shelf::{Loaded, Shelf};
use crate::analysis::climate::compare::{Bins, Compared, pair, pair_issues};
use crate::analysis::climate::exposure::DoseMeter;
use crate::analysis::climate::sensors::{accuracy, correction};
use crate::analysis::climate::{Piece, Window, merged, speaks_for};
use crate::domain::InputHash;
use crate::domain::tag::keys;
use crate::domain::{
    Campaign, ChannelSummary, ClimateAssessment, ClimateQuantity, ClimateRules, Exposure, Issue, RunRecord,
    SensorPair, SensorStatement, SensorSummary,
};
use crate::pipeline::campaign::context::{PROGRAM, now};
use crate::pipeline::intake::ingest::run_window;
use crate::pipeline::{Context, PipelineError};
use crate::store::{NewResult, ResultKind, Store, StoreError, Subject};

/// Stretches that an overview curve is thinned over.
const DRAWN: usize = 400;

/// Shortest record of a run that can be compared with a sensor's clock, s.
const SHORTEST_RECORD_S: f64 = 43_200.0;

/// Version of what is computed here: another one makes stored assessments out of date.
const VERSION: u32 = 3;

/// Name of the one assessment that there is.
const NAME: &str = "all sensors";

/// Brings the stored assessment up to date where it is not.
///
/// # Errors
/// The database refuses.
pub fn assess(context: &mut Context, shelf: &Shelf) -> Result<(), PipelineError> {
    let stored = context
        .store
        .result::<ClimateAssessment>(ResultKind::Climate, NAME)?;
    if stored.is_none() && shelf.series.is_empty() {
        return Ok(());
    }
    let runs = context.store.runs()?;
    let inputs = inputs(context, shelf, &runs);
    if stored.is_some_and(|stored| stored.origin.key == inputs) {
        return Ok(());
    }
    let assessment = assessment(context, shelf, &runs)?;
    let result = NewResult {
        of: Subject::Named(NAME),
        // The sensors' readings and the runs are in the key, by which the next look makes it again.
        made_from: &[],
        key: &inputs,
        made_by: &PROGRAM,
        found: Ok(&assessment),
    };
    context
        .store
        .keep_results(&now(), ResultKind::Climate, &[result])?;
    Ok(())
}

/// What the logs came to when it was last computed.
///
/// # Errors
/// See [`StoreError`].
pub fn stored(store: &Store) -> Result<Option<ClimateAssessment>, StoreError> {
    let stored = store.result(ResultKind::Climate, NAME)?;
    Ok(stored.and_then(|stored| stored.found.ok()))
}

fn inputs(context: &Context, shelf: &Shelf, runs: &[RunRecord]) -> String {
    let mut hash = InputHash::new();
    hash.whole(VERSION.into()).text(&context.campaign_digest);
    hash.count(shelf.series.len());
    for series in &shelf.series {
        hash.text(&series.path)
            .whole(series.ordinal.into())
            .text(&series.data_hash);
    }
    for run in runs {
        hash.text(&run.path)
            .text_or_none(run.tag(keys::SAMPLE))
            .text_or_none(run.tag(keys::ENVIRONMENT));
        let window = run_window(run);
        hash.number_or_none(window.map(|window| window.from_s))
            .number_or_none(window.map(|window| window.to_s));
    }
    hash.finished()
}

/// A sensor's series as it is read through, and what is gathered on the way.
struct Gathered {
    summary: SensorSummary,
    bins: Bins,
}

fn assessment(
    context: &Context,
    shelf: &Shelf,
    runs: &[RunRecord],
) -> Result<ClimateAssessment, PipelineError> {
    let campaign = &context.campaign;
    let mut issues = file_issues(context)?;
    let mut histories = histories(runs);
    let mut gathered: Vec<Gathered> = Vec::new();
    for numbers in groups(shelf, campaign, 0..shelf.series.len()).into_values() {
        let mut meters = meters(context, shelf, &numbers, &histories);
        gathered.extend(read_through(context, shelf, &numbers, &mut meters, &mut issues)?);
        for (sample, sensor, meter) in meters {
            if let Some(history) = histories.get_mut(&sample) {
                history.take(&sensor, &meter);
            }
        }
    }
    let mut pairs = pairs(context, &gathered);
    pairs.extend(with_own_records(context, &gathered, runs)?);
    issues.extend(pair_issues(&pairs));
    issues.extend(without_log(campaign, shelf));
    let mut sensors: Vec<SensorSummary> = gathered.into_iter().map(|one| one.summary).collect();
    sensors.extend(not_used(context, shelf));
    Ok(ClimateAssessment {
        sensors,
        pairs,
        exposures: histories
            .into_iter()
            .map(|(sample, history)| history.exposure(sample, campaign.climate.exposure_above_percent))
            .collect(),
        issues: once_each(issues),
    })
}

/// Code of what is said of a sensor of campaign.toml that no log is of.
pub const SENSOR_WITHOUT_LOG: &str = "sensor-without-log";

/// Sensors of campaign.toml that no log is of: what is stated of them is of nothing.
fn without_log(campaign: &Campaign, shelf: &Shelf) -> Vec<Issue> {
    let identities = (0..shelf.series.len()).map(|at| shelf.identity(campaign, at));
    let identities: Vec<_> = identities.collect();
    let matches = |sensor: &&SensorStatement| {
        let is = |stated: &&SensorStatement| stated.id == sensor.id;
        !identities
            .iter()
            .any(|identity| identity.statement.as_ref().is_some_and(is))
    };
    let mut found: Vec<&str> = identities
        .iter()
        .map(|identity| identity.sensor.as_str())
        .collect();
    found.sort_unstable();
    found.dedup();
    let issue = |sensor: &SensorStatement| {
        let message = format!(
            "[[sensor]] \"{}\" of campaign.toml is the sensor of no log",
            sensor.id
        );
        let there = match found.as_slice() {
            [] => "there is no log yet: copy it into ambient/".to_owned(),
            found => format!(
                "the logs are of {}; write one of these ids, or `files` with the log's name",
                found.join(", ")
            ),
        };
        Issue::warning(SENSOR_WITHOUT_LOG, message)
            .at("campaign.toml")
            .mend(there)
    };
    campaign.sensors.iter().filter(matches).map(issue).collect()
}

/// Reads all files of one sensor and quantity in the order of time, a few at once.
fn read_through(
    context: &Context,
    shelf: &Shelf,
    numbers: &[usize],
    meters: &mut [(String, String, DoseMeter)],
    issues: &mut Vec<Issue>,
) -> Result<Option<Gathered>, PipelineError> {
    let campaign = &context.campaign;
    let series = &shelf.series[numbers[0]];
    let identity = shelf.identity(campaign, numbers[0]);
    let mut summary = SensorSummary {
        sensor: identity.sensor.clone(),
        place: identity.place.clone(),
        quantity: series.quantity,
        files: numbers.len(),
        readings: 0,
        from: String::new(),
        to: String::new(),
        interval_s: series.interval_s,
        least: f64::INFINITY,
        mean: 0.0,
        most: f64::NEG_INFINITY,
        clock: String::new(),
        accuracy: accuracy(identity.statement, series.quantity),
        correction: correction(identity.statement, series.quantity),
        calibration: identity.statement.and_then(|stated| stated.calibration.clone()),
        not_used: None,
        curve: (Vec::new(), Vec::new()),
    };
    let mut in_order = numbers.to_vec();
    in_order.sort_by(|a, b| {
        let start = |at: &usize| shelf.series[*at].clock_start_s + shelf.series[*at].first_s;
        start(a)
            .total_cmp(&start(b))
            .then_with(|| shelf.series[*a].path.cmp(&shelf.series[*b].path))
    });
    let mut reading = ReadThrough {
        bins: Bins::default(),
        sum: 0.0,
        conflicts: 0,
        first_s: f64::NAN,
        last_s: f64::NAN,
    };
    let mut cluster: Vec<(usize, Rc<Loaded>)> = Vec::new();
    let mut end_s = f64::NEG_INFINITY;
    for at in in_order {
        let Some(loaded) = shelf.load(&context.store, campaign, at)? else {
            issues.push(without_zone(&shelf.series[at].path, &identity.sensor));
            continue;
        };
        issues.extend(loaded.issues.iter().cloned());
        summary.clock = loaded.clock.clone();
        let starts_s = loaded.times_s.first().copied().unwrap_or(f64::INFINITY);
        if starts_s > end_s {
            reading.flush(shelf, &mut cluster, meters, &mut summary);
        }
        end_s = loaded.times_s.last().copied().unwrap_or(end_s).max(end_s);
        cluster.push((at, loaded));
    }
    reading.flush(shelf, &mut cluster, meters, &mut summary);
    if summary.readings == 0 {
        return Ok(None);
    }
    if reading.conflicts > 0 {
        let message = format!(
            "{} readings of {} stand in two files with different values; the file that begins first counts",
            reading.conflicts, identity.sensor
        );
        issues.push(
            Issue::warning("logs-contradict", message)
                .at(series.quantity.key())
                .mend("check whether both files are of the same sensor (if not, give each its own [[sensor]] with files), and \
                     whether its clock follows summer time (if not, state its utc_offset)"),
        );
    }
    summary.mean = reading.sum / summary.readings as f64;
    (summary.from, summary.to) = (moment(reading.first_s), moment(reading.last_s));
    summary.curve = reading.bins.drawn(DRAWN);
    Ok(Some(Gathered {
        summary,
        bins: reading.bins,
    }))
}

/// What is added up while files are read.
struct ReadThrough {
    bins: Bins,
    sum: f64,
    conflicts: usize,
    first_s: f64,
    last_s: f64,
}

impl ReadThrough {
    /// Adds the files of `cluster`, which overlap each other and nothing that follows.
    fn flush(
        &mut self,
        shelf: &Shelf,
        cluster: &mut Vec<(usize, Rc<Loaded>)>,
        meters: &mut [(String, String, DoseMeter)],
        summary: &mut SensorSummary,
    ) {
        let pieces = cluster.iter().map(|(at, loaded)| Piece {
            times_s: &loaded.times_s,
            values: &loaded.values,
            interval_s: shelf.series[*at].interval_s,
            hash: &shelf.series[*at].data_hash,
        });
        let all = merged(pieces.collect());
        cluster.clear();
        let (Some(&first_s), Some(&last_s)) = (all.times_s.first(), all.times_s.last()) else {
            return;
        };
        if self.first_s.is_nan() {
            self.first_s = first_s;
        }
        self.last_s = last_s;
        self.conflicts += all.conflicts;
        self.bins.add(&all.times_s, &all.values);
        self.sum += all.values.iter().sum::<f64>();
        summary.readings += all.values.len();
        summary.least = all.values.iter().copied().fold(summary.least, f64::min);
        summary.most = all.values.iter().copied().fold(summary.most, f64::max);
        for (_, _, meter) in meters {
            meter.add(&all.times_s, &all.values);
        }
    }
}

/// Runs of a sample in the order of time, and the best that a sensor says of its exposure.
struct History {
    runs: Vec<(Window, Option<String>)>,
    best: Option<(String, f64, f64)>,
    elsewhere_s: f64,
}

fn histories(runs: &[RunRecord]) -> BTreeMap<String, History> {
    let mut histories: BTreeMap<String, History> = BTreeMap::new();
    for run in runs {
        if let (Some(sample), Some(window)) = (run.tag(keys::SAMPLE), run_window(run)) {
            let history = histories.entry(sample.to_owned()).or_insert_with(|| History {
                runs: Vec::new(),
                best: None,
                elsewhere_s: 0.0,
            });
            history
                .runs
                .push((window, run.tag(keys::ENVIRONMENT).map(str::to_owned)));
        }
    }
    for history in histories.values_mut() {
        history.runs.sort_by(|a, b| a.0.from_s.total_cmp(&b.0.from_s));
    }
    histories
}

impl History {
    fn span(&self) -> (f64, f64) {
        let end = self
            .runs
            .iter()
            .map(|(window, _)| window.to_s)
            .fold(f64::NEG_INFINITY, f64::max);
        (self.runs[0].0.from_s, end)
    }

    /// Keeps what `meter` added up where it covers more than the sensors before, which rank higher.
    fn take(&mut self, sensor: &str, meter: &DoseMeter) {
        let dose = meter.dose();
        if dose.covered_s > self.best.as_ref().map_or(0.0, |best| best.2) {
            self.best = Some((sensor.to_owned(), dose.above_s, dose.covered_s));
            self.elsewhere_s = meter
                .elsewhere
                .iter()
                .map(|(from, to)| to - from)
                .fold(0.0, |sum, one| sum + one);
        }
    }

    fn exposure(self, sample: String, above_percent: f64) -> Exposure {
        let (from_s, to_s) = self.span();
        let (sensors, above_s, covered_s) = match &self.best {
            Some((sensor, above_s, covered_s)) => (vec![sensor.clone()], *above_s, *covered_s),
            None => (Vec::new(), 0.0, 0.0),
        };
        Exposure {
            sample,
            above_percent,
            from: moment(from_s),
            to: moment(to_s),
            reason: sensors
                .is_empty()
                .then(|| "no log of a sensor that speaks for the sample covers its history".to_owned()),
            sensors,
            above_h: above_s / 3600.0,
            covered_h: covered_s / 3600.0,
            uncovered_h: (to_s - from_s - covered_s - self.elsewhere_s).max(0.0) / 3600.0,
            elsewhere_h: self.elsewhere_s / 3600.0,
        }
    }
}

/// A meter for each sample that the sensor of these series speaks for.
fn meters(
    context: &Context,
    shelf: &Shelf,
    numbers: &[usize],
    histories: &BTreeMap<String, History>,
) -> Vec<(String, String, DoseMeter)> {
    let quantity = shelf.series[numbers[0]].quantity;
    if quantity != ClimateQuantity::RelativeHumidity {
        return Vec::new();
    }
    let campaign = &context.campaign;
    let identity = shelf.identity(campaign, numbers[0]);
    let meter = |(sample, history): (&String, &History)| {
        let speaks = |environment: &Option<String>| {
            speaks_for(identity.statement, quantity, environment.as_deref(), Some(sample))
        };
        if !history.runs.iter().any(|(_, environment)| speaks(environment)) {
            return None;
        }
        let away = history
            .runs
            .iter()
            .filter(|(_, environment)| !speaks(environment));
        let rules = &campaign.climate;
        let meter = DoseMeter::new(
            history.span(),
            rules.exposure_above_percent,
            rules.longest_gap_s,
            joined(away.map(|(window, _)| (window.from_s, window.to_s))),
        );
        Some((sample.clone(), identity.sensor.clone(), meter))
    };
    histories.iter().filter_map(meter).collect()
}

/// Stretches in order of their start as stretches that do not overlap.
fn joined(stretches: impl Iterator<Item = (f64, f64)>) -> Vec<(f64, f64)> {
    let mut joined: Vec<(f64, f64)> = Vec::new();
    for (from, to) in stretches {
        match joined.last_mut() {
            Some(last) if from <= last.1 => last.1 = last.1.max(to),
            _ => joined.push((from, to)),
        }
    }
    joined
}

/// Every two sensors of one place and quantity.
fn pairs(context: &Context, gathered: &[Gathered]) -> Vec<SensorPair> {
    let rules = &context.campaign.climate;
    let mut pairs = Vec::new();
    for (at, a) in gathered.iter().enumerate() {
        for b in &gathered[at + 1..] {
            let (one, other) = (&a.summary, &b.summary);
            // What gauges and analysers allow is not known.
            if one.quantity != other.quantity || one.place != other.place || !one.quantity.is_of_air() {
                continue;
            }
            let tolerance = tolerance(one.quantity, rules);
            pairs.extend(pair(compared(a), compared(b), one.quantity, tolerance));
        }
    }
    pairs
}

/// Runs that recorded temperature or humidity themselves for long enough to compare clocks, each beside the first
/// sensor that measured at the same time.
fn with_own_records(
    context: &Context,
    gathered: &[Gathered],
    runs: &[RunRecord],
) -> Result<Vec<SensorPair>, PipelineError> {
    let rules = &context.campaign.climate;
    let mut pairs = Vec::new();
    for run in runs {
        let Some(window) = run_window(run).filter(|window| window.to_s - window.from_s >= SHORTEST_RECORD_S)
        else {
            continue;
        };
        let recorded = |channel: &ChannelSummary| {
            ClimateQuantity::measured(channel.quantity).is_some_and(ClimateQuantity::is_of_air)
        };
        if !run.channels.iter().any(recorded) {
            continue;
        }
        let channels = context.store.channels(run.id)?;
        let first_s = channels
            .iter()
            .filter_map(|c| c.time_s.first().copied())
            .fold(f64::INFINITY, f64::min);
        for channel in &channels {
            let measured = ClimateQuantity::measured(channel.quantity);
            let Some(quantity) = measured.filter(|quantity| quantity.is_of_air()) else {
                continue;
            };
            let times_s: Vec<f64> = channel
                .time_s
                .iter()
                .map(|t| window.from_s + t - first_s)
                .collect();
            let mut bins = Bins::default();
            bins.add(&times_s, &channel.values);
            let own = Compared {
                sensor: &run.path,
                bins: &bins,
                accuracy: None,
            };
            let of_quantity = gathered
                .iter()
                .filter(|sensor| sensor.summary.quantity == quantity);
            let tolerance = tolerance(quantity, rules);
            pairs.extend(
                of_quantity
                    .map(compared)
                    .find_map(|sensor| pair(sensor, own, quantity, tolerance)),
            );
        }
    }
    Ok(pairs)
}

fn tolerance(quantity: ClimateQuantity, rules: &ClimateRules) -> f64 {
    match quantity {
        ClimateQuantity::RelativeHumidity => rules.relative_humidity_tolerance_percent,
        _ => rules.temperature_tolerance_c,
    }
}

fn compared(gathered: &Gathered) -> Compared<'_> {
    Compared {
        sensor: &gathered.summary.sensor,
        bins: &gathered.bins,
        accuracy: gathered.summary.accuracy,
    }
}

/// Sensors whose readings are not used, with the reason.
fn not_used(context: &Context, shelf: &Shelf) -> Vec<SensorSummary> {
    let mut found: BTreeMap<(String, ClimateQuantity), SensorSummary> = BTreeMap::new();
    for (at, series) in shelf.series.iter().enumerate() {
        let Some(reason) = &series.not_used else { continue };
        let identity = shelf.identity(&context.campaign, at);
        let summary = found
            .entry((identity.sensor.clone(), series.quantity))
            .or_insert_with(|| SensorSummary {
                sensor: identity.sensor,
                place: identity.place,
                quantity: series.quantity,
                files: 0,
                readings: 0,
                from: String::new(),
                to: String::new(),
                interval_s: series.interval_s,
                least: 0.0,
                mean: 0.0,
                most: 0.0,
                clock: String::new(),
                accuracy: None,
                correction: None,
                calibration: None,
                not_used: Some(reason.clone()),
                curve: (Vec::new(), Vec::new()),
            });
        summary.files += 1;
        summary.readings += series.readings;
    }
    found.into_values().collect()
}

/// What readers noticed in files, at the file.
fn file_issues(context: &Context) -> Result<Vec<Issue>, PipelineError> {
    let mut issues = Vec::new();
    for log in context.store.logs()? {
        for issue in log.issues {
            let place = if issue.place.is_empty() {
                log.path.clone()
            } else {
                format!("{}, {}", log.path, issue.place)
            };
            issues.push(issue.at(place));
        }
    }
    Ok(issues)
}

/// One issue of a kind and column, where many files show the same: the first, with how many more there are.
fn once_each(issues: Vec<Issue>) -> Vec<Issue> {
    let kind = |issue: &Issue| {
        let column = issue.place.split_once(", ").map_or("", |(_, column)| column);
        let column = if column.starts_with("column") {
            column.to_owned()
        } else {
            String::new()
        };
        let by_message =
            ["clock-offset", "sensors-disagree", "logs-contradict"].contains(&issue.code.as_str());
        (
            issue.code.clone(),
            if by_message { issue.message.clone() } else { column },
        )
    };
    let mut kept: Vec<((String, String), Issue, usize)> = Vec::new();
    for issue in issues {
        let key = kind(&issue);
        match kept.iter_mut().find(|(other, ..)| *other == key) {
            Some((_, first, more)) => {
                *more += usize::from(first.place != issue.place || first.message != issue.message)
            }
            None => kept.push((key, issue, 0)),
        }
    }
    let mut issues: Vec<Issue> = kept
        .into_iter()
        .map(|(_, mut issue, more)| {
            if more > 0 {
                issue.message += &format!(" (and {more} more like it)");
            }
            issue
        })
        .collect();
    issues.sort_by_key(|issue| std::cmp::Reverse(issue.severity));
    issues
}

fn without_zone(path: &str, sensor: &str) -> Issue {
    let message = format!(
        "the log of {sensor} states no offset from UTC, and campaign.toml no time zone: it cannot be placed beside runs"
    );
    Issue::error("log-without-zone", message)
        .at(path)
        .mend("state `timezone` under [campaign], or `utc_offset` under [[sensor]], in campaign.toml")
}

fn moment(at_s: f64) -> String {
    match jiff::Timestamp::from_second(at_s as i64) {
        Ok(moment) if at_s.is_finite() => moment.strftime("%Y-%m-%dT%H:%M:%SZ").to_string(),
        _ => String::new(),
    }
}
