//! A record that begins under voltage, where nothing tells since when: the run is fitted with its first edge ever earlier, and
//! what all those that describe it as well have in common is stated.
//!
//! Of a current alone that is how long ago the voltage was applied times nothing: a branch is the same with a smaller resistance
//! and a larger capacitance, applied earlier. A bending strip, a discharge or a reversal in the record tells more.

use ieap_domain::quantiles::CHI_SQUARE_95_OF_ONE;
use ieap_domain::{Channel, Drive, Edge, Estimate, Fit};
use ieap_numerics::sums;

use crate::error::FitError;
use crate::interval_rule::is_narrow_enough;
use crate::line::Line;
use crate::options::{FitInput, FitOptions};
use crate::sampled::Sampled;
use crate::settled_edges::settled;
use crate::two_steps::{Readings, identify};
use crate::uncertainty::Residuals;
use crate::unseen_charge;

const WHY: &str = "the record begins under voltage, and nothing tells since when: keep the rows before the voltage was applied";

/// Whether nothing tells when the first edge was.
pub(crate) fn is_unseen(drive: &Drive) -> bool {
    drive.segments.first().is_some_and(|first| first.edge.is_unseen())
}

/// Halvings of the record down to the first time that is tried: less than an interval of most records.
const FINEST: i32 = 14;

/// Fits a run whose first edge nothing tells; `seen` fits one whose first edge is stated.
///
/// # Errors
/// As [`crate::fit_run`].
pub(crate) fn fit(
    input: &FitInput,
    options: &FitOptions,
    seen: impl Fn(&FitInput) -> Result<Fit, FitError>,
) -> Result<Fit, FitError> {
    let mut fit = seen(&FitInput {
        drive: &earlier(input.drive, 0.0),
        ..*input
    })?;
    let last_s = |channel: &Channel| channel.time_s.last().copied();
    let ends_s = input.channels.iter().filter_map(last_s).fold(0.0, f64::max);
    let lasts_s = (ends_s - input.drive.segments[0].start_s()).max(f64::MIN_POSITIVE);
    let at = |by_s: f64| left(input, options, &earlier(input.drive, by_s));
    // By halves of the record; then the best of it, and how far on either side is as good.
    let halved = (0..FINEST).rev().map(|halved| lasts_s * 0.5_f64.powi(halved));
    let tried_s: Vec<f64> = std::iter::once(0.0).chain(halved).collect();
    let tried: Vec<Option<Left>> = tried_s.iter().map(|by_s| at(*by_s)).collect();
    // In variances of the noise where the model leaves least, one for all.
    let noise: Left = std::array::from_fn(|k| {
        let variances = tried.iter().flatten().map(|own| own[k].1);
        (0.0, variances.fold(f64::INFINITY, f64::min))
    });
    let square = |own: &Option<Left>| {
        let of = |own: &Left| {
            own.iter()
                .zip(noise)
                .map(|((square, _), (_, noise))| square / noise)
                .sum()
        };
        own.as_ref().map_or(f64::INFINITY, of)
    };
    let Some(line) = Line::of(&tried_s, |by_s| square(&at(by_s)), |_| CHI_SQUARE_95_OF_ONE) else {
        return Ok(fit);
    };
    let of = |by_s: f64| {
        let drive = earlier(input.drive, by_s);
        seen(&FitInput {
            drive: &drive,
            ..*input
        })
    };
    let (latest, best, earliest) = (of(line.low)?, of(line.best)?, of(line.high)?);
    let is_endless = line.high >= lasts_s;
    for parameter in &mut fit.parameters {
        let own = |fit: &Fit| fit.parameter(&parameter.key).cloned();
        let all: Vec<Estimate> = [&latest, &best, &earliest].into_iter().filter_map(own).collect();
        parameter.estimate = common(&parameter.estimate, &all, is_endless);
    }
    let parameters = fit.parameters;
    Ok(Fit { parameters, ..best })
}

/// The drive with its first edge so long before the first reading, s.
fn earlier(drive: &Drive, by_s: f64) -> Drive {
    let mut earlier = drive.clone();
    let at_s = drive.segments[0].start_s() - by_s;
    // Not stated: a branch that charges before the first reading is not seen.
    earlier.segments[0].edge = Edge::between(at_s, at_s);
    earlier
}

/// What is left of current and curvature, and the variance of a long sum of it.
type Left = [(f64, f64); 2];

fn left(input: &FitInput, options: &FitOptions, drive: &Drive) -> Option<Left> {
    let settled = settled(&FitInput { drive, ..*input }, options).ok()?;
    let input = FitInput {
        drive: settled.edges.drive(),
        ..*input
    };
    let mut identified = identify(&input, options, Readings::new(&input).ok()?);
    unseen_charge::look(&input, options, &mut identified);
    let of = |sampled: &Sampled, residuals: &Residuals| {
        (
            residuals.square,
            residuals.long_run_variance(sums::peak(&sampled.values)),
        )
    };
    let (current, electrical) = identified.current.as_ref().ok()?;
    let bent = identified.curvature.as_ref().ok();
    let bent = bent.map(|(sampled, bending)| of(sampled, &bending.residuals));
    Some([of(current, &electrical.residuals), bent.unwrap_or((0.0, 1.0))])
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
