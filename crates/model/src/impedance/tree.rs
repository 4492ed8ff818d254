//! A circuit as a tree of elements in series and in parallel.

use std::f64::consts::TAU;

use ieap_numerics::complex::Complex;

use super::elements::{ELEMENTS, Element, Immittance, Scale};

/// A part of a circuit.
#[derive(Debug, Clone)]
pub enum Part {
    /// An element, with the place of its first parameter.
    Element(&'static Element, usize),
    /// Parts one after the other.
    Series(Vec<Part>),
    /// Parts beside each other.
    Parallel(Vec<Part>),
}

impl Part {
    /// What it lets through, with the circuit's parameters, at an angular frequency, 1/s.
    pub fn immittance(&self, values: &[f64], w: f64) -> Immittance {
        match self {
            Part::Element(element, first) => {
                (element.immittance)(&values[*first..*first + element.parameters.len()], w)
            }
            Part::Series(parts) => Immittance::Impedance((parts.iter()).fold(Complex::ZERO, |sum, part| {
                sum + part.immittance(values, w).impedance()
            })),
            Part::Parallel(parts) => {
                Immittance::Admittance((parts.iter()).fold(Complex::ZERO, |sum, part| {
                    sum + part.immittance(values, w).admittance()
                }))
            }
        }
    }

    /// Places of its parameters.
    pub fn places(&self) -> Vec<usize> {
        match self {
            Part::Element(element, first) => (*first..*first + element.parameters.len()).collect(),
            Part::Series(parts) | Part::Parallel(parts) => parts.iter().flat_map(Part::places).collect(),
        }
    }

    /// Whether it is built of the same elements in the same way.
    pub fn is_like(&self, other: &Part) -> bool {
        match (self, other) {
            (Part::Element(one, _), Part::Element(other, _)) => one.symbol == other.symbol,
            (Part::Series(own), Part::Series(others)) | (Part::Parallel(own), Part::Parallel(others)) => {
                own.len() == others.len() && own.iter().zip(others).all(|(a, b)| a.is_like(b))
            }
            _ => false,
        }
    }

    /// Groups of parts that are alike and stand beside each other: they may change places without a change of the whole.
    pub fn exchangeable(&self) -> Vec<Vec<&Part>> {
        let (Part::Series(parts) | Part::Parallel(parts)) = self else {
            return Vec::new();
        };
        let mut groups: Vec<Vec<&Part>> = Vec::new();
        for part in parts {
            match groups.iter_mut().find(|group| group[0].is_like(part)) {
                Some(group) => group.push(part),
                None => groups.push(vec![part]),
            }
        }
        groups.retain(|group| group.len() > 1);
        groups.extend(parts.iter().flat_map(Part::exchangeable));
        groups
    }
}

/// A parameter of a circuit.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CircuitParameter {
    /// Key with the unit, `r1_ohm`.
    pub key: String,
    /// How it is searched.
    pub scale: Scale,
}

/// A number that follows from the parameters of a circuit; none where it has no limit.
pub type Derived = (&'static str, fn(&[f64]) -> f64);

/// A circuit.
#[derive(Debug, Clone)]
pub struct SpectrumCircuit {
    /// Stable id: that of the fit model where there is one of the same circuit, else the circuit as a text.
    pub id: String,
    /// What it is, in words.
    pub title: String,
    /// The circuit as a text, [`super::circuit`].
    pub notation: String,
    /// Its parameters.
    pub parameters: Vec<CircuitParameter>,
    /// How its elements stand.
    pub root: Part,
    /// What follows from its parameters.
    pub derived: Vec<Derived>,
}

/// Key of the inductance of the leads, H.
pub const LEADS: &str = "l_h";

impl SpectrumCircuit {
    /// The same behind the inductance of its leads, the last parameter.
    pub fn behind_leads(&self) -> SpectrumCircuit {
        let mut own = self.clone();
        let inductors = ELEMENTS.iter().filter(|element| element.symbol == "L");
        let leads = inductors.map(|inductor| Part::Element(inductor, self.parameters.len()));
        own.root = Part::Series(leads.chain([self.root.clone()]).collect());
        own.notation = format!("L-{}", self.notation);
        own.title += ", behind the inductance of its leads";
        own.parameters.push(CircuitParameter {
            key: LEADS.to_owned(),
            scale: Scale::Inductance,
        });
        own
    }

    /// Impedance at a frequency, Hz, with parameters in their order, Ohm.
    pub fn impedance(&self, values: &[f64], frequency_hz: f64) -> Complex {
        self.root.immittance(values, TAU * frequency_hz).impedance()
    }
}
