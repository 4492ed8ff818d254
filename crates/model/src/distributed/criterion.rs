//! Lumped or distributed: what the lumped model gets wrong at the tip, as a number.

use super::DistributedModel;

/// The lumped model is called enough where it is wrong by no more than this share at the tip: what a camera and the
/// dimensions of a strip leave open.
pub const LUMPED_TOLERANCE: f64 = 0.05;

/// Error of a lumped model with the strip's own R_c, C and R_ss, as shares of what it says (0 none, 1 all), and
/// the delay that it does not know.
///
/// All follow from `x^2 = R_e L^2 (1/R_c + 1/R_ss)`; for resistances per square and per area the width cancels,
/// `x^2 = R_sq L^2 (1/R_c + 1/R_ss)`. The errors are those of the charge and of the bending that it drives: largest
/// at the first instant after the step, where the empty capacitors draw most current, and falling from there to
/// those of the steady state. Back-relaxation is left out: late, when both models have relaxed to almost nothing,
/// the share between them says little. A lumped model *fitted* to such a strip hides part of the error in its
/// parameters, which are then not the laminate's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LumpedError {
    /// Voltage, and with it the rate of charging, at the tip at the first instant: `1 - 1/cosh(x)`.
    pub first_voltage_at_tip: f64,
    /// Voltage and charge at the tip in the end: the same with `x^2 = R_e L^2 / R_ss`.
    pub final_voltage_at_tip: f64,
    /// Rate of the tip's displacement at the first instant, small bending: `1 - 2 [tanh(x)/x - (1-sech x)/x^2]`,
    /// about x^2/4 for small x. This is *the* criterion; see [`LumpedError::lumped_is_enough`].
    pub first_displacement: f64,
    /// Displacement of the tip in the end if nothing relaxed back.
    pub final_displacement: f64,
    /// How much later than the lumped model says the tip's charge arrives, on the average, if nothing leaks:
    /// `R_e C L^2 / 2`, s. None where a steady current flows, for part of it then never arrives.
    pub charge_delay_s: Option<f64>,
}

impl LumpedError {
    /// Whether the lumped model is wrong by no more than the share `tolerance` in the displacement of the tip that
    /// the charge drives, at any time from the first instant on.
    pub fn lumped_is_enough(&self, tolerance: f64) -> bool {
        self.first_displacement.max(self.final_displacement) <= tolerance
    }
}

impl DistributedModel {
    /// What the lumped model with the same R_c, C and R_ss gets wrong at the tip.
    pub fn lumped_error(&self) -> LumpedError {
        let first = self.first_decay_per_cm2().sqrt() * self.length_cm;
        let last = self.steady_decay_per_cm2().sqrt() * self.length_cm;
        let sealed = self.steady_state_resistance_ohm_cm.is_infinite();
        let delay_s = 0.5
            * self.electrode_resistance_ohm_per_cm
            * self.capacitance_f_per_cm
            * self.length_cm
            * self.length_cm;
        LumpedError {
            first_voltage_at_tip: missing_at_tip(first),
            final_voltage_at_tip: missing_at_tip(last),
            first_displacement: missing_displacement(first),
            final_displacement: missing_displacement(last),
            charge_delay_s: sealed.then_some(delay_s),
        }
    }
}

/// `1 - 1/cosh(x)`, by the half argument so that a small share keeps its digits.
fn missing_at_tip(x: f64) -> f64 {
    // 2 sinh^2(x/2) / cosh(x), with both scaled by e^-x.
    (-x).exp_m1().powi(2) / (1.0 + (-2.0 * x).exp())
}

/// `1 - (2/L^2) INT_0^L u cosh(xu/L)/cosh(x) du`, the tip's displacement being the curvatures' moment about it.
fn missing_displacement(x: f64) -> f64 {
    let square = x * x;
    if x < 0.05 {
        return square * (0.25 - square * (7.0 / 72.0 - square * (113.0 / 2880.0)));
    }
    1.0 - 2.0 * (x.tanh() / x - missing_at_tip(x) / square)
}

#[cfg(test)]
mod tests {
    use super::super::Laminate;
    use super::*;
    use crate::coupling::{ActiveArea, CurvaturePerArealCharge};
    use crate::lumped::Branch;
    use ieap_numerics::ode::integrate;

    /// Laminates of thesis table 3.
    fn laminate(per_sq: f64, c: f64, rc: f64, rss: f64) -> Laminate {
        Laminate {
            electrode_resistance_ohm_per_sq: per_sq,
            branch: Branch {
                resistance_ohm_cm2: rc,
                capacitance_f_per_cm2: c,
            },
            steady_state_resistance_ohm_cm2: rss,
            coupling: CurvaturePerArealCharge(3.0),
            relaxation_rate_per_s: 0.0,
        }
    }

    fn strip(laminate: &Laminate, length_cm: f64, width_cm: f64) -> DistributedModel {
        laminate.strip(&ActiveArea { length_cm, width_cm })
    }

    #[test]
    fn displacement_share_is_its_integral_for_every_resistance() {
        for x in [1e-4, 0.03, 0.0499, 0.0501, 0.3, 2.0, 30.0] {
            let mut moment = [0.0];
            let rate = |u: f64, _: &[f64], out: &mut [f64]| {
                // 1 - cosh(xu)/cosh(x) without cancellation.
                let missing = 2.0 * (0.5 * x * (1.0 + u)).sinh() * (0.5 * x * (1.0 - u)).sinh();
                out[0] = 2.0 * u * missing / x.cosh();
            };
            integrate(rate, 0.0, 1.0, &mut moment, 1e-13, 1e-18);
            let found = missing_displacement(x);
            assert!(
                (found / moment[0] - 1.0).abs() < 1e-8,
                "{x}: {found} {}",
                moment[0]
            );
        }
    }

    #[test]
    fn shares_are_what_the_series_says_at_the_first_instant_and_in_the_end() {
        let model = strip(&laminate(4.5, 0.0197, 3.0, 42.9), 4.5, 0.3);
        let error = model.lumped_error();
        let lumped = DistributedModel {
            electrode_resistance_ohm_per_cm: 0.0,
            ..model
        };
        let first_s = 1e-6 / model.charging_rate_per_s();
        let last_s = 1e4 / model.charging_rate_per_s();
        let cells = 400;
        let middles: Vec<f64> = (0..cells)
            .map(|k| (k as f64 + 0.5) * model.length_cm / cells as f64)
            .collect();
        let displacement = |model: &DistributedModel, time| -> f64 {
            let curvature = model.curvature_per_cm(1.0, &middles, &[time]);
            let lever = |k: usize| model.length_cm - middles[k];
            (0..cells).map(|k| lever(k) * curvature.at(0, k)).sum()
        };
        let tip = |model: &DistributedModel, time| model.voltage_v(1.0, &[model.length_cm], &[time]).at(0, 0);
        for (time, at_tip, share) in [
            (first_s, error.first_voltage_at_tip, error.first_displacement),
            (last_s, error.final_voltage_at_tip, error.final_displacement),
        ] {
            let voltage = 1.0 - tip(&model, time) / tip(&lumped, time);
            let moved = 1.0 - displacement(&model, time) / displacement(&lumped, time);
            assert!((voltage - at_tip).abs() < 1e-5, "{voltage} {at_tip}");
            assert!((moved - share).abs() < 1e-4, "{moved} {share}");
        }
    }

    #[test]
    fn error_of_the_displacement_falls_from_the_first_instant_on() {
        let model = strip(&laminate(4.5, 0.0197, 3.0, 42.9), 4.5, 0.3);
        let error = model.lumped_error();
        let tau_s = 1.0 / model.charging_rate_per_s();
        let times: Vec<f64> = (0..60).map(|k| 1e-3 * tau_s * 1.25_f64.powi(k)).collect();
        let middles: Vec<f64> = (0..200)
            .map(|k| (f64::from(k) + 0.5) * model.length_cm / 200.0)
            .collect();
        let charge = model.charge_c_per_cm(1.0, &middles, &times);
        let mut before = error.first_displacement;
        for (k, t) in times.iter().enumerate() {
            let lever = middles
                .iter()
                .zip(charge.profile(k))
                .map(|(s, q)| (model.length_cm - s) * q);
            let moment = lever.sum::<f64>() * model.length_cm / 200.0;
            let lumped = model.capacitance_f_per_cm * -(-t / tau_s).exp_m1() * 0.5 * model.length_cm.powi(2);
            let share = 1.0 - moment / lumped;
            assert!(
                share <= before + 1e-4 && share >= error.final_displacement - 1e-4,
                "{t}: {share}"
            );
            before = share;
        }
        assert!(before < 0.9 * error.first_displacement);
    }

    #[test]
    fn delay_of_the_tip_is_the_area_between_the_two_charges() {
        let model = strip(&laminate(4.5, 0.0197, 3.0, f64::INFINITY), 4.5, 0.3);
        let tau_s = 1.0 / model.charging_rate_per_s();
        let step_s = 0.02 * tau_s;
        let times: Vec<f64> = (0..100_000).map(|k| (f64::from(k) + 0.5) * step_s).collect();
        let charge = model.charge_c_per_cm(1.0, &[model.length_cm], &times);
        let missing =
            |(k, t): (usize, &f64)| (1.0 - (-t / tau_s).exp()) - charge.at(k, 0) / model.capacitance_f_per_cm;
        let delay_s: f64 = times.iter().enumerate().map(missing).sum::<f64>() * step_s;
        let stated = model.lumped_error().charge_delay_s.unwrap();
        assert!((delay_s / stated - 1.0).abs() < 1e-4, "{delay_s} {stated}");
    }

    #[test]
    fn width_does_not_matter_and_the_samples_of_the_thesis_fall_on_their_sides() {
        let ptnaf = laminate(4.5, 0.0197, 3.0, 42.9);
        let cnaf = laminate(2.5, 0.131, 4.5, 22.7);
        let narrow = strip(&ptnaf, 4.5, 0.3).lumped_error().first_displacement;
        let wide = strip(&ptnaf, 4.5, 3.0).lumped_error().first_displacement;
        assert!((narrow / wide - 1.0).abs() < 1e-12);
        // Table 3: the distributed model is needed. Table 5 (5 mm long, 64.4 || 130.3 Ohm cm2): it is not.
        assert!(!strip(&ptnaf, 4.5, 0.3).lumped_error().lumped_is_enough(0.3));
        assert!(!strip(&cnaf, 2.8, 0.5).lumped_error().lumped_is_enough(0.3));
        let in_vacuum = laminate(2.5, 0.139, 43.1, 64_050.0);
        let error = strip(&in_vacuum, 0.5, 0.2).lumped_error();
        assert!(error.lumped_is_enough(0.005), "{error:?}");
    }
}
