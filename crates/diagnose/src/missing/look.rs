//! A misfit looked at: everything weighed, what leads held out, law after law, the account of the error, and what is told.

use ieap_domain::finding_words::variable_words;
use ieap_domain::{Account, HeldOutError, Hypothesis, MissingLaw, Verdict};
use ieap_model::FitModel;
use ieap_model::effects::Site;
use ieap_model::effects::smooth_laws::Place;

use super::account::account;
use super::columns::{LawColumns, columns};
use super::drawn::drawn;
use super::policy::{CLEAR_GAIN, LARGER_PART, MOST_LAWS, MOST_RIVALS, NEXT_FROM_PART, SURE};
use super::posterior::{differing, posterior};
use super::told::{Told, told};
use super::weighed::{Asked, Says, Weighed};
use crate::cause::evidence::Varying;
use crate::cause::proof::by_size::between;
use crate::cause::proof::held_out::{HeldOut, Part, nrmse, parts};
use crate::cause::selection_input::SelectionInput;
use crate::fitting::fitted::Fitted;
use crate::fitting::scale::scale;
use crate::levels::RIGHT_FROM;
use crate::misfit::signature::{Direction, directions};
use crate::readings::group::RunGroup;

/// What is found of a misfit.
pub(crate) struct Found<'g> {
    /// `Law`, `Differs` or `Unexplained`.
    pub(crate) verdict: Verdict,
    /// The laws that are told.
    pub(crate) laws: Vec<MissingLaw>,
    /// The base with these laws, or with what was tried; none where nothing could be fitted.
    pub(crate) lead: Option<Lead<'g>>,
    pub(crate) account: Account,
    /// What may be behind the misfit beside the base, the most probable first.
    pub(crate) posterior: Vec<Hypothesis>,
    pub(crate) varying: Option<Varying>,
    /// Whether slow noise, if it were asked as a rival, would be sure: that is for the readings beside it to refute.
    pub(crate) may_be_noise: bool,
    /// Explanations beside the base that are not ruled out, in few words; of one that is sure none.
    pub(crate) rivals: Vec<(String, Fitted<'g>)>,
}

impl Found<'_> {
    /// Mean square by which the leading explanation misses what was held out, current and curvature, in parts of that of their range;
    /// none where nothing leads.
    pub(crate) fn held_out_square(&self, group: &RunGroup) -> Option<f64> {
        let after = &self.lead.as_ref()?.held_out.after;
        let each = (0..2).filter_map(|channel| nrmse(group, after, channel));
        Some(each.map(|error| error * error).sum())
    }
}

/// The explanation that leads.
pub(crate) struct Lead<'g> {
    pub(crate) model: Fitted<'g>,
    /// Chance of what it leaves; none where it is not told.
    pub(crate) p_leftover: Option<f64>,
    /// Against the base.
    pub(crate) held_out: HeldOut,
    /// Of each part of it whether others lie on both sides of it in the variables of all laws.
    pub(crate) between: Vec<bool>,
}

/// Looks at a misfit beside the base; `beside_base` are the directions of the equations there.
pub(crate) fn look<'g>(
    input: &SelectionInput<'_, 'g>,
    beside_base: &[Direction],
    model: &'static FitModel,
) -> Found<'g> {
    let base = input.base;
    let first = Round::of(input, base, beside_base, model);
    let by_base = parts(base, input.group);
    let mut laws = Vec::new();
    let mut lead: Option<Lead<'g>> = None;
    let mut later: Option<Round<'g>> = None;
    for _ in 0..MOST_LAWS {
        let round = later.as_ref().unwrap_or(&first);
        let before = lead.as_ref().map_or(&by_base, |lead| &lead.held_out.after);
        let is_sure = round.told.site.is_some();
        if !is_sure && lead.is_some() {
            break;
        }
        let current = lead.as_ref().map_or(base, |lead| &lead.model);
        let Some(Predicting {
            model: next,
            held_out,
            between,
            log_odds,
        }) = round.predicting(input, current, before)
        else {
            break;
        };
        // A law must predict better what it has not seen, beside the laws before it, and take the larger part of the error: what
        // leaves most of it stands beside something else that is the law.
        let takes_most = left_part(current, &next) < LARGER_PART;
        let is_told = is_sure && takes_most && log_odds >= CLEAR_GAIN;
        if !is_told && lead.is_some() {
            break;
        }
        let after = held_out.after.clone();
        if is_told {
            laws.push(round.described(input, &next, &judged(&held_out, &between)));
        }
        let p_leftover = is_told.then(|| input.p_of(&next));
        let is_more = left_part(base, &next) >= NEXT_FROM_PART;
        let earlier = lead.map_or_else(|| vec![true; between.len()], |lead| lead.between);
        lead = Some(Lead {
            between: earlier.iter().zip(&between).map(|(a, b)| *a && *b).collect(),
            p_leftover,
            held_out: HeldOut {
                before: by_base.clone(),
                after,
            },
            model: next,
        });
        // Beside something of which only the place is known nothing more can be.
        let is_law = round.told.place.is_some();
        if !(is_law && is_more && p_leftover.is_some_and(|p| p < RIGHT_FROM)) {
            break;
        }
        later = lead.as_ref().map(|lead| {
            let (_, tangent) = lead.model.tangent();
            let beside = directions(input.signatures, &tangent);
            Round::of(input, &lead.model, &beside, model)
        });
    }
    let own = first.weighed.varying.as_ref().map(Varying::own_square);
    let verdict = match () {
        () if first.mass(|own| own == Says::Differ) >= SURE => Verdict::Differs,
        () if laws.is_empty() => Verdict::Unexplained,
        () => Verdict::Law,
    };
    let told_model = lead.as_ref().map(|lead| &lead.model).filter(|_| !laws.is_empty());
    let is_of_laws = verdict == Verdict::Law;
    let account = account(input.group, base, told_model.filter(|_| is_of_laws), own);
    if !is_of_laws {
        laws.clear();
    }
    Found {
        verdict,
        laws,
        lead,
        account,
        posterior: posterior(&first.weighed, &first.masses, &first.columns, base),
        may_be_noise: first.weighed.slow_noise >= SURE,
        rivals: first.rivals(),
        varying: first.weighed.varying,
    }
}

/// Part of what the base leaves beyond noise that a model leaves.
fn left_part(base: &Fitted, model: &Fitted) -> f64 {
    let rows = base.problem.group.rows() as f64;
    let beyond = |fitted: &Fitted| (fitted.square - (rows - fitted.at.len() as f64)).max(0.0);
    beyond(model) / beyond(base).max(f64::MIN_POSITIVE)
}

/// The parts on which a law is judged: those that others lie on both sides of, or all where there are none.
fn judged(held_out: &HeldOut, is_between: &[bool]) -> HeldOut {
    let of_all = vec![true; is_between.len()];
    let between = if is_between.contains(&true) {
        is_between
    } else {
        &of_all
    };
    held_out.only(between, true)
}

/// A model with what it predicts of what it has not seen.
struct Predicting<'g> {
    model: Fitted<'g>,
    held_out: HeldOut,
    between: Vec<bool>,
    log_odds: f64,
}

/// Everything weighed beside a model.
struct Round<'g> {
    columns: Vec<LawColumns>,
    weighed: Weighed<'g>,
    masses: Vec<f64>,
    told: Told,
}

impl<'g> Round<'g> {
    fn of(
        input: &SelectionInput<'_, 'g>,
        current: &Fitted<'g>,
        directions: &[Direction],
        model: &'static FitModel,
    ) -> Round<'g> {
        let scale = scale(input.group, &input.base.problem, &input.base.at);
        let columns = columns(&current.problem, &current.at, &scale);
        let weighed = Asked {
            group: input.group,
            current,
            residuals: &current.residuals(),
            signatures: input.signatures,
            directions,
            laws: &columns,
            model,
            absent: input.absent,
        }
        .weigh();
        let masses = weighed.masses();
        let each = weighed.all.iter().zip(&masses);
        let mass = each
            .filter(|(own, _)| own.says == Says::Differ)
            .map(|(_, mass)| mass)
            .sum();
        let told = told(&weighed, &masses, &differing(&weighed, mass, current));
        Round {
            columns,
            weighed,
            masses,
            told,
        }
    }

    fn mass(&self, is: impl Fn(Says) -> bool) -> f64 {
        let each = self.weighed.all.iter().zip(&self.masses);
        each.filter(|(own, _)| is(own.says)).map(|(_, mass)| mass).sum()
    }

    /// Places of the hypotheses that were fitted, the most probable first.
    fn fitted(&self) -> Vec<usize> {
        let mut order: Vec<usize> = (0..self.masses.len())
            .filter(|&k| self.weighed.all[k].fitted.is_some())
            .collect();
        order.sort_by(|&a, &b| self.masses[b].total_cmp(&self.masses[a]));
        order
    }

    /// The model of what is told, which is drawn, held out, adopted and predicted with: the curve that explains most there or what is
    /// most probable, whichever predicts better what it has not seen.
    fn predicting(
        &self,
        input: &SelectionInput<'_, 'g>,
        current: &Fitted<'g>,
        before: &[Part],
    ) -> Option<Predicting<'g>> {
        let variable = self.told.place.map(|place| place.variable);
        let of = |model: Fitted<'g>| {
            let held_out = HeldOut {
                before: before.to_vec(),
                after: parts(&model, input.group),
            };
            Predicting {
                log_odds: held_out.log_odds(input.group, variable, current, &model),
                held_out,
                between: between(input.group, variable),
                model,
            }
        };
        let all = self.leading().into_iter().map(of);
        all.max_by(|a, b| a.log_odds.total_cmp(&b.log_odds))
    }

    /// The models of what is told: of a law what is most probable there (a curve, or an equation that lies under it) and, unless a
    /// name is sure, the curve that explains most; of a place such a curve; of nothing what is most probable.
    fn leading(&self) -> Vec<Fitted<'g>> {
        let is_at = |k: &usize| {
            let place = self.weighed.all[*k].place;
            place.is_some_and(|own| match (self.told.place, self.told.site) {
                (Some(told), _) => own.law == told.law && own.variable == told.variable,
                (None, Some(site)) => own.site == site,
                _ => false,
            })
        };
        let fitted = self.fitted();
        let says = |k: &usize| self.weighed.all[*k].says;
        let fall = |k: &usize| self.weighed.all[*k].fall;
        let at_place = || fitted.iter().copied().filter(is_at);
        let curves = at_place().filter(|k| self.told.name.is_none() && matches!(says(k), Says::Curve(_)));
        let curve = curves.max_by(|a, b| fall(a).total_cmp(&fall(b)));
        let is_told = |k: &usize| match (says(k), self.told.name) {
            (Says::Equation(id), None) => self.told.names.contains(&id),
            (Says::Equation(id), Some(name)) => id == name,
            (_, name) => name.is_none(),
        };
        let is_likeliest = self.told.place.is_some() || curve.is_none();
        let likeliest = at_place().filter(|_| is_likeliest).find(is_told);
        let mut found: Vec<usize> = likeliest.into_iter().chain(curve).collect();
        found.dedup();
        if found.is_empty() {
            found.extend(at_place().next().or(fitted.first().copied()));
        }
        let model = |k: usize| self.weighed.all[k].fitted.clone();
        found.into_iter().filter_map(model).collect()
    }

    /// The law that is told.
    fn described(&self, input: &SelectionInput, lead: &Fitted, held_out: &HeldOut) -> MissingLaw {
        let site = self.told.site.unwrap_or(Site::Current);
        let channel = usize::from(site == Site::Bending);
        let percent = |parts: &[Part]| nrmse(input.group, parts, channel).map(|part| 100.0 * part);
        let (better, all) = held_out.better();
        let place = self.told.place;
        MissingLaw {
            place: site.name().to_owned(),
            law: place.map(|own| own.law.to_owned()),
            of: place.map(|own| own.of.to_owned()).filter(|of| !of.is_empty()),
            variable: place.map(|own| own.variable.to_owned()),
            words: place.map_or_else(|| site.words().to_owned(), |own| own.words()),
            name: self.told.name.map(str::to_owned),
            names: self.told.names.iter().map(|id| (*id).to_owned()).collect(),
            probability: self.told.probability.min(1.0),
            curve: place.and_then(|_| drawn(lead)),
            held_out: HeldOutError {
                error_percent_before: percent(&held_out.before),
                error_percent_after: percent(&held_out.after),
                better_parts: format!("{better} of {all}"),
            },
        }
    }

    /// Explanations that are not ruled out, one of each law and variable, and every textbook curve within the band; none where
    /// that is one.
    fn rivals(&self) -> Vec<(String, Fitted<'g>)> {
        let mut found: Vec<(String, Fitted<'g>)> = Vec::new();
        let mut places: Vec<Place> = Vec::new();
        let mut held = 0.0;
        for k in self.fitted() {
            let own = &self.weighed.all[k];
            let Some(place) = own.place.map(|place| Place { of: "", ..place }) else {
                continue;
            };
            let (is_of_band, name) = match own.says {
                Says::Equation(id) => (self.told.names.contains(&id), id.to_owned()),
                _ => {
                    let variable = variable_words(place.variable);
                    (false, format!("{} by {variable}", place.law))
                }
            };
            let is_new = !places.contains(&place) && held < SURE;
            if (is_of_band || is_new) && found.len() < MOST_RIVALS {
                found.extend(own.fitted.clone().map(|fitted| (name, fitted)));
            }
            places.push(place);
            held += self.masses[k];
        }
        if found.len() < 2 { Vec::new() } else { found }
    }
}
