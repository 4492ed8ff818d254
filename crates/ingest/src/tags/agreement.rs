//! Whether two sources mean the same, and what to say where they do not.

use crate::tags::policy::START_AGREES_S;
use crate::tags::value;
use jiff::Timestamp;

use ieap_domain::drive::{NOMINAL_AGREES_PART, NOMINAL_AGREES_V};
use ieap_domain::tag::{DISAGREEMENT, NAMES_CONTRADICT, keys};
use ieap_domain::{ClimateQuantity, Issue, Tag, TagSource};

/// The issue that names both sources and values, where `overruled` does not mean what `chosen` means.
///
/// It is a warning where two statements about this very run differ, and a note where the stronger source is
/// there to overrule (a value set by hand, a nearer tag file, the run's own column beside a log, a default) or the tag is
/// a text that two sources may well word differently. A sidecar stands over a tags.toml as the exception over the rule: the
/// same person wrote both, so that it is no contradiction.
pub(super) fn disagreement(chosen: &Tag, overruled: &Tag) -> Option<Issue> {
    if agree(chosen, overruled) {
        return None;
    }
    let message = format!(
        "`{}` is {} ({}) and {} ({}): the first is used",
        chosen.key,
        chosen.value,
        origin(chosen),
        overruled.value,
        origin(overruled)
    );
    let is_by_hand = chosen.source == TagSource::Hand;
    let is_nearer = chosen.source == TagSource::Sidecar && overruled.source == TagSource::Folder;
    let is_one_name = chosen.source == TagSource::Derived && overruled.source == TagSource::FileName;
    let meant_to_overrule = is_by_hand
        || is_nearer
        || is_one_name
        || (chosen.source == TagSource::Column && overruled.source == TagSource::Ambient)
        || chosen.source == overruled.source
        || overruled.source == TagSource::EnvironmentDefault;
    let issue = if meant_to_overrule || is_wording(chosen) {
        Issue::note(DISAGREEMENT, message)
    } else {
        Issue::warning(DISAGREEMENT, message)
            .mend("correct the wrong one, or set the tag by hand with `ieap tag`")
    };
    Some(issue.at(&chosen.key))
}

/// The issue of one measurement that lies under two names of which different things are stated, where they do. A value set
/// by hand is there to overrule.
pub(super) fn contradiction(chosen: &Tag, overruled: &Tag, (one, other): (String, String)) -> Option<Issue> {
    if agree(chosen, overruled) {
        return None;
    }
    if chosen.source == TagSource::Hand || is_wording(chosen) {
        return disagreement(chosen, overruled);
    }
    let message = format!(
        "`{}` is {} for {one} ({}) and {} for {other} ({}), and both hold the same readings: the first is used",
        chosen.key,
        chosen.value,
        origin(chosen),
        overruled.value,
        origin(overruled)
    );
    let mend = "remove the file whose name or folder is wrong, correct its tags, or set the tag by hand with `ieap tag`";
    Some(
        Issue::warning(NAMES_CONTRADICT, message)
            .at(&chosen.key)
            .mend(mend),
    )
}

/// Texts that two sources may well word differently.
fn is_wording(tag: &Tag) -> bool {
    [keys::INSTRUMENT, keys::OPERATOR, keys::NOTE].contains(&tag.key.as_str())
}

fn origin(tag: &Tag) -> String {
    if tag.detail.is_empty() {
        tag.source.label().to_owned()
    } else {
        format!("{}: {}", tag.source.label(), tag.detail)
    }
}

fn agree(chosen: &Tag, overruled: &Tag) -> bool {
    if chosen.value == overruled.value {
        return true;
    }
    if chosen.key == keys::STARTED_AT {
        if lies_in_day(chosen, overruled) || lies_in_day(overruled, chosen) {
            return true;
        }
        return match (
            chosen.value.parse::<Timestamp>(),
            overruled.value.parse::<Timestamp>(),
        ) {
            (Ok(a), Ok(b)) => a.duration_since(b).as_secs_f64().abs() <= START_AGREES_S,
            _ => false,
        };
    }
    // Sample "01" is not sample "1": only keys that stand for numbers are compared as numbers.
    if !keys::NUMERIC.contains(&chosen.key.as_str()) {
        return false;
    }
    match (chosen.value.parse::<f64>(), overruled.value.parse::<f64>()) {
        (Ok(a), Ok(b)) => numbers_agree(chosen, overruled, (a, b)),
        _ => false,
    }
}

/// Whether one start is a moment of the day that the other is.
pub(super) fn lies_in_day(moment: &Tag, day: &Tag) -> bool {
    let is_day = value::day(&day.value).is_some() && value::day(&moment.value).is_none();
    day.key == keys::STARTED_AT && is_day && moment.value.starts_with(&day.value)
}

/// Whether two numbers of a key mean the same: exactly where neither was measured.
fn numbers_agree(chosen: &Tag, overruled: &Tag, (a, b): (f64, f64)) -> bool {
    let climate = ClimateQuantity::MEASURED
        .into_iter()
        .find(|quantity| quantity.key() == chosen.key);
    if let Some(quantity) = climate
        && [chosen, overruled]
            .iter()
            .any(|tag| tag.source.is_measured_climate())
    {
        return quantity.agree(a, b);
    }
    let magnitude = a.abs().max(b.abs());
    let is_measured = [chosen, overruled]
        .iter()
        .any(|tag| tag.source == TagSource::Channel);
    let allowed = if chosen.key == keys::VOLTAGE_V && is_measured {
        NOMINAL_AGREES_V.max(NOMINAL_AGREES_PART * magnitude)
    } else {
        0.0
    };
    // The last digits of a binary fraction say nothing: 2.51 - 2.5 is 0.00999...
    (a - b).abs() <= allowed + 1e-12 * magnitude
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tag(key: &str, value: &str, source: TagSource) -> Tag {
        Tag {
            key: key.to_owned(),
            value: value.to_owned(),
            source,
            detail: String::new(),
        }
    }

    #[test]
    fn what_was_measured_agrees_within_the_stated_rule() {
        use TagSource::{Ambient, Channel, Column, FileName, Sidecar};
        for (key, stated, source, other, agrees) in [
            ("voltage_v", "2.5", FileName, "2.50", true),
            ("voltage_v", "2.5", FileName, "2.501", false),
            ("voltage_v", "2.5", Channel, "2.55", true),
            ("voltage_v", "2.5", Channel, "2.56", false),
            ("voltage_v", "-0.05", Channel, "-0.06", true),
            ("voltage_v", "-0.05", Channel, "-0.1", false),
            ("voltage_v", "2.5", Channel, "-2.5", false),
            ("relative_humidity_percent", "34", Ambient, "36.9", true),
            ("relative_humidity_percent", "34", Ambient, "37.1", false),
            ("relative_humidity_percent", "34", Column, "36.9", true),
            ("relative_humidity_percent", "34", Column, "37.1", false),
            ("relative_humidity_percent", "34", FileName, "35", false),
            ("temperature_c", "22", Ambient, "23", true),
            ("temperature_c", "22", Ambient, "23.1", false),
            ("cycle", "1", FileName, "1.0", true),
            (
                "started_at",
                "2026-11-20T10:00:00Z",
                FileName,
                "2026-11-20T12:00:30+02:00",
                true,
            ),
            (
                "started_at",
                "2026-11-20T10:00:00Z",
                FileName,
                "2026-11-20T12:02:00+02:00",
                false,
            ),
            ("sample", "1", FileName, "01", false),
            ("sample", "C1", FileName, "C2", false),
        ] {
            let found = agree(&tag(key, stated, Sidecar), &tag(key, other, source));
            assert_eq!(found, agrees, "{key} {stated} {other} {source:?}");
        }
    }
}
