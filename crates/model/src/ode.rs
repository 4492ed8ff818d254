//! The lumped model stated a second time, as differential equations, to hold the closed form against.

use ieap_domain::{Drive, Level};
use ieap_numerics::ode::integrate;

use super::lumped::{Branch, LumpedModel};

/// Responses of a sample at given times.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Responses {
    /// Current into the sample, A.
    pub current_a: Vec<f64>,
    /// Charge stored in the capacitors, C.
    pub charge_c: Vec<f64>,
    /// Curvature, 1/cm.
    pub curvature_per_cm: Vec<f64>,
}

/// Integrates Kirchhoff's laws (17) and the spring equation eps' = q' - lambda eps (14) step by step, with the
/// local error of each step below `relative` times the largest value so far. `time_s` must increase.
///
/// It shares nothing with the closed form but the parameters. It is slow where a time constant is much
/// shorter than the record.
pub fn integrate_responses(
    model: &LumpedModel,
    drive: &Drive,
    area_cm2: f64,
    time_s: &[f64],
    relative: f64,
) -> Responses {
    let charge = |branch: &Branch| branch.capacitance_f_per_cm2 * drive.baseline_v;
    let mut level = Level::Voltage(drive.baseline_v);
    let first = drive.segments.first().map_or(0.0, |segment| segment.start_s());
    let mut sample = Sample {
        model,
        relative,
        state: model.branches.iter().map(charge).chain([0.0]).collect(),
        now_s: time_s.first().map_or(first, |&t| t.min(first)),
    };
    let mut upcoming = drive.segments.iter().peekable();
    let mut responses = Responses::default();
    for &t in time_s {
        while let Some(segment) = upcoming.next_if(|segment| segment.start_s() <= t) {
            sample.advance(segment.start_s(), |_| level);
            level = segment.level;
        }
        sample.advance(t, |_| level);
        sample.respond(level, area_cm2, &mut responses);
    }
    responses
}

/// The same under any course of the voltage, V over s, from rest without a charge at the first of `time_s`.
pub fn integrate_under(
    model: &LumpedModel,
    volts: impl Fn(f64) -> f64,
    area_cm2: f64,
    time_s: &[f64],
    relative: f64,
) -> Responses {
    let mut sample = Sample {
        model,
        relative,
        state: vec![0.0; model.branches.len() + 1],
        now_s: time_s.first().copied().unwrap_or_default(),
    };
    let mut responses = Responses::default();
    for &t in time_s {
        sample.advance(t, |time_s| Level::Voltage(volts(time_s)));
        sample.respond(Level::Voltage(volts(t)), area_cm2, &mut responses);
    }
    responses
}

/// A sample on its way.
struct Sample<'a> {
    model: &'a LumpedModel,
    relative: f64,
    /// Charge of every branch, and strain of the spring.
    state: Vec<f64>,
    now_s: f64,
}

impl Sample<'_> {
    fn advance(&mut self, to_s: f64, level: impl Fn(f64) -> Level) {
        let n = self.model.branches.len();
        let rate = |time_s: f64, y: &[f64], out: &mut [f64]| {
            branch_currents(self.model, level(time_s), y, out);
            out[n] = out[..n].iter().sum::<f64>() - self.model.relaxation_rate_per_s * y[n];
        };
        integrate(rate, self.now_s, to_s, &mut self.state, self.relative, 1e-18);
        self.now_s = to_s;
    }

    fn respond(&self, level: Level, area_cm2: f64, responses: &mut Responses) {
        let n = self.model.branches.len();
        let current = outer_current(self.model, level, &self.state);
        let per_charge = self.model.charge_to_curvature_per_c_cm * area_cm2;
        responses.current_a.push(area_cm2 * current);
        responses
            .charge_c
            .push(area_cm2 * self.state[..n].iter().sum::<f64>());
        responses.curvature_per_cm.push(per_charge * self.state[n]);
    }
}

/// Voltage between the terminals, V: the source's, or what leaves no current in the outer circuit.
fn terminal_voltage(model: &LumpedModel, level: Level, state: &[f64]) -> f64 {
    match level {
        Level::Voltage(level_v) => level_v,
        Level::OpenCircuit => {
            let mut conductance = 1.0 / model.steady_state_resistance_ohm_cm2;
            let mut driving = 0.0;
            for (branch, charge) in model.branches.iter().zip(state) {
                conductance += 1.0 / branch.resistance_ohm_cm2;
                driving += charge / branch.capacitance_f_per_cm2 / branch.resistance_ohm_cm2;
            }
            driving / conductance
        }
    }
}

fn branch_currents(model: &LumpedModel, level: Level, state: &[f64], out: &mut [f64]) {
    let across = terminal_voltage(model, level, state);
    for ((branch, charge), out) in model.branches.iter().zip(state).zip(out) {
        *out = (across - charge / branch.capacitance_f_per_cm2) / branch.resistance_ohm_cm2;
    }
}

fn outer_current(model: &LumpedModel, level: Level, state: &[f64]) -> f64 {
    if level == Level::OpenCircuit {
        return 0.0;
    }
    let mut currents = vec![0.0; model.branches.len()];
    branch_currents(model, level, state, &mut currents);
    let across = terminal_voltage(model, level, state);
    currents.iter().sum::<f64>() + across / model.steady_state_resistance_ohm_cm2
}

#[cfg(test)]
mod tests {
    use super::*;
    use ieap_domain::testing::{branch, drive};

    fn model(rss_ohm_cm2: f64, lambda_per_s: f64) -> LumpedModel {
        LumpedModel {
            branches: vec![branch(521.4, 0.098), branch(2629.9, 0.13)],
            steady_state_resistance_ohm_cm2: rss_ohm_cm2,
            charge_to_curvature_per_c_cm: 13.88,
            relaxation_rate_per_s: lambda_per_s,
        }
    }

    fn compare(model: &LumpedModel, drive: &Drive) {
        let time_s: Vec<f64> = (0..300).map(|k| -20.0 + 5.0 * k as f64).collect();
        let ode = integrate_responses(model, drive, 0.1, &time_s, 1e-12);
        let pairs = [
            (ode.current_a, model.current_a(drive, 0.1, &time_s)),
            (ode.charge_c, model.charge_c(drive, 0.1, &time_s)),
            (ode.curvature_per_cm, model.curvature_per_cm(drive, 0.1, &time_s)),
        ];
        for (integrated, closed) in pairs {
            let scale = closed.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
            assert!(scale > 0.0);
            for (k, (a, b)) in integrated.iter().zip(&closed).enumerate() {
                assert!((a - b).abs() < 1e-9 * scale, "{} s: {a} {b}", time_s[k]);
            }
        }
    }

    #[test]
    fn closed_form_is_the_differential_equation() {
        for (rss, lambda) in [
            (5660.0, 3.8e-4),
            (f64::INFINITY, 0.0),
            (900.0, 0.02),
            (5660.0, 1.0 / (521.4 * 0.098)),
        ] {
            compare(&model(rss, lambda), &Drive::step(2.0));
        }
    }

    #[test]
    fn states_are_carried_across_segments_and_through_an_open_circuit() {
        let pulses = drive(0.5, &[(0.0, Some(2.0)), (200.0, Some(-1.0)), (350.0, Some(0.0))]);
        let opened = drive(
            0.0,
            &[(0.0, Some(2.0)), (120.0, None), (600.0, Some(1.0)), (900.0, None)],
        );
        for (rss, lambda) in [(5660.0, 3.8e-4), (f64::INFINITY, 1e-3), (50.0, 0.0)] {
            compare(&model(rss, lambda), &pulses);
            compare(&model(rss, lambda), &opened);
        }
    }

    #[test]
    fn open_circuit_without_steady_state_resistor_keeps_the_charge() {
        let opened = drive(0.0, &[(0.0, Some(2.0)), (50.0, None)]);
        let charge_c = model(f64::INFINITY, 0.0).charge_c(&opened, 1.0, &[50.0, 1e3, 1e6]);
        assert!((charge_c[2] / charge_c[0] - 1.0).abs() < 1e-12);
    }
}
