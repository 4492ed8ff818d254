//! Responses that a run's files name and that could not be read: a fit without them is told as one.

use crate::domain::{Channel, Issue, Quantity};
use crate::ingest::text::header::{Header, Meaning};
use crate::ingest::text::likely::likely;

/// Code of the issue of a run whose files hold a response that is not read.
pub const RESPONSE_MISSING: &str = "response-missing";

/// One issue for each response that a column which is kept under its own name is probably meant to hold, where no other
/// column gives it.
pub fn missing_responses(channels: &[Channel]) -> Vec<Issue> {
    let mut found: Vec<(Quantity, Issue)> = Vec::new();
    for channel in channels
        .iter()
        .filter(|channel| channel.quantity == Quantity::Other)
    {
        let Some((quantity, reason)) = meant(channel) else {
            continue;
        };
        let is_given = channels.iter().any(|c| gives(c.quantity) == gives(quantity))
            || found.iter().any(|(known, _)| gives(*known) == gives(quantity));
        if quantity.is_response() && !is_given {
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
    found.into_iter().map(|(_, issue)| issue).collect()
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
            let issues = missing_responses(channels).into_iter();
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
}
