//! Words, symbols and units in LaTeX that any engine sets.

use crate::visible::one_line;

/// Sub- and superscript characters with what they stand for.
const LOWERED: [(char, &str); 16] = [
    ('₀', "0"),
    ('₁', "1"),
    ('₂', "2"),
    ('₃', "3"),
    ('₄', "4"),
    ('₅', "5"),
    ('₆', "6"),
    ('₇', "7"),
    ('₈', "8"),
    ('₉', "9"),
    ('ₑ', "e"),
    ('ₛ', "s"),
    ('ₜ', "t"),
    ('ₗ', "l"),
    ('ₚ', "p"),
    ('꜀', "c"),
];
const RAISED: [(char, &str); 13] = [
    ('⁰', "0"),
    ('¹', "1"),
    ('²', "2"),
    ('³', "3"),
    ('⁴', "4"),
    ('⁵', "5"),
    ('⁶', "6"),
    ('⁷', "7"),
    ('⁸', "8"),
    ('⁹', "9"),
    ('⁻', "-"),
    ('⁺', "+"),
    ('ⁿ', "n"),
];
/// Characters that stand in mathematics only.
const MATHEMATICS: [(char, &str); 29] = [
    ('α', "\\alpha"),
    ('β', "\\beta"),
    ('γ', "\\gamma"),
    ('δ', "\\delta"),
    ('ε', "\\varepsilon"),
    ('η', "\\eta"),
    ('κ', "\\kappa"),
    ('λ', "\\lambda"),
    ('μ', "\\mu"),
    ('µ', "\\mu"),
    ('σ', "\\sigma"),
    ('τ', "\\tau"),
    ('φ', "\\varphi"),
    ('ω', "\\omega"),
    ('Δ', "\\Delta"),
    ('Ω', "\\Omega"),
    ('∥', "\\parallel"),
    ('×', "\\times"),
    ('·', "\\cdot"),
    ('±', "\\pm"),
    ('−', "-"),
    ('≤', "\\le"),
    ('≥', "\\ge"),
    ('≈', "\\approx"),
    ('∞', "\\infty"),
    ('→', "\\to"),
    ('′', "'"),
    ('″', "''"),
    ('°', "^{\\circ}"),
];

fn found<'a>(list: &'a [(char, &'a str)], character: char) -> Option<&'a str> {
    list.iter()
        .find(|(known, _)| *known == character)
        .map(|(_, latex)| *latex)
}

/// Words in which nothing is a command: special characters escaped, Greek and scripts as mathematics, other
/// characters beyond Latin by their number, since an 8-bit engine would stop at them.
pub fn words(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let text: Vec<char> = one_line(text).chars().collect();
    let mut at = 0;
    while at < text.len() {
        let character = text[at];
        let script = |list: &[(char, &'static str)]| -> Vec<&'static str> {
            text[at..]
                .iter()
                .map_while(|&c| list.iter().find(|(known, _)| *known == c).map(|(_, s)| *s))
                .collect()
        };
        let (lowered, raised) = (script(&LOWERED), script(&RAISED));
        if !lowered.is_empty() || !raised.is_empty() {
            let (sign, list) = if !lowered.is_empty() {
                ('_', lowered)
            } else {
                ('^', raised)
            };
            out += &format!("${sign}{{\\mathrm{{{}}}}}$", list.concat());
            at += list.len();
            continue;
        }
        out += &match character {
            '\\' => "\\textbackslash{}".to_owned(),
            '~' => "\\textasciitilde{}".to_owned(),
            '^' => "\\textasciicircum{}".to_owned(),
            '{' | '}' | '$' | '&' | '#' | '%' | '_' => format!("\\{character}"),
            '<' => "\\textless{}".to_owned(),
            '>' => "\\textgreater{}".to_owned(),
            '|' => "\\textbar{}".to_owned(),
            '"' => "''".to_owned(),
            '–' => "--".to_owned(),
            '—' => "---".to_owned(),
            '…' => "\\dots{}".to_owned(),
            '\u{a0}' | '\u{202f}' => "~".to_owned(),
            '\u{20}'..='\u{7e}' | '\u{a1}'..='\u{17f}' if found(&MATHEMATICS, character).is_none() => {
                character.to_string()
            }
            other => match found(&MATHEMATICS, other) {
                Some(latex) => format!("${latex}$"),
                None => format!("\\texttt{{U+{:04X}}}", other as u32),
            },
        };
        at += 1;
    }
    // Neighbouring pieces of mathematics are one formula.
    out.replace("$$", "")
}

/// The title of a column: a single letter, with or without scripts, is a quantity and set as one.
pub fn symbol(text: &str) -> String {
    let is_script = |c: char| found(&LOWERED, c).or(found(&RAISED, c)).is_some();
    let mut letters = text.chars();
    let begins = letters.next().is_some_and(|c| c.is_ascii_alphabetic());
    if begins && letters.clone().all(is_script) {
        let (letter, scripts) = text.split_at(1);
        format!("${letter}${}", words(scripts)).replace("$$", "")
    } else {
        words(text)
    }
}

/// A unit for `\unit`: `k\Omega.cm^{2}`.
pub fn unit(text: &str) -> String {
    let mut out = String::from("\\unit{");
    let mut raised = false;
    for character in text.chars() {
        let power = found(&RAISED, character);
        if raised && power.is_none() {
            out.push('}');
        }
        if let Some(digit) = power {
            out += if raised { "" } else { "^{" };
            out += digit;
            raised = true;
            continue;
        }
        raised = false;
        match character {
            'Ω' => out += "\\Omega ",
            'µ' | 'μ' => out += "\\micro ",
            '%' => out += "\\%",
            '°' => out += "\\degree ",
            ' ' => out.push('.'),
            plain => out.push(plain),
        }
    }
    if raised {
        out.push('}');
    }
    out.push('}');
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_parameter_and_its_unit_can_be_set() {
        for info in ieap_domain::ParameterInfo::all() {
            let set = symbol(info.symbol) + &unit(info.shown_unit());
            assert!(set.is_ascii() && !set.contains("U+"), "{}: {set}", info.key);
        }
    }

    #[test]
    fn symbols_and_units() {
        assert_eq!(words("Rₛₛ"), "R$_{\\mathrm{ss}}$");
        assert_eq!(words("α"), "$\\alpha$");
        assert_eq!(symbol("Rₛₛ"), "$R_{\\mathrm{ss}}$");
        assert_eq!(symbol("n"), "$n$");
        assert_eq!(symbol("RH"), "RH");
        assert_eq!(unit("kΩ cm²"), "\\unit{k\\Omega .cm^{2}}");
        assert_eq!(unit("C⁻¹ cm⁻¹"), "\\unit{C^{-1}.cm^{-1}}");
        assert_eq!(unit("S sⁿ"), "\\unit{S.s^{n}}");
        assert_eq!(unit("%"), "\\unit{\\%}");
    }

    #[test]
    fn what_people_type_is_no_command() {
        assert_eq!(
            words("50_%~\\x{}"),
            "50\\_\\%\\textasciitilde{}\\textbackslash{}x\\{\\}"
        );
        assert_eq!(words("Nafion® õ 水"), "Nafion® õ \\texttt{U+6C34}");
    }
}
