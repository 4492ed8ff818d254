//! Laws of the base as smooth unknown functions of one variable: what is asked of a misfit before any equation is.
//!
//! A smooth law is a part of the model and what it follows (its variable). To the fit it is an effect whose parameters are
//! the weights of smooth bells over the variable, so that it is simulated, fitted and held out like any other.

mod axis;
mod course;
mod law;
mod list;
mod part;
mod shapes;
mod words;

pub use axis::WEIGHTS;
pub use law::{Drawn, Place, SmoothLaw};
pub use list::{SMOOTH_LAWS, smooth_law};
pub use shapes::{Shape, Textbook};

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::tests::{drives, logged, scale, times};
    use crate::effects::{Applied, Effect};
    use crate::extended::tests::{base, context, drive};
    use crate::extended::{ExtendedModel, RunContext};

    fn responses(
        law: &'static SmoothLaw,
        parameters: &[f64],
        levels: &[(f64, Option<f64>)],
    ) -> [Vec<f64>; 2] {
        let model = ExtendedModel {
            base: base(),
            effects: vec![Applied {
                effect: law,
                variant: 0,
                parameters: parameters.to_vec(),
            }],
        };
        let (drive, logged) = (drive(levels), logged());
        let run = RunContext {
            channels: &logged,
            ..context(&drive)
        };
        let found = model.responses(&run, &times(300), &times(300));
        [found.current_a, found.curvature_per_cm]
    }

    /// Without weights nothing changes; with small ones something does in some drive, along a straight line.
    #[test]
    fn every_cell_acts_along_a_straight_line_and_is_absent_at_none() {
        for &law in SMOOTH_LAWS.iter() {
            let id = law.about().id;
            let search = law.search(0, &scale());
            let probe = search.probes.first().unwrap_or_else(|| panic!("{id}"));
            let mut moved: f64 = 0.0;
            for k in 0..law.weights() {
                for levels in drives() {
                    let with = |weight: f64| {
                        let mut parameters = probe.clone();
                        parameters[..WEIGHTS].fill(0.0);
                        parameters[k] = weight;
                        responses(law, &parameters, &levels)
                    };
                    let (none, once, twice) = (with(0.0), with(1e-4), with(2e-4));
                    for channel in 0..2 {
                        let largest = none[channel].iter().fold(0.0_f64, |most, v| most.max(v.abs()));
                        for (k, none) in none[channel].iter().enumerate() {
                            let (first, second) = (once[channel][k] - none, twice[channel][k] - none);
                            assert!(first.is_finite() && second.is_finite(), "{id}");
                            moved = moved.max(first.abs() / largest);
                            let bent = (second - 2.0 * first).abs() / largest;
                            assert!(bent < 2e-5, "{id} {k}: {first} {second} of {largest}");
                        }
                    }
                }
            }
            assert!(moved > 1e-6, "{id} does nothing: {moved}");
        }
    }

    /// Under a held voltage a capacitance that grows draws V dC/dt, and what it draws bends: q = C(t) e of every branch,
    /// `q' = (u - q/C)/R`, `s' = sum of q' - rate s`, by Runge and Kutta in small steps.
    #[test]
    fn what_grows_under_a_held_voltage_draws_and_bends() {
        let law = smooth_law("law:capacitance:time").unwrap();
        let mut parameters = law.search(0, &scale()).probes[0].clone();
        parameters[..WEIGHTS].fill(0.0);
        for by in [0.8, -0.6] {
            parameters[WEIGHTS - 1] = by;
            for levels in drives() {
                let found = responses(law, &parameters, &levels);
                let own = by_equation(by, &levels);
                for (channel, (found, own)) in found.iter().zip(&own).enumerate() {
                    let largest = own.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
                    for (k, (found, own)) in found.iter().zip(own).enumerate() {
                        let off = (found - own).abs() / largest;
                        assert!(off < 3e-4, "{levels:?} {by} {channel} {k}: {found} for {own}");
                    }
                }
            }
        }
    }

    /// Current and curvature at `times(300)` where every capacitance becomes `1 + by` of itself.
    fn by_equation(by: f64, levels: &[(f64, Option<f64>)]) -> [Vec<f64>; 2] {
        let (base, area, drive) = (base(), context(&drive(levels)).area_cm2, drive(levels));
        let all = times(300);
        let last = all[all.len() - 1];
        let held = |t: f64| drive.level_at(t).volts();
        let drawn = |t: f64, level: Option<f64>, state: &[f64; 3]| {
            let (mut conductance, mut offset) = (base.steady_state_resistance_ohm_cm2.recip(), 0.0);
            let e = |k: usize| state[k] / base.branches[k].capacitance_f_per_cm2 / (1.0 + by * t / last);
            for (k, b) in base.branches.iter().enumerate() {
                conductance += b.resistance_ohm_cm2.recip();
                offset += e(k) / b.resistance_ohm_cm2;
            }
            let u = level.unwrap_or(offset / conductance);
            let into = [0, 1].map(|k| (u - e(k)) / base.branches[k].resistance_ohm_cm2);
            (into, conductance * u - offset)
        };
        let slope = |t: f64, level, state: &[f64; 3]| {
            let ([first, second], _) = drawn(t, level, state);
            let relaxing = base.relaxation_rate_per_s * state[2];
            [first, second, first + second - relaxing]
        };
        let mut state = [0.0; 3];
        let scale = base.charge_to_curvature_per_c_cm * area;
        let mut answers = [Vec::new(), Vec::new()];
        for (k, &t) in all.iter().enumerate() {
            answers[0].push(area * drawn(t, held(t), &state).1);
            answers[1].push(scale * state[2]);
            let Some(next) = all.get(k + 1) else { break };
            let h = (next - t) / STEPS as f64;
            for j in 0..STEPS {
                let (at, level) = (t + h * j as f64, held(t + h * (j as f64 + 0.5)));
                let ahead = |by: f64, slope: [f64; 3]| [0, 1, 2].map(|m| state[m] + by * slope[m]);
                let first = slope(at, level, &state);
                let second = slope(at + h / 2.0, level, &ahead(h / 2.0, first));
                let third = slope(at + h / 2.0, level, &ahead(h / 2.0, second));
                let fourth = slope(at + h, level, &ahead(h, third));
                state = [0, 1, 2]
                    .map(|m| state[m] + h / 6.0 * (first[m] + 2.0 * second[m] + 2.0 * third[m] + fourth[m]));
            }
        }
        answers
    }

    /// Steps of the equation between two readings.
    const STEPS: usize = 400;
}
