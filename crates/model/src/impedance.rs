//! Circuits that an impedance spectrum is fitted with: those of the thesis's figures 7 and 8, and those in which the
//! capacitor is spread out (constant-phase element, Warburg element).
//!
//! The impedances are those of the whole sample, Ohm and F. The chains stand in parallel with each other and with
//! the steady-state resistance R_ss, as in [`super::circuit`].

use std::f64::consts::TAU;

use ieap_numerics::complex::Complex;

/// How a parameter is searched.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// A resistance, by its logarithm.
    Resistance,
    /// A capacitance, or the size of an element that stores, by its logarithm.
    Storage,
    /// An exponent between [`LEAST_EXPONENT`] and 1.
    Exponent,
}

/// Lowest exponent of a constant-phase element: 0.5 is a Warburg element, 0 a resistor.
pub const LEAST_EXPONENT: f64 = 0.3;

/// A parameter of a circuit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CircuitParameter {
    /// Key with the unit, `r1_ohm`.
    pub key: &'static str,
    /// Symbol with the unit, as pages print it.
    pub label: &'static str,
    /// How it is searched.
    pub scale: Scale,
}

/// A circuit.
pub struct SpectrumCircuit {
    /// Stable id, that of the fit model where there is one of the same circuit.
    pub id: &'static str,
    /// What it is, in words.
    pub title: &'static str,
    /// Its parameters.
    pub parameters: &'static [CircuitParameter],
    /// The admittance beside R_ss, S, at an angular frequency, 1/s.
    admittance: fn(&[f64], f64) -> Complex,
    /// Capacitance at the longest times, F; none where it has no limit.
    pub total_capacitance_f: fn(&[f64]) -> Option<f64>,
    /// Resistance at the highest frequencies without R_ss, Ohm.
    pub fastest_resistance_ohm: fn(&[f64]) -> f64,
}

impl SpectrumCircuit {
    /// Impedance at a frequency, Hz, with parameters in their order, Ohm.
    pub fn impedance(&self, values: &[f64], frequency_hz: f64) -> Complex {
        let leak = Complex::new(values.last().copied().unwrap_or(f64::INFINITY).recip(), 0.0);
        ((self.admittance)(values, TAU * frequency_hz) + leak).reciprocal()
    }
}

const fn resistance(key: &'static str, label: &'static str) -> CircuitParameter {
    let scale = Scale::Resistance;
    CircuitParameter { key, label, scale }
}

const fn storage(key: &'static str, label: &'static str) -> CircuitParameter {
    let scale = Scale::Storage;
    CircuitParameter { key, label, scale }
}

const R1: CircuitParameter = resistance("r1_ohm", "R₁ (Ω)");
const C1: CircuitParameter = storage("c1_f", "C₁ (F)");
const R2: CircuitParameter = resistance("r2_ohm", "R₂ (Ω)");
const C2: CircuitParameter = storage("c2_f", "C₂ (F)");
const RSS: CircuitParameter = resistance("rss_ohm", "R_ss (Ω)");

/// Every circuit. R_ss is the last parameter of each.
pub static CIRCUITS: [SpectrumCircuit; 5] = [
    SpectrumCircuit {
        id: "lumped-1",
        title: "one R-C chain beside R_ss (figure 7G of the thesis; 7B, 7F are the same)",
        parameters: &[R1, C1, RSS],
        admittance: |v, w| chain(v[0], v[1], w),
        total_capacitance_f: |v| Some(v[1]),
        fastest_resistance_ohm: |v| v[0],
    },
    SpectrumCircuit {
        id: "lumped-2",
        title: "two R-C chains beside R_ss (figure 8 of the thesis)",
        parameters: &[R1, C1, R2, C2, RSS],
        admittance: |v, w| chain(v[0], v[1], w) + chain(v[2], v[3], w),
        total_capacitance_f: |v| Some(v[1] + v[3]),
        fastest_resistance_ohm: |v| (v[0].recip() + v[2].recip()).recip(),
    },
    SpectrumCircuit {
        id: "constant-phase",
        title: "a resistor and a constant-phase element beside R_ss",
        parameters: &[
            R1,
            storage("cpe_s_sn", "Q (S sⁿ)"),
            CircuitParameter {
                key: "cpe_exponent",
                label: "n",
                scale: Scale::Exponent,
            },
            RSS,
        ],
        admittance: |v, w| behind(v[0], Complex::power_of_imaginary(w, v[2]) * v[1]),
        total_capacitance_f: |_| None,
        fastest_resistance_ohm: |v| v[0],
    },
    SpectrumCircuit {
        id: "warburg-finite",
        title: "a resistor and a Warburg element of finite length, closed at its end (a porous electrode), beside R_ss",
        parameters: &[
            R1,
            resistance("rw_ohm", "R_W (Ω)"),
            storage("cw_f", "C_W (F)"),
            RSS,
        ],
        admittance: |v, w| behind(v[0], line(v[1], v[2], w)),
        total_capacitance_f: |v| Some(v[2]),
        fastest_resistance_ohm: |v| v[0],
    },
    SpectrumCircuit {
        id: "warburg-parallel",
        title: "a resistor before a capacitor with a Warburg element in parallel, beside R_ss",
        parameters: &[R1, C1, storage("warburg_s_s05", "Y_W (S s^½)"), RSS],
        admittance: |v, w| {
            let stored = Complex::new(0.0, w * v[1]) + Complex::power_of_imaginary(w, 0.5) * v[2];
            behind(v[0], stored)
        },
        total_capacitance_f: |_| None,
        fastest_resistance_ohm: |v| v[0],
    },
];

/// The circuit of that id.
pub fn spectrum_circuit(id: &str) -> Option<&'static SpectrumCircuit> {
    CIRCUITS.iter().find(|circuit| circuit.id == id)
}

/// A resistance in series with an admittance, as an admittance.
fn behind(resistance_ohm: f64, admittance: Complex) -> Complex {
    admittance / (Complex::ONE + admittance * resistance_ohm)
}

fn chain(resistance_ohm: f64, capacitance_f: f64, w: f64) -> Complex {
    behind(resistance_ohm, Complex::new(0.0, w * capacitance_f))
}

/// Admittance of a line of total resistance R and capacitance C whose end is closed: (root / R) tanh(root) with
/// root = (j w R C)^(1/2) (de Levie 1963).
fn line(resistance_ohm: f64, capacitance_f: f64, w: f64) -> Complex {
    let root = Complex::power_of_imaginary(w * resistance_ohm * capacitance_f, 0.5);
    root * root.tanh() * resistance_ohm.recip()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::circuit::EquivalentCircuit;
    use crate::lumped::Branch;

    fn close(a: Complex, b: Complex, part: f64) -> bool {
        (a - b).magnitude() <= part * b.magnitude()
    }

    fn impedance(id: &str, values: &[f64], hz: f64) -> Complex {
        spectrum_circuit(id).unwrap().impedance(values, hz)
    }

    #[test]
    fn the_chains_are_those_that_the_step_is_fitted_with() {
        let branch = |r, c| Branch {
            resistance_ohm_cm2: r,
            capacitance_f_per_cm2: c,
        };
        let both = EquivalentCircuit {
            branches: vec![branch(20.0, 0.05), branch(90.0, 0.2)],
            steady_state_resistance_ohm_cm2: 4000.0,
        };
        for hz in [1e-4, 0.01, 0.3, 10.0, 1e4] {
            let told = both.impedance(TAU * hz);
            let told = Complex::new(told.real_ohm_cm2, told.imaginary_ohm_cm2);
            let own = impedance("lumped-2", &[20.0, 0.05, 90.0, 0.2, 4000.0], hz);
            assert!(close(own, told, 1e-12), "{hz} Hz");
        }
        let alone = impedance("lumped-1", &[20.0, 0.05, f64::INFINITY], 0.5);
        assert!(close(alone, Complex::new(20.0, -1.0 / (TAU * 0.5 * 0.05)), 1e-12));
    }

    #[test]
    fn a_constant_phase_of_exponent_one_is_a_capacitor_and_of_a_half_a_warburg_element() {
        for hz in [0.01, 1.0, 100.0] {
            let capacitor = impedance("lumped-1", &[7.0, 0.02, 900.0], hz);
            let cpe = impedance("constant-phase", &[7.0, 0.02, 1.0, 900.0], hz);
            assert!(close(cpe, capacitor, 1e-12));
            let half = impedance("constant-phase", &[7.0, 0.02, 0.5, 900.0], hz);
            let warburg = impedance("warburg-parallel", &[7.0, 0.0, 0.02, 900.0], hz);
            assert!(close(half, warburg, 1e-12));
        }
    }

    #[test]
    fn the_line_is_the_limit_of_a_ladder_of_resistors_and_capacitors() {
        // A ladder of 4000 equal parts, seen from its open end.
        let (r, c, parts) = (50.0, 0.1, 4000);
        for hz in [1e-3, 0.05, 1.0] {
            let step_c = Complex::new(0.0, TAU * hz * c / f64::from(parts));
            let mut seen = Complex::ZERO;
            for _ in 0..parts {
                seen = behind(r / f64::from(parts), seen + step_c);
            }
            let line = impedance("warburg-finite", &[3.0, r, c, f64::INFINITY], hz);
            let ladder = Complex::new(3.0, 0.0) + seen.reciprocal();
            assert!(close(line, ladder, 1e-3), "{hz} Hz: {line:?} {ladder:?}");
        }
        // Slow enough, all of it charges: R/3 and C in series.
        let slow = impedance("warburg-finite", &[3.0, r, c, f64::INFINITY], 1e-6);
        assert!((slow.re - 3.0 - r / 3.0).abs() < 1e-3);
        assert!((slow.im * TAU * 1e-6 * c + 1.0).abs() < 1e-6);
    }
}
