//! A record that begins under voltage, where nothing tells since when: the run is fitted with its first edge ever earlier, and
//! what all those that describe it as well have in common is stated.
//!
//! Of a current alone that is how long ago the voltage was applied times nothing: a branch is the same with a smaller resistance
//! and a larger capacitance, applied earlier. A bending strip, a discharge or a reversal in the record tells more.

use ieap_domain::quantiles::CHI_SQUARE_95_OF_ONE;
use ieap_domain::{Drive, Edge, Estimate, Fit, Parameter};
use ieap_numerics::sums;

use crate::interval_rule::is_narrow_enough;
use crate::options::{FitInput, FitOptions};
use crate::sampled::Sampled;
use crate::two_steps::{Identified, Readings, identify};
use crate::uncertainty::Residuals;
use crate::{outcome, unseen_charge};

const WHY: &str = "the record begins under voltage, and nothing tells since when: keep the rows before the voltage was applied";

/// Whether nothing tells when the first edge was.
pub(crate) fn is_unseen(drive: &Drive) -> bool {
    drive.segments.first().is_some_and(|first| first.edge.is_unseen())
}

/// The run with its first edge earlier.
struct Earlier {
    square: f64,
    parameters: Vec<Parameter>,
}

/// Halvings of a stretch of time in which an end is sought.
const HALVED: usize = 8;

/// Opens the estimates of a fit whose first edge was taken at the first reading.
pub(crate) fn open(fit: &mut Fit, input: &FitInput, options: &FitOptions) {
    let lasts_s = input.drive.segments[0].edge.open_s();
    let at = |by_s: f64| earlier(input, options, by_s);
    // By halves of the record, down to less than an interval; then the best of it, and how far on either side is as good.
    let tried_s: Vec<f64> = std::iter::once(0.0)
        .chain((0..14).rev().map(|halved| lasts_s * 0.5_f64.powi(halved)))
        .collect();
    let tried: Vec<Option<Earlier>> = tried_s.iter().map(|by_s| at(*by_s)).collect();
    let square = |own: &Option<Earlier>| own.as_ref().map_or(f64::INFINITY, |own| own.square);
    let order = (0..tried.len()).min_by(|a, b| square(&tried[*a]).total_cmp(&square(&tried[*b])));
    let Some(near) = order.filter(|near| tried[*near].is_some()) else {
        return;
    };
    let last = tried.len() - 1;
    let (mut low_s, mut high_s) = (tried_s[near.saturating_sub(1)], tried_s[(near + 1).min(last)]);
    let (mut best_s, mut least) = (tried_s[near], square(&tried[near]));
    for _ in 0..HALVED {
        for by_s in [0.5 * (low_s + best_s), 0.5 * (best_s + high_s)] {
            let found = square(&at(by_s));
            if found < least {
                (least, best_s) = (found, by_s);
            }
        }
        (low_s, high_s) = (0.5 * (low_s + best_s), 0.5 * (best_s + high_s));
    }
    let is_as_good = |own: f64| own - least <= CHI_SQUARE_95_OF_ONE;
    let end_s = |places: &mut dyn Iterator<Item = usize>| {
        let mut inside_s = best_s;
        for place in places {
            if is_as_good(square(&tried[place])) {
                inside_s = tried_s[place];
                continue;
            }
            let mut outside_s = tried_s[place];
            for _ in 0..HALVED {
                let middle_s = 0.5 * (inside_s + outside_s);
                if is_as_good(square(&at(middle_s))) {
                    inside_s = middle_s;
                } else {
                    outside_s = middle_s;
                }
            }
            break;
        }
        inside_s
    };
    let earliest_s = end_s(&mut (0..=last).filter(|place| tried_s[*place] > best_s));
    let latest_s = end_s(&mut (0..=last).rev().filter(|place| tried_s[*place] < best_s));
    let is_endless = earliest_s >= lasts_s;
    let as_good: Vec<Earlier> = [latest_s, best_s, earliest_s]
        .into_iter()
        .filter_map(at)
        .collect();
    for parameter in &mut fit.parameters {
        let of = |own: &Earlier| {
            let own = own.parameters.iter().find(|own| own.key == parameter.key);
            own.map(|own| own.estimate.clone())
        };
        let all: Vec<Estimate> = as_good.iter().filter_map(of).collect();
        parameter.estimate = common(&parameter.estimate, &all, is_endless);
    }
}

fn earlier(input: &FitInput, options: &FitOptions, by_s: f64) -> Option<Earlier> {
    let mut drive = input.drive.clone();
    drive.segments[0].edge = Edge::at(drive.segments[0].start_s() - by_s);
    let input = FitInput {
        drive: &drive,
        ..*input
    };
    let mut identified = identify(&input, options, Readings::new(&input).ok()?);
    unseen_charge::look(&input, options, &mut identified);
    let square = weighed(&identified)?;
    Some(Earlier {
        square,
        parameters: outcome::fit(&input, options, &identified, None).parameters,
    })
}

/// What is left of both responses in variances of their noise.
fn weighed(identified: &Identified) -> Option<f64> {
    let of = |sampled: &Sampled, residuals: &Residuals| {
        let noise = sampled.scatter.as_ref()?;
        let memory = residuals.long_run_variance(sums::peak(&sampled.values)) / residuals.noise.variance;
        Some(residuals.square / (noise.standard_deviation.powi(2) * memory.max(1.0)))
    };
    let (current, electrical) = identified.current.as_ref().ok()?;
    let bent = identified.curvature.as_ref().ok();
    let bent = bent.and_then(|(sampled, bending)| of(sampled, &bending.residuals));
    Some(of(current, &electrical.residuals)? + bent.unwrap_or(0.0))
}

/// What estimates have in common that hold for ever earlier edges: an end that goes on with them is open.
fn common(stated: &Estimate, all: &[Estimate], is_endless: bool) -> Estimate {
    let values: Option<Vec<f64>> = all.iter().map(|own| own.value).collect();
    let Some(values) = values.filter(|values| !values.is_empty()) else {
        return match stated.value {
            Some(_) => Estimate::not_determined(WHY),
            None => stated.clone(),
        };
    };
    let ends = |pick: fn(&Estimate) -> Option<f64>| all.iter().filter_map(pick);
    let low = ends(|own| own.low_95).fold(f64::INFINITY, f64::min);
    let high = ends(|own| own.high_95).fold(f64::NEG_INFINITY, f64::max);
    let (first, last) = (values[0], values[values.len() - 1]);
    let goes_on = is_endless
        && !(low > 0.0 && is_narrow_enough((high / low).ln().abs() * 0.5) && is_near(first, last, all));
    match goes_on {
        true if last > first => Estimate::above(low, WHY),
        true => Estimate::below(high, WHY),
        false if low > 0.0 && !is_narrow_enough(0.5 * (high / low).ln()) => Estimate::not_determined(WHY),
        // The best of them lies in the middle.
        false => Estimate {
            low_95: Some(low),
            high_95: Some(high),
            ..all[all.len() / 2].clone()
        },
    }
}

/// Whether a value stays within its own first interval.
fn is_near(first: f64, last: f64, all: &[Estimate]) -> bool {
    let half = |own: &Estimate| Some(own.high_95? - own.low_95?);
    all.first()
        .and_then(half)
        .is_some_and(|width| (last - first).abs() <= width)
}
