//! Messages of other rooms as people read them.

use crate::parameters::ParameterInfo;
use ieap_domain::number::significant;

/// A message of another room as pages print it: symbols for stored keys, powers of ten for `1.5e4`, a word for `->`.
pub fn readable(message: &str) -> String {
    let words: Vec<String> = message.split(' ').map(readable_word).collect();
    words.join(" ").replace("Ω cm2", "Ω cm²")
}

/// How documents spell what pages have signs for.
const SPELLED: [(&str, &str); 16] = [
    ("->", "to"),
    ("+-", "±"),
    ("R1", "R₁"),
    ("R2", "R₂"),
    ("R_ss", "Rₛₛ"),
    ("C1", "C₁"),
    ("C2", "C₂"),
    ("alpha", "α"),
    ("lambda", "λ"),
    ("uF/cm2", "µF cm⁻²"),
    ("mF/cm2", "mF cm⁻²"),
    ("F/cm2", "F cm⁻²"),
    ("Ohm", "Ω"),
    ("kOhm", "kΩ"),
    ("1/s", "s⁻¹"),
    ("1/cm", "cm⁻¹"),
];

fn readable_word(word: &str) -> String {
    let is_edge = |c: char| matches!(c, '(' | ')' | ',' | ';' | ':' | '.' | '[' | ']');
    let core = word.trim_matches(is_edge);
    let shown = match core {
        _ if let Some((_, sign)) = SPELLED.iter().find(|(spelled, _)| *spelled == core) => {
            Some((*sign).to_owned())
        }
        _ if core.contains('_') => ParameterInfo::of(core).map(|info| info.symbol.to_owned()),
        _ if core.contains(['e', 'E']) => {
            let number = core.parse::<f64>().ok().filter(|number| number.is_finite());
            number.map(|number| significant(number, 3))
        }
        _ => None,
    };
    shown.map_or_else(|| word.to_owned(), |shown| word.replacen(core, &shown, 1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_have_symbols_and_powers_of_ten() {
        let said = "rss_ohm_cm2: only a lower bound is known, 1.5494e4; 3.22e6 -> 1584 (tau2_s), off by -1.3167e-5 A";
        assert_eq!(
            readable(said),
            "Rₛₛ: only a lower bound is known, 15500; 3.22·10⁶ to 1584 (τ₂), off by −1.32·10⁻⁵ A"
        );
        let said = "together not: C1 rises from 10.2 to 145 mF/cm2, lambda from 1.62e-4 to 0 1/s, R_ss to 1.9 kOhm cm2; 5 +- 2";
        assert_eq!(
            readable(said),
            "together not: C₁ rises from 10.2 to 145 mF cm⁻², λ from 1.62·10⁻⁴ to 0 s⁻¹, Rₛₛ to 1.9 kΩ cm²; 5 ± 2"
        );
        // Names of columns and of files stay as they are written.
        assert_eq!(readable("column current_a of e.csv"), "column current_a of e.csv");
    }
}
