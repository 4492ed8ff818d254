//! A strip whose electrodes resist more (or less) beyond a place: a foil that is cracked there.
//!
//! With `w = V0 - v` and `z = V0 - q/C` the strip obeys `-(w'/R_e)' + a w = V0/R_ss + z/R_c`, `z' = r (w - z)`,
//! `w(0) = 0`, `w'(L) = 0`, `a = 1/R_c + 1/R_ss`, for any R_e along it. The modes of `-(w'/R_e)'` alone decouple these
//! equations in place, and each mode is solved in time in closed form. The modes are sought among polynomials of degree
//! `DEGREE` on either side of the break (integrated Legendre polynomials), in which profiles that are smooth on
//! either side converge faster than any power of the degree: at once after the step and in the end alike.

use super::DistributedModel;
use super::field::StripField;
use crate::relaxation::spring_response;
use ieap_numerics::sums::add;
use ieap_numerics::symmetric::Symmetric;

/// Degree of the polynomials on either side.
const DEGREE: usize = 16;
/// Unknowns: the break, the end, and what vanishes at both ends of a side, on both sides.
const UNKNOWNS: usize = 2 + 2 * (DEGREE - 1);
/// The break stays this share of the length away from both ends.
const NEAREST: f64 = 0.005;

/// A strip with a break; see the module.
#[derive(Debug, Clone)]
pub struct BrokenStrip {
    model: DistributedModel,
    break_at_cm: f64,
    /// Rates mu_n of the modes, 1/(Ohm cm).
    mode_conductance: Vec<f64>,
    /// Integral of each mode over the strip, cm.
    integral: Vec<f64>,
    /// Each mode in the polynomials: `vectors[unknown][mode]`.
    vectors: Vec<Vec<f64>>,
}

/// What every mode does at one time, for a step of 1 V and a weight of one.
struct Amplitudes {
    /// `e^(-rt)`.
    decayed: f64,
    /// z less its value at the clamp.
    capacitor: Vec<f64>,
    /// w.
    voltage: Vec<f64>,
}

impl BrokenStrip {
    /// The strip of `model` whose electrodes have `beyond` times its resistance from `break_at_cm` to the end.
    pub fn new(model: &DistributedModel, break_at_cm: f64, beyond: f64) -> BrokenStrip {
        let length = model.length_cm;
        let break_at_cm = break_at_cm.clamp(NEAREST * length, (1.0 - NEAREST) * length);
        let first = model.electrode_resistance_ohm_per_cm.max(f64::MIN_POSITIVE);
        let sides = [(break_at_cm, first), (length - break_at_cm, first * beyond)];
        let stiffness = Stiffness::new(&sides);
        let (periods, modes) = Symmetric::from_fn(UNKNOWNS, |row, column| {
            let (row, column) = (stiffness.unit(row), stiffness.unit(column));
            mass(&sides, &row, &column)
        })
        .eigen();
        let largest = periods.iter().fold(0.0f64, |most, period| most.max(*period));
        let mut strip = BrokenStrip {
            model: *model,
            break_at_cm,
            mode_conductance: periods.iter().map(|p| p.max(1e-15 * largest).recip()).collect(),
            integral: vec![0.0; UNKNOWNS],
            vectors: vec![vec![0.0; UNKNOWNS]; UNKNOWNS],
        };
        let loads = loads(&sides);
        for mode in 0..UNKNOWNS {
            let norm = strip.mode_conductance[mode].sqrt();
            for (unknown, row) in modes.iter().enumerate() {
                for (place, value) in stiffness.unit(unknown) {
                    strip.vectors[place][mode] += norm * value * row[mode];
                }
            }
            strip.integral[mode] = (0..UNKNOWNS)
                .map(|place| loads[place] * strip.vectors[place][mode])
                .sum();
        }
        strip
    }

    /// Voltage between the electrodes at the positions (cm from the clamp) and times (s after a step of `step_v` from
    /// the discharged state), V.
    pub fn voltage_v(&self, step_v: f64, arc_length_cm: &[f64], time_s: &[f64]) -> StripField {
        let modes = self.modes_at(arc_length_cm);
        self.field(arc_length_cm.len(), time_s, |time_s, row| {
            let amplitudes = self.amplitudes(time_s);
            for (value, modes) in row.iter_mut().zip(&modes) {
                let fallen: f64 = modes.iter().zip(&amplitudes.voltage).map(|(m, a)| m * a).sum();
                *value = step_v * (1.0 - fallen);
            }
        })
    }

    /// Local curvature that the step induced, 1/cm.
    pub fn curvature_per_cm(&self, step_v: f64, arc_length_cm: &[f64], time_s: &[f64]) -> StripField {
        let modes = self.modes_at(arc_length_cm);
        let held: Vec<f64> = modes
            .iter()
            .map(|modes| 1.0 - modes.iter().sum::<f64>())
            .collect();
        let scale = self.model.coupling.0 * step_v * self.model.capacitance_f_per_cm;
        let (rate, relaxation) = (self.model.charging_rate_per_s(), self.model.relaxation_rate_per_s);
        let of_modes: Vec<(f64, f64)> = (0..UNKNOWNS)
            .map(|n| (rate * (1.0 - self.share(n)), 1.0 - self.steady(n)))
            .collect();
        self.field(arc_length_cm.len(), time_s, |time_s, row| {
            let at_clamp = spring_response(time_s, rate, relaxation);
            let strain: Vec<f64> = of_modes
                .iter()
                .map(|(rate, share)| share * spring_response(time_s, *rate, relaxation))
                .collect();
            for ((value, modes), held) in row.iter_mut().zip(&modes).zip(&held) {
                let charged: f64 = modes.iter().zip(&strain).map(|(m, e)| m * e).sum();
                *value = scale * (held * at_clamp + charged);
            }
        })
    }

    /// Current into the strip at the clamp, A, at times (s) after the step.
    pub fn clamp_current_a(&self, step_v: f64, time_s: &[f64]) -> Vec<f64> {
        let steady = self.model.steady_state_resistance_ohm_cm.recip();
        let charging = self.model.branch_resistance_ohm_cm.recip();
        let length = self.model.length_cm;
        let field = self.field(1, time_s, |time_s, row| {
            let amplitudes = self.amplitudes(time_s);
            let over = |of: &[f64]| self.integral.iter().zip(of).map(|(i, a)| i * i * a).sum::<f64>();
            let (fallen, held_back) = (over(&amplitudes.voltage), over(&amplitudes.capacitor));
            let across = (length - fallen) * steady;
            row[0] = step_v * (across + (length * amplitudes.decayed + held_back - fallen) * charging);
        });
        field.values
    }

    fn field(&self, positions: usize, time_s: &[f64], mut at: impl FnMut(f64, &mut [f64])) -> StripField {
        let mut values = vec![0.0; positions * time_s.len()];
        for (time_s, row) in time_s.iter().zip(values.chunks_exact_mut(positions.max(1))) {
            // Before the step the strip is discharged.
            if *time_s >= 0.0 {
                at(*time_s, row);
            }
        }
        StripField {
            positions,
            values,
            truncation_bound: None,
        }
    }

    /// `y_n = (1/R_c) / (mu_n + a)`.
    fn share(&self, mode: usize) -> f64 {
        let charging = self.model.branch_resistance_ohm_cm.recip();
        let steady = self.model.steady_state_resistance_ohm_cm.recip();
        charging / (self.mode_conductance[mode] + charging + steady)
    }

    /// `(1/R_ss) / (mu_n + 1/R_ss)`: what of a mode never charges.
    fn steady(&self, mode: usize) -> f64 {
        let steady = self.model.steady_state_resistance_ohm_cm.recip();
        steady / (self.mode_conductance[mode] + steady)
    }

    fn amplitudes(&self, time_s: f64) -> Amplitudes {
        let rate = self.model.charging_rate_per_s();
        let steady = self.model.steady_state_resistance_ohm_cm.recip();
        let charging = self.model.branch_resistance_ohm_cm.recip();
        let at_clamp = -(-rate * time_s).exp_m1();
        let mut amplitudes = Amplitudes {
            decayed: 1.0 - at_clamp,
            capacitor: Vec::with_capacity(UNKNOWNS),
            voltage: Vec::with_capacity(UNKNOWNS),
        };
        for mode in 0..UNKNOWNS {
            let charged = -(-rate * (1.0 - self.share(mode)) * time_s).exp_m1();
            let capacitor = at_clamp - charged * (1.0 - self.steady(mode));
            let driven = steady + charging * (amplitudes.decayed + capacitor);
            let voltage = driven / (self.mode_conductance[mode] + charging + steady);
            amplitudes.capacitor.push(capacitor);
            amplitudes.voltage.push(voltage);
        }
        amplitudes
    }

    /// Every mode at every position, times its integral: the weights with which modes follow a step.
    fn modes_at(&self, arc_length_cm: &[f64]) -> Vec<Vec<f64>> {
        arc_length_cm.iter().map(|&s| self.modes(s)).collect()
    }

    fn modes(&self, s: f64) -> Vec<f64> {
        let (break_at, length) = (self.break_at_cm, self.model.length_cm);
        let (side, x) = if s <= break_at {
            (0, 2.0 * s / break_at - 1.0)
        } else {
            (1, 2.0 * (s - break_at) / (length - break_at) - 1.0)
        };
        let legendre = legendre(x);
        let mut modes = vec![0.0; UNKNOWNS];
        for unknown in 0..UNKNOWNS {
            let value: f64 = coefficients(unknown, side)
                .iter()
                .map(|(degree, c)| c * legendre[*degree])
                .sum();
            if value != 0.0 {
                add(&mut modes, value, &self.vectors[unknown]);
            }
        }
        modes
            .iter_mut()
            .zip(&self.integral)
            .for_each(|(mode, integral)| *mode *= integral);
        modes
    }
}

/// Polynomials of an unknown on a side, as (degree of a Legendre polynomial, coefficient).
fn coefficients(unknown: usize, side: usize) -> Vec<(usize, f64)> {
    let rising = vec![(0, 0.5), (1, 0.5)];
    let falling = vec![(0, 0.5), (1, -0.5)];
    match (unknown, side) {
        (0, 0) | (1, 1) => rising,
        (0, 1) => falling,
        (0 | 1, _) => Vec::new(),
        _ => {
            let (own, degree) = ((unknown - 2) / (DEGREE - 1), (unknown - 2) % (DEGREE - 1) + 2);
            if own != side {
                return Vec::new();
            }
            let norm = (2.0 * (2 * degree - 1) as f64).sqrt().recip();
            vec![(degree, norm), (degree - 2, -norm)]
        }
    }
}

/// Legendre polynomials up to [`DEGREE`].
fn legendre(x: f64) -> [f64; DEGREE + 1] {
    let mut p = [1.0; DEGREE + 1];
    p[1] = x;
    for n in 1..DEGREE {
        let k = n as f64;
        p[n + 1] = ((2.0 * k + 1.0) * x * p[n] - k * p[n - 1]) / (k + 1.0);
    }
    p
}

/// `INT N_i N_j ds` of two combinations of unknowns.
fn mass(sides: &[(f64, f64); 2], a: &[(usize, f64)], b: &[(usize, f64)]) -> f64 {
    let mut sum = 0.0;
    for (side, (length, _)) in sides.iter().enumerate() {
        for (i, weight_a) in a {
            let left = coefficients(*i, side);
            for (j, weight_b) in b {
                for (degree, c) in coefficients(*j, side) {
                    let same = left.iter().filter(|(other, _)| *other == degree);
                    let product: f64 = same.map(|(_, d)| c * d).sum();
                    sum += weight_a * weight_b * product * length / (2 * degree + 1) as f64;
                }
            }
        }
    }
    sum
}

/// `INT N_i ds`.
fn loads(sides: &[(f64, f64); 2]) -> Vec<f64> {
    let of = |unknown: usize| {
        sides
            .iter()
            .enumerate()
            .map(|(side, (length, _))| {
                let constant = coefficients(unknown, side);
                let constant = constant.iter().filter(|(degree, _)| *degree == 0);
                constant.map(|(_, c)| c).sum::<f64>() * length
            })
            .sum()
    };
    (0..UNKNOWNS).map(of).collect()
}

/// Combinations of unknowns for which `INT N_i' N_j' / R_e ds` is one where i = j and zero elsewhere: the polynomials
/// that vanish at both ends of a side are so already but for a factor, and the two at break and end need one step of
/// Cholesky's.
struct Stiffness {
    /// Factor of each polynomial.
    scale: Vec<f64>,
    /// What the one at the end takes of the one at the break.
    coupling: f64,
}

impl Stiffness {
    fn new(sides: &[(f64, f64); 2]) -> Stiffness {
        // Conductance along each side; a polynomial's derivative is that in x times 2 / length.
        let along = sides.map(|(length, resistance)| 1.0 / (length * resistance));
        let at_break = along[0] + along[1];
        let at_end = along[1] - along[1] * along[1] / at_break;
        let mut scale = vec![at_break.sqrt().recip(), at_end.sqrt().recip()];
        for along in along {
            scale.extend([(2.0 * along).sqrt().recip(); DEGREE - 1]);
        }
        Stiffness {
            scale,
            coupling: along[1] / at_break,
        }
    }

    /// The combination of that index.
    fn unit(&self, index: usize) -> Vec<(usize, f64)> {
        let scale = self.scale[index];
        match index {
            1 => vec![(1, scale), (0, scale * self.coupling)],
            _ => vec![(index, scale)],
        }
    }
}

#[cfg(test)]
mod tests;
