//! A sensor whose zero is not known bends the scale of what is made of its readings: what is left open of it, in the intervals.

use std::sync::Arc;

use ieap_domain::quantiles::NORMAL_95;
use ieap_domain::{Channel, Fit, Issue, OpenZero, Parameter, Quantity};
use ieap_numerics::noise::local_scatter;
use ieap_numerics::sums::square;

use crate::options::FitInput;
use crate::policy::OPEN_ZERO_SIGMAS;
use crate::widened::{End, Values, values, widen_by};

/// Widens the intervals of a fit by what is left open of the zero of its bending; `fitted` fits the run, and has the parameters
/// `here` as it is. It is asked at both ends of where that zero is in 95 of 100 runs.
pub(crate) fn widen(
    fit: &mut Fit,
    input: &FitInput,
    here: Values,
    fitted: impl Fn(&FitInput) -> Option<Vec<Parameter>>,
) {
    let is_bent = |channel: &&Channel| channel.is_whole(Quantity::Curvature);
    let Some((bending, zero)) = (input.channels.iter().find(is_bent))
        .and_then(|bending| Some((bending, bending.open_zero.as_ref()?)))
        .filter(|(bending, zero)| counts(bending, zero))
    else {
        return;
    };
    let with = |sigmas: f64| {
        let mut channels = input.channels.to_vec();
        for channel in channels.iter_mut().filter(|channel| is_bent(&&**channel)) {
            let pairs = bending.values.iter().zip(&*zero.error);
            channel.values = pairs
                .map(|(value, error)| value + sigmas * error)
                .collect::<Arc<[f64]>>();
        }
        let moved = FitInput {
            channels: &channels,
            ..*input
        };
        fitted(&moved).map_or_else(Default::default, |found| values(&found))
    };
    let ends = [-NORMAL_95, NORMAL_95].map(|sigmas| {
        Some(End {
            part: 1.0,
            there: with(sigmas),
        })
    });
    if widen_by(&mut fit.parameters, &here, &[ends]) {
        fit.issues.push(issue(zero));
    }
}

/// Whether the error could move any estimate so far that it counts: by as many standard errors at most as the readings have noise in
/// it.
fn counts(bending: &Channel, zero: &OpenZero) -> bool {
    let noise = local_scatter(&[&bending.values]).map_or(0.0, |own| own.standard_deviation);
    square(&zero.error) > (OPEN_ZERO_SIGMAS * noise).powi(2)
}

fn issue(zero: &OpenZero) -> Issue {
    let message = if zero.is_free {
        "the record begins under voltage: where the tip stood at rest, and with it the zero of the sensor, is not known, and what is \
         left open of it widens the intervals"
    } else {
        "what the tip reads at rest may be the zero of the sensor or a strip that was bent, and what is left open of it widens the \
         intervals"
    };
    Issue::note("open-zero", message).at(Quantity::TipDisplacement.column())
}
