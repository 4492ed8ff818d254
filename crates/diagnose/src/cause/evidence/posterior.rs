//! Hypotheses about a group with their probabilities.

use ieap_domain::{Hypothesis, HypothesisKind};
use ieap_model::FitModel;
use rayon::prelude::*;

use super::laplace::log_evidence;
use super::policy::{self, LEAST_PROBABILITY, SIZES, log_sum, temperature};
use super::unnamed::Nameless;
use super::varies::Varying;
use crate::cause::select::Selection;
use crate::fitting::fitted::Fitted;
use crate::readings::group::RunGroup;

/// What hypotheses are weighed on.
pub(crate) struct Asked<'a, 'g> {
    pub(crate) group: &'g RunGroup<'g>,
    pub(crate) base: &'a Fitted<'g>,
    pub(crate) selection: &'a Selection<'g>,
    pub(crate) model: &'static FitModel,
}

/// A hypothesis with its weight beside the base alone, logarithms.
struct Weight<'s, 'g> {
    hypothesis: Hypothesis,
    /// What the likelihood gains.
    fall: f64,
    /// Everything else: priors, widths of peaks.
    rest: f64,
    /// Parameters that it adds.
    free: usize,
    /// The extended model, of effects that were fitted.
    fitted: Option<&'s Fitted<'g>>,
}

impl Weight<'_, '_> {
    fn log(&self) -> f64 {
        let all = self.fall + self.rest;
        // One that cannot be weighed takes nothing from the others.
        if all.is_nan() { f64::NEG_INFINITY } else { all }
    }

    /// Whether it is known effects and nothing else: what is beside them else takes up what their equations err by.
    fn is_equation(&self) -> bool {
        self.hypothesis.kind == HypothesisKind::Effect && !self.hypothesis.with_unnamed
    }
}

/// Every hypothesis, weighed.
pub(crate) struct Weighed<'s, 'g> {
    weights: Vec<Weight<'s, 'g>>,
    pub(crate) varying: Option<Varying>,
}

/// What of the hypotheses still stands.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Standing {
    /// Effects that explain no more than this leave more than noise: they stand with something unnamed beside them only.
    pub(crate) refuted_below: f64,
    /// Whether parameters may differ: each run is described by its own.
    pub(crate) may_vary: bool,
}

impl Standing {
    /// Before anything was asked of what they leave.
    pub(crate) const ALL: Standing = Standing {
        refuted_below: f64::NEG_INFINITY,
        may_vary: true,
    };
}

/// Weighs all hypotheses.
pub(crate) fn weigh<'s, 'g>(asked: &Asked<'s, 'g>) -> Weighed<'s, 'g> {
    let (slope, tangent) = asked.base.tangent();
    let residuals = asked.base.residuals();
    let nameless = Nameless::of(asked.group);
    let effects = asked
        .selection
        .steps
        .first()
        .map_or(0, |step| step.candidates.len());
    let of_unnamed = policy::EFFECT * effects.max(1) as f64;
    let mut weights = vec![
        weight(HypothesisKind::Base, policy::BASE, 0.0),
        weight(
            HypothesisKind::Unnamed,
            of_unnamed,
            nameless.unnamed(&tangent, &residuals),
        ),
        weight(
            HypothesisKind::SlowNoise,
            policy::SLOW_NOISE,
            nameless.slow_noise(&tangent, &residuals),
        ),
    ];
    let fitted = explanations(asked.selection);
    let of_fitted =
        |(fitted, prior): &(&'s Fitted<'g>, f64)| weights_of(asked.base, &nameless, fitted, *prior);
    weights.extend(fitted.par_iter().flat_map_iter(of_fitted).collect::<Vec<_>>());
    weights.extend(promised(asked.selection));
    let varying = Varying::of(asked.group, asked.base, asked.model, &slope.normal);
    if let Some(varying) = &varying {
        weights.extend(varying.weighed(asked.base).map(|(hypothesis, fall)| Weight {
            hypothesis,
            fall,
            rest: 0.0,
            free: 0,
            fitted: None,
        }));
    }
    Weighed { weights, varying }
}

impl<'s, 'g> Weighed<'s, 'g> {
    /// Probabilities of all that stands, in falling order.
    pub(crate) fn posterior(&self, standing: Standing) -> Vec<Hypothesis> {
        let (of, masses) = self.masses(standing);
        let mut found: Vec<Hypothesis> = of
            .into_iter()
            .zip(masses)
            .map(|(own, mass)| Hypothesis {
                mass,
                ..own.hypothesis.clone()
            })
            .collect();
        found.sort_by(|a, b| b.mass.total_cmp(&a.mass));
        let mut kinds: Vec<HypothesisKind> = Vec::new();
        found.retain(|own| {
            let is_first = !kinds.contains(&own.kind);
            kinds.push(own.kind);
            is_first || own.mass >= LEAST_PROBABILITY
        });
        found
    }

    /// The most probable of the effects that were fitted and leave more unexplained than is refuted; none where none is left.
    pub(crate) fn lead(&self, standing: Standing) -> Option<&'s Fitted<'g>> {
        let (of, masses) = self.masses(standing);
        let alone = of.into_iter().zip(masses);
        let alone = alone.filter(|(own, _)| own.is_equation());
        let fitted = alone.filter_map(|(own, mass)| Some((own.fitted?, mass)));
        fitted
            .max_by(|a, b| a.1.total_cmp(&b.1))
            .map(|(fitted, _)| fitted)
    }

    /// What stands, and its probabilities. Effects are held against each other by what they explain at a temperature, and
    /// together against all else as they are.
    fn masses(&self, standing: Standing) -> (Vec<&Weight<'s, 'g>>, Vec<f64>) {
        let stands = |own: &&Weight| match own.hypothesis.kind {
            HypothesisKind::Effect => own.hypothesis.with_unnamed || own.fall > standing.refuted_below,
            HypothesisKind::Varies => standing.may_vary,
            _ => true,
        };
        let of: Vec<&Weight> = self.weights.iter().filter(stands).collect();
        let equations: Vec<&&Weight> = of.iter().filter(|own| own.is_equation()).collect();
        let best = equations.iter().map(|own| own.fall).fold(0.0, f64::max);
        let t = temperature(best);
        let cooled = |own: &Weight| {
            if own.log().is_finite() {
                own.fall / t + own.rest + 0.5 * own.free as f64 * t.ln()
            } else {
                f64::NEG_INFINITY
            }
        };
        let together = log_sum(&equations.iter().map(|own| own.log()).collect::<Vec<_>>());
        let all_cooled = log_sum(&equations.iter().map(|own| cooled(own)).collect::<Vec<_>>());
        let logs: Vec<f64> = of
            .iter()
            .map(|own| {
                if own.is_equation() && all_cooled.is_finite() {
                    together + cooled(own) - all_cooled
                } else {
                    own.log()
                }
            })
            .collect();
        let all = log_sum(&logs);
        let masses = logs.iter().map(|own| (own - all).exp()).collect();
        (of, masses)
    }
}

/// A hypothesis without effects.
fn weight<'s, 'g>(kind: HypothesisKind, prior: f64, log_evidence: f64) -> Weight<'s, 'g> {
    Weight {
        hypothesis: Hypothesis {
            kind,
            effects: Vec::new(),
            form: None,
            parameters_that_differ: Vec::new(),
            with: None,
            with_unnamed: false,
            mass: 0.0,
        },
        fall: log_evidence,
        rest: prior.ln(),
        free: 0,
        fitted: None,
    }
}

fn ids(fitted: &Fitted) -> Vec<&'static str> {
    let mut ids: Vec<&'static str> = fitted
        .problem
        .effects
        .iter()
        .map(|free_effect| free_effect.effect.about().id)
        .collect();
    ids.sort_unstable();
    ids
}

/// Every extended model that was fitted with its prior weight, each set of effects once: where it explains most.
fn explanations<'s, 'g>(selection: &'s Selection<'g>) -> Vec<(&'s Fitted<'g>, f64)> {
    let singles = selection
        .steps
        .first()
        .map_or(1, |step| step.candidates.len().max(1));
    let candidates = selection.steps.iter().flat_map(|step| &step.candidates);
    let fitted = candidates.filter_map(|candidate| candidate.fitted.as_ref());
    let mut found: Vec<(Vec<&'static str>, &Fitted)> = Vec::new();
    for own in fitted.chain([&selection.model]) {
        let ids = ids(own);
        match found.iter_mut().find(|(known, _)| *known == ids) {
            Some((_, known)) if known.square > own.square => *known = own,
            Some(_) => {}
            None if ids.is_empty() => {}
            None => found.push((ids, own)),
        }
    }
    let further = policy::PAIR / singles as f64;
    let prior = |ids: &[&str]| policy::EFFECT * further.powi(ids.len() as i32 - 1);
    found.into_iter().map(|(ids, own)| (own, prior(&ids))).collect()
}

/// An extended model alone, and with something unnamed beside it.
fn weights_of<'s, 'g>(
    base: &Fitted,
    nameless: &Nameless,
    fitted: &'s Fitted<'g>,
    prior: f64,
) -> [Weight<'s, 'g>; 2] {
    let (_, tangent) = fitted.tangent();
    let (fall, rest) = log_evidence(base, fitted);
    let mut alone = weight(HypothesisKind::Effect, prior, fall);
    alone.rest += rest;
    alone.fitted = Some(fitted);
    alone.free = fitted.extra();
    let effects = &fitted.problem.effects;
    alone.hypothesis.effects = effects
        .iter()
        .map(|free_effect| free_effect.effect.about().id.to_owned())
        .collect();
    alone.hypothesis.form = effects
        .first()
        .and_then(|first| first.effect.about().variants.get(first.variant))
        .map(|form| (*form).to_owned());
    let mut beside = Weight {
        hypothesis: alone.hypothesis.clone(),
        fall: fall + nameless.unnamed(&tangent, &fitted.residuals()),
        rest: alone.rest + policy::EFFECT_AND_UNNAMED.ln(),
        free: alone.free,
        fitted: Some(fitted),
    };
    beside.hypothesis.with_unnamed = true;
    [alone, beside]
}

/// Effects that were not fitted, by what they promise.
fn promised<'s, 'g>(selection: &'s Selection<'g>) -> Vec<Weight<'s, 'g>> {
    let candidates = selection.steps.first().map_or(&[][..], |step| &step.candidates);
    let waiting = candidates.iter().filter(|candidate| candidate.fitted.is_none());
    waiting
        .map(|candidate| {
            let fall = 0.5 * candidate.forecast.max(0.0);
            let size = (2.0 * fall).sqrt().max(SIZES.0);
            let mut own = weight(HypothesisKind::Effect, policy::EFFECT, fall);
            own.rest += 0.5 * std::f64::consts::TAU.ln() - (2.0 * size * (SIZES.1 / SIZES.0).ln()).ln();
            own.hypothesis.effects = vec![candidate.effect.to_owned()];
            own.free = candidate.extra;
            own
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn effect(id: &str, fall: f64, with_unnamed: bool) -> Weight<'static, 'static> {
        let mut own = weight(HypothesisKind::Effect, 1.0, fall);
        own.hypothesis.effects = vec![id.to_owned()];
        own.hypothesis.with_unnamed = with_unnamed;
        own
    }

    fn weighed(weights: Vec<Weight<'static, 'static>>) -> Weighed<'static, 'static> {
        Weighed {
            weights,
            varying: None,
        }
    }

    #[test]
    fn a_hypothesis_that_cannot_be_weighed_takes_nothing_from_the_others() {
        let all = weighed(vec![
            effect("warburg", f64::NAN, false),
            weight(HypothesisKind::Base, 1.0, 0.0),
            weight(HypothesisKind::Unnamed, 3.0, 0.0),
        ]);
        let found = all.posterior(Standing::ALL);
        let masses: Vec<f64> = found.iter().map(|own| own.mass).collect();
        assert!((masses[0] - 0.75).abs() < 1e-12 && (masses[1] - 0.25).abs() < 1e-12);
        assert_eq!(found.len(), 2);
    }

    /// A rival that explains 95 % of what the best does keeps what is not sure, however strong both are.
    #[test]
    fn rivals_within_the_error_of_an_equation_share_what_is_left() {
        for best in [500.0, 5e5] {
            let all = weighed(vec![
                effect("warburg", best, false),
                effect("dispersion", 0.95 * best, false),
                weight(HypothesisKind::Unnamed, 1.0, 0.9 * best),
            ]);
            let found = all.posterior(Standing::ALL);
            assert!((found[0].mass - 0.95).abs() < 1e-9 && (found[1].mass - 0.05).abs() < 1e-9);
            assert!(found[2].mass < 1e-9);
        }
    }

    /// What leaves a misfit stands only with something else beside it, and its likes with it.
    #[test]
    fn what_is_refuted_leaves_room_for_something_else() {
        let all = weighed(vec![
            effect("warburg", 500.0, false),
            effect("dispersion", 499.0, false),
            effect("warburg", 520.0, true),
            weight(HypothesisKind::Varies, 1.0, 600.0),
        ]);
        let standing = Standing {
            refuted_below: 500.0,
            may_vary: false,
        };
        let found = all.posterior(standing);
        assert_eq!(found.len(), 1);
        assert!(found[0].with_unnamed && (found[0].mass - 1.0).abs() < 1e-12);
        assert!(all.lead(standing).is_none());
    }
}
