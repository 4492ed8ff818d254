//! Numbers as machines read them, in SVG, CSV, names of files and keys: ASCII signs, and an `e` before a power of ten.

/// A fixed number of decimals: `-0.70`.
pub fn digits(value: f64, decimals: usize) -> String {
    format!("{value:.decimals$}")
}

/// A fixed number of decimals and a power of ten: `-7.0e-5`.
pub fn scientific(value: f64, decimals: usize) -> String {
    format!("{value:.decimals$e}")
}

/// The shortest text with a power of ten that reads back the same: `9.96921e36`.
pub fn exact(value: f64) -> String {
    format!("{value:e}")
}

/// The number itself, rounded to `digits` significant digits.
pub fn to_digits(value: f64, digits: usize) -> f64 {
    let rounded = scientific(value, digits.saturating_sub(1));
    rounded.parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn machines_read_ascii() {
        assert_eq!(digits(-0.7, 2), "-0.70");
        assert_eq!(scientific(-7e-5, 1), "-7.0e-5");
        assert_eq!(exact(9.96921e36), "9.96921e36");
        assert_eq!(to_digits(-123_456.0, 3), -123_000.0);
        assert_eq!(to_digits(0.0, 3), 0.0);
        assert!(to_digits(f64::NAN, 3).is_nan());
    }
}
