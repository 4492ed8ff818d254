//! Rival models of back-relaxation: Yagasaki and Tamagawa's time-dependent modulus (1), Bao's two-way transport (2).

use thiserror::Error;

use super::circuit::EquivalentCircuit;
use super::lumped::LumpedModel;
use ieap_domain::Drive;

/// Bao's two-way transport (2): `kappa' = K1 q' - (kappa - K2 q) / tau_2`, with the charge of an equivalent
/// circuit. K2 = 0 *is* the thesis's model with alpha = K1 and lambda = 1/tau_2; K2 between 0 and K1 lets part of
/// the bending stay.
#[derive(Debug, Clone, PartialEq)]
pub struct TwoWayTransport {
    /// Where the charge comes from.
    pub circuit: EquivalentCircuit,
    /// K1, curvature per charge of the forward bending, 1/(C cm).
    pub forward_coupling_per_c_cm: f64,
    /// K2, curvature per charge in equilibrium, 1/(C cm).
    pub equilibrium_coupling_per_c_cm: f64,
    /// tau_2, time constant of back-relaxation, s; positive.
    pub transport_time_constant_s: f64,
}

impl TwoWayTransport {
    /// Curvature at each time (s), 1/cm, with the shape before the first segment subtracted, for a sample of
    /// `area_cm2` in the given drive.
    ///
    /// Integrating (14) by parts, the part of the charge that has relaxed is `q - q_spring`, so that
    /// `kappa = K1 q_spring + K2 (q - q_spring)` for any drive.
    pub fn curvature_per_cm(&self, drive: &Drive, area_cm2: f64, time_s: &[f64]) -> Vec<f64> {
        let unit = self.with_unit_coupling();
        let resting_c = drive.baseline_v * unit.total_capacitance_f_per_cm2() * area_cm2;
        let charge = unit.charge_c(drive, area_cm2, time_s);
        let spring = unit.curvature_per_cm(drive, area_cm2, time_s);
        charge
            .iter()
            .zip(spring)
            .map(|(charge, spring)| {
                self.forward_coupling_per_c_cm * spring
                    + self.equilibrium_coupling_per_c_cm * (charge - resting_c - spring)
            })
            .collect()
    }

    fn with_unit_coupling(&self) -> LumpedModel {
        let circuit = self.circuit.clone();
        circuit.with_relaxation(1.0, self.transport_time_constant_s.recip())
    }
}

/// Yagasaki and Tamagawa's modulus that changes with the time since the step (1):
/// `E(t) = E0 + (E1 t + E2) e^(-lambda t)` with `E0 > E2 > 0` and `E1, lambda > 0`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TimeDependentModulus {
    /// E0, modulus in the end, MPa.
    final_modulus_mpa: f64,
    /// E1, MPa/s.
    growth_mpa_per_s: f64,
    /// E2, what the modulus has beyond E0 at the first instant, MPa.
    first_excess_mpa: f64,
    /// lambda, 1/s.
    rate_per_s: f64,
}

/// Parameters that (1) does not allow.
#[derive(Debug, Clone, PartialEq, Error)]
#[error(
    "E0 = {final_modulus_mpa} MPa, E1 = {growth_mpa_per_s} MPa/s, E2 = {first_excess_mpa} MPa, lambda = {rate_per_s} 1/s; \
     the model needs E0 > E2 > 0, E1 > 0 and lambda > 0"
)]
pub struct ModulusError {
    /// E0 as given, MPa.
    pub final_modulus_mpa: f64,
    /// E1 as given, MPa/s.
    pub growth_mpa_per_s: f64,
    /// E2 as given, MPa.
    pub first_excess_mpa: f64,
    /// lambda as given, 1/s.
    pub rate_per_s: f64,
}

impl TimeDependentModulus {
    /// The modulus with E0, E1, E2 and lambda.
    ///
    /// # Errors
    /// The parameters do not obey `E0 > E2 > 0`, `E1 > 0`, `lambda > 0`.
    pub fn new(
        final_modulus_mpa: f64,
        growth_mpa_per_s: f64,
        first_excess_mpa: f64,
        rate_per_s: f64,
    ) -> Result<TimeDependentModulus, ModulusError> {
        let allowed = final_modulus_mpa > first_excess_mpa
            && first_excess_mpa > 0.0
            && growth_mpa_per_s > 0.0
            && rate_per_s > 0.0;
        if !allowed {
            return Err(ModulusError {
                final_modulus_mpa,
                growth_mpa_per_s,
                first_excess_mpa,
                rate_per_s,
            });
        }
        Ok(TimeDependentModulus {
            final_modulus_mpa,
            growth_mpa_per_s,
            first_excess_mpa,
            rate_per_s,
        })
    }

    /// Modulus at `elapsed_s` (not negative) after the step, MPa (1).
    pub fn modulus_mpa(&self, elapsed_s: f64) -> f64 {
        let decaying = self.growth_mpa_per_s * elapsed_s + self.first_excess_mpa;
        self.final_modulus_mpa + decaying * (-self.rate_per_s * elapsed_s).exp()
    }

    /// Curvature at each time (s) after a step of `step_v` from the discharged state, 1/cm: the moment that the
    /// charge makes (15) on a strip of this modulus (7), `kappa = alpha q E0 / E(t)`.
    ///
    /// `circuit` gives the charge and `coupling_per_c_cm` is alpha = mu/(E0 I), that of the final modulus. The
    /// modulus counts time from one step, so no other drive is defined.
    pub fn curvature_per_cm(
        &self,
        circuit: &EquivalentCircuit,
        coupling_per_c_cm: f64,
        step_v: f64,
        area_cm2: f64,
        time_s: &[f64],
    ) -> Vec<f64> {
        let charge = circuit.clone().with_relaxation(coupling_per_c_cm, 0.0).charge_c(
            &Drive::step(step_v),
            area_cm2,
            time_s,
        );
        let bend = |(t, charge): (&f64, f64)| {
            if *t < 0.0 {
                return 0.0;
            }
            coupling_per_c_cm * charge * self.final_modulus_mpa / self.modulus_mpa(*t)
        };
        time_s.iter().zip(charge).map(bend).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ieap_domain::testing::branch;
    use ieap_domain::{Level, Segment};
    use ieap_numerics::ode::integrate;

    fn circuit() -> EquivalentCircuit {
        EquivalentCircuit {
            branches: vec![branch(521.4, 0.098), branch(2629.9, 0.13)],
            steady_state_resistance_ohm_cm2: 5660.0,
        }
    }

    fn transport(equilibrium_coupling_per_c_cm: f64) -> TwoWayTransport {
        TwoWayTransport {
            circuit: circuit(),
            forward_coupling_per_c_cm: 13.88,
            equilibrium_coupling_per_c_cm,
            transport_time_constant_s: 400.0,
        }
    }

    fn pulses() -> Drive {
        let segment = |start_s, v| Segment::at(start_s, Level::Voltage(v));
        Drive {
            baseline_v: 0.5,
            segments: vec![segment(0.0, 2.0), segment(300.0, -1.0), segment(800.0, 0.0)],
        }
    }

    /// (2) itself with the branches' charges as further states, from the steady state at the baseline.
    fn by_integration(model: &TwoWayTransport, drive: &Drive, area_cm2: f64, time_s: &[f64]) -> Vec<f64> {
        let branches = &model.circuit.branches;
        let n = branches.len();
        let mut state: Vec<f64> = branches
            .iter()
            .map(|b| b.capacitance_f_per_cm2 * drive.baseline_v)
            .collect();
        let resting: f64 = state.iter().sum::<f64>() * area_cm2 * model.equilibrium_coupling_per_c_cm;
        state.push(resting);
        let (mut now, mut level_v, mut found) = (0.0, drive.baseline_v, Vec::new());
        let mut upcoming = drive.segments.iter().peekable();
        let advance = |state: &mut [f64], now: f64, to: f64, level_v: f64| {
            let rate = |_: f64, y: &[f64], out: &mut [f64]| {
                for (k, b) in branches.iter().enumerate() {
                    out[k] = (level_v - y[k] / b.capacitance_f_per_cm2) / b.resistance_ohm_cm2;
                }
                let charge: f64 = area_cm2 * y[..n].iter().sum::<f64>();
                let charging: f64 = area_cm2 * out[..n].iter().sum::<f64>();
                out[n] = model.forward_coupling_per_c_cm * charging
                    - (y[n] - model.equilibrium_coupling_per_c_cm * charge) / model.transport_time_constant_s;
            };
            integrate(rate, now, to, state, 1e-11, 1e-18);
        };
        for &t in time_s {
            while let Some(segment) = upcoming.next_if(|segment| segment.start_s() <= t) {
                advance(&mut state, now, segment.start_s(), level_v);
                now = segment.start_s();
                if let Level::Voltage(v) = segment.level {
                    level_v = v;
                }
            }
            advance(&mut state, now, t, level_v);
            now = t;
            found.push(state[n] - resting);
        }
        found
    }

    #[test]
    fn two_way_transport_is_its_differential_equation() {
        let time_s: Vec<f64> = (0..150).map(|k| 10.0 * f64::from(k)).collect();
        for k2 in [0.0, 3.0, 13.88, -2.0] {
            let model = transport(k2);
            let closed = model.curvature_per_cm(&pulses(), 0.1, &time_s);
            let integrated = by_integration(&model, &pulses(), 0.1, &time_s);
            let scale = closed.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
            for (a, b) in closed.iter().zip(integrated) {
                assert!((a - b).abs() < 1e-8 * scale, "{k2}: {a} {b}");
            }
        }
    }

    #[test]
    fn without_equilibrium_bending_it_is_the_model_of_the_thesis() {
        let time_s: Vec<f64> = (0..150).map(|k| 10.0 * f64::from(k)).collect();
        let thesis = circuit().with_relaxation(13.88, 1.0 / 400.0);
        let ours = thesis.curvature_per_cm(&pulses(), 0.1, &time_s);
        let bao = transport(0.0).curvature_per_cm(&pulses(), 0.1, &time_s);
        let scale = ours.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
        assert!(scale > 0.01);
        for (a, b) in ours.iter().zip(bao) {
            assert!((a - b).abs() < 1e-14 * scale, "{a} {b}");
        }
        // With K2 = K1 nothing relaxes, with K2 between a part of the bending stays.
        let (last, drive) = ([1e6], Drive::step(1.0));
        let full = 13.88 * thesis.charge_c(&drive, 0.1, &last)[0];
        let kept = |k2| transport(k2).curvature_per_cm(&drive, 0.1, &last)[0] / full;
        assert!((kept(13.88) - 1.0).abs() < 1e-12 && (kept(3.47) - 0.25).abs() < 1e-12);
        assert!(kept(0.0).abs() < 1e-12);
    }

    #[test]
    fn modulus_is_its_differential_equation_and_is_stiffest_where_it_says() {
        let modulus = TimeDependentModulus::new(70.0, 4.0, 30.0, 0.05).unwrap();
        // (d/dt + lambda)^2 (E - E0) = 0 with E(0) = E0 + E2 and E'(0) = E1 - lambda E2.
        let mut state = [100.0, 4.0 - 0.05 * 30.0];
        let rate = |_: f64, y: &[f64], out: &mut [f64]| {
            out[0] = y[1];
            out[1] = -2.0 * 0.05 * y[1] - 0.05 * 0.05 * (y[0] - 70.0);
        };
        let mut now = 0.0;
        for t in [1.0, 12.5, 40.0, 200.0] {
            integrate(rate, now, t, &mut state, 1e-12, 1e-14);
            now = t;
            assert!((modulus.modulus_mpa(t) / state[0] - 1.0).abs() < 1e-10);
        }
        // 1/lambda - E2/E1: from the step until then a constant moment can let the strip relax back, and not afterwards.
        let peak = 12.5;
        let at = modulus.modulus_mpa(peak);
        assert!(at > modulus.modulus_mpa(peak - 0.1) && at > modulus.modulus_mpa(peak + 0.1));
    }

    #[test]
    fn a_time_dependent_modulus_bends_relaxes_and_ends_bent() {
        let modulus = TimeDependentModulus::new(70.0, 4.0, 30.0, 0.002).unwrap();
        let time_s: Vec<f64> = (-1..3000).map(|k| 5.0 * f64::from(k)).collect();
        let curvature = modulus.curvature_per_cm(&circuit(), 13.88, 2.0, 0.1, &time_s);
        assert_eq!(curvature[0], 0.0);
        // The moment is alpha q times E0 I; over E(t) I it must be the curvature, the charge integrated by itself.
        let mut charge = [0.0, 0.0];
        let rate = |_: f64, q: &[f64], out: &mut [f64]| {
            for (k, b) in circuit().branches.iter().enumerate() {
                out[k] = (2.0 - q[k] / b.capacitance_f_per_cm2) / b.resistance_ohm_cm2;
            }
        };
        integrate(rate, 0.0, time_s[101], &mut charge, 1e-12, 1e-18);
        let moment = 13.88 * 0.1 * (charge[0] + charge[1]) * 70.0;
        assert!((curvature[101] * modulus.modulus_mpa(time_s[101]) / moment - 1.0).abs() < 1e-10);
        // It comes back to alpha q of the final modulus: unlike (14) it cannot relax to the unbent state.
        let last = *curvature.last().unwrap();
        let full = 13.88 * 0.1 * 2.0 * (0.098 + 0.13);
        assert!((last / full - 1.0).abs() < 1e-4, "{last} {full}");
        assert!(curvature.windows(2).any(|pair| pair[1] < pair[0]));
    }

    #[test]
    fn parameters_that_the_model_excludes_are_refused() {
        for (e0, e1, e2, rate) in [
            (30.0, 4.0, 70.0, 0.1),
            (70.0, 0.0, 30.0, 0.1),
            (70.0, 4.0, 0.0, 0.1),
            (70.0, 4.0, 30.0, 0.0),
            (f64::NAN, 4.0, 30.0, 0.1),
        ] {
            let error = TimeDependentModulus::new(e0, e1, e2, rate).unwrap_err();
            assert!(error.to_string().contains("needs E0 > E2 > 0"), "{error}");
        }
    }
}
