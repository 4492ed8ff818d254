//! The identified parameters of the lumped model that comparisons show.

use ieap_domain::{Estimate, Fit, ParameterInfo, RunRecord};

/// Keys of the parameters that figure 26 of the thesis compares, in this report's order: what bends first.
pub const COMPARED: [&str; 5] = [
    "alpha_per_c_cm",
    "lambda_per_s",
    "c_total_f_per_cm2",
    "r_parallel_ohm_cm2",
    "rss_ohm_cm2",
];

/// Unit and shown number per stored number in a list of the parameters of a fit. The distributed model's resistances are a few
/// Ω cm², also the steady-state one, and stand in one unit as in the thesis's table 3.
pub fn shown_in(parameter: &ParameterInfo, fit: &Fit) -> (&'static str, f64) {
    match fit.parameter("rc_ohm_cm2") {
        Some(_) if parameter.unit() == "Ω cm²" => (parameter.unit(), 1.0),
        _ => (parameter.shown_unit(), parameter.shown_factor()),
    }
}

/// The estimate of a converged fit: what comparisons use. A fit that did not converge says nothing.
pub fn usable<'a>(run: &'a RunRecord, key: &str) -> Option<&'a Estimate> {
    run.fit.as_ref().filter(|fit| fit.converged)?.parameter(key)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_compared_parameter_is_known() {
        for key in COMPARED {
            assert!(ParameterInfo::of(key).is_some(), "{key}");
        }
    }
}
