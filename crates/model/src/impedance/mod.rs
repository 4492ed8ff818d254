//! Circuits that an impedance spectrum is fitted with: those of the thesis's figures 7 and 8, those in which the
//! capacitor is spread out (constant-phase element, Warburg element), and any other as a text.
//!
//! The impedances are those of the whole sample, Ohm and F.

mod elements;
mod notation;
mod tree;

use std::sync::LazyLock;

pub use elements::{ELEMENTS, Element, Immittance, LEAST_EXPONENT, Scale};
pub use notation::{LONGEST, NotationError, circuit};
pub use tree::{CircuitParameter, Derived, LEADS, Part, SpectrumCircuit};

/// A circuit that every spectrum is fitted with. Its chains stand beside the steady-state resistance R_ss, the last
/// parameter of each, as in [`super::circuit`].
struct BuiltIn {
    id: &'static str,
    title: &'static str,
    notation: &'static str,
    keys: &'static [&'static str],
    derived: &'static [Derived],
}

/// Capacitance at the longest times, F.
const TOTAL: &str = "c_total_f";
/// Resistance at the highest frequencies without R_ss, Ohm.
const FASTEST: &str = "r_parallel_ohm";

const BUILT_IN: [BuiltIn; 5] = [
    BuiltIn {
        id: "lumped-1",
        title: "one R-C chain beside R_ss (figure 7G of the thesis; 7B, 7F are the same)",
        notation: "p(R1-C1,R_ss)",
        keys: &["r1_ohm", "c1_f", "rss_ohm"],
        derived: &[(TOTAL, |v| v[1]), (FASTEST, |v| v[0])],
    },
    BuiltIn {
        id: "lumped-2",
        title: "two R-C chains beside R_ss (figure 8 of the thesis)",
        notation: "p(R1-C1,R2-C2,R_ss)",
        keys: &["r1_ohm", "c1_f", "r2_ohm", "c2_f", "rss_ohm"],
        derived: &[
            (TOTAL, |v| v[1] + v[3]),
            (FASTEST, |v| (v[0].recip() + v[2].recip()).recip()),
        ],
    },
    BuiltIn {
        id: "constant-phase",
        title: "a resistor and a constant-phase element beside R_ss",
        notation: "p(R1-CPE,R_ss)",
        keys: &["r1_ohm", "cpe_s_sn", "cpe_exponent", "rss_ohm"],
        derived: &[(FASTEST, |v| v[0])],
    },
    BuiltIn {
        id: "warburg-finite",
        title: "a resistor and a Warburg element of finite length, closed at its end (a porous electrode), beside R_ss",
        notation: "p(R1-Wo,R_ss)",
        keys: &["r1_ohm", "rw_ohm", "cw_f", "rss_ohm"],
        derived: &[(TOTAL, |v| v[2]), (FASTEST, |v| v[0])],
    },
    BuiltIn {
        id: "warburg-parallel",
        title: "a resistor before a capacitor with a Warburg element in parallel, beside R_ss",
        notation: "p(R1-p(C1,W),R_ss)",
        keys: &["r1_ohm", "c1_f", "warburg_s_s05", "rss_ohm"],
        derived: &[(FASTEST, |v| v[0])],
    },
];

static CIRCUITS: LazyLock<Vec<SpectrumCircuit>> =
    LazyLock::new(|| BUILT_IN.iter().filter_map(|own| own.circuit().ok()).collect());

impl BuiltIn {
    fn circuit(&self) -> Result<SpectrumCircuit, NotationError> {
        let mut found = circuit(self.notation)?;
        for (parameter, key) in found.parameters.iter_mut().zip(self.keys) {
            (*key).clone_into(&mut parameter.key);
        }
        Ok(SpectrumCircuit {
            id: self.id.to_owned(),
            title: self.title.to_owned(),
            derived: self.derived.to_vec(),
            ..found
        })
    }
}

/// The circuits that every spectrum is fitted with.
pub fn circuits() -> &'static [SpectrumCircuit] {
    &CIRCUITS
}

/// The circuit of that id.
pub fn spectrum_circuit(id: &str) -> Option<&'static SpectrumCircuit> {
    CIRCUITS.iter().find(|circuit| circuit.id == id)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use ieap_numerics::complex::Complex;

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
        }
        .with_relaxation(1.0, 0.0);
        for hz in [1e-4, 0.01, 0.3, 10.0, 1e4] {
            let told = both.admittance_a_per_v(1.0, hz).reciprocal();
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
                let step_r = Complex::new(r / f64::from(parts), 0.0);
                seen = (step_r + (seen + step_c).reciprocal()).reciprocal();
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

    #[test]
    fn every_built_in_circuit_is_a_text_with_a_key_for_each_number() {
        assert_eq!(circuits().len(), BUILT_IN.len());
        for (own, built_in) in circuits().iter().zip(&BUILT_IN) {
            assert_eq!(own.parameters.len(), built_in.keys.len(), "{}", own.id);
        }
    }
}
