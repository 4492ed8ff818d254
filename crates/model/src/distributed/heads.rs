//! Sums over all modes in closed form: what makes the series of the distributed model converge fast.
//!
//! With `c_n = (2 beta_n / L) / (beta_n^2 + g^2)` the coefficients of the steady profile
//! `S(g^2) = cosh(g(L-s)) / cosh(gL) = SUM c_n sin(beta_n s)` and `y_n = (R_e/R_c) / (beta_n^2 + g0^2)` every
//! response is `SUM c_n sin(beta_n s) F(t, y_n)`, where the modes' rates are `k_n = r (1 - y_n)`. The sums
//! `T_j = SUM c_n y_n^j sin(beta_n s)` that the expansion of F in y needs are remainders of the expansion of S in
//! its argument: `T_0 = S(g^2)`, `T_1 = T_0 - S(g0^2)`, `T_2 = T_1 + (g0^2 - g^2) S'(g0^2)`.

use super::DistributedModel;

/// Number of orders in y whose sums are taken in closed form.
pub(super) const ORDERS: usize = 3;

/// `T_0..T_2` at the position `arc_length_cm`.
pub(super) fn at_position(model: &DistributedModel, arc_length_cm: f64) -> [f64; ORDERS] {
    let profile = |decay| steady_profile(decay, arc_length_cm, model.length_cm);
    let slope = |decay| profile_slope(decay, arc_length_cm, model.length_cm);
    remainders(model, profile, slope)
}

/// The same sums integrated over the strip, `SUM (c_n / beta_n) y_n^j`, cm.
pub(super) fn over_strip(model: &DistributedModel) -> [f64; ORDERS] {
    let length = model.length_cm;
    let total = |decay: f64| {
        let g = decay.sqrt();
        if g * length < 1e-8 {
            length
        } else {
            (g * length).tanh() / g
        }
    };
    let slope = |decay: f64| {
        let tanh = (decay.sqrt() * length).tanh();
        (length * (1.0 - tanh * tanh) - total(decay)) / (2.0 * decay)
    };
    remainders(model, total, slope)
}

fn remainders(
    model: &DistributedModel,
    sum: impl Fn(f64) -> f64,
    slope: impl Fn(f64) -> f64,
) -> [f64; ORDERS] {
    let (steady, first) = (model.steady_decay_per_cm2(), model.first_decay_per_cm2());
    let zeroth = sum(steady);
    let difference = model.charging_decay_per_cm2();
    if difference == 0.0 {
        return [zeroth, 0.0, 0.0];
    }
    // Where the two arguments nearly agree the remainders lose relative precision, not absolute.
    let one = zeroth - sum(first);
    [zeroth, one, one + difference * slope(first)]
}

/// `cosh(g(L-s)) / cosh(gL)` for `decay = g^2`, free of overflow.
fn steady_profile(decay_per_cm2: f64, arc_length_cm: f64, length_cm: f64) -> f64 {
    let g = decay_per_cm2.sqrt();
    let there = (-g * arc_length_cm).exp();
    let back = (-g * (2.0 * length_cm - arc_length_cm)).exp();
    (there + back) / (1.0 + (-2.0 * g * length_cm).exp())
}

/// Derivative of the profile by `g^2`: `[u sinh(gu)/cosh(gL) - L S tanh(gL)] / (2g)` with u = L - s; g > 0.
fn profile_slope(decay_per_cm2: f64, arc_length_cm: f64, length_cm: f64) -> f64 {
    let g = decay_per_cm2.sqrt();
    let inward = length_cm - arc_length_cm;
    let sinh_over_cosh =
        -(-g * arc_length_cm).exp() * (-2.0 * g * inward).exp_m1() / (1.0 + (-2.0 * g * length_cm).exp());
    let profile = steady_profile(decay_per_cm2, arc_length_cm, length_cm);
    (inward * sinh_over_cosh - length_cm * profile * (g * length_cm).tanh()) / (2.0 * g)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::coupling::CurvaturePerLineCharge;

    fn model(electrode: f64, steady: f64) -> DistributedModel {
        DistributedModel {
            electrode_resistance_ohm_per_cm: electrode,
            branch_resistance_ohm_cm: 10.0,
            capacitance_f_per_cm: 0.0059,
            steady_state_resistance_ohm_cm: steady,
            length_cm: 4.5,
            coupling: CurvaturePerLineCharge(132.75),
            relaxation_rate_per_s: 0.29,
        }
    }

    /// Sums over a million modes, smallest terms first: over points and over the strip.
    fn summed(model: &DistributedModel, order: i32, s: f64) -> (f64, f64) {
        let (mut at_point, mut over) = (0.0, 0.0);
        for n in (1..=1_000_000).rev() {
            let beta = (2 * n - 1) as f64 * std::f64::consts::PI / (2.0 * model.length_cm);
            let c = 2.0 * beta / model.length_cm / (beta * beta + model.steady_decay_per_cm2());
            let y = model.charging_decay_per_cm2() / (beta * beta + model.first_decay_per_cm2());
            at_point += c * y.powi(order) * (beta * s).sin();
            over += c / beta * y.powi(order);
        }
        (at_point, over)
    }

    #[test]
    fn closed_sums_are_the_sums_over_modes() {
        for model in [model(15.0, 143.0), model(0.02, f64::INFINITY), model(800.0, 20.0)] {
            let over = over_strip(&model);
            for s in [0.7, 4.5] {
                let at = at_position(&model, s);
                for order in 0..ORDERS {
                    let (point, strip) = summed(&model, order as i32, s);
                    // The sum of order 0 itself converges with 1/n only.
                    let allowed = if order == 0 { 2e-6 } else { 1e-11 };
                    assert!(
                        (at[order] - point).abs() < allowed,
                        "{order} {s}: {} {point}",
                        at[order]
                    );
                    assert!(
                        (over[order] - strip).abs() < allowed,
                        "{order}: {} {strip}",
                        over[order]
                    );
                }
            }
        }
    }

    #[test]
    fn clamp_has_the_full_voltage_and_a_perfect_electrode_no_profile() {
        assert_eq!(at_position(&model(15.0, 143.0), 0.0), [1.0, 0.0, 0.0]);
        assert_eq!(at_position(&model(0.0, 143.0), 3.0), [1.0, 0.0, 0.0]);
        assert_eq!(over_strip(&model(0.0, f64::INFINITY)), [4.5, 0.0, 0.0]);
    }
}
