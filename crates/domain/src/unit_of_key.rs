//! The unit that a stored key or a column's name ends in: `r1_ohm_cm2` is in Ohm cm2.

/// Endings of names with the unit that they stand for; the first that fits holds, so longer ones stand before shorter ones.
pub const UNITS: [(&str, &str); 47] = [
    ("_a_sqrt_s_per_v_cm2", "A sqrt(s)/(V cm2)"),
    ("_a_per_v_cm2", "A/(V cm2)"),
    ("_f_per_cm2", "F/cm2"),
    ("_a_per_cm2", "A/cm2"),
    ("_c_per_cm2", "C/cm2"),
    ("_s_per_cm2", "S/cm2"),
    ("_cm2_per_c", "cm2/C"),
    ("_cm2_per_j", "cm2/J"),
    ("_cm_per_c2", "1/(C2 cm)"),
    ("_ohm_per_sq", "Ohm/sq"),
    ("_ohm_cm2", "Ohm cm2"),
    ("_per_c_cm", "1/(C cm)"),
    ("_per_v2_cm", "1/(V2 cm)"),
    ("_per_v_cm", "1/(V cm)"),
    ("_per_cm_v", "1/(cm V)"),
    ("_per_v2", "1/V2"),
    ("_per_cm", "1/cm"),
    ("_per_c", "1/C"),
    ("_per_h", "1/h"),
    ("_per_s", "1/s"),
    ("_per_v", "1/V"),
    ("_v_s_cm", "V s cm"),
    ("_percent", "%"),
    ("_degree", "degree"),
    ("_bytes", "bytes"),
    ("_cm2", "cm2"),
    ("_mpa", "MPa"),
    ("_ohm", "Ohm"),
    ("_ppm", "ppm"),
    ("_rad", "rad"),
    ("_cm", "cm"),
    ("_hz", "Hz"),
    ("_kg", "kg"),
    ("_mm", "mm"),
    ("_mn", "mN"),
    ("_ms", "ms"),
    ("_ns", "ns"),
    ("_pa", "Pa"),
    ("_px", "px"),
    ("_um", "µm"),
    ("_us", "µs"),
    ("_a", "A"),
    ("_c", "°C"),
    ("_h", "h"),
    ("_s", "s"),
    ("_v", "V"),
    ("_w", "W"),
];

/// Units that pages and tables for people write otherwise than keys and documents do, which are in ASCII.
const SIGNS: [(&str, &str); 24] = [
    ("A sqrt(s)/(V cm2)", "A s^½ V⁻¹ cm⁻²"),
    ("A/(V cm2)", "A V⁻¹ cm⁻²"),
    ("F/cm2", "F cm⁻²"),
    ("A/cm2", "A cm⁻²"),
    ("C/cm2", "C cm⁻²"),
    ("S/cm2", "S cm⁻²"),
    ("cm2/C", "cm² C⁻¹"),
    ("cm2/J", "cm² J⁻¹"),
    ("1/(C2 cm)", "C⁻² cm⁻¹"),
    ("Ohm/sq", "Ω/sq"),
    ("Ohm cm2", "Ω cm²"),
    ("1/(C cm)", "C⁻¹ cm⁻¹"),
    ("1/(V2 cm)", "V⁻² cm⁻¹"),
    ("1/(V cm)", "V⁻¹ cm⁻¹"),
    ("1/(cm V)", "cm⁻¹ V⁻¹"),
    ("1/V2", "V⁻²"),
    ("1/cm", "cm⁻¹"),
    ("1/C", "C⁻¹"),
    ("1/h", "h⁻¹"),
    ("1/s", "s⁻¹"),
    ("1/V", "V⁻¹"),
    ("cm2", "cm²"),
    ("Ohm", "Ω"),
    ("degree", "°"),
];

/// A unit as pages and tables for people write it: `Ω cm²` of `Ohm cm2`.
pub fn printed_unit(unit: &'static str) -> &'static str {
    let written = SIGNS.iter().find(|(spelled, _)| *spelled == unit);
    written.map_or(unit, |(_, signs)| signs)
}

/// What columns of tables add to a name whose unit they share.
const SHARE: [&str; 7] = [
    "_standard_error",
    "_standard_deviation",
    "_low_95",
    "_high_95",
    "_mean",
    "_blob",
    "_readings",
];

/// The unit that a key ends in; none where it ends in none: a pure number, a count, words.
pub fn unit_of_key(key: &str) -> Option<&'static str> {
    let stripped = SHARE.iter().find_map(|ending| key.strip_suffix(ending));
    parted(stripped.unwrap_or(key)).map(|(_, unit)| unit)
}

/// A key without its unit, and that unit; none where it ends in none.
pub fn parted(key: &str) -> Option<(&str, &'static str)> {
    UNITS
        .iter()
        .find_map(|(ending, unit)| Some((key.strip_suffix(ending)?, *unit)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Quantity;

    #[test]
    fn the_longest_ending_holds() {
        assert_eq!(unit_of_key("change_cm2_per_c"), Some("cm2/C"));
        assert_eq!(unit_of_key("alpha_per_c_cm_standard_error"), Some("1/(C cm)"));
        assert_eq!(unit_of_key("temperature_c"), Some("°C"));
        assert_eq!(unit_of_key("r_squared_current"), None);
        for (at, (ending, _)) in UNITS.iter().enumerate() {
            let earlier = UNITS[..at].iter().find(|(earlier, _)| ending.ends_with(earlier));
            assert!(earlier.is_none(), "{ending} never holds");
        }
    }

    #[test]
    fn columns_of_quantities_end_in_their_units() {
        for quantity in Quantity::ALL
            .into_iter()
            .filter(|quantity| *quantity != Quantity::Other)
        {
            assert_eq!(
                unit_of_key(quantity.column()).unwrap_or(""),
                quantity.unit(),
                "{}",
                quantity.column()
            );
        }
    }
}
