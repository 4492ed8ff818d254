//! What a fit estimates beside the parameters of its model: edges, zeros, the offset of a clock, a charge that no reading saw,
//! the memory of the noise that weighs it.
//! A fit can be made again from its parameters and these.

use ieap_domain::quantiles::NORMAL_95;
use ieap_domain::{Drive, Estimate, Nuisance, NuisanceOrigin, Quantity};

use crate::bending::Bending;
use crate::edges::Settled;
use crate::electrical::{Electrical, Unseen};
use crate::joint::single::Judged;
use crate::zero::Zero;

const NO_REST: &str = "nothing was read at rest, and nothing else tells it from what is held: taken as 0";

/// The key of a channel's zero.
fn zero_key(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::Curvature => "curvature_zero_per_cm",
        _ => "current_zero_a",
    }
}

fn about(value: f64, standard_error: f64) -> Estimate {
    let half = NORMAL_95 * standard_error;
    Estimate::determined(value, standard_error, value - half, value + half)
}

/// Widens an interval by what moves its middle so far, half of a 95 % interval.
pub(crate) fn widen(estimate: &mut Estimate, half: f64) {
    if let (Some(value), Some(error)) = (estimate.value, estimate.standard_error) {
        *estimate = about(value, error.hypot(half / NORMAL_95));
    }
}

fn estimated(key: String, estimate: Estimate) -> Nuisance {
    Nuisance {
        key,
        estimate,
        origin: NuisanceOrigin::Readings,
    }
}

/// The zero of a channel; taken as 0 where none was fitted.
pub(crate) fn zero(quantity: Quantity, zero: Option<Zero>) -> Nuisance {
    let key = zero_key(quantity).to_owned();
    match zero {
        Some(zero) => estimated(key, about(zero.value, zero.standard_error)),
        None => Nuisance {
            key,
            estimate: Estimate {
                value: Some(0.0),
                ..Estimate::not_determined(NO_REST)
            },
            origin: NuisanceOrigin::Assumed,
        },
    }
}

/// The memories of the noise that a fit allows for, of current and curvature.
pub(crate) fn memories(found: [Option<Estimate>; 2]) -> impl Iterator<Item = Nuisance> {
    let keys = ["current_noise_correlation", "curvature_noise_correlation"];
    let of = |(key, estimate): (&str, Option<Estimate>)| {
        let nuisance = estimated(key.to_owned(), estimate?);
        let is_assumed = nuisance.estimate.value.is_some() && nuisance.estimate.standard_error.is_none();
        Some(Nuisance {
            origin: if is_assumed {
                NuisanceOrigin::Assumed
            } else {
                nuisance.origin
            },
            ..nuisance
        })
    };
    keys.into_iter().zip(found).filter_map(of)
}

/// Zeros, unseen charge and memories of the noise of a run that was fitted in two steps, or judged after them.
pub(crate) fn of_steps(
    electrical: Option<&Electrical>,
    bending: Option<&Bending>,
    judged: Option<&Judged>,
) -> Vec<Nuisance> {
    let judged_zero = |k: usize| judged.and_then(|judged| judged.zeros[k]);
    let current = electrical.map(|own| zero(Quantity::Current, judged_zero(0).or_else(|| own.zero())));
    let curvature = bending.map(|own| zero(Quantity::Curvature, judged_zero(1).or(own.zero)));
    let unseen = electrical.and_then(unseen_charge);
    let memories = judged.map_or_else(
        || {
            [
                electrical.map(|own| own.residuals.memory()),
                bending.map(|own| own.residuals.memory()),
            ]
        },
        |judged| judged.memories.clone(),
    );
    let found = [current, curvature, unseen].into_iter().flatten();
    found.chain(self::memories(memories)).collect()
}

/// Zero and memory of the noise of a bending that is fitted without a current.
pub(crate) fn of_bending(judged: &Judged) -> Vec<Nuisance> {
    let zero = zero(Quantity::Curvature, judged.zeros[1]);
    std::iter::once(zero)
        .chain(memories(judged.memories.clone()))
        .collect()
}

/// What is known of a charge that no reading of the current saw, in percent of the whole.
fn unseen_charge(electrical: &Electrical) -> Option<Nuisance> {
    const SAW_NONE: &str = "no reading of the current saw it, and the bending asks for none";
    const NOTHING_TELLS: &str = "no reading of the current saw it, and no bending tells";
    let percent = |part: f64| 100.0 * part;
    let estimate = match electrical.unseen? {
        Unseen::Told { part, error } => {
            let found = about(percent(part), percent(error));
            Estimate {
                low_95: found.low_95.map(|low| low.max(0.0)),
                high_95: found.high_95.map(|high| high.min(100.0)),
                ..found
            }
        }
        Unseen::AtMost(share) => Estimate::below(percent(share / (1.0 + share)), SAW_NONE),
        Unseen::NotKnown => Estimate::not_determined(NOTHING_TELLS),
    };
    Some(estimated("unseen_charge_percent".to_owned(), estimate))
}

/// The edges of a drive that only readings tell, each where the fit has it.
pub(crate) fn edges(settled: &Settled, given: &Drive) -> Vec<Nuisance> {
    let placed = settled.edges.drive();
    let errors = settled.errors_s();
    let edges = given
        .segments
        .iter()
        .zip(&placed.segments)
        .zip(errors)
        .enumerate();
    let open = edges.filter(|(_, ((given, _), _))| !given.edge.is_stated());
    let of =
        |(at, ((given, placed), error_s)): (usize, ((&ieap_domain::Segment, &ieap_domain::Segment), f64))| {
            let found = about(placed.start_s(), error_s);
            // The readings beside it set the last ends.
            let estimate = Estimate {
                low_95: found.low_95.map(|low| low.max(given.edge.no_earlier_s)),
                high_95: found.high_95.map(|high| high.min(given.edge.no_later_s)),
                ..found
            };
            estimated(format!("edge_{}_s", at + 1), estimate)
        };
    open.map(of).collect()
}

/// How far the clock of the bending is ahead of that of the voltage, s, with its standard error.
pub(crate) fn clock(ahead_s: f64, error_s: f64) -> Nuisance {
    estimated("bending_clock_ahead_s".to_owned(), about(ahead_s, error_s))
}
