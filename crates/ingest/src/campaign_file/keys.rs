//! Keys of campaign.toml that nothing reads, with the known key that was probably meant.

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::lines::Lines;
use super::nearest;
use ieap_domain::Issue;

/// Code of what is said of a key that nothing reads.
pub const UNKNOWN_KEY: &str = "unknown-key";

/// Each table with the keys that it may hold.
const KNOWN: [(&str, &[&str]); 20] = [
    (
        "campaign",
        &[
            "id",
            "title",
            "timezone",
            "date_order",
            "notice",
            "model",
            "group_by",
            "tolerance_percent",
        ],
    ),
    (
        "sample",
        &[
            "id",
            "material",
            "length_mm",
            "width_mm",
            "thickness_mm",
            "area_cm2",
            "electrode_resistance_ohm_per_sq",
            "batch",
        ],
    ),
    (
        "material",
        &[
            "id",
            "electrode",
            "membrane",
            "electrolyte",
            "current_collector",
            "reinforcement",
            "electrode_thickness_um",
            "membrane_thickness_um",
        ],
    ),
    (
        "environment",
        &["id", "relative_humidity_percent", "temperature_c", "pressure_pa"],
    ),
    ("adopted", &["group", "model"]),
    ("fit", &["method", "simultaneous", "known"]),
    ("runs", &["folder", "name_pattern", "pair_by"]),
    ("pair", &["current", "bending"]),
    ("dma", &["folder", "name_pattern"]),
    ("impedance", &["folder", "name_pattern", "circuits"]),
    ("report", &["templates"]),
    (
        "frames",
        &[
            "px_per_mm",
            "length_mm",
            "clamp",
            "strip",
            "crop_px",
            "positive",
            "initial",
            "vectors",
            "frames_per_second",
            "first_frame_s",
            "times_s",
        ],
    ),
    (
        "sensor",
        &[
            "id",
            "files",
            "place",
            "environments",
            "samples",
            "relative_humidity_accuracy_percent",
            "temperature_accuracy_c",
            "relative_humidity_correction_percent",
            "temperature_correction_c",
            "utc_offset",
            "calibration",
        ],
    ),
    (
        "climate",
        &[
            "relative_humidity_tolerance_percent",
            "temperature_tolerance_c",
            "longest_gap_s",
            "exposure_above_percent",
            "pressure_tolerance_percent",
            "oxygen_limit_ppm",
            "water_limit_ppm",
        ],
    ),
    ("compare", &["reference", "by"]),
    (
        "study",
        &[
            "compare",
            "within",
            "at_equal",
            "scatter_percent",
            "alike_percent",
        ],
    ),
    (
        "answers",
        &[
            "clock",
            "decimal",
            "thousands",
            "elapsed",
            "humidity",
            "temperature",
        ],
    ),
    (
        "publication",
        &[
            "title",
            "description",
            "license",
            "doi",
            "publisher",
            "date",
            "keywords",
            "author",
        ],
    ),
    ("tags", &["extra"]),
    (
        "monitoring",
        &[
            "reference",
            "false_alarm_runs",
            "limit",
            "command",
            "command_time_limit_s",
            "acknowledged",
        ],
    ),
];

/// One warning for each key that is not known, in the file's order.
pub(super) fn unknown_keys(file: &DeTable, lines: &Lines<'_>) -> Vec<Issue> {
    let mut found = Vec::new();
    for (name, value) in file {
        match KNOWN.iter().find(|(table, _)| table == name.get_ref()) {
            Some((table, keys)) => in_value(value.get_ref(), table, keys, &mut found),
            None => found.push((name.span().start, warning(name.get_ref(), "", &table_names()))),
        }
    }
    found.sort_by_key(|(offset, _)| *offset);
    let place = |offset| {
        let (line, column) = lines.place(offset);
        format!("line {line}, column {column}")
    };
    found
        .into_iter()
        .map(|(offset, issue)| issue.at(place(offset)))
        .collect()
}

fn table_names() -> Vec<&'static str> {
    KNOWN.iter().map(|(table, _)| *table).collect()
}

fn in_value(value: &DeValue, table: &str, keys: &[&str], found: &mut Vec<(usize, Issue)>) {
    if let Some(entries) = value.as_array() {
        for entry in entries {
            in_value(Spanned::get_ref(entry), table, keys, found);
        }
    }
    for (key, _) in value.as_table().into_iter().flatten() {
        if !keys.contains(&&**key.get_ref()) {
            found.push((key.span().start, warning(key.get_ref(), table, keys)));
        }
    }
}

fn warning(key: &str, table: &str, known: &[&str]) -> Issue {
    let of_table = if table.is_empty() {
        String::new()
    } else {
        format!(" of [{table}]")
    };
    let message = format!("the key `{key}`{of_table} is not known and is not used");
    let mend = match nearest(key, known.iter().copied()) {
        Some(meant) => format!("write `{meant}` if that is meant"),
        None => format!("known here: {}", known.join(", ")),
    };
    Issue::warning(UNKNOWN_KEY, message).mend(mend)
}
