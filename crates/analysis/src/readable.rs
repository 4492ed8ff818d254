//! Messages of other rooms as people read them.

use ieap_domain::ParameterInfo;
use ieap_domain::number::significant;
use ieap_domain::{UNITS, printed_unit};

/// A message of another room as pages print it: symbols for stored keys, powers of ten for `1.5e4`, a word for `->`.
pub fn readable(message: &str) -> String {
    let words: Vec<String> = message.split(' ').map(readable_word).collect();
    words.join(" ").replace("Ω cm2", "Ω cm²")
}

/// How documents spell what pages have signs for, beside symbols of parameters and their units.
const SPELLED: [(&str, &str); 4] = [("->", "to"), ("+-", "±"), ("Ohm", "Ω"), ("kOhm", "kΩ")];

/// The sign of a spelled word.
fn sign(word: &str) -> Option<&'static str> {
    let spelled = SPELLED.iter().find(|(spelled, _)| *spelled == word);
    let parameter = || ParameterInfo::all().find(|info| info.ascii == word);
    let unit = || UNITS.iter().find(|(_, unit)| *unit == word);
    spelled
        .map(|(_, sign)| *sign)
        .or_else(|| Some(parameter()?.symbol))
        .or_else(|| Some(printed_unit(unit()?.1)))
}

fn readable_word(word: &str) -> String {
    let is_edge = |c: char| matches!(c, '(' | ')' | ',' | ';' | ':' | '.' | '[' | ']');
    let core = word.trim_matches(is_edge);
    let shown = match core {
        _ if let Some(sign) = sign(core) => Some(sign.to_owned()),
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
        let said = "together not: C1 rises from 0.0102 to 0.145 F/cm2, lambda from 1.62e-4 to 0 1/s, R_ss to 1.9 kOhm cm2; 5 +- 2";
        assert_eq!(
            readable(said),
            "together not: C₁ rises from 0.0102 to 0.145 F cm⁻², λ from 1.62·10⁻⁴ to 0 s⁻¹, Rₛₛ to 1.9 kΩ cm²; 5 ± 2"
        );
        // Names of columns and of files stay as they are written.
        assert_eq!(readable("column current_a of e.csv"), "column current_a of e.csv");
    }
}
