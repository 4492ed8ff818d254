//! Candidates in the order of what they promise, the promising ones fitted in full.

use rayon::prelude::*;

use crate::cause::extended_start::ExtendedStart;
use crate::cause::policy::{
    AS_GOOD, CONTENDING_WITHIN_PART, FEWEST_FITTED, MOST_FITTED, PRICE, PROMISING_PART, PROMISING_WITHIN,
    STARTS,
};
use crate::fitting::fitted::Fitted;
use crate::misfit::signature::{Direction, Signature};
use ieap_numerics::sums::dot;

/// A candidate with its forecast and, where it was fitted, the extended model.
#[derive(Clone)]
pub(crate) struct CandidateFit<'g> {
    pub(crate) effect: &'static str,
    pub(crate) variant: usize,
    /// The direction with the best forecast.
    pub(crate) direction: usize,
    pub(crate) forecast: f64,
    pub(crate) fitted: Option<Fitted<'g>>,
    /// Fall of the sum of squares by the full fit.
    pub(crate) gain: f64,
    /// Parameters that it adds.
    pub(crate) extra: usize,
    /// Evidence that its choice of forms must bring.
    pub(crate) forms: f64,
}

impl CandidateFit<'_> {
    /// Gain less the price of the strength and of the forms.
    pub(crate) fn score(&self) -> f64 {
        self.gain - self.price()
    }

    fn price(&self) -> f64 {
        PRICE * self.extra.min(1) as f64 + self.forms
    }

    /// The score, or the one that was forecast where it is more: the quick fit may not have arrived.
    fn promise(&self) -> f64 {
        self.score().max(self.forecast - self.price())
    }
}

/// Looks at every effect beside those that `current` has.
pub(crate) fn fit_candidates<'g>(
    current: &Fitted<'g>,
    residuals: &[f64],
    signatures: &[Signature],
    directions: &[Direction],
) -> Vec<CandidateFit<'g>> {
    let has = |id: &str| {
        current
            .problem
            .effects
            .iter()
            .any(|free_effect| free_effect.effect.about().id == id)
    };
    let mut candidates: Vec<(CandidateFit, Vec<usize>)> = Vec::new();
    for (place, direction) in directions.iter().enumerate() {
        let signature = &signatures[direction.signature];
        let id = signature.effect.about().id;
        if has(id) {
            continue;
        }
        let forecast = direction.gain(residuals);
        match candidates
            .iter_mut()
            .find(|(candidate, _)| candidate.effect == id)
        {
            Some((candidate, places)) => {
                places.push(place);
                if forecast > candidate.forecast {
                    candidate.forecast = forecast;
                    candidate.direction = place;
                    candidate.variant = signature.variant;
                }
            }
            None => candidates.push((
                CandidateFit {
                    effect: id,
                    variant: signature.variant,
                    direction: place,
                    forecast,
                    fitted: None,
                    gain: 0.0,
                    extra: signature.free_effect().free(),
                    forms: 0.0,
                },
                vec![place],
            )),
        }
    }
    for (candidate, places) in &mut candidates {
        let gains = places.iter().map(|&place| directions[place].gain(residuals));
        candidate.forms = price_of_forms(gains, candidate.forecast);
    }
    candidates.sort_by(|a, b| b.0.forecast.total_cmp(&a.0.forecast));
    let best = candidates
        .first()
        .map_or(0.0, |(candidate, _)| candidate.forecast);
    let promising = |(rank, (candidate, _)): &(usize, &(CandidateFit, Vec<usize>))| {
        let near =
            candidate.forecast >= PROMISING_PART * best || candidate.forecast >= best - PROMISING_WITHIN;
        *rank < MOST_FITTED && candidate.forecast > 0.0 && (near || *rank < FEWEST_FITTED)
    };
    let count = candidates.iter().enumerate().take_while(promising).count();
    // A law without free strength can do more than its forecast, which is for a strength that could be chosen.
    let (mut candidates, rest): (Vec<_>, Vec<_>) = candidates
        .into_iter()
        .enumerate()
        .partition(|(rank, (candidate, _))| *rank < count || candidate.extra == 0);
    let count = candidates.len();
    candidates.extend(rest);
    let mut candidates: Vec<(CandidateFit, Vec<usize>)> =
        candidates.into_iter().map(|(_, candidate)| candidate).collect();
    let extended_start = ExtendedStart::of(current);
    candidates[..count]
        .par_iter_mut()
        .for_each(|(candidate, places)| {
            fit(
                candidate,
                places,
                &extended_start,
                residuals,
                signatures,
                directions,
            );
        });
    let mut candidates: Vec<CandidateFit> = candidates.into_iter().map(|(candidate, _)| candidate).collect();
    let best = candidates[..count]
        .iter()
        .map(CandidateFit::score)
        .fold(0.0, f64::max);
    candidates[..count].par_iter_mut().for_each(|candidate| {
        if candidate.promise() > (1.0 - CONTENDING_WITHIN_PART) * best - PROMISING_WITHIN {
            converge(candidate, current);
        }
    });
    candidates[..count].sort_by(|a, b| b.score().total_cmp(&a.score()));
    simplest_first(&mut candidates[..count]);
    candidates
}

/// What an effect pays for having had the choice among forms of these gains: the best one's gain less what they bring on
/// average. Nothing where all explain the readings alike, twice the logarithm of their number where one alone does. A price
/// for every parameter of a form is too low where the readings know the form and too high where they do not.
fn price_of_forms(gains: impl ExactSizeIterator<Item = f64>, best: f64) -> f64 {
    let count = gains.len() as f64;
    let likelihood: f64 = gains.map(|gain| (0.5 * (gain - best)).exp()).sum();
    -2.0 * (likelihood / count).ln()
}

/// Of the candidates that explain as much as the best the one with the fewest parameters comes first. What is allowed for
/// equations that are not exact does not count here: a simpler law that leaves a misfit would hide the better one.
fn simplest_first(candidates: &mut [CandidateFit]) {
    let Some(best) = candidates.iter().map(CandidateFit::score).max_by(f64::total_cmp) else {
        return;
    };
    let least = best - AS_GOOD;
    let as_good = candidates
        .iter()
        .take_while(|other| other.score() > least && other.fitted.is_some());
    let simplest = as_good
        .enumerate()
        .min_by_key(|(rank, other)| (other.extra, *rank));
    if let Some((place, _)) = simplest {
        candidates[..=place].rotate_right(1);
    }
}

/// The current model with the one effect that all `signatures` are of, from its most promising shapes; none where it
/// cannot be fitted.
pub(crate) fn added<'g>(
    current: &Fitted<'g>,
    residuals: &[f64],
    signatures: &[Signature],
    directions: &[Direction],
) -> Option<Fitted<'g>> {
    let extended_start = ExtendedStart::of(current);
    let first = signatures.first()?;
    let mut candidate = CandidateFit {
        effect: first.effect.about().id,
        variant: first.variant,
        direction: 0,
        forecast: 0.0,
        fitted: None,
        gain: 0.0,
        extra: 0,
        forms: 0.0,
    };
    let places: Vec<usize> = (0..directions.len()).collect();
    if !places.is_empty() {
        fit(
            &mut candidate,
            &places,
            &extended_start,
            residuals,
            signatures,
            directions,
        );
    }
    // An effect that a refit takes up entirely has no direction of its own: it is searched from its first shape.
    candidate
        .fitted
        .or_else(|| extended_start.extended(first, first.part))
}

/// Goes on to the end with all columns of the Jacobian.
fn converge(candidate: &mut CandidateFit, current: &Fitted) {
    if let Some(fitted) = candidate.fitted.take() {
        let fitted = fitted.converged().in_own_limits();
        candidate.gain = current.square - fitted.square;
        candidate.fitted = Some(fitted);
    }
}

/// Fits one candidate in full from its best probes.
fn fit<'g>(
    candidate: &mut CandidateFit<'g>,
    places: &[usize],
    extended_start: &ExtendedStart<'_, 'g>,
    residuals: &[f64],
    signatures: &[Signature],
    directions: &[Direction],
) {
    let current = extended_start.current;
    let mut ranked: Vec<usize> = places.to_vec();
    ranked.sort_by(|&a, &b| {
        directions[b]
            .gain(residuals)
            .total_cmp(&directions[a].gain(residuals))
    });
    let variants = signatures[directions[ranked[0]].signature]
        .effect
        .about()
        .variants
        .len()
        .max(1);
    let best_of = |variant: usize| {
        ranked
            .iter()
            .copied()
            .filter(move |&p| signatures[directions[p].signature].variant == variant)
    };
    let mut starts: Vec<usize> = (0..variants)
        .filter_map(|variant| best_of(variant).next())
        .collect();
    starts.extend(
        ranked
            .iter()
            .copied()
            .filter(|p| !starts.contains(p))
            .take(STARTS.saturating_sub(starts.len()))
            .collect::<Vec<_>>(),
    );
    let tried = starts.into_iter().filter_map(|place| {
        let direction = &directions[place];
        let signature = &signatures[direction.signature];
        let strength = signature.part * dot(&direction.unit, residuals) / direction.norm;
        let fitted = extended_start.extended(signature, strength)?;
        Some((fitted, signature.variant, place))
    });
    let best = tried.min_by(|a, b| a.0.square.total_cmp(&b.0.square));
    if let Some((fitted, variant, _)) = best {
        candidate.gain = current.square - fitted.square;
        candidate.extra = fitted.extra() - current.extra();
        candidate.variant = variant;
        candidate.fitted = Some(fitted);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_form_costs_as_much_as_the_readings_had_to_choose() {
        let price = |gains: &[f64]| price_of_forms(gains.iter().copied(), 60.0);
        assert!(price(&[60.0]).abs() < 1e-12);
        assert!(price(&[60.0; 9]).abs() < 1e-12);
        assert!((price(&[60.0, 0.0, 0.0, 0.0]) - 2.0 * 4.0_f64.ln()).abs() < 1e-9);
        assert!((price(&[60.0, 60.0, 0.0, 0.0]) - 2.0 * 2.0_f64.ln()).abs() < 1e-9);
    }
}
