//! Causes searched from other places of the base parameters.
//!
//! Under one shape of drive a strong cause draws the base parameters far from where they belong: another pair of branches
//! makes up for most of it. From there the search for the cause that is there ends in a valley of its own, and one for
//! which the base parameters lie well (mostly a third branch, which lets the other two be anything) is the only one that
//! explains what is left. So every cause is searched again from the base parameters beside those that explain the readings.
//! Of 107 causes of 64 standard deviations under one step, 10 had the name of another without this and 1 with it.

use ieap_model::{Branch, LumpedModel};

use crate::cause::candidates::{CandidateFit, by_score, fit_candidates, rivals};
use crate::cause::policy::{AS_GOOD, MOST_PLACES, PLACE_ROUNDS, PLACES_APART_LOG, PLACES_FROM_PART};
use crate::cause::selection_input::SelectionInput;
use crate::fitting::fitted::Fitted;
use crate::fitting::problem::ExtendedProblem;
use crate::fitting::scale::scale;
use crate::levels::TAKEN;
use crate::misfit::signature::{directions, signatures};

impl<'g> SelectionInput<'_, 'g> {
    /// Whether causes are searched elsewhere: where drives have one shape; of one run of several only where one cause alone
    /// would be given, since it is the group that is asked for the cause, and the search takes as long as all else.
    pub(crate) fn needs_multistart(&self, candidates: &[CandidateFit]) -> bool {
        self.has_one_shape_of_drive() && (!self.of_several || rivals(candidates).len() < 2)
    }

    /// Whether all drives are one with its voltages times a number, which what is linear answers alike: other drives hold
    /// the base parameters where they belong.
    fn has_one_shape_of_drive(&self) -> bool {
        let drives = || self.group.runs.iter().map(|run| run.drive());
        drives().all(|drive| drives().all(|other| drive.is_scaled(other)))
    }

    /// What is known of every cause beside the base after searching elsewhere too, where one cause is then or was before
    /// all there is. Where several are at work, one that makes up for them from a place of its own is not their beginning:
    /// what was known goes on to further causes.
    pub(crate) fn or_multistart(&self, candidates: Vec<CandidateFit<'g>>) -> Vec<CandidateFit<'g>> {
        let mut searched = candidates.clone();
        let is_other = self.multistart(&mut searched);
        if is_other && (self.would_explain_all(&searched) || self.would_explain_all(&candidates)) {
            searched
        } else {
            candidates
        }
    }

    /// Whether the best of `candidates` would leave nothing beside it.
    pub(crate) fn would_explain_all(&self, candidates: &[CandidateFit<'g>]) -> bool {
        let Some(best) = candidates.first().and_then(|best| best.fitted.as_ref()) else {
            return false;
        };
        let (null, directions) = self.null(best, 1);
        let leftover = null.observe(self.group, &best.residuals(), &directions);
        self.p_left(best, &null, &leftover, 1) >= TAKEN
    }

    /// Searches every cause beside the base again from other places, and keeps what explains more than before; whether
    /// any does.
    fn multistart(&self, candidates: &mut [CandidateFit<'g>]) -> bool {
        let mut seen = vec![self.base.base()];
        let mut is_other = false;
        for _ in 0..PLACE_ROUNDS {
            let first = seen.len();
            for place in self.contending(candidates) {
                if seen.len() < first + MOST_PLACES
                    && seen.iter().all(|other| apart(other, &place) > PLACES_APART_LOG)
                {
                    seen.push(place);
                }
            }
            let rises = seen[first..]
                .iter()
                .map(|place| self.search_from(place, candidates));
            let rise = rises.fold(0.0, f64::max);
            is_other |= rise > 0.0;
            if rise < AS_GOOD {
                break;
            }
        }
        by_score(candidates);
        is_other
    }

    /// Base parameters beside the causes that explain nearly as much as the best, those of the best first.
    fn contending(&self, candidates: &[CandidateFit<'g>]) -> Vec<LumpedModel> {
        let best = candidates.iter().map(CandidateFit::score).fold(0.0, f64::max);
        let contends = |own: &&CandidateFit| own.fitted.is_some() && own.score() > PLACES_FROM_PART * best;
        let mut ranked: Vec<&CandidateFit> = candidates.iter().filter(contends).collect();
        ranked.sort_by(|a, b| b.score().total_cmp(&a.score()));
        let fitted = ranked.iter().filter_map(|own| own.fitted.as_ref());
        fitted.flat_map(|fitted| self.places(fitted)).collect()
    }

    /// The base parameters of a fitted model; where it has one branch more than the base, also with that in the place of
    /// each of the others.
    fn places(&self, fitted: &Fitted<'g>) -> Vec<LumpedModel> {
        let model = fitted.problem.model(&fitted.at);
        let system = model.system(&self.group.runs[0].context(0, None));
        let mut added = system.branches.iter().filter(|branch| branch.of_base.is_none());
        let mut places = vec![model.base.clone()];
        if let (Some(added), None) = (added.next(), added.next()) {
            let added = Branch {
                resistance_ohm_cm2: added.resistance_ohm_cm2,
                capacitance_f_per_cm2: added.capacitance_f_per_cm2,
            };
            places.extend((0..model.base.branches.len()).map(|place| {
                let mut other = model.base.clone();
                other.branches[place] = added;
                other
            }));
        }
        places
    }

    /// Searches from one place and keeps what explains more in all runs; by how much more it does, at most. What a refit
    /// takes up whole beside the base is not looked at.
    fn search_from(&self, place: &LumpedModel, candidates: &mut [CandidateFit<'g>]) -> f64 {
        let largest = self.largest();
        let in_largest = |fitted: &Fitted| fitted.problem.over(vec![largest]).square(&fitted.at);
        let without = in_largest(self.base);
        let known = candidates.iter().filter_map(|own| own.fitted.as_ref());
        let mut least = known.map(in_largest).fold(without, f64::min);
        let mut rise: f64 = 0.0;
        for found in self.found_in(largest, place) {
            let own = candidates.iter_mut().find(|own| own.effect == found.effect);
            let (Some(own), Some(fitted)) = (own, found.fitted) else {
                continue;
            };
            least = least.min(fitted.square);
            let before = own.fitted.as_ref().map_or(without, in_largest);
            let contends = without - fitted.square > PLACES_FROM_PART * (without - least);
            if !contends || fitted.square + self.due(&fitted) > before {
                continue;
            }
            let Some(fitted) = self.in_all(fitted) else {
                continue;
            };
            let gain = self.base.square - fitted.square;
            if gain > own.gain {
                rise = rise.max(gain - own.gain);
                own.gain = gain;
                own.variant = found.variant;
                own.extra = found.extra;
                own.fitted = Some(fitted);
            }
        }
        rise
    }

    /// What a search from that place finds in one run: where drives have one shape the others show the same.
    fn found_in(&self, run: usize, place: &LumpedModel) -> Vec<CandidateFit<'g>> {
        let problem = ExtendedProblem::new(self.group, place, Vec::new()).over(vec![run]);
        let at = problem.coordinates(place, &[]);
        let Some(there) = Fitted::unsearched(problem, at) else {
            return Vec::new();
        };
        let scale = scale(self.group, &there.problem, &there.at);
        let signatures = signatures(&there.problem, &there.at, &scale);
        let (_, tangent) = there.tangent();
        let directions = directions(&signatures, &tangent);
        fit_candidates(&there, &there.residuals(), &signatures, &directions, &[])
    }

    /// The run of the largest step.
    fn largest(&self) -> usize {
        let step_v = |run: &usize| self.group.runs[*run].drive().nominal_step_v().abs();
        let runs = 0..self.group.runs.len();
        runs.max_by(|a, b| step_v(a).total_cmp(&step_v(b))).unwrap_or(0)
    }

    /// How much lower the sum of squares of one run lies by chance where it alone is fitted.
    fn due(&self, fitted: &Fitted) -> f64 {
        if self.group.runs.len() > 1 {
            fitted.at.len() as f64
        } else {
            0.0
        }
    }

    /// The same searched in all runs.
    fn in_all(&self, fitted: Fitted<'g>) -> Option<Fitted<'g>> {
        let runs = self.group.runs.len();
        if runs == 1 {
            return Some(fitted);
        }
        let problem = fitted.problem.over((0..runs).collect());
        Fitted::unsearched(problem, fitted.at).map(|there| there.converged().in_own_limits())
    }
}

/// Largest difference of the branches, by time constant, and of the coupling, in logarithms.
fn apart(a: &LumpedModel, b: &LumpedModel) -> f64 {
    let logarithms = |model: &LumpedModel| {
        let mut branches = model.branches.clone();
        branches.sort_by(|a, b| a.time_constant_s().total_cmp(&b.time_constant_s()));
        let of = |branch: &Branch| [branch.resistance_ohm_cm2.ln(), branch.capacitance_f_per_cm2.ln()];
        let coupling = model.charge_to_curvature_per_c_cm.abs();
        let coupling = coupling.max(f64::MIN_POSITIVE).ln();
        branches
            .iter()
            .flat_map(of)
            .chain([coupling])
            .collect::<Vec<f64>>()
    };
    let pairs = logarithms(a).into_iter().zip(logarithms(b));
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use ieap_domain::testing::branch;

    #[test]
    fn models_of_the_same_branches_in_another_order_are_one_place() {
        let model = |branches: Vec<Branch>| LumpedModel {
            branches,
            steady_state_resistance_ohm_cm2: 3000.0,
            charge_to_curvature_per_c_cm: 20.0,
            relaxation_rate_per_s: 0.01,
        };
        let one = model(vec![branch(30.0, 0.03), branch(120.0, 0.15)]);
        let same = model(vec![branch(120.0, 0.15), branch(30.0, 0.03)]);
        let other = model(vec![branch(30.0, 0.03), branch(120.0, 0.3)]);
        assert_eq!(apart(&one, &same), 0.0);
        assert!((apart(&one, &other) - 2.0_f64.ln()).abs() < 1e-12);
        // A strip that does not bend has no coupling to differ in.
        let flat = LumpedModel {
            charge_to_curvature_per_c_cm: 0.0,
            ..one.clone()
        };
        assert_eq!(apart(&flat, &flat.clone()), 0.0);
    }
}
