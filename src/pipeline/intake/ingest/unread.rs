//! Responses that a run's files name and that could not be read: a fit without them is told as one.

use crate::domain::unit::conversion;
use crate::domain::{Channel, Issue, Quantity};
use crate::ingest::text::header::{Header, Meaning};
use crate::ingest::text::likely::likely;

/// Code of the issue of a run whose files hold a response that is not read.
pub const RESPONSE_MISSING: &str = "response-missing";

/// One issue for each response that a column which is kept under its own name is probably meant to hold, where no other
/// column gives it; `file` is in the command that mends it.
pub fn missing_responses(channels: &[Channel], file: &str) -> Vec<Issue> {
    let mut found: Vec<(Quantity, Issue)> = Vec::new();
    let unread = || {
        channels
            .iter()
            .filter(|channel| channel.quantity == Quantity::Other)
    };
    let is_given = |quantity: Quantity, found: &[(Quantity, Issue)]| {
        channels.iter().any(|c| gives(c.quantity) == gives(quantity))
            || found.iter().any(|(known, _)| gives(*known) == gives(quantity))
    };
    for channel in unread() {
        let Some((quantity, reason)) = meant(channel) else {
            continue;
        };
        if quantity.is_response() && !is_given(quantity, &found) {
            let message = format!(
                "the run is without its {}: column \"{}\" is kept and not used, for {reason}",
                gives(quantity).label().to_lowercase(),
                channel.raw_name
            );
            let mend = format!(
                "name the column {} with its unit, or read the file by a profile (`ieap profile FILE`)",
                quantity.label().to_lowercase()
            );
            found.push((quantity, Issue::warning(RESPONSE_MISSING, message).mend(mend)));
        }
    }
    let bending = unread().find(|channel| may_be_bending(channel));
    if let Some(channel) = bending.filter(|_| !is_given(Quantity::Curvature, &found)) {
        found.push((Quantity::Curvature, asked(channel, file)));
    }
    found.into_iter().map(|(_, issue)| issue).collect()
}

/// Names that laboratories give the motion of the tip.
const BENDING_NAMES: [&str; 16] = [
    "d",
    "x",
    "y",
    "w",
    "weg",
    "biegung",
    "auslenkung",
    "verschiebung",
    "spitze",
    "laser",
    "tip",
    "bending",
    "deflection",
    "displacement",
    "distance",
    "position",
];

/// Whether a column may be the motion of the tip: by its name, or by a unit of length.
fn may_be_bending(channel: &Channel) -> bool {
    let is_length = conversion(Quantity::TipDisplacement, &channel.raw_unit).is_ok();
    let letters = |c: char| c.is_alphabetic();
    let mut words = channel.raw_name.split(|c| !letters(c)).map(str::to_lowercase);
    let is_named = words
        .next()
        .is_some_and(|first| BENDING_NAMES.contains(&first.as_str()));
    is_length || (is_named && channel.raw_unit.is_empty())
}

/// The question that a column asks which may be the motion of the tip, with the one command that answers it.
fn asked(channel: &Channel, file: &str) -> Issue {
    let unit = if channel.raw_unit.is_empty() { ",mm" } else { "" };
    let name = &channel.raw_name;
    let message = format!("column \"{name}\" is not used: is it the tip displacement?");
    let mend = format!(
        "if it is: ieap profile \"{file}\" --column \"{name}=tip_displacement{unit}\" --write displacement{}",
        match unit {
            "" => "",
            _ => ", with the unit that it has",
        }
    );
    Issue::warning(RESPONSE_MISSING, message).mend(mend)
}

/// What a fit makes of a response: a current of a current density, a curvature of a tip displacement.
fn gives(quantity: Quantity) -> Quantity {
    match quantity {
        Quantity::CurrentDensity => Quantity::Current,
        Quantity::TipDisplacement => Quantity::Curvature,
        other => other,
    }
}

/// What a column was probably meant to measure, and why it is not read as that.
fn meant(channel: &Channel) -> Option<(Quantity, String)> {
    let named = Header::parse(&channel.raw_name);
    let header = match named.meaning {
        Meaning::Other if !channel.raw_unit.is_empty() => Header {
            raw_unit: channel.raw_unit.clone(),
            ..named
        },
        _ => named,
    };
    match &header.meaning {
        Meaning::Refused { quantity, error } => Some((*quantity, error.to_string())),
        Meaning::Known { .. } => None,
        Meaning::Other => {
            let found = likely(&header)?;
            let reason = format!(
                "its unit is one of {}, and its name is not known",
                found.quantity.label()
            );
            Some((found.quantity, reason.to_lowercase()))
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;

    fn channel(quantity: Quantity, raw_name: &str) -> Channel {
        Channel {
            raw_name: raw_name.to_owned(),
            raw_unit: String::new(),
            ..Channel::new(quantity, Arc::from([0.0]), Arc::from([1.0]))
        }
    }

    #[test]
    fn a_response_that_is_named_and_not_read_is_said_unless_another_column_gives_it() {
        let said = |channels: &[Channel]| -> Vec<String> {
            let issues = missing_responses(channels, "runs/a.csv").into_iter();
            issues.map(|issue| issue.message).collect()
        };
        let current = channel(Quantity::Current, "I/mA");
        let bending = channel(Quantity::Other, "curvature");
        let found = said(&[
            current.clone(),
            bending.clone(),
            channel(Quantity::Other, "probe [1/m]"),
        ]);
        assert_eq!(found.len(), 1, "{found:?}");
        assert!(
            found[0].contains("without its curvature") && found[0].contains("no unit"),
            "{found:?}"
        );
        let read = channel(Quantity::TipDisplacement, "Displacement (mm)");
        assert!(said(&[current, bending, read, channel(Quantity::Other, "Index")]).is_empty());
        let density = channel(Quantity::CurrentDensity, "j");
        assert!(said(&[density, channel(Quantity::Other, "Kanal (mA)")]).is_empty());
    }

    #[test]
    fn a_column_that_may_be_the_motion_of_the_tip_is_asked_about() {
        let asked = |name: &str, unit: &str| {
            let column = Channel {
                raw_unit: unit.to_owned(),
                ..channel(Quantity::Other, name)
            };
            let current = channel(Quantity::Current, "I/mA");
            missing_responses(&[current, column], "runs/a.csv").pop()
        };
        for (name, unit, command) in [
            ("d [mm]", "mm", "--column \"d [mm]=tip_displacement\""),
            ("Weg", "", "--column \"Weg=tip_displacement,mm\""),
            ("Laser", "", "tip_displacement,mm"),
            ("Kamera (µm)", "µm", "tip_displacement\""),
        ] {
            let issue = asked(name, unit).unwrap_or_else(|| panic!("{name}"));
            assert!(issue.message.contains("is it the tip displacement?"), "{name}");
            assert!(issue.mend.contains(command), "{}", issue.mend);
        }
        for (name, unit) in [("Index", ""), ("Range", ""), ("Temp [°C]", "°C")] {
            assert_eq!(asked(name, unit), None, "{name}");
        }
    }
}
