//! What is known along a strip: maps of curvature over place and time, shapes, curves at places, voltages.

pub mod curves;
pub mod frames;
pub mod key;
pub mod map;
pub mod shapes;
pub mod voltages;

use ieap_domain::number::significant;

/// A time for a key: three digits, no zeros at the end: `0.02 s`, `860 s`.
pub fn seconds(time_s: f64) -> String {
    let text = significant(time_s, 3);
    let short = if text.contains('.') && !text.contains('·') {
        text.trim_end_matches('0').trim_end_matches('.')
    } else {
        &text
    };
    format!("{short} s")
}

/// A place for a key: `5.6 mm`.
pub fn millimetres(position_mm: f64) -> String {
    let rounded = (10.0 * position_mm).round() / 10.0;
    format!("{rounded} mm")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_and_places_are_short() {
        assert_eq!([0.02, 2.0, 859.99].map(seconds), ["0.02 s", "2 s", "860 s"]);
        assert_eq!([5.600_000_1, 14.0].map(millimetres), ["5.6 mm", "14 mm"]);
    }
}
