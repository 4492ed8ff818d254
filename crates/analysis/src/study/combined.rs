//! A combination of conditions as an answer.

use ieap_domain::quantiles::NORMAL_95;
use ieap_numerics::mixed::Mixture;

use super::also::also_changed;
use super::answer::{Answer, Basis, Certainty, InScope, Kind, Scale, Scope, Verdict};
use super::asking::Asking;
use super::combinations::Combinations;
use super::measured::{Measured, Value};
use super::measures::{BENDING_LOST, CURVES};
use super::policy::{LARGEST_RATIO, LEAST_ERROR};
use super::scoped::{Scoped, Told};

/// A combination of what one model of a parameter of a material tells.
pub(super) struct Term<'a> {
    pub of: &'a Measured,
    pub factors: Vec<f64>,
    /// On which side of it each value stands: positive above, negative below.
    pub side: Vec<f64>,
}

impl<'a> Term<'a> {
    /// Of conditions.
    pub fn of_conditions(of: &'a Measured, factors: Vec<f64>) -> Term<'a> {
        let side = |own: &Value| of.at(own.cell).map_or(0.0, |at| factors[at]);
        Term {
            side: of.values.iter().map(side).collect(),
            of,
            factors,
        }
    }

    /// A number in one scope, with a sign.
    pub fn of_number(told: &'a Told, sign: f64) -> Term<'a> {
        let signed = |of: &[f64]| of.iter().map(|own| sign * own).collect();
        Term {
            of: &told.of,
            factors: signed(&told.factors),
            side: signed(&told.side),
        }
    }
}

impl Asking<'_> {
    pub(super) fn blank(
        &self,
        kind: Kind,
        material: usize,
        parameter: &'static str,
        (upper, lower): (&str, &str),
    ) -> Answer {
        let is_law = kind.is_law();
        Answer {
            kind,
            is_of_study: false,
            parameter,
            scope: Scope::Material,
            material: self.conditions.materials[material].clone(),
            against_material: None,
            covariate: None,
            drawn: None,
            upper: upper.to_owned(),
            lower: lower.to_owned(),
            voltages_v: Vec::new(),
            from_to: None,
            span: None,
            times_s: None,
            most_at_s: None,
            scale: match parameter {
                BENDING_LOST => Scale::Points,
                curve if CURVES.contains(&curve) => Scale::OfRange,
                _ if is_law => Scale::PerUnit,
                _ => Scale::Ratio,
            },
            value: None,
            fits_low_95: None,
            fits_high_95: None,
            low_95: None,
            high_95: None,
            at_least: None,
            at_most: None,
            basis: Basis::Unknown,
            scatter: None,
            undone_by_scatter: None,
            no_more_than: None,
            p: None,
            q: None,
            of_strips: None,
            of_material: None,
            strips_differ_p: None,
            strips_from_to: None,
            verdict: Verdict::NotTold,
            certainty: Certainty::Open,
            samples: 0,
            runs: (0, 0),
            of_runs: Vec::new(),
            also_changed: Vec::new(),
            reason: None,
        }
    }

    /// A sum of combinations of conditions, each with its sign, in both scopes.
    pub(super) fn contrast(
        &self,
        of: &[(&Combinations, Vec<f64>, f64)],
        voltages: &[usize],
        is_asked: bool,
        blank: Answer,
    ) -> Answer {
        let scoped: Vec<_> = (of.iter()).map(|(of, factors, _)| of.scoped(factors)).collect();
        let signs = of.iter().map(|(_, _, sign)| *sign);
        let plus: Vec<(&Scoped, f64)> = scoped.iter().map(|own| &**own).zip(signs).collect();
        let voltages = |_: &[Term]| voltages.to_vec();
        self.in_scopes(&plus, voltages, is_asked, blank)
    }

    /// A sum of numbers: of the strips as they are, and beside it of their materials; the other way round where nothing tells
    /// what strips do from what their runs share by chance. Of the materials alone where these tell more.
    pub(super) fn in_scopes(
        &self,
        of: &[(&Scoped, f64)],
        voltages: impl Fn(&[Term]) -> Vec<usize>,
        is_asked: bool,
        blank: Answer,
    ) -> Answer {
        let both = InBoth::of(of);
        let (first, beside) = if both.is_by_material || both.strips.is_none() {
            (&both.material, &both.strips)
        } else {
            (&both.strips, &both.material)
        };
        let Some(told) = first else {
            return blank;
        };
        let (scale, span) = (blank.scale, blank.span);
        let answer = self.answer(told, &voltages(told), is_asked, blank);
        let beside = beside.as_ref().and_then(|of| InScope::of(of, scale, span));
        let (of_strips, of_material) = if both.is_by_material {
            (beside, None)
        } else {
            (None, beside)
        };
        let differ = of
            .first()
            .filter(|_| of.len() == 1)
            .and_then(|(own, _)| own.differ);
        let shown = |number| Answer::shown(scale, number);
        Answer {
            scope: if both.is_by_material || both.strips.is_none() {
                answer.scope
            } else {
                Scope::Strips
            },
            of_strips,
            of_material,
            strips_differ_p: differ.map(|own| own.p),
            strips_from_to: differ.map(|own| (shown(own.least), shown(own.largest))),
            ..answer
        }
    }

    /// The sum of some combinations as an answer.
    pub(super) fn answer(
        &self,
        terms: &[Term],
        voltages: &[usize],
        is_of_study: bool,
        blank: Answer,
    ) -> Answer {
        self.chosen(terms, voltages, is_of_study, (blank, 1))
    }

    /// The same of one of so many that was chosen by what was found: intervals hold of all of them together.
    pub(super) fn chosen(
        &self,
        terms: &[Term],
        voltages: &[usize],
        is_of_study: bool,
        (blank, of): (Answer, usize),
    ) -> Answer {
        let tail = 0.025 / of as f64;
        let scale = blank.scale;
        let shown = |number: f64| Answer::shown(scale, number);
        // What an error of this size is called: percent of the parameter, or points.
        let size = |number: f64| match scale {
            Scale::Points | Scale::OfRange => number,
            Scale::Ratio | Scale::PerUnit => 100.0 * number.exp_m1(),
        };
        let by_fits: Option<Vec<_>> = terms.iter().map(|term| term.of.by_fits(&term.factors)).collect();
        let Some(by_fits) = by_fits else {
            return blank;
        };
        let with_scatter = told(terms, scale, blank.span);
        // Where the scatter is known, runs and samples are weighed by it.
        let value: f64 = match &with_scatter {
            Some(all) => all.law.mean(),
            None => by_fits.iter().map(Mixture::mean).sum(),
        };
        let of_fits: f64 = by_fits.iter().map(|own| own.error().powi(2)).sum();
        let reach = Mixture::normal(0.0, of_fits.sqrt()).quantile(1.0 - tail);
        let (upper, lower) = self.places(terms);
        let mut samples: Vec<&str> = upper
            .iter()
            .chain(&lower)
            .map(|&at| self.facts[at].sample.as_str())
            .collect();
        samples.sort_unstable();
        samples.dedup();
        let is_law = blank.kind.is_law();
        let mut answer = Answer {
            is_of_study,
            voltages_v: voltages
                .iter()
                .map(|&at| self.conditions.voltages_v[at])
                .collect(),
            value: Some(shown(value)),
            fits_low_95: Some(shown(value - reach)),
            fits_high_95: Some(shown(value + reach)),
            samples: samples.len(),
            scope: if samples.len() == 1 {
                Scope::Strips
            } else {
                Scope::Material
            },
            runs: (upper.len(), lower.len()),
            of_runs: upper.iter().chain(&lower).map(|&at| self.facts[at].run).collect(),
            also_changed: if is_law {
                Vec::new()
            } else {
                also_changed(self.facts, &upper, &lower)
            },
            ..blank
        };
        if let Some(all) = with_scatter {
            answer.low_95 = Some(shown(all.law.quantile(tail)));
            answer.high_95 = Some(shown(all.law.quantile(1.0 - tail)));
            // Of a law, over all that was measured.
            answer.no_more_than = Some(size(answer.span.unwrap_or(1.0) * all.law.most_95()));
            answer.p = Some(all.law.chance_of_none());
            answer.basis = all.basis;
            let scatter: f64 = terms
                .iter()
                .filter_map(|term| term.of.scatter())
                .fold(0.0, f64::max);
            answer.scatter = Some(match scale {
                Scale::Points | Scale::OfRange => scatter,
                Scale::Ratio | Scale::PerUnit => 100.0 * scatter,
            });
        }
        if terms.iter().all(|term| term.of.is_of_single_runs()) {
            let square: f64 = terms
                .iter()
                .flat_map(|term| &term.factors)
                .map(|factor| factor * factor)
                .sum();
            let left = (value / NORMAL_95).powi(2) - of_fits;
            answer.undone_by_scatter = (left > 0.0 && square > 0.0).then(|| size((left / square).sqrt()));
        }
        answer
    }

    /// Places of the runs above and below.
    pub(super) fn places(&self, terms: &[Term]) -> (Vec<usize>, Vec<usize>) {
        let (mut upper, mut lower) = (Vec::new(), Vec::new());
        for term in terms {
            for (value, side) in term.of.values.iter().zip(&term.side) {
                match *side {
                    side if side > 0.0 => upper.push(value.place),
                    side if side < 0.0 => lower.push(value.place),
                    _ => {}
                }
            }
        }
        (upper, lower)
    }
}

/// A sum of numbers in both scopes.
pub(super) struct InBoth<'a> {
    /// Of the strips as they are; none where their materials tell more.
    pub strips: Option<Vec<Term<'a>>>,
    /// Of their materials.
    pub material: Option<Vec<Term<'a>>>,
    /// Whether the answer is that of the materials.
    is_by_material: bool,
}

impl<'a> InBoth<'a> {
    /// The sum of these, each with its sign.
    pub fn of(of: &[(&'a Scoped, f64)]) -> InBoth<'a> {
        let material = terms(of, |own| own.material.as_ref());
        // Where strips were measured at different places their material tells more than what differs within each.
        let tells_more = |own: &Vec<Term>| material.as_ref().is_none_or(|of| reach(own) <= reach(of));
        InBoth {
            strips: terms(of, |own| own.strips.as_ref()).filter(tells_more),
            is_by_material: material.is_some() && of.iter().any(|(own, _)| own.is_of_surroundings),
            material,
        }
    }
}

impl InScope {
    /// A sum in one scope; none where nothing tells the scatter.
    pub(super) fn of(terms: &[Term], scale: Scale, span: Option<f64>) -> Option<InScope> {
        let law = told(terms, scale, span)?.law;
        let shown = |number: f64| Answer::shown(scale, number);
        let (low, high) = law.ends_95();
        Some(InScope {
            value: shown(law.mean()),
            low_95: shown(low),
            high_95: shown(high),
            p: law.chance_of_none(),
            q: None,
            is_shown: false,
        })
    }
}

/// Numbers in one scope, each with its sign; none where one is not told in it.
fn terms<'a>(
    of: &[(&'a Scoped, f64)],
    scope: impl Fn(&'a Scoped) -> Option<&'a Told>,
) -> Option<Vec<Term<'a>>> {
    let term = |&(own, sign): &(&'a Scoped, f64)| Some(Term::of_number(scope(own)?, sign));
    of.iter().map(term).collect()
}

/// A sum with its scatter; none where nothing tells that, or so little that the interval holds whatever could be. Of a law
/// over `span` of its variable.
fn told(terms: &[Term], scale: Scale, span: Option<f64>) -> Option<Summed> {
    let all = summed(terms)?;
    let reach = match scale {
        Scale::Ratio => all.reach(),
        Scale::PerUnit => all.reach() * span.unwrap_or(1.0),
        // No ratios: their numbers stay as they are.
        Scale::Points | Scale::OfRange => 0.0,
    };
    (reach < LARGEST_RATIO.ln()).then_some(all)
}

/// Half-width of the 95 % interval of a sum; infinite where nothing tells the scatter.
fn reach(terms: &[Term]) -> f64 {
    summed(terms).map_or(f64::INFINITY, |all| all.reach())
}

/// A sum of combinations with its scatter.
struct Summed {
    law: Mixture,
    basis: Basis,
}

impl Summed {
    /// Half-width of the 95 % interval.
    fn reach(&self) -> f64 {
        let (low, high) = self.law.ends_95();
        0.5 * (high - low)
    }
}

/// None where nothing tells the scatter of one of them, or where values are alike to the last digit.
fn summed(terms: &[Term]) -> Option<Summed> {
    let each = terms.iter().map(|term| term.of.with_scatter(&term.factors));
    let each: Vec<_> = each.collect::<Option<_>>()?;
    let basis = each
        .iter()
        .map(|(_, basis)| *basis)
        .max()
        .unwrap_or(Basis::Unknown);
    let law = each
        .into_iter()
        .map(|(law, _)| law)
        .reduce(|all, own| all.plus(&own))?;
    (law.error() > LEAST_ERROR).then_some(Summed { law, basis })
}
