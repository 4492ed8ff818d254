//! What the branches do while the source is disconnected: they exchange charge through R_ss and each other.

use ieap_numerics::symmetric::Symmetric;

use super::lumped::{Branch, SegmentResponse};

/// The circuit without its source. With u_k = sqrt(C_k) v_k Kirchhoff's laws read u' = -M u with M symmetric:
/// `M_jk = delta_jk / tau_k - 1 / (R_j R_k sqrt(C_j C_k) G)`, `G = SUM 1/R_k + 1/R_ss`.
pub(super) struct FreeCircuit<'a> {
    branches: &'a [Branch],
    /// Decay rates of the modes, 1/s; none is negative.
    rates_per_s: Vec<f64>,
    /// `modes[k][m]`: part of branch k in mode m.
    modes: Vec<Vec<f64>>,
}

impl<'a> FreeCircuit<'a> {
    /// Modes of any number of `branches` beside `steady_state_resistance_ohm_cm2`.
    pub(super) fn new(branches: &'a [Branch], steady_state_resistance_ohm_cm2: f64) -> FreeCircuit<'a> {
        let n = branches.len();
        let steady = steady_state_resistance_ohm_cm2.recip();
        let conductance: f64 = branches.iter().map(|b| b.resistance_ohm_cm2.recip()).sum::<f64>() + steady;
        let weight = |b: &Branch| b.resistance_ohm_cm2.recip() / b.capacitance_f_per_cm2.sqrt();
        let entry = |j: usize, k: usize| {
            let own = if j == k {
                branches[k].time_constant_s().recip()
            } else {
                0.0
            };
            own - weight(&branches[j]) * weight(&branches[k]) / conductance
        };
        let (mut rates_per_s, modes) = Symmetric::from_fn(n, entry).eigen();
        refine_slowest(&mut rates_per_s, branches, steady / conductance);
        FreeCircuit {
            branches,
            rates_per_s,
            modes,
        }
    }

    /// Amplitude of each mode in the branch voltages `v`.
    fn amplitudes(&self, v: &[f64]) -> Vec<f64> {
        let part = |m: usize| {
            let terms = self.branches.iter().zip(v).zip(&self.modes);
            terms
                .map(|((b, v), row)| b.capacitance_f_per_cm2.sqrt() * v * row[m])
                .sum()
        };
        (0..self.rates_per_s.len()).map(part).collect()
    }

    /// The segment's response from the branch voltages `from_v`; start and strain are the caller's.
    pub(super) fn response(&self, from_v: &[f64]) -> SegmentResponse {
        let charge_of_mode = |m: usize| -> f64 {
            let rows = self.branches.iter().zip(&self.modes);
            rows.map(|(b, row)| b.capacitance_f_per_cm2.sqrt() * row[m]).sum()
        };
        let amplitudes = self.amplitudes(from_v);
        SegmentResponse {
            start_s: 0.0,
            rates_per_s: self.rates_per_s.clone(),
            charge_start_c_per_cm2: (self.branches.iter().zip(from_v))
                .map(|(b, v)| b.capacitance_f_per_cm2 * v)
                .sum(),
            charge_amplitudes_c_per_cm2: amplitudes
                .iter()
                .enumerate()
                .map(|(m, amplitude)| amplitude * charge_of_mode(m))
                .collect(),
            current_constant_a_per_cm2: 0.0,
            current_amplitudes_a_per_cm2: vec![0.0; amplitudes.len()],
            strain_start_c_per_cm2: 0.0,
        }
    }

    /// Branch voltages after `lasting_s`.
    pub(super) fn voltages_after(&self, from_v: &[f64], lasting_s: f64) -> Vec<f64> {
        let lost: Vec<f64> = (self.amplitudes(from_v).iter().zip(&self.rates_per_s))
            .map(|(amplitude, rate)| amplitude * (-rate * lasting_s).exp_m1())
            .collect();
        let after = |((b, v), row): ((&Branch, &f64), &Vec<f64>)| {
            let change: f64 = row.iter().zip(&lost).map(|(part, lost)| part * lost).sum();
            v + change / b.capacitance_f_per_cm2.sqrt()
        };
        self.branches
            .iter()
            .zip(from_v)
            .zip(&self.modes)
            .map(after)
            .collect()
    }
}

/// Puts the smallest rate right, which the eigenvalue routine knows only to rounding of the largest one:
/// the determinant of M is `(1/R_ss)/G` times the product of `1/tau_k`, zero for an infinite R_ss.
fn refine_slowest(rates_per_s: &mut [f64], branches: &[Branch], steady_share: f64) {
    let slowest = (0..rates_per_s.len()).min_by(|&a, &b| rates_per_s[a].total_cmp(&rates_per_s[b]));
    let Some(slowest) = slowest else { return };
    let own = branches.iter().map(|b| b.time_constant_s().recip());
    let others = (0..rates_per_s.len())
        .filter(|&m| m != slowest)
        .map(|m| rates_per_s[m]);
    rates_per_s[slowest] = steady_share * own.product::<f64>() / others.product::<f64>();
    for rate in rates_per_s {
        *rate = rate.max(0.0);
    }
}
