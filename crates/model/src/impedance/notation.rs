//! A circuit as a text, in the notation of impedance.py (Murbach and others, J. Open Source Softw. 5, 2349, 2020):
//! `R0-p(R1,CPE1)-W1` is a resistor before a resistor beside a constant-phase element before a Warburg element.

use super::elements::{ELEMENTS, Element};
use super::tree::{CircuitParameter, Part, SpectrumCircuit};

/// Longest text of a circuit, characters; a spectrum determines the elements of a shorter one at best.
pub const LONGEST: usize = 120;

/// Why a text is no circuit: where, what was found, what was needed.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("the circuit \"{text}\", character {character}: found {found}; {needed}")]
pub struct NotationError {
    /// The text.
    pub text: String,
    /// Where, from 1.
    pub character: usize,
    /// What stands there.
    pub found: String,
    /// What was needed.
    pub needed: String,
}

/// The circuit of a text. Its id is the text without spaces.
///
/// # Errors
/// The text is no circuit.
pub fn circuit(text: &str) -> Result<SpectrumCircuit, NotationError> {
    let characters: Vec<char> = text.chars().collect();
    let mut reader = Reader {
        text,
        characters,
        at: 0,
        names: Vec::new(),
        parameters: Vec::new(),
    };
    if reader.characters.len() > LONGEST {
        reader.at = LONGEST;
        let found = format!("{} characters", reader.characters.len());
        return Err(reader.error(found, format!("{LONGEST} at most are read")));
    }
    let root = reader.series()?;
    if reader.peek().is_some() {
        return Err(reader.unexpected("`-` and a further element, or the end, is needed"));
    }
    let id: String = text.chars().filter(|c| !c.is_whitespace()).collect();
    Ok(SpectrumCircuit {
        title: format!("the circuit {id}"),
        notation: id.clone(),
        id,
        parameters: reader.parameters,
        root,
        derived: Vec::new(),
    })
}

struct Reader<'a> {
    text: &'a str,
    characters: Vec<char>,
    at: usize,
    names: Vec<String>,
    parameters: Vec<CircuitParameter>,
}

impl Reader<'_> {
    /// The next character that is no space.
    fn peek(&mut self) -> Option<char> {
        while self.characters.get(self.at).is_some_and(|c| c.is_whitespace()) {
            self.at += 1;
        }
        self.characters.get(self.at).copied()
    }

    fn takes(&mut self, wanted: char) -> bool {
        let is_there = self.peek() == Some(wanted);
        self.at += usize::from(is_there);
        is_there
    }

    fn series(&mut self) -> Result<Part, NotationError> {
        let mut parts = vec![self.part()?];
        while self.takes('-') {
            parts.push(self.part()?);
        }
        Ok(one_or(parts, Part::Series))
    }

    fn part(&mut self) -> Result<Part, NotationError> {
        if self.peek() != Some('p') {
            return self.element();
        }
        self.at += 1;
        if !self.takes('(') {
            return Err(self.unexpected("`(` is needed after p: p(R1,C1) sets R1 beside C1"));
        }
        let mut parts = vec![self.series()?];
        while self.takes(',') {
            parts.push(self.series()?);
        }
        if parts.len() < 2 {
            return Err(
                self.unexpected("`,` and what stands beside it is needed: p(R1,C1) sets R1 beside C1")
            );
        }
        if !self.takes(')') {
            return Err(self.unexpected("`-`, `,` or the `)` of p( is needed"));
        }
        Ok(Part::Parallel(parts))
    }

    fn element(&mut self) -> Result<Part, NotationError> {
        self.peek();
        let start = self.at;
        let is_of_name = |c: &char| c.is_ascii_alphanumeric() || *c == '_';
        let name: String = self.characters[start..]
            .iter()
            .take_while(|c| is_of_name(c))
            .collect();
        if name.is_empty() {
            return Err(self.unexpected("an element such as R0 or CPE1, or p(..,..), is needed"));
        }
        let Some(element) = element_of(&name) else {
            let known: Vec<&str> = ELEMENTS.iter().map(|element| element.symbol).collect();
            let needed = format!(
                "known elements are {}, each with a number: R0, CPE1",
                known.join(", ")
            );
            return Err(self.error(format!("`{name}`"), needed));
        };
        let stem = name.replace('_', "").to_lowercase();
        if self.names.contains(&stem) {
            return Err(self.error(
                format!("`{name}` again"),
                "give every element its own number".to_owned(),
            ));
        }
        let first = self.parameters.len();
        let parameters = element.parameters.iter();
        self.parameters
            .extend(parameters.map(|(unit, _, scale)| CircuitParameter {
                key: format!("{stem}_{unit}"),
                scale: *scale,
            }));
        self.names.push(stem);
        self.at += name.len();
        Ok(Part::Element(element, first))
    }

    fn unexpected(&mut self, needed: &str) -> NotationError {
        let found = self.peek().map_or("its end".to_owned(), |c| format!("`{c}`"));
        self.error(found, needed.to_owned())
    }

    fn error(&self, found: String, needed: String) -> NotationError {
        NotationError {
            text: self.text.chars().take(LONGEST).collect(),
            character: self.at + 1,
            found,
            needed,
        }
    }
}

/// The element of a name: its letters are the symbol, and a number or `_` and a word follow.
fn element_of(name: &str) -> Option<&'static Element> {
    let symbol = name.split('_').next().unwrap_or(name);
    let symbol = symbol.trim_end_matches(|c: char| c.is_ascii_digit());
    ELEMENTS.iter().find(|element| element.symbol == symbol)
}

fn one_or(mut parts: Vec<Part>, several: fn(Vec<Part>) -> Part) -> Part {
    match parts.len() {
        1 => parts.remove(0),
        _ => several(parts),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ieap_numerics::complex::Complex;

    #[test]
    fn a_text_is_the_circuit_that_it_says() {
        let found = circuit(" R0 - p(R1, CPE1) - W1 ").unwrap();
        assert_eq!(found.id, "R0-p(R1,CPE1)-W1");
        let keys: Vec<&str> = found.parameters.iter().map(|p| p.key.as_str()).collect();
        assert_eq!(
            keys,
            ["r0_ohm", "r1_ohm", "cpe1_s_sn", "cpe1_exponent", "w1_s_s05"]
        );
    }

    #[test]
    fn numbers_of_impedance_py() {
        // impedance.py 1.7.1, CustomCircuit(text).predict([0.02, 1, 250]); its Wo and Ws take a resistance and a time
        // R C, its W a resistance 1 / (Y 2^0.5).
        for (text, values, expected) in [
            (
                "R0-p(R1,CPE1)-W1",
                &[50.0, 900.0, 2e-4, 0.8, 0.01][..],
                [
                    (1.139121678973e3, -2.281455200113e2),
                    (6.111955875399e2, -3.478194019134e2),
                    (5.624041387087e1, -1.484767943490e1),
                ],
            ),
            (
                "L0-R0-p(C1,R1-Wo1)",
                &[1e-3, 20.0, 3e-3, 100.0, 400.0, 0.02],
                [
                    (1.937738867342e2, -3.658676788682e2),
                    (3.395789407677e1, -4.377215362084e1),
                    (2.000043892148e1, 1.358601446525),
                ],
            ),
            (
                "R0-Ws1-TLMQ1",
                &[20.0, 300.0, 2.5, 150.0, 5e-3, 0.9],
                [
                    (5.683867226798e2, -1.308802776431e3),
                    (1.235094970697e2, -1.014981130296e2),
                    (2.818636404084e1, -7.485772355255),
                ],
            ),
        ] {
            let found = circuit(text).unwrap();
            for (hz, (re, im)) in [0.02, 1.0, 250.0].into_iter().zip(expected) {
                let own = found.impedance(values, hz);
                let told = Complex::new(re, im);
                assert!(
                    (own - told).magnitude() < 1e-9 * told.magnitude(),
                    "{text} {hz}: {own:?}"
                );
            }
        }
    }

    #[test]
    fn errors_tell_where_what_and_what_was_needed() {
        for (text, character, found, needed) in [
            ("", 1, "its end", "an element"),
            ("R0-", 4, "its end", "an element"),
            ("R0-p(R1)", 8, "`)`", "stands beside"),
            ("R0-p(R1,C1", 11, "its end", "`)`"),
            ("R0-p R1", 6, "`R`", "`(`"),
            (
                "R0-Gs1",
                4,
                "`Gs1`",
                "known elements are R, C, L, CPE, W, Wo, Ws, TLMQ",
            ),
            ("R1-p(R1,C1)", 6, "`R1` again", "its own number"),
            ("R0)C1", 3, "`)`", "the end"),
        ] {
            let error = circuit(text).unwrap_err();
            assert_eq!(
                (error.character, error.found.as_str()),
                (character, found),
                "{text}"
            );
            assert!(error.needed.contains(needed), "{text}: {error}");
        }
        assert!(
            circuit(&"R1-".repeat(200))
                .unwrap_err()
                .found
                .contains("600 characters")
        );
    }

    #[test]
    fn parts_that_are_alike_may_change_places() {
        let found = circuit("R0-p(R1,CPE1)-p(R2,CPE2)-p(C3-R3,C4-R4,L1)").unwrap();
        let groups = found.root.exchangeable();
        let sizes: Vec<usize> = groups.iter().map(Vec::len).collect();
        assert_eq!(sizes, [2, 2]);
        assert_eq!(groups[0][1].places(), [4, 5, 6]);
    }
}
