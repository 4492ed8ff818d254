//! Which parameters of a fit its curves are made of, and at which places.

use super::RunAtHand;
use crate::domain::{Channel, Fit, Quantity};
use crate::fit::distributed;
use crate::model::fit_model;

/// What a sum over branches may differ by from what a fit states of all of them: rounding.
const ROUNDING: f64 = 1e-9;

/// Keys of the parameters that simulating a fit needs: those that were fitted, without the parts of branches that are not
/// there. Branches without a value are not there where the others make up all that the fit states of them together.
pub fn needed_keys(fit: &Fit) -> Vec<&str> {
    let of_model = fit_model(&fit.model).map_or(&[][..], |model| model.parameters);
    let follows = |key: &str| of_model.iter().any(|own| own.derived && own.key == key);
    let absent = absent(fit);
    let keys = fit.parameters.iter().map(|own| own.key.as_str());
    keys.filter(|key| !follows(key) && !absent.iter().any(|own| own == key))
        .collect()
}

/// Places whose curvatures the distributed model was fitted to, mm from the clamp; none of another model.
pub fn fitted_places_mm(fit: &Fit, run: &RunAtHand) -> Vec<f64> {
    let end_mm = run.length_cm().unwrap_or(0.0) * 10.0 * (1.0 + 1e-9);
    let bent = |channel: &&Channel| channel.quantity == Quantity::Curvature && !channel.is_empty();
    if fit.model == distributed::MODEL_ID {
        (run.channels().iter().filter(bent))
            .filter_map(|channel| channel.position_mm)
            .filter(|place| *place <= end_mm)
            .collect()
    } else {
        Vec::new()
    }
}

/// Resistances and capacitances of branches that are not there.
fn absent(fit: &Fit) -> Vec<String> {
    let value = |key: &str| fit.parameter(key).and_then(|estimate| estimate.value);
    let (mut conductance, mut capacitance, mut unknown) = (0.0, 0.0, Vec::new());
    for k in 1..=4 {
        let keys = [format!("r{k}_ohm_cm2"), format!("c{k}_f_per_cm2")];
        match (value(&keys[0]), value(&keys[1])) {
            (Some(resistance), Some(own)) => {
                conductance += f64::recip(resistance);
                capacitance += own;
            }
            (None, None) => unknown.extend(keys),
            _ => return Vec::new(),
        }
    }
    let is_all = |sum: f64, stated: f64| (sum - stated).abs() <= ROUNDING * stated.abs();
    let all = value("c_total_f_per_cm2").is_some_and(|stated| is_all(capacitance, stated))
        || value("r_parallel_ohm_cm2").is_some_and(|stated| is_all(conductance, stated.recip()));
    if all { unknown } else { Vec::new() }
}
