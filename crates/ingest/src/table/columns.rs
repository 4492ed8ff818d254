//! What the columns of a table mean by their names, and by their units where the names do not say it.

use crate::formats::error::quoted;
use crate::text::header::{Header, Meaning};
use crate::text::likely::{headed_by_unit, is_time_by_unit, says_nothing};
use crate::text::names::names_time;
use ieap_domain::unit;
use ieap_domain::{Issue, Quantity};

/// Where no name is that of a time, the one column with a unit of time is it.
fn name_time(headers: &mut [Header]) {
    if headers.iter().any(|header| names_time(&header.raw_name)) {
        return;
    }
    let mut by_unit = headers.iter_mut().filter(|header| is_time_by_unit(header));
    if let Some(only) = by_unit.next().filter(|_| by_unit.next().is_none()) {
        only.meaning = Header::with_unit("time", &only.raw_unit).meaning;
    }
}

/// Headers of names; a name without a unit of its own takes that of the row of units. A number in the place of a name, or of an
/// input, says nothing: the unit does, where only one input has it.
pub fn headers(names: &[&str], units: Option<&[String]>) -> Vec<Header> {
    let unit_of = |index: usize| {
        units
            .and_then(|units| units.get(index))
            .map_or("", String::as_str)
    };
    let header = |(index, name): (usize, &&str)| match (Header::parse(name), unit_of(index)) {
        (header, unit) if header.raw_unit.is_empty() && !unit.is_empty() => {
            match headed_by_unit(name, unit) {
                Some(header) if says_nothing(name) => header,
                _ => Header::with_unit(name, unit),
            }
        }
        (header, _) if header.meaning == Meaning::Other && says_nothing(name) => {
            headed_by_unit(&header.raw_name, &header.raw_unit).unwrap_or(header)
        }
        (header, _) => header,
    };
    let mut headers: Vec<Header> = names.iter().enumerate().map(header).collect();
    name_storage_modulus(&mut headers);
    name_time(&mut headers);
    let quantities: Vec<Option<Quantity>> = headers.iter().map(|h| h.meaning.quantity()).collect();
    let is_only = |quantity| quantities.iter().filter(|other| **other == quantity).count() == 1;
    for (header, quantity) in headers.iter_mut().zip(&quantities) {
        if says_nothing(&header.raw_name) && !is_only(*quantity) {
            header.meaning = Meaning::Other;
        }
    }
    headers
}

/// Beside `Modulus"`, the loss modulus, `Modulus` is the storage modulus.
fn name_storage_modulus(headers: &mut [Header]) {
    let is_named = |header: &Header, name: &str| header.raw_name.to_lowercase().starts_with(name);
    let is_loss = |header: &Header| {
        header.meaning.quantity() == Some(Quantity::LossModulus) && is_named(header, "modulus")
    };
    if !headers.iter().any(is_loss) {
        return;
    }
    let plain = headers
        .iter_mut()
        .filter(|header| header.meaning == Meaning::Other && is_named(header, "modulus"));
    for header in plain {
        header.meaning = Header::with_unit("storage modulus", &header.raw_unit).meaning;
    }
}

/// What a column is by its unit alone, because its name does not say it.
fn told(header: &Header) -> Option<Quantity> {
    let name = &header.raw_name;
    let plain = Header::parse(name);
    if is_time_by_unit(&plain) {
        return Some(Quantity::Time);
    }
    let is_open = says_nothing(name) && plain.meaning.named_quantity().is_none();
    let by_unit = is_open
        .then(|| headed_by_unit(name, &header.raw_unit))
        .flatten()?;
    by_unit.meaning.quantity()
}

/// Says which columns were decided by their units alone, each with the column that has such a unit as well: of the quantities
/// that are asked.
pub fn said_by_unit(headers: &[Header], is_asked: impl Fn(Quantity) -> bool) -> Vec<Issue> {
    let time_is_named = headers.iter().any(|header| names_time(&header.raw_name));
    let is_decided =
        |quantity: &Quantity| is_asked(*quantity) && !(time_is_named && *quantity == Quantity::Time);
    let said = |(at, header): (usize, &Header)| {
        let quantity = told(header).filter(is_decided)?;
        let can_be = |other: &Header| {
            other.meaning.quantity() == Some(quantity)
                || (!other.raw_unit.is_empty() && unit::conversion(quantity, &other.raw_unit).is_ok())
        };
        let mut rivals = headers
            .iter()
            .enumerate()
            .filter(|(other, header)| *other != at && can_be(header));
        let rival = rivals.next().map(|(_, rival)| quoted(&rival.raw_name));
        let (name, label) = (quoted(&header.raw_name), quantity.label().to_lowercase());
        let is_taken = header.meaning.quantity() == Some(quantity);
        let open = format!("column {name} does not say what it measures");
        let issue = match (is_taken, rival) {
            (true, None) => Issue::note(
                BY_UNIT,
                format!("{open}; by its unit it is taken for the {label}"),
            ),
            (true, Some(rival)) => {
                let message = format!(
                    "{open}; by its unit it is taken for the {label}, and column {rival} has such a unit, too"
                );
                Issue::warning(BY_UNIT, message)
                    .mend("name the column that counts by what it measures, with its unit")
            }
            (false, rival) => {
                let rival = rival.map_or(String::new(), |rival| {
                    format!(", and column {rival} has such a unit, too")
                });
                let message = format!(
                    "{open}; by its unit it may be the {label}{rival}; it is kept under its own name"
                );
                Issue::note(BY_UNIT, message)
            }
        };
        Some(issue.at(format!("column {}", at + 1)))
    };
    headers.iter().enumerate().filter_map(said).collect()
}

/// Code of what is said of a column that its unit alone decided.
const BY_UNIT: &str = "decided-by-unit";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_unit_alone_decided_is_said_with_the_column_that_could_be_it_too() {
        let said = |names: &[&str], units: Option<&[&str]>| {
            let units: Option<Vec<String>> =
                units.map(|units| units.iter().map(|unit| (*unit).to_owned()).collect());
            let headers = headers(names, units.as_deref());
            let issues = said_by_unit(&headers, |_| true);
            assert!(issues.iter().all(|issue| issue.code == "decided-by-unit"));
            issues.into_iter().map(|issue| issue.message).collect::<Vec<_>>()
        };
        let [time, voltage, current] = &said(
            &[
                "Id\u{151} (s)",
                "Rise limit (s)",
                "Channel 1 (V)",
                "Probe (V)",
                "Channel 2 (mA)",
            ],
            None,
        )[..] else {
            panic!("three columns are decided");
        };
        assert!(
            time.contains("the time") && time.contains("Rise limit (s)"),
            "{time}"
        );
        assert!(
            voltage.contains("taken for the voltage") && voltage.contains("Probe (V)"),
            "{voltage}"
        );
        assert!(current.ends_with("taken for the current"), "{current}");
        // Neither of two is taken, and a row of units says as much.
        let neither = said(&["time (s)", "1", "2"], Some(&["", "V", "V"]));
        assert!(
            neither.len() == 2
                && neither
                    .iter()
                    .all(|said| said.contains("kept under its own name")),
            "{neither:?}"
        );
        let none = said(
            &["Time (s)", "Dauer (s)", "Voltage (V)", "Probe (V)", "Current (A)"],
            None,
        );
        assert!(none.is_empty(), "{none:?}");
    }
}
