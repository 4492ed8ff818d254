//! What a column may mean whose name is not known: by a name that is nearly a known one, or by its unit alone.

use super::dictionary::{INPUTS, Role, is_among};
use super::header::{Header, Meaning, spelled_unit};
use super::names::{candidates, known_names, role};
use super::number::unquote;
use crate::campaign_file::nearest;
use crate::text::policy::FEWEST_LETTERS;
use ieap_domain::Quantity;
use ieap_domain::unit::{self, Conversion};

/// Quantities whose units say what is measured in a table of a run; a length may be many things. A voltage may be, too, but where
/// a table has no other its drive would be believed from a name while the readings are not asked.
const TOLD_BY_UNIT: [Quantity; 4] = [
    Quantity::Curvature,
    Quantity::Current,
    Quantity::CurrentDensity,
    Quantity::Voltage,
];

/// What a column probably measures.
#[derive(Debug, Clone, PartialEq)]
pub struct Likely {
    /// The quantity.
    pub quantity: Quantity,
    /// The known name that was probably meant, and the conversion of the unit: name and unit leave no doubt. None where
    /// the unit alone speaks.
    pub named: Option<(String, Conversion)>,
    /// The unit as it is understood.
    pub unit: String,
}

/// What a column probably measures; none where nothing speaks for a quantity, or where it is known.
pub fn likely(header: &Header) -> Option<Likely> {
    if header.meaning != Meaning::Other {
        return None;
    }
    by_name(header).or_else(|| by_unit(header))
}

/// What a column means whose name says nothing, as a number, or is a unit alone, as `V` and `µA` below which PSTrace
/// writes: the unit says it where only one quantity of a run is measured in it.
pub fn headed_by_unit(name: &str, unit: &str) -> Option<Header> {
    const SAID_BY_UNIT: [Quantity; 4] = [
        Quantity::Voltage,
        Quantity::Current,
        Quantity::Curvature,
        Quantity::TipDisplacement,
    ];
    let measures = |quantity: &&Quantity| unit::conversion(**quantity, unit).is_ok();
    let quantity = SAID_BY_UNIT.iter().find(measures)?;
    Some(Header {
        raw_name: name.to_owned(),
        ..Header::with_unit(quantity.label(), unit)
    })
}

/// Whether a name that nobody knows says by its unit that it is a time: `Idő (s)`.
pub fn is_time_by_unit(header: &Header) -> bool {
    let unit = &header.raw_unit;
    // The unit `min` is no minimum.
    let name = header.raw_name.split(['(', '[', '{', '/']).next().unwrap_or("");
    let is_stated = header.raw_name.ends_with([')', ']', '}']) || header.raw_name.contains('/');
    header.meaning == Meaning::Other
        && is_stated
        && !unit.is_empty()
        && role(name) == Role::Measured
        && unit::conversion(Quantity::Time, unit).is_ok()
}

/// Whether a name numbers an input and says nothing of what it measures: `3`, `Channel 2 (V)`.
pub fn says_nothing(name: &str) -> bool {
    let bare = unquote(name)
        .split(['(', '[', '{', '/'])
        .next()
        .unwrap_or("")
        .to_lowercase();
    let mut words = bare
        .split(|c: char| !c.is_alphanumeric())
        .filter(|word| !word.is_empty());
    let is_input = |word: &str| {
        let letters = word.trim_end_matches(|c: char| c.is_ascii_digit());
        letters.is_empty() || is_among(INPUTS, letters)
    };
    bare.contains(|c: char| c.is_ascii_digit()) && words.all(is_input)
}

/// `curvture_per_cm`, `Curent (mA)`: a slip in a known name, with a unit of its quantity.
fn by_name(header: &Header) -> Option<Likely> {
    let cell = header.raw_name.as_str();
    let whole = (!header.raw_unit.is_empty())
        .then(|| {
            cell.find(['(', '[', '/', ','])
                .map(|at| (&cell[..at], header.raw_unit.as_str()))
        })
        .flatten();
    let cuts = cell.char_indices().filter(|(_, c)| matches!(c, '_' | ' '));
    let parts = cuts.map(|(at, _)| (&cell[..at], &cell[at + 1..]));
    whole.into_iter().chain(parts).find_map(|(name, unit)| {
        let name = name.trim();
        if name.chars().count() < FEWEST_LETTERS {
            return None;
        }
        let meant = nearest(name, known_names())?;
        candidates(meant).iter().find_map(|&quantity| {
            let unit = spelled_unit(quantity, unit)?;
            let conversion = unit::conversion(quantity, &unit).ok()?;
            Some(Likely {
                quantity,
                named: Some((meant.to_owned(), conversion)),
                unit,
            })
        })
    })
}

fn by_unit(header: &Header) -> Option<Likely> {
    let fits = |quantity: &Quantity| unit::conversion(*quantity, &header.raw_unit).is_ok();
    let quantity = TOLD_BY_UNIT.into_iter().find(fits)?;
    Some(Likely {
        quantity,
        named: None,
        unit: header.raw_unit.clone(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slips_with_a_fitting_unit_leave_no_doubt_and_a_unit_alone_is_a_proposal() {
        for (cell, quantity, meant) in [
            ("curvture_per_cm", Quantity::Curvature, Some("curvature")),
            ("Curent (mA)", Quantity::Current, Some("current")),
            ("Kr\u{fc}mung [1/m]", Quantity::Curvature, Some("kr\u{fc}mmung")),
            ("voltge_v", Quantity::Voltage, Some("voltage")),
            ("k_strip [1/m]", Quantity::Curvature, None),
            ("Kanal 3 (mA)", Quantity::Current, None),
            ("Probe A (V)", Quantity::Voltage, None),
            ("signal / mA/cm2", Quantity::CurrentDensity, None),
        ] {
            let found = likely(&Header::parse(cell)).unwrap_or_else(|| panic!("{cell}"));
            let name = found.named.as_ref().map(|(name, _)| name.as_str());
            assert_eq!((found.quantity, name), (quantity, meant), "{cell}");
        }
    }

    #[test]
    fn a_number_of_an_input_says_nothing_and_a_unit_of_time_says_it() {
        for (name, says) in [
            ("3", true),
            ("Channel 2 (V)", true),
            ("CH1", true),
            ("通道3 (mA)", true),
            ("Input (V)", false),
            ("I1 (A)", false),
            ("(V)", false),
        ] {
            assert_eq!(says_nothing(name), says, "{name}");
        }
        for (name, is_time) in [
            ("Idő (s)", true),
            ("Aika [min]", true),
            ("Rate limit (s)", false),
            ("x_s", false),
            ("Áram (mA)", false),
        ] {
            assert_eq!(is_time_by_unit(&Header::parse(name)), is_time, "{name}");
        }
    }

    #[test]
    fn known_columns_and_those_of_other_kinds_are_left_alone() {
        for cell in [
            "current_a",
            "Current range",
            "Potential applied (V)",
            "Distance1 (mm)",
            "Index",
            "time stamp",
            "Temperatur (\u{b0}C)",
            "note",
        ] {
            assert_eq!(likely(&Header::parse(cell)), None, "{cell}");
        }
    }
}
