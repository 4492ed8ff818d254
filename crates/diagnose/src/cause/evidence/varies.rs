//! Parameters that are not one number for the group: they differ from run to run, freely or with what the runs carry.
//!
//! Of every run the fit with parameters of its own says how its sum of squares rises about its best place. What of the
//! parameters is shared and what differs is then asked in closed form: a parameter that differs freely scatters about a
//! mean with a spread of its own, one that follows the voltage or a tag lies on a line.

use ieap_domain::quantiles::NORMAL_95;
use ieap_domain::{Hypothesis, HypothesisKind, Ratio, VaryingParameter, VaryingValue, range_of};
use ieap_model::FitModel;
use ieap_numerics::random_effects::{Form, Shared};
use ieap_numerics::sums;
use ieap_numerics::symmetric::Symmetric;

use super::by_voltage;
use super::laplace::known_before;
use super::own::OwnFits;
use super::policy::{
    KNOWN_BEFORE, LEAST_RATIO, MOST_FOR_ALL_SUBSETS, SPREADS, SUBSETS_FITTED, VARIES, grid, log_mean,
};
use super::shared;
use crate::cause::proof::held_out::HeldOut;
use crate::fitting::fitted::Fitted;
use crate::fitting::policy::WIDEST_HALF_LOG;
use crate::readings::group::RunGroup;

/// A spread that holds nothing together.
const FREE: f64 = 1e4;

/// What the parameters of a subset follow.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Covariate {
    /// `voltage_v`, or the id of the effect that follows a tag.
    pub(super) name: String,
    /// Place of every run on a scale of unit span about its mean.
    pub(super) at: Vec<f64>,
}

/// Parameters that differ.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Subset {
    /// Coordinates.
    pub(super) of: Vec<usize>,
    /// Place in the list of covariates; none where they differ freely.
    pub(super) with: Option<usize>,
    /// Logarithm of prior weight times evidence over the base's evidence.
    pub(super) log_weight: f64,
}

/// Parameters that differ between the runs of a group.
pub(crate) struct Varying {
    covariates: Vec<Covariate>,
    /// In falling order.
    subsets: Vec<Subset>,
    /// The leading one, fitted in full.
    shared: shared::Shared,
    /// What all runs leave with parameters of their own, and where these lie.
    own_square: f64,
    own_at: Vec<Vec<f64>>,
    /// What is left where one parameter alone is every run's own, parameter by parameter.
    alone_square: Vec<f64>,
}

impl Varying {
    /// None of a single run, or where a run cannot be fitted by itself.
    pub(crate) fn of(
        group: &RunGroup,
        base: &Fitted,
        model: &'static FitModel,
        normal: &Symmetric,
    ) -> Option<Varying> {
        if group.runs.len() < 2 {
            return None;
        }
        let own = OwnFits::of(group, base, model)?;
        let all: Vec<usize> = (0..group.runs.len()).collect();
        let covariates = covariates(group);
        let width = known_before(normal, normal.order()).log_determinant();
        let log_base = -0.5 * base.square - 0.5 * width;
        let forms = own.forms();
        let mut subsets = subsets(&forms, &covariates, log_base);
        subsets.sort_by(|a, b| b.log_weight.total_cmp(&a.log_weight));
        // What is left in full is more than the closed form has it: where parameters are far apart it is a parabola.
        let mut known: Vec<(Vec<usize>, shared::Shared)> = Vec::new();
        for _ in 0..SUBSETS_FITTED {
            let first = subsets.first()?.of.clone();
            if known.iter().any(|(of, _)| *of == first) {
                break;
            }
            let fitted = shared::fit(base, &first, &all, &own.at);
            let beyond = 0.5 * (fitted.square - least(&forms, &first)).max(0.0);
            for subset in subsets.iter_mut().filter(|subset| subset.of == first) {
                subset.log_weight -= beyond;
            }
            known.push((first, fitted));
            subsets.sort_by(|a, b| b.log_weight.total_cmp(&a.log_weight));
        }
        let first = subsets.first()?.of.clone();
        let place = known.iter().position(|(of, _)| *of == first);
        let shared = match place {
            Some(place) => known.swap_remove(place).1,
            None => shared::fit(base, &first, &all, &own.at),
        };
        Some(Varying {
            covariates,
            subsets,
            shared,
            own_square: own.square(),
            own_at: own.at,
            alone_square: (0..normal.order()).map(|k| least(&forms, &[k])).collect(),
        })
    }

    /// Prior weight of all subsets together.
    pub(crate) fn prior(&self) -> f64 {
        VARIES
    }

    /// Parameters that the leading subset adds.
    pub(crate) fn free(&self) -> usize {
        let runs = self.shared.at.len().saturating_sub(1);
        self.subsets.first().map_or(0, |first| {
            first.of.len() * if first.with.is_some() { 1 } else { runs }
        })
    }

    /// What the leading subset leaves.
    pub(crate) fn square(&self) -> f64 {
        self.shared.square
    }

    /// What all runs leave with parameters of their own.
    pub(crate) fn own_square(&self) -> f64 {
        self.own_square
    }

    /// Every subset as a hypothesis, with the logarithm of its weight.
    pub(crate) fn weighed(&self, base: &Fitted) -> impl Iterator<Item = (Hypothesis, f64)> {
        self.subsets.iter().map(|subset| {
            let hypothesis = Hypothesis {
                kind: HypothesisKind::Varies,
                effect: None,
                parameters_that_differ: subset.of.iter().map(|&k| base.base_key(k)).collect(),
                with: Some(self.followed_by(subset)),
                mass: 0.0,
            };
            (hypothesis, subset.log_weight)
        })
    }

    /// What the parameters of a subset follow.
    fn followed_by(&self, subset: &Subset) -> String {
        let name = subset.with.map(|place| self.covariates[place].name.clone());
        name.unwrap_or_else(|| "run".to_owned())
    }

    /// What the leading subset is worth where its parameters are laws of the voltage: on every drive in turn, predicted without
    /// it; none of fewer than three voltages.
    pub(crate) fn by_voltage(&self, group: &RunGroup, base: &Fitted) -> Option<HeldOut> {
        by_voltage::held_out(group, base, &self.subsets.first()?.of, &self.own_at)
    }

    /// The parameters of the leading subset, run by run.
    pub(crate) fn told(&self, group: &RunGroup, base: &Fitted) -> Vec<VaryingParameter> {
        let Some(first) = self.subsets.first() else {
            return Vec::new();
        };
        let beyond_noise = (base.square - (group.rows() - base.at.len()) as f64).max(f64::MIN_POSITIVE);
        let of_parameter = |&k: &usize| {
            let of_run = |(run, name): (usize, &str)| {
                let (at, error) = (self.shared.at[run][k], self.shared.standard_errors[run][k]);
                // A bound of the search is no value, nor is what the run does not tell.
                let is_told = !base.problem.at_limit(k, at) && error < WIDEST_HALF_LOG / NORMAL_95;
                let (value, standard_error) = base.base_value(k, at, error).filter(|_| is_told)?;
                Some(VaryingValue {
                    run: name.to_owned(),
                    step_v: group.runs[run].drive().nominal_step_v(),
                    value,
                    standard_error,
                })
            };
            let names = group.runs.iter().map(|run| run.given.name);
            let values: Vec<VaryingValue> = names.enumerate().filter_map(of_run).collect();
            let taken = (base.square - self.alone_square[k]) / beyond_noise;
            VaryingParameter {
                key: base.base_key(k),
                with: self.followed_by(first),
                share_percent: 100.0 * taken.clamp(0.0, 1.0),
                ratio: ratio(&values),
                values,
            }
        };
        let all = first.of.iter().map(of_parameter);
        let differs = |own: &VaryingParameter| own.ratio.is_none_or(|ratio| ratio.high_95 > LEAST_RATIO);
        all.filter(|own| own.values.len() > 1 && differs(own)).collect()
    }
}

/// The largest value over the smallest, its interval on the logarithmic scale.
fn ratio(values: &[VaryingValue]) -> Option<Ratio> {
    let size = |own: &&VaryingValue| own.value.abs();
    let low = values.iter().min_by(|a, b| size(a).total_cmp(&size(b)))?;
    let high = values.iter().max_by(|a, b| size(a).total_cmp(&size(b)))?;
    let value = high.value / low.value;
    let relative = |own: &VaryingValue| own.standard_error / own.value;
    let half = NORMAL_95 * relative(low).hypot(relative(high));
    (value > 0.0 && half.is_finite() && value.is_finite()).then(|| Ratio {
        value,
        low_95: value * (-half).exp(),
        high_95: value * half.exp(),
    })
}

/// What the runs of a group carry that differs between them: the voltage, and numbers that are tags.
pub(super) fn covariates(group: &RunGroup) -> Vec<Covariate> {
    let volts: Vec<f64> = group
        .runs
        .iter()
        .map(|run| run.drive().nominal_step_v().abs())
        .collect();
    let mut found = Vec::new();
    if volts.iter().all(|v| *v > 0.0) {
        let logarithms = volts.iter().map(|v| v.ln()).collect();
        found.extend(scaled("voltage_v".to_owned(), logarithms));
    }
    if let Some(first) = group.runs.first() {
        for (k, tag) in first.given.tags.iter().enumerate() {
            let at = group
                .runs
                .iter()
                .map(|run| run.given.tags.get(k).map_or(0.0, |tag| tag.at));
            found.extend(scaled(tag.id.to_owned(), at.collect()));
        }
    }
    found
}

/// None where all runs have the same, or each of two runs its own: two points lie on any line.
fn scaled(name: String, at: Vec<f64>) -> Option<Covariate> {
    let (low, high) = range_of(at.iter().copied());
    let span = high - low;
    let mean = sums::mean(&at);
    (at.len() > 2 && span > 1e-9).then(|| Covariate {
        at: at.iter().map(|x| (x - mean) / span).collect(),
        name,
    })
}

/// Every subset with its weight. `log_base` is the logarithm of the base's evidence but for what all hypotheses share: half
/// of its sum of squares and of its width, negative.
pub(super) fn subsets(forms: &[Form], covariates: &[Covariate], log_base: f64) -> Vec<Subset> {
    let parameters = forms.first().map_or(0, |form| form.pull.len());
    let sets = sets(parameters);
    let mut of_size = vec![0_usize; parameters + 1];
    for set in &sets {
        of_size[set.len()] += 1;
    }
    let sizes = of_size.iter().filter(|count| **count > 0).count();
    let kinds = 1 + covariates.len();
    let mut found = Vec::new();
    for set in sets {
        let prior = VARIES / (sizes * of_size[set.len()] * kinds) as f64;
        for with in std::iter::once(None).chain((0..covariates.len()).map(Some)) {
            let by_spread: Vec<f64> = grid(SPREADS)
                .map(|spread| match with {
                    None => free(forms, &set, spread),
                    Some(k) => along(forms, &set, &covariates[k].at, spread),
                })
                .collect();
            found.push(Subset {
                of: set.clone(),
                with,
                log_weight: prior.ln() + log_mean(&by_spread) - log_base,
            });
        }
    }
    found
}

fn sets(parameters: usize) -> Vec<Vec<usize>> {
    if parameters <= MOST_FOR_ALL_SUBSETS {
        let of = |mask: usize| (0..parameters).filter(|k| mask >> k & 1 == 1).collect();
        return (1..1_usize << parameters).map(of).collect();
    }
    let singles = (0..parameters).map(|k| vec![k]);
    let pairs = (0..parameters).flat_map(|a| (a + 1..parameters).map(move |b| vec![a, b]));
    let all = std::iter::once((0..parameters).collect());
    singles.chain(pairs).chain(all).collect()
}

/// Logarithm of the evidence where the parameters of `set` scatter freely by `spread` about a mean.
fn free(forms: &[Form], set: &[usize], spread: f64) -> f64 {
    scattering(forms, set, spread).log_evidence(KNOWN_BEFORE)
}

/// Least sum of squares where the parameters of `set` are every run's own.
pub(super) fn least(forms: &[Form], set: &[usize]) -> f64 {
    scattering(forms, set, FREE).least()
}

fn scattering(forms: &[Form], set: &[usize], spread: f64) -> Shared {
    Shared::of(forms, &set.iter().map(|&k| (k, spread)).collect::<Vec<_>>())
}

/// Logarithm of the evidence where the parameters of `set` lie on lines over `at` whose rises scatter by `spread`.
fn along(forms: &[Form], set: &[usize], at: &[f64], spread: f64) -> f64 {
    let n = forms[0].pull.len();
    let all = n + set.len();
    let place = |k: usize| if k < n { k } else { set[k - n] };
    let factor = |at: f64, k: usize| if k < n { 1.0 } else { spread * at };
    let each = || forms.iter().zip(at);
    // Rises in units of their spread have a variance of one; what is shared has its own prior in `concluded`.
    let own = |a: usize, b: usize| if a == b && a >= n { 1.0 - KNOWN_BEFORE } else { 0.0 };
    let precision = |a: usize, b: usize| {
        let of = |(form, at): (&Form, &f64)| {
            factor(*at, a) * factor(*at, b) * form.precision.get(place(a), place(b))
        };
        each().map(of).sum::<f64>() + own(a, b)
    };
    let pull = |k: usize| {
        each()
            .map(|(form, at)| factor(*at, k) * form.pull[place(k)])
            .sum()
    };
    let shared = Shared {
        precision: Symmetric::from_fn(all, precision),
        pull: (0..all).map(pull).collect(),
        square: forms.iter().map(|form| form.at_origin).sum(),
        log_widths: 0.0,
    };
    shared.log_evidence(KNOWN_BEFORE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use ieap_numerics::least_squares::Local;

    /// Runs that each know both of their parameters, at these places, to one standard error.
    fn forms(places: &[[f64; 2]], error: f64) -> Vec<Form> {
        let of = |at: &[f64; 2]| {
            let mut slope = Local::zero(2);
            for k in 0..2 {
                slope.normal.add(k, k, error.powi(-2));
            }
            Form::of(at, &slope)
        };
        places.iter().map(of).collect()
    }

    fn best(places: &[[f64; 2]], covariates: &[Covariate]) -> Subset {
        let forms = forms(places, 0.01);
        let all = subsets(&forms, covariates, 0.0);
        let most = all
            .into_iter()
            .max_by(|a, b| a.log_weight.total_cmp(&b.log_weight));
        most.unwrap()
    }

    #[test]
    fn the_parameter_that_differs_is_found_and_what_it_follows() {
        let free = [[0.0, 1.0], [0.3, 1.01], [-0.2, 0.99], [0.1, 1.0]];
        let volts = Covariate {
            name: "voltage_v".into(),
            at: vec![-0.5, -0.2, 0.2, 0.5],
        };
        let found = best(&free, std::slice::from_ref(&volts));
        assert_eq!((found.of, found.with), (vec![0], None));
        let line = [[-0.5, 1.0], [-0.2, 1.01], [0.21, 0.99], [0.5, 1.0]];
        let found = best(&line, &[volts]);
        assert_eq!((found.of, found.with), (vec![0], Some(0)));
        let both = [[0.0, 1.0], [0.3, 1.2], [-0.2, 0.7], [0.1, 1.0]];
        assert_eq!(best(&both, &[]).of, [0, 1]);
    }

    /// The closed form against a sum over all values of the deviations.
    #[test]
    fn a_scatter_is_integrated_out() {
        let (error, spread) = (0.1, 0.2);
        let forms = forms(&[[0.25, 0.0], [-0.15, 0.0]], error);
        let with = free(&forms, &[0], spread);
        let none = free(&forms, &[0], 1e-9);
        // One shared mean with a prior of variance 1/KNOWN_BEFORE: of the difference of two runs the variance is
        // 2 (error^2 + spread^2), and of their mean half of that beside the prior's.
        let log_normal = |x: f64, variance: f64| -0.5 * (x * x / variance + variance.ln());
        let of = |spread: f64| {
            let own = error * error + spread * spread;
            log_normal(0.4, 2.0 * own) + log_normal(0.05, 0.5 * own + 1.0 / KNOWN_BEFORE)
        };
        let expected = of(spread) - of(0.0);
        assert!(
            (with - none - expected).abs() < 1e-3,
            "{} {expected}",
            with - none
        );
    }
}
