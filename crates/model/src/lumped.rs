//! The lumped electromechanical model: R-C branches in parallel, a steady-state resistor, back-relaxation.

pub use ieap_domain::Branch;
use ieap_domain::{Drive, Level};

use super::open_circuit::FreeCircuit;
use super::relaxation::spring_response;

/// Equivalent circuit of thesis figures 7 and 8 with back-relaxation (14): the charge that the capacitors store
/// strains the polymer network, and the strain relaxes; the current through R_ss does not bend the strip.
#[derive(Debug, Clone, PartialEq)]
pub struct LumpedModel {
    /// Branches in parallel with each other and with R_ss, fastest first.
    pub branches: Vec<Branch>,
    /// Steady-state ("leakage") resistance R_ss, Ohm cm2; infinite where no steady current flows.
    pub steady_state_resistance_ohm_cm2: f64,
    /// Coupling alpha between the total charge of the sample and its curvature, 1/(C cm).
    pub charge_to_curvature_per_c_cm: f64,
    /// Rate lambda of back-relaxation, 1/s.
    pub relaxation_rate_per_s: f64,
}

/// One segment of the drive solved in closed form, per unit area and with time counted from its start:
/// charge is `charge_start + SUM amplitude (e^(-rate t) - 1)`, current `constant + SUM amplitude e^(-rate t)`.
#[derive(Debug, Clone, PartialEq)]
pub struct SegmentResponse {
    /// Start of the segment, s.
    pub start_s: f64,
    /// Rates of the modes, 1/s.
    pub rates_per_s: Vec<f64>,
    /// Charge stored at the start, C/cm2.
    pub charge_start_c_per_cm2: f64,
    /// Charge amplitude of each mode, C/cm2.
    pub charge_amplitudes_c_per_cm2: Vec<f64>,
    /// Current in the outer circuit that does not decay, A/cm2.
    pub current_constant_a_per_cm2: f64,
    /// Current amplitude of each mode, A/cm2; zeros while the circuit is open.
    pub current_amplitudes_a_per_cm2: Vec<f64>,
    /// Spring strain at the start, in units of areal charge, C/cm2.
    pub strain_start_c_per_cm2: f64,
}

impl SegmentResponse {
    pub(super) fn current_a_per_cm2(&self, elapsed_s: f64) -> f64 {
        let decaying = self.rates_per_s.iter().zip(&self.current_amplitudes_a_per_cm2);
        let sum: f64 = decaying
            .map(|(rate, amplitude)| amplitude * (-rate * elapsed_s).exp())
            .sum();
        self.current_constant_a_per_cm2 + sum
    }

    pub(super) fn charge_c_per_cm2(&self, elapsed_s: f64) -> f64 {
        let modes = self.rates_per_s.iter().zip(&self.charge_amplitudes_c_per_cm2);
        let gained: f64 = modes
            .map(|(rate, amplitude)| amplitude * (-rate * elapsed_s).exp_m1())
            .sum();
        self.charge_start_c_per_cm2 + gained
    }

    pub(super) fn strain_c_per_cm2(&self, elapsed_s: f64, relaxation_rate_per_s: f64) -> f64 {
        let modes = self.rates_per_s.iter().zip(&self.charge_amplitudes_c_per_cm2);
        let driven: f64 = modes
            .map(|(&rate, amplitude)| amplitude * spring_response(elapsed_s, rate, relaxation_rate_per_s))
            .sum();
        self.strain_start_c_per_cm2 * (-relaxation_rate_per_s * elapsed_s).exp() - driven
    }
}

impl LumpedModel {
    /// The model of parameters by their stored keys. A branch without resistance or capacitance is absent; a steady current, a
    /// coupling and a relaxation that nothing is known of are none.
    pub fn of_parameters(value: impl Fn(&str) -> Option<f64>) -> LumpedModel {
        let branch = |k: usize| {
            Some(Branch {
                resistance_ohm_cm2: value(&format!("r{k}_ohm_cm2"))?,
                capacitance_f_per_cm2: value(&format!("c{k}_f_per_cm2"))?,
            })
        };
        LumpedModel {
            branches: (1..=4).filter_map(branch).collect(),
            steady_state_resistance_ohm_cm2: value("rss_ohm_cm2").unwrap_or(f64::INFINITY),
            charge_to_curvature_per_c_cm: value("alpha_per_c_cm").unwrap_or(0.0),
            relaxation_rate_per_s: value("lambda_per_s").unwrap_or(0.0),
        }
    }

    /// Current into the sample at each time, A.
    ///
    /// `area_cm2` is the active area; `time_s` may be in any order. Before the first segment the sample rests
    /// in the steady state at the baseline voltage; at the very start of a segment its new level holds already.
    pub fn current_a(&self, drive: &Drive, area_cm2: f64, time_s: &[f64]) -> Vec<f64> {
        let before = drive.baseline_v / self.steady_state_resistance_ohm_cm2;
        self.evaluate(drive, time_s, |segment, elapsed_s| {
            area_cm2 * segment.map_or(before, |segment| segment.current_a_per_cm2(elapsed_s))
        })
    }

    /// Charge stored in the capacitors of the whole sample at each time, C: what bends the strip.
    pub fn charge_c(&self, drive: &Drive, area_cm2: f64, time_s: &[f64]) -> Vec<f64> {
        let before = drive.baseline_v * self.total_capacitance_f_per_cm2();
        self.evaluate(drive, time_s, |segment, elapsed_s| {
            area_cm2 * segment.map_or(before, |segment| segment.charge_c_per_cm2(elapsed_s))
        })
    }

    /// Curvature at each time, 1/cm, with the shape before the first segment subtracted:
    /// kappa = alpha A q_spring (15, 16, 20).
    pub fn curvature_per_cm(&self, drive: &Drive, area_cm2: f64, time_s: &[f64]) -> Vec<f64> {
        let per_areal_charge = self.charge_to_curvature_per_c_cm * area_cm2;
        self.evaluate(drive, time_s, |segment, elapsed_s| {
            let strain =
                |segment: &SegmentResponse| segment.strain_c_per_cm2(elapsed_s, self.relaxation_rate_per_s);
            per_areal_charge * segment.map_or(0.0, strain)
        })
    }

    /// Sum of the branch capacitances, F/cm2.
    pub fn total_capacitance_f_per_cm2(&self) -> f64 {
        self.branches
            .iter()
            .map(|branch| branch.capacitance_f_per_cm2)
            .sum()
    }

    /// Every segment of the drive in closed form, with the state carried across.
    pub fn segment_responses(&self, drive: &Drive) -> Vec<SegmentResponse> {
        self.segment_responses_from(drive, vec![drive.baseline_v; self.branches.len()], 0.0)
    }

    /// The same from given branch voltages (V, one per branch) and spring strain (C/cm2) at the first segment.
    pub(super) fn segment_responses_from(
        &self,
        drive: &Drive,
        mut voltages_v: Vec<f64>,
        mut strain: f64,
    ) -> Vec<SegmentResponse> {
        let mut responses: Vec<SegmentResponse> = Vec::with_capacity(drive.segments.len());
        for (index, segment) in drive.segments.iter().enumerate() {
            let mut response = match segment.level {
                Level::Voltage(level_v) => self.held(level_v, &voltages_v),
                Level::OpenCircuit => self.circuit().response(&voltages_v),
            };
            response.start_s = segment.start_s();
            response.strain_start_c_per_cm2 = strain;
            if let Some(next) = drive.segments.get(index + 1) {
                let lasting_s = next.start_s() - segment.start_s();
                strain = response.strain_c_per_cm2(lasting_s, self.relaxation_rate_per_s);
                voltages_v = self.voltages_after(segment.level, &voltages_v, lasting_s);
            }
            responses.push(response);
        }
        responses
    }

    fn circuit(&self) -> FreeCircuit<'_> {
        FreeCircuit::new(&self.branches, self.steady_state_resistance_ohm_cm2)
    }

    /// Response while the source holds `level_v`, from the branch voltages `from_v`.
    fn held(&self, level_v: f64, from_v: &[f64]) -> SegmentResponse {
        let branches = || self.branches.iter().zip(from_v);
        SegmentResponse {
            start_s: 0.0,
            rates_per_s: self
                .branches
                .iter()
                .map(|branch| branch.time_constant_s().recip())
                .collect(),
            charge_start_c_per_cm2: branches()
                .map(|(branch, v)| branch.capacitance_f_per_cm2 * v)
                .sum(),
            charge_amplitudes_c_per_cm2: branches()
                .map(|(branch, v)| branch.capacitance_f_per_cm2 * (v - level_v))
                .collect(),
            current_constant_a_per_cm2: level_v / self.steady_state_resistance_ohm_cm2,
            current_amplitudes_a_per_cm2: branches()
                .map(|(branch, v)| (level_v - v) / branch.resistance_ohm_cm2)
                .collect(),
            strain_start_c_per_cm2: 0.0,
        }
    }

    pub(super) fn voltages_after(&self, level: Level, from_v: &[f64], lasting_s: f64) -> Vec<f64> {
        match level {
            Level::OpenCircuit => self.circuit().voltages_after(from_v, lasting_s),
            Level::Voltage(level_v) => self
                .branches
                .iter()
                .zip(from_v)
                .map(|(branch, v)| v + (v - level_v) * (-lasting_s / branch.time_constant_s()).exp_m1())
                .collect(),
        }
    }

    /// `value` at each time, given the segment that holds it (none before the first) and the time since its start.
    fn evaluate(
        &self,
        drive: &Drive,
        time_s: &[f64],
        value: impl Fn(Option<&SegmentResponse>, f64) -> f64,
    ) -> Vec<f64> {
        let responses = self.segment_responses(drive);
        let at = |&t: &f64| {
            let after = responses.partition_point(|response| response.start_s <= t);
            match after.checked_sub(1) {
                Some(index) => value(Some(&responses[index]), t - responses[index].start_s),
                None => value(None, 0.0),
            }
        };
        time_s.iter().map(at).collect()
    }
}
