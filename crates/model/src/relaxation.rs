//! Back-relaxation: the spring strain that an exponentially arriving charge leaves, thesis (14), (18), (20).
//!
//! Corrections to the thesis: (18) prints e^(+t/tau), which grows for ever; it is e^(-t/tau). tau lambda = 1 is no
//! pole of (18) and (20) and does not cancel the bending. Charging is not slower than relaxation by orders of
//! magnitude, as the text beside (20) says: in the thesis's table 5 it is faster in every row.

/// Response g of the spring to a unit charge that arrives as `1 - e^(-r t)`, with r = 1/tau:
/// `g = (e^(-t/tau) - e^(-lambda t)) / (tau lambda - 1)`, dimensionless.
///
/// The printed form loses all digits where tau lambda is near 1, which is no pole: the limit there is
/// `(t/tau) e^(-t/tau)`. Here it is written as `r t e^(-min(r, lambda) t) phi(|r - lambda| t)` with
/// `phi(d) = (1 - e^-d)/d`, which keeps full precision for every rate, both rates zero included.
///
/// `elapsed_s` and both rates (1/s) must be finite and not negative.
pub fn spring_response(elapsed_s: f64, charging_rate_per_s: f64, relaxation_rate_per_s: f64) -> f64 {
    let slower = charging_rate_per_s.min(relaxation_rate_per_s);
    let apart = (charging_rate_per_s - relaxation_rate_per_s).abs() * elapsed_s;
    charging_rate_per_s * elapsed_s * (-slower * elapsed_s).exp() * saturation(apart)
}

/// `(1 - e^-d)/d`, 1 at zero; d must not be negative.
fn saturation(d: f64) -> f64 {
    if d == 0.0 { 1.0 } else { -(-d).exp_m1() / d }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agrees_with_the_printed_form_where_that_is_well_conditioned() {
        for (t, tau, lambda) in [(3.0_f64, 5.0_f64, 0.01_f64), (40.0, 2.0, 3.0), (0.1, 100.0, 0.5)] {
            let printed = ((-t / tau).exp() - (-lambda * t).exp()) / (tau * lambda - 1.0);
            let ours = spring_response(t, 1.0 / tau, lambda);
            assert!((ours / printed - 1.0).abs() < 1e-12, "{ours} {printed}");
        }
    }

    #[test]
    fn printed_sign_breaks_the_spring_equation() {
        // eps' = q' - lambda eps (14) with q = 1 - e^(-t/tau), by central differences.
        let (tau, lambda, h) = (5.0_f64, 0.02_f64, 1e-4);
        let printed = |t: f64| ((t / tau).exp() - (-lambda * t).exp()) / (tau * lambda - 1.0);
        let ours = |t: f64| spring_response(t, 1.0 / tau, lambda);
        let broken_by = |strain: &dyn Fn(f64) -> f64, t: f64| {
            let change = (strain(t + h) - strain(t - h)) / (2.0 * h);
            change - ((-t / tau).exp() / tau - lambda * strain(t))
        };
        for t in [1.0, 10.0, 50.0] {
            assert!(broken_by(&ours, t).abs() < 1e-8);
            assert!(broken_by(&printed, t).abs() > 0.3);
        }
    }

    #[test]
    fn degenerate_limit_and_no_relaxation() {
        let (t, tau) = (7.0_f64, 4.0_f64);
        let limit = t / tau * (-t / tau).exp();
        assert!((spring_response(t, 1.0 / tau, 1.0 / tau) / limit - 1.0).abs() < 1e-15);
        let near = spring_response(t, 1.0 / tau, (1.0 + 1e-13) / tau);
        assert!((near / limit - 1.0).abs() < 1e-12);
        let charge = -(-t / tau).exp_m1();
        assert!((spring_response(t, 1.0 / tau, 0.0) / charge - 1.0).abs() < 1e-15);
        assert_eq!(spring_response(t, 0.0, 0.0), 0.0);
    }
}
