//! Where a simpler circuit would do, run by run, as tables show it.

use crate::policy::DIFFERS_BELOW;

/// What simpler circuits cost in one run, or why nothing can be said.
#[derive(Debug, Clone, PartialEq)]
pub struct RunReductions {
    /// Row id of the run.
    pub run_id: i64,
    /// Its path.
    pub path: String,
    /// One for each circuit, the fullest first; or why there is none.
    pub found: Result<Vec<ReducedCircuit>, String>,
}

/// What a simpler circuit costs.
#[derive(Debug, Clone, PartialEq)]
pub struct ReducedCircuit {
    /// In words.
    pub circuit: &'static str,
    /// Parameters that it saves.
    pub parameters_saved: usize,
    /// By how much the weighted sum of squares rises.
    pub chi_square_rise: f64,
    /// Chance of such a rise where the simpler circuit is the true one.
    pub p: f64,
    /// By how much its current differs from that of the full circuit, root mean square, percent of that one's range.
    pub current_differs_percent: f64,
    /// The same of the curvature.
    pub curvature_differs_percent: Option<f64>,
    /// R, C and R_ss of figure 7G (Ohm cm2, F/cm2, Ohm cm2), where it is that circuit.
    pub elements: Option<[f64; 3]>,
}

impl ReducedCircuit {
    /// Whether the readings have nothing against it.
    pub fn is_enough(&self) -> bool {
        self.p >= DIFFERS_BELOW
    }

    /// R_a, R_b and C of figure 7F, a resistor before a capacitor with a leak: the same impedance as 7G.
    pub fn series_elements(&self) -> Option<[f64; 3]> {
        let [r, c, rss] = self.elements?;
        let sum = r + rss;
        Some([r * rss / sum, rss * rss / sum, c * (sum / rss).powi(2)])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_forms_of_figure_7_have_one_impedance() {
        let circuit = ReducedCircuit {
            circuit: "one branch",
            parameters_saved: 2,
            chi_square_rise: 0.0,
            p: 1.0,
            current_differs_percent: 0.0,
            curvature_differs_percent: None,
            elements: Some([120.0, 0.05, 2500.0]),
        };
        let [ra, rb, cf] = circuit.series_elements().unwrap();
        for omega in [0.0, 1e-3, 1e-2, 0.1, 1.0, 100.0_f64] {
            // Real and imaginary part of the admittance of G, and of the impedance of F.
            let (r, c, rss) = (120.0, 0.05, 2500.0);
            let x = omega * r * c;
            let g = (1.0 / rss + x * x / (r * (1.0 + x * x)), x / (r * (1.0 + x * x)));
            let y = omega * rb * cf;
            let z = (ra + rb / (1.0 + y * y), -rb * y / (1.0 + y * y));
            let product = (g.0 * z.0 - g.1 * z.1, g.0 * z.1 + g.1 * z.0);
            assert!(
                (product.0 - 1.0).abs() < 1e-12 && product.1.abs() < 1e-12,
                "{omega}: {product:?}"
            );
        }
        assert!(circuit.is_enough());
    }
}
