//! A run that no campaign holds, put together of what was read and what is stated.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::read::ReadTable;
use crate::domain::data_hash::data_hash;
use crate::domain::number::fixed;
use crate::domain::tag::keys;
use crate::domain::{
    AskedFit, Channel, Drive, FlaggedStretch, Issue, Quantity, RunKind, RunOrigin, Sample, Severity, Tag,
    TagSource, left_out,
};
use crate::ingest::drive;
use crate::ingest::tags::{MISSPELT, Resolved, TagKey, tag_key};
use crate::pipeline::intake::ingest::tagging::{TaggingInput, conclude};
use crate::store::FitTask;

/// The strip, as campaign.toml states it of a sample.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Strip {
    /// Active area, cm2; none: length times width.
    pub area_cm2: Option<f64>,
    /// Free length, mm.
    pub length_mm: Option<f64>,
    /// Width, mm.
    pub width_mm: Option<f64>,
    /// Resistance of both electrodes along the strip, Ohm per square.
    pub electrode_resistance_ohm_per_sq: Option<f64>,
}

/// What a caller states of readings.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Stated {
    /// The strip.
    pub strip: Strip,
    /// The drive; none: as the voltage channel or the tag `voltage_v` says.
    pub drive: Option<Drive>,
    /// Tags by key, as a sidecar states them: `voltage_v`, `leave_out`, `open_circuit`, `operator`, ...
    pub tags: BTreeMap<String, String>,
}

impl Stated {
    /// Two statements that cannot both hold; the issue names both.
    pub fn contradiction(&self) -> Option<Issue> {
        self.other_area().or_else(|| self.other_level())
    }

    fn other_area(&self) -> Option<Issue> {
        let Strip {
            area_cm2: Some(area_cm2),
            length_mm: Some(length_mm),
            width_mm: Some(width_mm),
            ..
        } = self.strip
        else {
            return None;
        };
        let product_cm2 = length_mm * width_mm / 100.0;
        let message = format!(
            "area_cm2 is {area_cm2} cm2, and length_mm x width_mm is {length_mm} mm x {width_mm} mm = {product_cm2} cm2"
        );
        let issue = Issue::error(CONTRADICTION, message).at("area_cm2");
        ((area_cm2 - product_cm2).abs() > AREAS_AGREE * area_cm2.abs()).then(|| {
            issue.mend("state the area, or length and width; a free length beside an area needs no width")
        })
    }

    fn other_level(&self) -> Option<Issue> {
        let stated_v: f64 = self.tags.get(keys::VOLTAGE_V)?.parse().ok()?;
        let drive = self
            .drive
            .as_ref()
            .filter(|drive| !drive.has_level_near(stated_v))?;
        let message = format!(
            "voltage_v is {stated_v} V, and the drive goes to {} V",
            drive.nominal_step_v()
        );
        let issue = Issue::error(CONTRADICTION, message).at(keys::VOLTAGE_V);
        Some(issue.mend("state the drive, or voltage_v, the step at time zero"))
    }

    /// Tags that are probably a slip of a known one.
    pub fn misspelt(&self) -> impl Iterator<Item = Issue> {
        self.tags.keys().filter_map(|key| {
            let TagKey::Near(meant) = tag_key(key, &[]) else {
                return None;
            };
            let issue =
                Issue::error(MISSPELT, format!("`{key}` is no tag that ieap knows")).at(format!("tag {key}"));
            Some(issue.mend(format!(
                "write `{meant}` if that is meant, and another word if not"
            )))
        })
    }
}

/// A run that no campaign holds, ready to be fitted.
#[derive(Debug, Clone)]
pub struct RunAtHand {
    /// Readings as a fit takes them.
    pub(super) channels: Vec<Channel>,
    /// Drive and dimensions, under the run's name.
    pub(super) task: FitTask,
    /// What was stated of it.
    pub(super) tags: BTreeMap<String, String>,
    /// What a reader must know of the readings.
    pub(super) issues: Vec<Issue>,
}

impl RunAtHand {
    /// Puts together what was read and what is stated.
    ///
    /// # Errors
    /// The area, or the drive, is not known; the issue says what to state.
    pub fn new(name: &str, read: &ReadTable, stated: &Stated) -> Result<RunAtHand, Issue> {
        let sample = sample(&stated.strip);
        if !sample
            .active_area_cm2()
            .is_some_and(|area| area.is_finite() && area > 0.0)
        {
            let found = match sample.active_area_cm2() {
                Some(area) => format!("the active area of the strip is {area} cm2"),
                None => "the active area of the strip is not stated".to_owned(),
            };
            let issue = Issue::error(NO_AREA, found).at("area_cm2");
            return Err(issue.mend("state area_cm2, or length_mm and width_mm, above 0"));
        }
        let resolved = resolved(read, stated);
        let origin = RunOrigin {
            flags: read.flags.clone(),
            ..RunOrigin::default()
        };
        let input = TaggingInput {
            said_of: Vec::new(),
            run_path: name,
            kind: RunKind::Actuation,
            file_paths: Vec::new(),
            other_names: &[],
            origin: &origin,
            channels: &read.channels,
            time_zero_is_step: read.time_zero_is_step,
            is_step_response: read.is_step_response,
            header_tags: Vec::new(),
            started_at: None,
            kept: None,
            held: None,
        };
        let tags: BTreeMap<String, String> = chosen(&resolved);
        let tagging = conclude(Some(&sample), &input, resolved, String::new());
        let of_readings = tagging.drive.clone().filter(|_| read.is_step_response);
        // What is stated holds unless the readings contradict it.
        let contradiction = stated.drive.as_ref().filter(|_| of_readings.is_some());
        let contradiction = contradiction.and_then(|drive| drive::contradicted(drive, &read.channels));
        let of_statement = stated.drive.clone().filter(|_| contradiction.is_none());
        let is_stated = of_statement.is_some();
        let Some(drive) = of_statement.or(of_readings) else {
            return Err(no_drive(&tagging.issues, read.is_step_response));
        };
        let (Some(area_cm2), length_cm) = (tagging.area_cm2, tagging.length_cm) else {
            return Err(Issue::error(NO_AREA, "the active area of the strip is not known").at("area_cm2"));
        };
        let mut issues = read.issues.clone();
        issues.extend(contradiction);
        issues.extend(other_voltage(read, &tags, &drive));
        // What is assumed of a drive that is found does not hold of one that is stated.
        let is_assumption = |issue: &Issue| issue.code == drive::ASSUMED;
        let told = tagging.issues.into_iter();
        issues.extend(told.filter(|issue| !is_stated || !is_assumption(issue)));
        Ok(RunAtHand {
            channels: as_used(&read.channels, &read.flags, &tags, area_cm2),
            task: FitTask {
                run_id: 0,
                revision: 0,
                path: name.to_owned(),
                drive,
                area_cm2,
                length_cm,
                electrode_resistance_ohm_per_sq: tagging.electrode_resistance_ohm_per_sq,
                electrode_resistance_error_ohm_per_sq: None,
                data_hash: stamp(&read.channels, &tags),
                climate_hash: None,
                sample: None,
                instrument: None,
                started_at: None,
                last_asked: AskedFit::default(),
            },
            tags,
            issues,
        })
    }

    /// Its name.
    pub fn name(&self) -> &str {
        &self.task.path
    }

    /// The drive.
    pub fn drive(&self) -> &Drive {
        &self.task.drive
    }

    /// Active area, cm2.
    pub fn area_cm2(&self) -> f64 {
        self.task.area_cm2
    }

    /// Free length, cm.
    pub fn length_cm(&self) -> Option<f64> {
        self.task.length_cm
    }

    /// Hash of the readings, with the tags that leave readings out.
    pub fn data_hash(&self) -> &str {
        &self.task.data_hash
    }

    /// Readings as a fit takes them.
    pub fn channels(&self) -> &[Channel] {
        &self.channels
    }
}

/// Part of an area by which a product of rounded lengths may differ from it.
const AREAS_AGREE: f64 = 0.01;
/// Code of two statements of which one must be wrong.
const CONTRADICTION: &str = "contradiction";
/// Codes of what is missing of a run.
pub(super) const NO_AREA: &str = "no-area";
const NO_DRIVE: &str = "no-drive";

pub(super) fn sample(strip: &Strip) -> Sample {
    Sample {
        id: String::new(),
        material: String::new(),
        length_mm: strip.length_mm,
        width_mm: strip.width_mm,
        thickness_mm: None,
        area_cm2: strip.area_cm2,
        electrode_resistance_ohm_per_sq: strip.electrode_resistance_ohm_per_sq,
        batch: None,
    }
}

/// Stated tags, and those of the file's header that nobody states otherwise.
fn resolved(read: &ReadTable, stated: &Stated) -> Resolved {
    let tag = |key: &str, value: &str, source, detail: &str| Tag {
        key: key.to_owned(),
        value: value.to_owned(),
        source,
        detail: detail.to_owned(),
    };
    let own = stated
        .tags
        .iter()
        .map(|(key, value)| tag(key, value, TagSource::Hand, ""));
    let header = read.header_tags.iter();
    let header = header
        .filter(|(key, _, _)| !stated.tags.contains_key(key))
        .map(|(key, value, detail)| tag(key, value, TagSource::Header, detail));
    Resolved {
        tags: own.chain(header).collect(),
        ..Resolved::default()
    }
}

/// The first tag of each key.
fn chosen(resolved: &Resolved) -> BTreeMap<String, String> {
    let mut chosen = BTreeMap::new();
    for tag in &resolved.tags {
        chosen.entry(tag.key.clone()).or_insert_with(|| tag.value.clone());
    }
    chosen
}

/// Says that the readings hold a voltage, which goes before one that a tag states, and that the two differ.
fn other_voltage(read: &ReadTable, tags: &BTreeMap<String, String>, drive: &Drive) -> Option<Issue> {
    let stated_v: f64 = tags.get(keys::VOLTAGE_V)?.parse().ok()?;
    if !drive::has_voltage(&read.channels) || drive.has_level_near(stated_v) {
        return None;
    }
    let found_v = drive.nominal_step_v();
    let message = format!(
        "voltage_v is {stated_v} V, and the voltage among the readings goes to {} V, which is used",
        fixed(found_v, 4)
    );
    let issue = Issue::warning("tag-disagreement", message).at(keys::VOLTAGE_V);
    Some(issue.mend("leave voltage_v out, or the voltage among the readings where that is wrong"))
}

/// Why the drive is not known: what was found wrong with the voltage, else that there is none.
fn no_drive(issues: &[Issue], is_step_response: bool) -> Issue {
    let mend =
        "state voltage_v, the step at time zero, or drive, the start (s) and voltage (V) of each segment";
    if !is_step_response {
        let message = "the file's technique is no response to voltage steps";
        return Issue::error(NO_DRIVE, message).mend(format!("{mend}, if it is one all the same"));
    }
    let of_voltage = |issue: &&Issue| issue.code == drive::NO_STEPS || issue.place.contains(keys::VOLTAGE_V);
    match issues.iter().find(of_voltage) {
        Some(found) => Issue {
            severity: Severity::Error,
            mend: mend.to_owned(),
            ..found.clone()
        },
        None => Issue::error(
            NO_DRIVE,
            "there is no voltage among the readings, and none is stated",
        )
        .at(Quantity::Voltage.column())
        .mend(mend),
    }
}

/// The readings as the database gives them to a fit: a current density as a current, and without what tags leave out.
fn as_used(
    channels: &[Channel],
    flags: &[FlaggedStretch],
    tags: &BTreeMap<String, String>,
    area_cm2: f64,
) -> Vec<Channel> {
    let mut channels = channels.to_vec();
    let has_current = channels
        .iter()
        .any(|channel| channel.quantity == Quantity::Current);
    let density = channels
        .iter()
        .position(|channel| channel.quantity == Quantity::CurrentDensity);
    if let Some(index) = density.filter(|_| !has_current) {
        channels[index] = channels[index].as_current(area_cm2);
    }
    if let Some(marked) = tags.get(keys::LEAVE_OUT_MARKED) {
        left_out::leave_out_marked(&mut channels, marked, flags);
    }
    let stretches = tags
        .get(keys::LEAVE_OUT)
        .and_then(|text| left_out::stretches(text));
    left_out::leave_out(&mut channels, &stretches.unwrap_or_default());
    channels
}

/// Hash of the readings with the tags that leave some out, as `store` makes it of a stored run.
fn stamp(channels: &[Channel], tags: &BTreeMap<String, String>) -> String {
    let left_out = [keys::LEAVE_OUT, keys::LEAVE_OUT_MARKED];
    let stated = left_out
        .iter()
        .filter_map(|key| Some(format!(":{key}={}", tags.get(*key)?)));
    data_hash(channels) + &stated.collect::<String>()
}
