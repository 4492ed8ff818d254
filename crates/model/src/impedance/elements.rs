//! The elements of circuits: their symbols, their parameters, and what each lets through.

use ieap_numerics::complex::Complex;

/// How a parameter is searched.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// A resistance, by its logarithm.
    Resistance,
    /// A capacitance, or the size of an element that stores, by its logarithm.
    Storage,
    /// An inductance, by its logarithm.
    Inductance,
    /// A time constant, by its logarithm.
    Time,
    /// An exponent between [`LEAST_EXPONENT`] and 1.
    Exponent,
}

/// Lowest exponent of a constant-phase element: 0.5 is a Warburg element, 0 a resistor.
pub const LEAST_EXPONENT: f64 = 0.3;

/// What an element has in the form that is natural to it: a capacitor without capacitance, or a resistor that is a cut,
/// is zero in one form only.
#[derive(Debug, Clone, Copy)]
pub enum Immittance {
    /// Impedance, Ohm.
    Impedance(Complex),
    /// Admittance, S.
    Admittance(Complex),
}

impl Immittance {
    /// As impedance, Ohm.
    pub fn impedance(self) -> Complex {
        match self {
            Immittance::Impedance(z) => z,
            Immittance::Admittance(y) => y.reciprocal(),
        }
    }

    /// As admittance, S.
    pub fn admittance(self) -> Complex {
        match self {
            Immittance::Impedance(z) => z.reciprocal(),
            Immittance::Admittance(y) => y,
        }
    }
}

/// A kind of element.
#[derive(Debug)]
pub struct Element {
    /// Its symbol, as impedance.py writes it.
    pub symbol: &'static str,
    /// What it is, in words.
    pub title: &'static str,
    /// Its parameters: the end of the key, the unit as pages print it, how it is searched.
    pub parameters: &'static [(&'static str, &'static str, Scale)],
    /// What it lets through at an angular frequency, 1/s.
    pub immittance: fn(&[f64], f64) -> Immittance,
}

/// Every element.
pub static ELEMENTS: [Element; 8] = [
    Element {
        symbol: "R",
        title: "resistor",
        parameters: &[("ohm", "Ω", Scale::Resistance)],
        immittance: |v, _| Immittance::Impedance(Complex::new(v[0], 0.0)),
    },
    Element {
        symbol: "C",
        title: "capacitor",
        parameters: &[("f", "F", Scale::Storage)],
        immittance: |v, w| Immittance::Admittance(Complex::new(0.0, w * v[0])),
    },
    Element {
        symbol: "L",
        title: "inductor",
        parameters: &[("h", "H", Scale::Inductance)],
        immittance: |v, w| Immittance::Impedance(Complex::new(0.0, w * v[0])),
    },
    Element {
        symbol: "CPE",
        title: "constant-phase element, admittance Q (jω)ⁿ",
        parameters: &[
            ("s_sn", "S sⁿ", Scale::Storage),
            ("exponent", "", Scale::Exponent),
        ],
        immittance: |v, w| Immittance::Admittance(Complex::power_of_imaginary(w, v[1]) * v[0]),
    },
    Element {
        symbol: "W",
        title: "Warburg element, diffusion into a layer without end, admittance Y (jω)^½",
        parameters: &[("s_s05", "S s^½", Scale::Storage)],
        immittance: |v, w| Immittance::Admittance(Complex::power_of_imaginary(w, 0.5) * v[0]),
    },
    Element {
        symbol: "Wo",
        title: "Warburg element of finite length whose end is closed: a line of total resistance R and capacitance C",
        parameters: &[("ohm", "Ω", Scale::Resistance), ("f", "F", Scale::Storage)],
        immittance: |v, w| line(v[0], Complex::power_of_imaginary(w * v[0] * v[1], 0.5)),
    },
    Element {
        symbol: "Ws",
        title: "Warburg element of finite length whose end conducts: resistance R, time of diffusion τ",
        parameters: &[("ohm", "Ω", Scale::Resistance), ("s", "s", Scale::Time)],
        immittance: |v, w| {
            let root = Complex::power_of_imaginary(w * v[1], 0.5);
            Immittance::Impedance(root.tanh() / root * v[0])
        },
    },
    Element {
        symbol: "TLMQ",
        title: "porous electrode (de Levie): a line of ionic resistance R whose wall is a constant-phase element Q, n",
        parameters: &[
            ("ohm", "Ω", Scale::Resistance),
            ("s_sn", "S sⁿ", Scale::Storage),
            ("exponent", "", Scale::Exponent),
        ],
        immittance: |v, w| {
            let size = (v[0] * v[1]).powf(v[2].recip());
            line(v[0], Complex::power_of_imaginary(w * size, 0.5 * v[2]))
        },
    },
];

/// A line of total resistance R whose end is closed: admittance (root / R) tanh(root), with root = (R Y)^(1/2) and Y the
/// admittance of its wall (de Levie 1963).
fn line(resistance_ohm: f64, root: Complex) -> Immittance {
    Immittance::Admittance(root * root.tanh() * resistance_ohm.recip())
}
