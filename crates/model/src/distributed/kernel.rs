//! How one mode answers in time, and its expansion in `y` (see `heads`), for each quantity of the strip.
//!
//! With r = 1/(R_c C), `k = r (1 - y)` and `p_j = e^(-rt) (rt)^j / j!` the local charge of a mode is
//! `1 - e^(-kt) = 1 - SUM p_j y^j` (25), its voltage `1 - y e^(-kt)` (23), its curvature the spring's response to
//! the charge (26), its current the steady one and the charging one. The first orders are summed over the modes
//! in closed form; here stand their factors, and what is left of a mode, with a bound.

use super::DistributedModel;
use super::heads::ORDERS;
use crate::relaxation::spring_response;

/// What is asked of the strip, per unit of the driving step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Quantity {
    /// Voltage between the electrodes, 1.
    Voltage,
    /// Charge, in units of C V0.
    Charge,
    /// Spring strain in units of charge, C V0.
    Strain,
    /// Current density across the laminate, 1/(Ohm cm).
    Current,
}

/// Everything that one time needs.
pub(super) struct Kernel {
    quantity: Quantity,
    time_s: f64,
    charging_rate_per_s: f64,
    relaxation_rate_per_s: f64,
    /// 1/R_c, 1/(Ohm cm).
    branch_conductance: f64,
    /// 1/R_c + 1/R_ss, 1/(Ohm cm).
    first_conductance: f64,
    /// Factors of `T_0..T_2`.
    pub(super) head: [f64; ORDERS],
}

impl Kernel {
    /// The kernel of `quantity` at `time_s` after the step, not negative.
    pub(super) fn new(model: &DistributedModel, quantity: Quantity, time_s: f64) -> Kernel {
        let rate = model.charging_rate_per_s();
        let branch_conductance = model.branch_resistance_ohm_cm.recip();
        let steady_conductance = model.steady_state_resistance_ohm_cm.recip();
        let first_conductance = branch_conductance + steady_conductance;
        let p = poisson(rate * time_s);
        let head = match quantity {
            Quantity::Voltage => [1.0, -p[0], -p[1]],
            Quantity::Charge => [-(-rate * time_s).exp_m1(), -p[1], -p[2]],
            Quantity::Strain => strain_head(time_s, rate, model.relaxation_rate_per_s, p),
            Quantity::Current => [
                steady_conductance + branch_conductance * p[0],
                branch_conductance * p[1] - first_conductance * p[0],
                branch_conductance * p[2] - first_conductance * p[1],
            ],
        };
        Kernel {
            quantity,
            time_s,
            charging_rate_per_s: rate,
            relaxation_rate_per_s: model.relaxation_rate_per_s,
            branch_conductance,
            first_conductance,
            head,
        }
    }

    /// What a mode adds to the closed sums: `F(t, y)` less its expansion to order 2.
    pub(super) fn rest(&self, y: f64) -> f64 {
        let elapsed = self.charging_rate_per_s * self.time_s;
        let rate = self.charging_rate_per_s * (1.0 - y);
        match self.quantity {
            Quantity::Strain => {
                let exact = spring_response(self.time_s, rate, self.relaxation_rate_per_s);
                exact - (self.head[0] + y * (self.head[1] + y * self.head[2]))
            }
            _ => {
                let x = elapsed * y;
                let (decayed, mode) = ((-elapsed).exp(), (-rate * self.time_s).exp());
                let second = mode - decayed * (1.0 + x);
                let third = second - decayed * 0.5 * x * x;
                match self.quantity {
                    Quantity::Voltage => -y * second,
                    Quantity::Current => {
                        self.branch_conductance * third - self.first_conductance * y * second
                    }
                    _ => -third,
                }
            }
        }
    }

    /// Largest magnitude of the quantity where the electrodes are perfect.
    pub(super) fn largest(&self) -> f64 {
        match self.quantity {
            Quantity::Current => self.first_conductance,
            Quantity::Voltage | Quantity::Charge | Quantity::Strain => 1.0,
        }
    }

    /// Bound on `|rest(y)| / y^3` for all `y <= largest` < 1.
    pub(super) fn bound(&self, largest: f64) -> f64 {
        let second = |elapsed: f64| 0.5 * elapsed.powi(2) * (-elapsed * (1.0 - largest)).exp();
        let third = |elapsed: f64| elapsed.powi(3) / 6.0 * (-elapsed * (1.0 - largest)).exp();
        let elapsed = self.charging_rate_per_s * self.time_s;
        match self.quantity {
            Quantity::Voltage => second(elapsed),
            Quantity::Charge => third(elapsed),
            // The spring never carries more than the largest charge so far, which is largest at 3/(1 - y).
            Quantity::Strain => third(elapsed.min(3.0 / (1.0 - largest))),
            Quantity::Current => {
                self.branch_conductance * third(elapsed) + self.first_conductance * second(elapsed)
            }
        }
    }
}

/// `e^-x x^j / j!`.
fn poisson(x: f64) -> [f64; ORDERS] {
    let none = (-x).exp();
    [none, none * x, none * x * x / 2.0]
}

/// The spring's response to the first orders of the charge: to `1 - p_0`, `-p_1` and `-p_2`. The response to p_j
/// is `p_j - lambda I_j` with `I_j = INT_0^t e^(-lambda (t-u)) p_j(u) du`.
fn strain_head(time_s: f64, rate: f64, relaxation: f64, p: [f64; ORDERS]) -> [f64; ORDERS] {
    let apart = (rate - relaxation) * time_s;
    let [zeroth, first, second] = moments(apart.abs());
    // The slower rate is taken out of the integral, so that nothing overflows; where that is the charging rate
    // the integral runs backwards and its weights are those of 1 - w.
    let (outer, first, second) = if apart >= 0.0 {
        ((-relaxation * time_s).exp(), first, second)
    } else {
        (
            (-rate * time_s).exp(),
            zeroth - first,
            0.5 * zeroth - first + second,
        )
    };
    let elapsed = rate * time_s;
    let lag = relaxation * time_s * outer;
    [
        spring_response(time_s, rate, relaxation),
        lag * elapsed * first - p[1],
        lag * elapsed * elapsed * second - p[2],
    ]
}

/// `INT_0^1 e^(-zw) w^j / j! dw` for j = 0, 1, 2 and z not negative.
fn moments(z: f64) -> [f64; ORDERS] {
    if z > 2.0 {
        let decayed = (-z).exp();
        let zeroth = (1.0 - decayed) / z;
        let first = (zeroth - decayed) / z;
        return [zeroth, first, (first - 0.5 * decayed) / z];
    }
    // The recursion upwards loses digits here; the power series does not.
    let (mut sums, mut power) = ([0.0; ORDERS], 1.0);
    for k in 0..28 {
        let k = f64::from(k);
        sums[0] += power / (k + 1.0);
        sums[1] += power / (k + 2.0);
        sums[2] += power / (2.0 * (k + 3.0));
        power *= -z / (k + 1.0);
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::coupling::CurvaturePerLineCharge;
    use ieap_numerics::ode::integrate;

    fn model(relaxation_rate_per_s: f64) -> DistributedModel {
        DistributedModel {
            electrode_resistance_ohm_per_cm: 15.0,
            branch_resistance_ohm_cm: 10.0,
            capacitance_f_per_cm: 0.05,
            steady_state_resistance_ohm_cm: 143.0,
            length_cm: 4.5,
            coupling: CurvaturePerLineCharge(1.0),
            relaxation_rate_per_s,
        }
    }

    #[test]
    fn moments_are_their_integrals() {
        for z in [0.0, 1e-6, 0.3, 1.99, 2.01, 30.0] {
            let mut sums = [0.0; 3];
            let rate = |w: f64, _: &[f64], out: &mut [f64]| {
                let factor = (-z * w).exp();
                out.copy_from_slice(&[factor, factor * w, factor * w * w / 2.0]);
            };
            integrate(rate, 0.0, 1.0, &mut sums, 1e-13, 1e-16);
            for (found, expected) in moments(z).iter().zip(sums) {
                assert!((found / expected - 1.0).abs() < 1e-11, "{z}: {found} {expected}");
            }
        }
    }

    #[test]
    fn head_of_the_strain_is_the_spring_equation_driven_by_the_head_of_the_charge() {
        // Relaxation much slower, equal to and much faster than charging (rate 2/s).
        for relaxation in [0.0, 1e-3, 1.9, 2.0, 2.1, 60.0] {
            let model = model(relaxation);
            for t in [0.05, 1.0, 12.0] {
                let mut strain = [0.0; 3];
                let rate = |u: f64, y: &[f64], out: &mut [f64]| {
                    let p = poisson(2.0 * u);
                    // p_j' = r (p_(j-1) - p_j)
                    out[0] = 2.0 * p[0] - relaxation * y[0];
                    out[1] = -2.0 * (p[0] - p[1]) - relaxation * y[1];
                    out[2] = -2.0 * (p[1] - p[2]) - relaxation * y[2];
                };
                integrate(rate, 0.0, t, &mut strain, 1e-12, 1e-16);
                let head = Kernel::new(&model, Quantity::Strain, t).head;
                for (found, expected) in head.iter().zip(strain) {
                    assert!(
                        (found - expected).abs() < 1e-11,
                        "{relaxation} {t}: {found} {expected}"
                    );
                }
            }
        }
    }

    #[test]
    fn what_is_left_of_a_mode_is_of_third_order_and_below_its_bound() {
        let quantities = [
            Quantity::Voltage,
            Quantity::Charge,
            Quantity::Strain,
            Quantity::Current,
        ];
        for quantity in quantities {
            for relaxation in [0.0, 0.3, 2.0, 40.0] {
                for t in [0.01, 0.4, 2.0, 9.0, 80.0] {
                    let kernel = Kernel::new(&model(relaxation), quantity, t);
                    for largest in [0.9, 0.1, 0.01] {
                        for share in [1.0, 0.5, 0.1] {
                            let y: f64 = largest * share;
                            let allowed = kernel.bound(largest) * y.powi(3);
                            assert!(kernel.rest(y).abs() <= allowed + 1e-15, "{quantity:?} {t} {y}");
                        }
                    }
                }
            }
        }
    }
}
