//! A quantity is stated where all that it is made of is determined; where a factor is open it is a bound, or open with that
//! factor's name.

use ieap_domain::{Estimate, EstimateState, Parameter};

/// What a coupling is divided by: curvature per charge, and the charge is that of all branches.
const CHARGE: &str = "c_total_f_per_cm2";
const PER_CHARGE: &str = "_per_c_cm";

/// Takes back what follows from a charge that is not determined.
pub(crate) fn only_with_their_factors(parameters: &mut [Parameter]) {
    let charge = parameters.iter().find(|own| own.key == CHARGE);
    let Some(charge) = charge.map(|own| own.estimate.clone()) else {
        return;
    };
    let per_charge = parameters.iter_mut().filter(|own| own.key.ends_with(PER_CHARGE));
    per_charge.for_each(|own| own.estimate = divided(&own.estimate, &charge));
}

/// What is left of a quantity that is divided by a charge.
fn divided(stated: &Estimate, charge: &Estimate) -> Estimate {
    let (Some(value), state) = (stated.value, charge.state()) else {
        return stated.clone();
    };
    let reason = || {
        format!(
            "the charge that bends the strip is open: {}",
            charge.reason.as_deref().unwrap_or("no value")
        )
    };
    let nearest_zero = |bound: Option<f64>| bound.filter(|bound| bound * value > 0.0);
    match state {
        EstimateState::Determined(_) => stated.clone(),
        // There may be more charge than was seen: less bending for each of it.
        EstimateState::Above(_) if value > 0.0 => stated.high_95.map_or_else(
            || Estimate::not_determined(reason()),
            |high| Estimate::below(high, reason()),
        ),
        EstimateState::Above(_) => stated.low_95.map_or_else(
            || Estimate::not_determined(reason()),
            |low| Estimate::above(low, reason()),
        ),
        EstimateState::Below(_) if value > 0.0 => nearest_zero(stated.low_95).map_or_else(
            || Estimate::not_determined(reason()),
            |low| Estimate::above(low, reason()),
        ),
        EstimateState::Below(_) => nearest_zero(stated.high_95).map_or_else(
            || Estimate::not_determined(reason()),
            |high| Estimate::below(high, reason()),
        ),
        EstimateState::Between(..) | EstimateState::Open => Estimate::not_determined(reason()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ieap_domain::testing::{known, parameter};

    fn coupling(alpha: f64, charge: Estimate) -> Estimate {
        let mut all = [
            parameter("alpha_per_c_cm", known(alpha, 0.1)),
            parameter(CHARGE, charge),
        ];
        only_with_their_factors(&mut all);
        all[0].estimate.clone()
    }

    #[test]
    fn a_coupling_is_stated_only_where_its_charge_is() {
        assert_eq!(coupling(10.0, known(0.1, 0.1)), known(10.0, 0.1));
        let bound = coupling(10.0, Estimate::above(0.1, "one branch was not seen"));
        assert_eq!(
            (bound.value, bound.low_95, bound.high_95),
            (None, None, known(10.0, 0.1).high_95)
        );
        assert!(bound.reason.unwrap().contains("one branch was not seen"));
        let bound = coupling(-10.0, Estimate::above(0.1, "one branch was not seen"));
        assert_eq!((bound.low_95, bound.high_95), (known(-10.0, 0.1).low_95, None));
        assert_eq!(
            coupling(10.0, Estimate::not_determined("no branch")).state(),
            EstimateState::Open
        );
    }
}
