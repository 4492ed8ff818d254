//! Tags of a run and what follows from them: whether it can be fitted, its drive, its dimensions.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use super::left_out;
use super::places::{beyond_strip, misplaced, zero_at_rest};
use super::start;
use super::unread::missing_responses;
use super::window::window;
use crate::analysis::climate::Window;
use crate::analysis::zone::seconds;
use crate::domain::number::fixed;
use crate::domain::tag::keys;
use crate::domain::{
    Channel, InputHash, Issue, Quantity, RunKind, RunOrigin, RunState, Sample, Severity, Tag, TagSource,
};
use crate::ingest::named_columns::named_columns;
use crate::ingest::scan::parse_display_path;
use crate::ingest::tags::{self, OtherName, Resolved, TagRequest};
use crate::ingest::{StartedAt, Timestamp, clocks, drive};
use crate::pipeline::intake::climate::{self, Asked, Shelf, Start, climate_of};
use crate::pipeline::{Context, PipelineError};
use crate::store::{HandTag, Tagging};

/// Code of the issue of a sample without dimensions.
pub const NO_AREA: &str = "no-area";

/// What the tags of a run are made from, beside campaign.toml and the tag files.
#[derive(Debug)]
pub struct TaggingInput<'a> {
    /// The run's name.
    pub run_path: &'a str,
    /// What is measured.
    pub kind: RunKind,
    /// Paths of its files, as the scan displays them.
    pub file_paths: Vec<&'a str>,
    /// What words of people hang on that hold of it ([`crate::store::TagSources::said_of`]).
    pub said_of: Vec<String>,
    /// Other paths and runs that hold the same readings.
    pub other_names: &'a [String],
    /// Clocks, flags and profiles that the readings rest on.
    pub origin: &'a RunOrigin,
    /// Readings.
    pub channels: &'a [Channel],
    /// Whether time zero is the voltage step.
    pub time_zero_is_step: bool,
    /// Whether the technique is a response to a piecewise-constant voltage.
    pub is_step_response: bool,
    /// Tags of the file's header: key, value, the header's own name.
    pub header_tags: Vec<(String, String, String)>,
    /// Date stated in the file.
    pub started_at: Option<StartedAt>,
    /// What was stated beside a file that is gone; none where it is there.
    pub kept: Option<Vec<Tag>>,
    /// The tags that the run had and why they hold, where what states some of them cannot be read.
    pub held: Option<(&'a [Tag], Vec<Issue>)>,
}

/// Tags a run with what [`Context::stated`] holds of its tag files.
///
/// # Errors
/// The database cannot be read.
pub fn tagging(context: &Context, shelf: &Shelf, input: &TaggingInput<'_>) -> Result<Tagging, PipelineError> {
    let files = tag_files(input.run_path, &input.file_paths);
    let hand = hand_tags(context, &input.said_of)?;
    let mut header = input.header_tags.clone();
    let beside = context
        .folder
        .join(files.first().map_or(Path::new(""), PathBuf::as_path));
    let started = input
        .started_at
        .as_ref()
        .map(|started| start::settled(started, context.campaign.date_order, &beside));
    let (started, open_date) = started.unzip();
    let open_date = open_date.flatten();
    header.extend(started.as_ref().and_then(start_tag));
    // A table of a file with several has the file's name; a joined run has the name of the stem.
    let named = files.first().map_or(Path::new(input.run_path), PathBuf::as_path);
    let channel_voltage_v = match input.kind {
        RunKind::Actuation => voltage_of_channel(input),
        RunKind::Dma | RunKind::Impedance => None,
    };
    let planned = planned_tags(context, input.run_path, &files);
    let other_names = other_names(context, input.other_names)?;
    let request = TagRequest {
        campaign: &context.campaign,
        tag_files: &context.stated,
        data_files: &files,
        stem: &tags::stem(named),
        name_pattern: context.campaign.name_pattern_of(input.kind),
        needed: input.kind.needed_tags(),
        hand: &hand,
        planned: &planned,
        kept: input.kept.as_deref().unwrap_or_default(),
        held: input.held.as_ref().map(|(tags, _)| *tags),
        header: &header,
        channel_voltage_v,
        has_voltage: drive::has_voltage(input.channels),
        other_names: &other_names,
        ambient: &[],
    };
    let without_logs = tags::resolve(&request);
    let times = times(input.channels);
    let window = window(without_logs.value(keys::STARTED_AT), times);
    let start = match without_logs.value(keys::STARTED_AT) {
        Some(start) if seconds(start).is_some() => Start::Known,
        Some(_) => Start::Day,
        None if is_start_stated(&without_logs.issues, &open_date) => Start::NotUsable,
        None => Start::NotStated,
    };
    let asked = Asked {
        window,
        start,
        times,
        own: own_climate(input),
        environment: without_logs.value(keys::ENVIRONMENT),
        sample: without_logs.value(keys::SAMPLE),
    };
    let climate = climate_of(context, shelf, asked)?;
    let mut resolved = if climate.tags.is_empty() {
        without_logs
    } else {
        tags::resolve(&TagRequest {
            ambient: &climate.tags,
            ..request
        })
    };
    if input.held.is_none() {
        let doubts = doubts(context, input.run_path, &files, input.other_names);
        resolved.issues.extend(doubts);
    }
    let digest = digest(
        context,
        shelf,
        (input.run_path, &files),
        &input.said_of,
        input.other_names,
        window,
        input.kept.is_some(),
    )?;
    let mut tagging = match input.kind {
        RunKind::Actuation => {
            let sample = resolved
                .value(keys::SAMPLE)
                .and_then(|id| context.campaign.sample(id));
            conclude(sample, input, resolved, digest)
        }
        RunKind::Dma => conclude_dma(input, resolved, digest),
        RunKind::Impedance => conclude_spectrum(context, input, resolved, digest),
    };
    tagging.issues.extend(open_date);
    let why_held = input.held.iter().flat_map(|(_, why)| why);
    tagging.issues.extend(why_held.cloned());
    tagging.issues.extend(climate.issues);
    (tagging.climate, tagging.climate_curves) = (climate.climate, climate.curves);
    Ok(tagging)
}

/// Whether a start is stated that is none.
fn is_start_stated(issues: &[Issue], open_date: &Option<Issue>) -> bool {
    issues
        .iter()
        .chain(open_date)
        .any(|issue| issue.place == keys::STARTED_AT)
}

/// The columns that hold the run's own climate. A modulus log has none: what it holds was set, and is read reading by
/// reading.
fn own_climate<'a>(input: &TaggingInput<'a>) -> &'a [Channel] {
    match input.kind {
        RunKind::Actuation | RunKind::Impedance => input.channels,
        RunKind::Dma => &[],
    }
}

/// First and last time of the readings, s.
fn times(channels: &[Channel]) -> Option<(f64, f64)> {
    let firsts = channels
        .iter()
        .filter_map(|channel| channel.time_s.first().copied());
    let lasts = channels
        .iter()
        .filter_map(|channel| channel.time_s.last().copied());
    Some((firsts.reduce(f64::min)?, lasts.reduce(f64::max)?))
}

/// Level that the voltage channel steps to, V.
fn voltage_of_channel(input: &TaggingInput<'_>) -> Option<f64> {
    let found = drive::find(input.channels, input.time_zero_is_step, None, &[]);
    Some(rounded_level(found.drive.as_ref()?.nominal_step_v()))
}

/// What follows from the tags of a modulus log: it can be analysed where its sample is known and a column is a
/// modulus, by its name or by a tag that says so.
fn conclude_dma(input: &TaggingInput<'_>, resolved: Resolved, digest: String) -> Tagging {
    let chosen = chosen(&resolved);
    let (channels, mut issues) = named_columns(input.channels, &resolved.tags[..chosen]);
    let has_modulus = channels.iter().any(|c| c.quantity.is_modulus() && !c.is_empty());
    if !has_modulus {
        issues.push(no_modulus(&channels));
    }
    let state = match (resolved.waits(), has_modulus) {
        (true, _) => RunState::Untagged,
        (false, true) => RunState::Ready,
        (false, false) => RunState::NotFitted,
    };
    Tagging {
        state,
        chosen,
        tags: resolved.tags,
        issues: resolved.issues.into_iter().chain(issues).collect(),
        drive: None,
        area_cm2: None,
        length_cm: None,
        electrode_resistance_ohm_per_sq: None,
        clock_offset_s: None,
        climate: Vec::new(),
        climate_curves: Vec::new(),
        digest,
    }
}

/// What follows from the tags of a spectrum: it is analysed where its sample is known; the area only carries its
/// numbers to those of a step.
fn conclude_spectrum(
    context: &Context,
    input: &TaggingInput<'_>,
    resolved: Resolved,
    digest: String,
) -> Tagging {
    let sample = resolved
        .value(keys::SAMPLE)
        .and_then(|id| context.campaign.sample(id));
    Tagging {
        state: if resolved.waits() {
            RunState::Untagged
        } else {
            RunState::Ready
        },
        chosen: chosen(&resolved),
        area_cm2: sample.and_then(|sample| sample.active_area_cm2()),
        clock_offset_s: None,
        tags: resolved.tags,
        issues: resolved
            .issues
            .into_iter()
            .chain(clocks::remarks(input.origin, None))
            .collect(),
        drive: None,
        length_cm: None,
        electrode_resistance_ohm_per_sq: None,
        climate: Vec::new(),
        climate_curves: Vec::new(),
        digest,
    }
}

fn no_modulus(channels: &[Channel]) -> Issue {
    let names: Vec<String> = channels.iter().map(|c| format!("\"{}\"", c.raw_name)).collect();
    let message = format!(
        "no column is known to be a modulus; there are {}",
        names.join(", ")
    );
    let mend = "say which one is, as in storage_modulus_column = \"E'/MPa\" in the file's tags, or name the \
                column storage_modulus_mpa, loss_modulus_mpa or complex_modulus_mpa";
    Issue::error("no-modulus", message).mend(mend)
}

/// Number of the tags that are chosen: the first of each key, which stand first.
fn chosen(resolved: &Resolved) -> usize {
    let mut seen = BTreeSet::new();
    let chosen = resolved.tags.iter();
    chosen.take_while(|tag| seen.insert(tag.key.clone())).count()
}

/// The files beside which the tags of a run may stand: the run's own name first where it is joined from several, then
/// each of its files.
pub fn tag_files(run_path: &str, file_paths: &[&str]) -> Vec<PathBuf> {
    let joined = file_paths.len() > 1;
    let named = joined.then_some(run_path);
    let paths = named.into_iter().chain(file_paths.iter().copied());
    paths.map(parse_display_path).collect()
}

/// BLAKE3 over everything that the tags of a run come from, but the file itself.
pub fn digest(
    context: &Context,
    shelf: &Shelf,
    (run_path, files): (&str, &[PathBuf]),
    said_of: &[String],
    other_paths: &[String],
    window: Option<Window>,
    is_gone: bool,
) -> Result<String, PipelineError> {
    let mut hash = InputHash::new();
    // Where it is there the form is that of digests before files could be gone.
    if is_gone {
        hash.text("gone");
    }
    hash.text(&context.campaign_digest)
        .whole(drive::VERSION.into())
        .whole(drive::jumps::VERSION.into())
        .whole(climate::VERSION.into())
        .text(&context.stated.digest(files))
        .text(&shelf.digest(window));
    take_stated(&mut hash, &planned_tags(context, run_path, files));
    let doubts = doubts(context, run_path, files, other_paths);
    hash.count(doubts.len());
    for doubt in &doubts {
        hash.issue(doubt);
    }
    // With by whom and when, which the run tells.
    take_stated(&mut hash, &hand_tags(context, said_of)?);
    for other in other_names(context, other_paths)? {
        hash.bytes(other.file.as_os_str().as_encoded_bytes());
        take_stated(&mut hash, &other.hand);
        take_stated(&mut hash, &other.planned);
        hash.text(&context.stated.digest(&[other.file]));
    }
    Ok(hash.finished())
}

fn take_stated(hash: &mut InputHash, tags: &[Tag]) {
    hash.count(tags.len());
    for tag in tags {
        hash.text(&tag.key).text(&tag.value).text(&tag.detail);
    }
}

/// Tags of the run sheets' rows that plan this run, by the name of any of its files. Modulus logs are not planned.
fn planned_tags(context: &Context, run_path: &str, files: &[PathBuf]) -> Vec<Tag> {
    let names = planned_names(context, run_path, files);
    let tags = names.iter().map(|name| context.sheets.tags_of(name));
    tags.flatten().collect()
}

/// Why it is not known whether a run sheet plans this file, or another name of the readings.
fn doubts(context: &Context, run_path: &str, files: &[PathBuf], other_paths: &[String]) -> Vec<Issue> {
    let own = planned_names(context, run_path, files);
    let others = other_paths
        .iter()
        .flat_map(|path| planned_names(context, path, &[parse_display_path(path)]));
    let names: BTreeSet<String> = own.into_iter().chain(others).collect();
    let mut found: Vec<Issue> = Vec::new();
    for doubt in names.iter().flat_map(|name| context.sheets.doubts(name)) {
        if !found.contains(&doubt) {
            found.push(doubt);
        }
    }
    found
}

/// The names by which run sheets plan a run, those of its files; none for what is not planned.
fn planned_names(context: &Context, run_path: &str, files: &[PathBuf]) -> Vec<String> {
    if context.campaign.kind_of(run_path) != RunKind::Actuation {
        return Vec::new();
    }
    let mut names: Vec<String> = files.iter().map(|file| tags::stem(file)).collect();
    if names.is_empty() {
        names.push(tags::stem(Path::new(run_path)));
    }
    names.dedup();
    names
}

/// What keeps the tags of a run from being known: tag files and run sheets that cannot be read.
pub fn unreadable(
    context: &Context,
    run_path: &str,
    files: &[PathBuf],
    other_paths: &[String],
) -> Vec<Issue> {
    let others = other_paths.iter().map(|path| parse_display_path(path));
    let all: Vec<PathBuf> = files.iter().cloned().chain(others).collect();
    let mut issues = context.stated.unreadable(&all);
    issues.extend(doubts(context, run_path, files, other_paths));
    issues
}

/// What is stated of other names of the readings.
fn other_names(context: &Context, paths: &[String]) -> Result<Vec<OtherName>, PipelineError> {
    let named = |path: &String| {
        let file = parse_display_path(path);
        Ok(OtherName {
            hand: hand_tags(context, &context.store.said_of(path)?)?,
            planned: planned_tags(context, path, std::slice::from_ref(&file)),
            file,
        })
    };
    paths.iter().map(named).collect()
}

/// Tags set by hand of what stands in `said_of`: of the run's bytes, whatever their name.
fn hand_tags(context: &Context, said_of: &[String]) -> Result<Vec<Tag>, PipelineError> {
    let as_tag = |tag: HandTag| {
        let detail = format!("{}, {}", tag.set_by, tag.set_at);
        Some(Tag {
            key: tag.key,
            value: tag.value?,
            source: TagSource::Hand,
            detail,
        })
    };
    let tags = context.store.hand_tags_of(said_of)?;
    Ok(tags.into_iter().filter_map(as_tag).collect())
}

/// The start of the run as a header tag, where the file states it for certain.
fn start_tag(started: &StartedAt) -> Option<(String, String, String)> {
    let local = started
        .local
        .as_ref()
        .filter(|_| started.kind == Timestamp::Start)?;
    let moment = format!("{local}{}", started.offset.as_deref().unwrap_or_default());
    let basis = if started.basis.is_empty() {
        String::new()
    } else {
        format!(" ({})", started.basis)
    };
    Some((
        keys::STARTED_AT.to_owned(),
        moment,
        format!("{}{basis}", started.raw),
    ))
}

/// A measured level as the nominal voltage it stands for: to 10 mV, what a step is set to; the drive itself
/// keeps the measured level.
fn rounded_level(level_v: f64) -> f64 {
    (level_v * 100.0).round() / 100.0
}

/// What follows from the tags of a run of that sample, and from its readings: its drive, its dimensions, whether it can be
/// fitted.
pub(crate) fn conclude(
    sample: Option<&Sample>,
    input: &TaggingInput<'_>,
    resolved: Resolved,
    digest: String,
) -> Tagging {
    let mut issues = resolved.issues.clone();
    let tag_v = resolved.value(keys::VOLTAGE_V).and_then(|text| text.parse().ok());
    let open = left_out::stretches(
        keys::OPEN_CIRCUIT,
        resolved.value(keys::OPEN_CIRCUIT),
        &mut issues,
    );
    left_out::by_time(input.channels, resolved.value(keys::LEAVE_OUT), &mut issues);
    let marked = resolved.value(keys::LEAVE_OUT_MARKED);
    left_out::by_mark(input.channels, &input.origin.flags, marked, &mut issues);
    let found = drive::find(input.channels, input.time_zero_is_step, tag_v, &open);
    let is_sweep = found.issues.iter().any(|issue| issue.code == drive::NO_STEPS);
    let has_steps = input.is_step_response && !is_sweep;
    // Of another technique nobody asks for steps.
    issues.extend(found.issues.into_iter().filter(|issue| {
        input.is_step_response || ![drive::NO_STEPS, drive::MOVES].contains(&issue.code.as_str())
    }));
    if !has_steps {
        issues = without_waiting(issues);
    }
    let area_cm2 = sample.and_then(|sample| sample.active_area_cm2());
    if let Some(sample) = sample.filter(|_| has_steps && area_cm2.is_none()) {
        let message = format!(
            "the sample {} has no dimensions, so its area is not known",
            sample.id
        );
        let mend = "give it length_mm and width_mm, or area_cm2, in campaign.toml";
        issues.push(Issue::error(NO_AREA, message).at(keys::SAMPLE).mend(mend));
    }
    issues.extend(area_cm2.and_then(|area_cm2| improbable_density(input.channels, area_cm2)));
    if !input.is_step_response {
        issues.push(Issue::note(
            "other-technique",
            "this technique is no response to voltage steps; it is kept, not fitted",
        ));
    }
    let length_cm = sample
        .and_then(|sample| sample.length_mm)
        .map(|length_mm| length_mm / 10.0);
    issues.extend(lengthless(input.channels, length_cm));
    issues.extend(held_and_bent(input.channels));
    if has_steps {
        issues.extend(missing_responses(input.channels, input.run_path));
    }
    let length_mm = sample.and_then(|sample| sample.length_mm);
    issues.extend(length_mm.and_then(|length_mm| misplaced(input.channels, length_mm)));
    let beyond = length_mm.and_then(|length_mm| beyond_strip(input.channels, length_mm, input.origin));
    let is_beyond = beyond.is_some();
    let zero = length_mm
        .zip(found.drive.as_ref())
        .filter(|_| !is_beyond)
        .and_then(|(length_mm, drive)| zero_at_rest(input.channels, drive, length_mm));
    issues.extend(zero);
    issues.extend(beyond);
    let stated = found.drive.as_ref().filter(|_| input.is_step_response);
    issues.extend(stated.and_then(|drive| drive::jumps::unexplained(input.channels, drive)));
    let clock_offset_s = resolved
        .value(keys::CLOCK_OFFSET_S)
        .and_then(|text| text.parse().ok());
    issues.extend(clocks::remarks(input.origin, clock_offset_s));
    let fittable = input.is_step_response
        && found.drive.is_some()
        && area_cm2.is_some()
        && has_response(input)
        && !is_beyond;
    let state = match (resolved.waits(), fittable) {
        _ if !has_steps => RunState::NoSteps,
        (true, _) => RunState::Untagged,
        (false, true) => RunState::Ready,
        (false, false) => RunState::NotFitted,
    };
    let of_tag = resolved
        .value(keys::ELECTRODE_RESISTANCE)
        .and_then(|value| value.parse::<f64>().ok());
    let electrode_resistance_ohm_per_sq = of_tag
        .filter(|ohm| ohm.is_finite() && *ohm > 0.0)
        .or_else(|| sample.and_then(|sample| sample.electrode_resistance_ohm_per_sq));
    Tagging {
        state,
        chosen: chosen(&resolved),
        tags: resolved.tags,
        issues,
        drive: found.drive,
        area_cm2,
        length_cm,
        clock_offset_s,
        electrode_resistance_ohm_per_sq,
        digest,
        climate: Vec::new(),
        climate_curves: Vec::new(),
    }
}

/// Without the step voltage, which a run without steps does not have; that other tags are missing is only noted, for
/// it waits for none.
fn without_waiting(issues: Vec<Issue>) -> Vec<Issue> {
    let kept = issues
        .into_iter()
        .filter(|issue| issue.code != tags::MISSING || issue.place != keys::VOLTAGE_V);
    let noted = |issue: Issue| match issue.code.as_str() {
        tags::MISSING | tags::UNKNOWN_SAMPLE => Issue {
            severity: Severity::Note,
            ..issue
        },
        _ => issue,
    };
    kept.map(noted).collect()
}

/// Current density beyond which a unit is more likely wrong than the strip that strong, A/cm2: the thesis's
/// samples stay below 0.13, while milliamperes under an ampere header come out a thousand times too large.
const PROBABLE_DENSITY_A_PER_CM2: f64 = 1.0;

/// Points out a current that is improbable for the sample's area; it is not changed.
fn improbable_density(channels: &[Channel], area_cm2: f64) -> Option<Issue> {
    let current = channels.iter().find(|c| c.quantity == Quantity::Current)?;
    let (_, readings) = current.included();
    let largest_a = readings.iter().fold(0.0_f64, |largest, i| largest.max(i.abs()));
    let density = largest_a / area_cm2;
    (density > PROBABLE_DENSITY_A_PER_CM2).then(|| {
        let message = format!(
            "the current reaches {} A on {area_cm2} cm2, {} A/cm2: improbable for such a strip; nothing was changed",
            fixed(largest_a, 3),
            fixed(density, 1)
        );
        Issue::warning("suspicious-range", message)
            .at(format!("column {}", current.raw_name))
            .mend("check the unit of the current in the file's header, and the sample's dimensions in campaign.toml")
    })
}

fn has_response(input: &TaggingInput<'_>) -> bool {
    input.channels.iter().any(|c| c.is_response())
}

/// A strip whose force was measured was held: what bending there is beside it is not that of its charge.
fn held_and_bent(channels: &[Channel]) -> Option<Issue> {
    let has = |quantity| channels.iter().any(|c| c.quantity == quantity && !c.is_empty());
    let bent = has(Quantity::Curvature) || has(Quantity::TipDisplacement);
    (bent && has(Quantity::BlockingForce)).then(|| {
        Issue::warning(
            "held-and-bent",
            "the file has a blocking force and a bending: a strip that is held does not bend freely, so that this \
             run's alpha is not the strip's; the force is used for its moment",
        )
        .at(Quantity::BlockingForce.column())
        .mend("store the free and the held strip as runs of their own")
    })
}

/// A tip displacement is of no use without the free length.
fn lengthless(channels: &[Channel], length_cm: Option<f64>) -> Option<Issue> {
    let has = |quantity| channels.iter().any(|c| c.quantity == quantity && !c.is_empty());
    let useless = has(Quantity::TipDisplacement) && !has(Quantity::Curvature) && length_cm.is_none();
    useless.then(|| {
        Issue::warning(
            "no-length",
            "the tip displacement gives no curvature without the sample's free length",
        )
        .at(Quantity::TipDisplacement.column())
        .mend("give the sample length_mm in campaign.toml")
    })
}
