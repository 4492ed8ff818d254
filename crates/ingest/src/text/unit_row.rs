//! Units in a row of their own below the names, as Anton Paar, TA, Zwick and Instron write them.

use super::number::{self, Cell, Decimal, unquote};
use crate::text::policy::LONGEST_UNIT;
use ieap_domain::unit;

/// The units below `names`, without their brackets; none where the row is no row of units.
///
/// Such a row has no number, no text longer than a unit, and at least half of what it holds is in brackets, a dash or a
/// unit that converts; it has no more cells than there are names.
pub fn unit_row<'a>(names: usize, cells: impl Iterator<Item = &'a str>) -> Option<Vec<String>> {
    let units: Vec<&str> = cells.map(unquote).collect();
    if units.len() > names {
        return None;
    }
    let filled: Vec<&str> = units.iter().copied().filter(|unit| !unit.is_empty()).collect();
    let is_number = |unit: &&str| {
        [Decimal::Point, Decimal::Comma]
            .iter()
            .any(|&decimal| !matches!(number::parse(unit, decimal), Cell::Text | Cell::Empty))
    };
    let is_sure = |unit: &&&str| bare(unit).len() < unit.len() || **unit == "-" || unit::is_known(unit);
    // `time [s]` and `Time us` are names with their units.
    let ends_in_unit = |(_, last): (&str, &str)| unit::is_known(last);
    let is_named = |unit: &str| {
        let known = unit::is_known(unit);
        unit.contains(" [")
            || unit.contains(" (")
            || (!known && unit.rsplit_once(' ').is_some_and(ends_in_unit))
    };
    let fits =
        |unit: &&str| (bare(unit).chars().count() <= LONGEST_UNIT && !is_named(unit)) || unit::is_known(unit);
    // Nearly every row holds numbers, and that is told soonest.
    if filled.iter().any(is_number) {
        return None;
    }
    let sure = filled.iter().filter(is_sure).count();
    if sure == 0 || 2 * sure < filled.len() || !filled.iter().all(fits) {
        return None;
    }
    Some(units.into_iter().map(|unit| bare(unit).to_owned()).collect())
}

/// A unit without the brackets around it.
fn bare(unit: &str) -> &str {
    let pairs = [('[', ']'), ('(', ')')];
    let inner = pairs
        .iter()
        .find_map(|(open, close)| unit.strip_prefix(*open)?.strip_suffix(*close));
    inner.map_or(unit, str::trim)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(names: usize, cells: &[&str]) -> Option<Vec<String>> {
        unit_row(names, cells.iter().copied())
    }

    #[test]
    fn rows_of_units_of_several_makers() {
        for (cells, units) in [
            (vec!["", "", "[s]", "[Pa]", "[1]"], vec!["", "", "s", "Pa", "1"]),
            (vec!["(s)", "(mm)", "(N)"], vec!["s", "mm", "N"]),
            (vec!["min", "°C", "mg", "%"], vec!["min", "°C", "mg", "%"]),
            (vec!["\"s\"", "\"N\"", "\"mm\""], vec!["s", "N", "mm"]),
            (vec!["s", "V", "-"], vec!["s", "V", "-"]),
        ] {
            assert_eq!(of(5, &cells).unwrap(), units, "{cells:?}");
        }
    }

    #[test]
    fn names_and_readings_are_no_units() {
        for cells in [
            vec!["Time", "Current", "Voltage"],
            vec!["0.5", "1", "2"],
            vec!["0,5", "", ""],
            vec!["NaN", "s", "V"],
            vec!["", "", ""],
            vec!["s", "a remark on this row", "V"],
            vec!["s", "V", "A", "mm", "N", "Pa"],
        ] {
            assert_eq!(of(5, &cells), None, "{cells:?}");
        }
    }
}
