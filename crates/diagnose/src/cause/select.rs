//! Which effects the readings ask for: forward, at most three, then backward.

use crate::cause::between::p_of;
use crate::cause::candidates::{AS_GOOD, BAYES, CandidateFit, INEXACT, PRICE, rivals};
use crate::cause::proof::discrepancy;
use crate::cause::proof::held_out::{self, Part};
use crate::cause::selection_input::SelectionInput;
use crate::fitting::fitted::Fitted;
use crate::fitting::problem::ExtendedProblem;
use crate::levels::TAKEN;
use crate::misfit::null::{Null, Statistics};
use crate::misfit::signature::Direction;

/// Effects that are taken at most.
const MOST_EFFECTS: usize = 3;
/// An effect takes another one's place where the sum of squares falls by so much more than for parameters it adds: twice
/// what two causes that explain as well may differ by.
const EXCHANGED: f64 = 12.0;
/// Part of the gain that must be found on held-out readings.
const HELD_OUT: f64 = 0.25;

/// A name is withheld where a discrepancy without one lowers the held-out sum of squares by so much more.
pub(crate) const BEATEN: f64 = 10.0;

/// Single causes that explain this part of what the best does, and at most so many, are tried on held-out readings.
const NEARLY: f64 = 0.95;
const TRIED: usize = 5;

/// One step forward.
pub(crate) struct SelectionStep<'g> {
    pub(crate) candidates: Vec<CandidateFit<'g>>,
    /// Ids of candidates that explain the readings as well as the one that was taken.
    pub(crate) rivals: Vec<&'static str>,
    pub(crate) p: f64,
    pub(crate) taken: bool,
}

/// What was selected.
pub(crate) struct Selection<'g> {
    pub(crate) steps: Vec<SelectionStep<'g>>,
    /// The model with everything that was taken.
    pub(crate) model: Fitted<'g>,
    pub(crate) p_leftover: f64,
    pub(crate) leftover: Statistics,
    pub(crate) held_out: Option<HeldOut>,
    /// Single causes that alone predict held-out readings, the best first, where what fits best does not.
    pub(crate) proved: Option<Vec<&'static str>>,
    /// Tags that differ in the group, by the ids of their effects, with the chance that others explain as much beside the
    /// base.
    pub(crate) dealt: Vec<(&'static str, f64)>,
}

/// Held-out parts by the base and by the extended model.
pub(crate) struct HeldOut {
    pub(crate) before: Vec<Part>,
    pub(crate) after: Vec<Part>,
    /// Fall of the deviance on each by a smooth answer to the voltage that has no name.
    pub(crate) nameless: Vec<f64>,
}

impl HeldOut {
    /// Fall of the deviance on every part.
    pub(crate) fn falls(&self) -> Vec<f64> {
        self.before
            .iter()
            .zip(&self.after)
            .map(|(before, after)| before.deviance - after.deviance)
            .collect()
    }

    /// Whether what has no name predicts better than the extension does.
    pub(crate) fn is_beaten(&self) -> bool {
        let named: f64 = self.falls().iter().sum();
        let nameless: f64 = self.nameless.iter().sum();
        nameless > named + BEATEN
    }

    /// Whether the extension predicts better what it has not seen, and no worse than what has no name.
    pub(crate) fn passed(&self, gain: f64) -> bool {
        if self.is_beaten() {
            return false;
        }
        let falls = self.falls();
        let total: f64 = falls.iter().sum();
        let better = falls.iter().filter(|fall| **fall > 0.0).count();
        total > HELD_OUT * gain || total > 0.0 && better * 5 >= falls.len() * 4
    }
}

impl<'g> SelectionInput<'_, 'g> {
    /// Selects, from the null distribution and directions beside the base.
    pub(crate) fn select(&self, null: &Null, beside_base: &[Direction]) -> Selection<'g> {
        let mut model = self.base.clone();
        let mut steps: Vec<SelectionStep<'g>> = Vec::new();
        let mut later: Option<(Null, Vec<Direction>)> = None;
        let residuals = model.residuals();
        let mut leftover = null.observe(self.group, &residuals, beside_base);
        let mut p_leftover = null.p_misfit(&leftover, None);
        let mut first_dealt = None;
        while steps.len() < MOST_EFFECTS {
            let (null, directions) = later
                .as_ref()
                .map_or((null, beside_base), |(null, d)| (null, d.as_slice()));
            let (mut candidates, dealt) = self.candidates_beside(&model, directions, steps.len());
            let step = self.step(null, &model, &mut candidates);
            if step && steps.is_empty() && self.needs_multistart(&candidates) {
                candidates = self.or_multistart(candidates);
            }
            let taken = step.then(|| candidates[0].fitted.clone()).flatten();
            let p = candidates
                .first()
                .map_or(1.0, |best| p_of(null, best, best.gain.max(best.forecast), &dealt));
            first_dealt.get_or_insert(dealt);
            let rivals = if taken.is_some() {
                rivals(&candidates)
            } else {
                Vec::new()
            };
            steps.push(SelectionStep {
                candidates,
                rivals,
                p,
                taken: taken.is_some(),
            });
            let Some(taken) = taken else { break };
            model = taken;
            let beside = self.null(&model, steps.len() as u64);
            leftover = beside.0.observe(self.group, &model.residuals(), &beside.1);
            p_leftover = self.p_left(&model, &beside.0, &leftover, steps.len() as u64);
            later = Some(beside);
            if p_leftover >= TAKEN {
                break;
            }
        }
        let mut model = self.backward(model);
        let exchanged = (p_leftover < TAKEN)
            .then(|| self.exchanged(&model, &mut steps))
            .flatten();
        let is_other = exchanged.is_some();
        if let Some(better) = exchanged {
            model = self.backward(better);
        }
        let taken = model.problem.effects.len();
        let model = self.pruned(model);
        if is_other || model.problem.effects.len() < taken {
            let (null, directions) = self.null(&model, steps.len() as u64);
            leftover = null.observe(self.group, &model.residuals(), &directions);
            p_leftover = self.p_left(&model, &null, &leftover, steps.len() as u64);
        }
        let held_out = (!model.problem.effects.is_empty()).then(|| self.held_out(&model));
        let selection = Selection {
            steps,
            model,
            p_leftover,
            leftover,
            held_out,
            proved: None,
            dealt: first_dealt.unwrap_or_default(),
        };
        self.or_single(selection)
    }

    /// Every held-out part by the base, by `model`, and by what has no name.
    fn held_out(&self, model: &Fitted<'g>) -> HeldOut {
        let before = held_out::parts(self.base, self.group);
        HeldOut {
            after: held_out::parts(model, self.group),
            nameless: discrepancy::falls(self.base, self.group, &before),
            before,
        }
    }

    /// What fits all readings best need not predict best: where it fails on held-out readings, single causes that
    /// explain nearly as much are tried on them, and the one that predicts best stands.
    fn or_single(&self, selection: Selection<'g>) -> Selection<'g> {
        let total = self.base.square - selection.model.square;
        let (Some(held_out), Some(step)) = (&selection.held_out, selection.steps.first()) else {
            return selection;
        };
        if held_out.passed(total) || !step.taken {
            return selection;
        }
        let best = step
            .candidates
            .iter()
            .map(CandidateFit::score)
            .fold(0.0, f64::max);
        let tried = step
            .candidates
            .iter()
            .filter(|candidate| candidate.fitted.is_some() && candidate.score() > NEARLY * best)
            .take(TRIED);
        let mut passed: Vec<(&CandidateFit, HeldOut, f64)> = Vec::new();
        for candidate in tried {
            let Some(fitted) = &candidate.fitted else { continue };
            let own = HeldOut {
                before: held_out.before.clone(),
                after: held_out::parts(fitted, self.group),
                nameless: held_out.nameless.clone(),
            };
            let fall: f64 = own.falls().iter().sum();
            if own.passed(candidate.gain) {
                passed.push((candidate, own, fall));
            }
        }
        passed.sort_by(|a, b| b.2.total_cmp(&a.2));
        let Some((fitted, most)) = passed
            .first()
            .and_then(|(l, _, fall)| Some((l.fitted.clone()?, *fall)))
        else {
            return selection;
        };
        let close = passed
            .iter()
            .filter(|(_, _, fall)| *fall > most - AS_GOOD - (1.0 - NEARLY) * most);
        let mut proved: Vec<&'static str> = close.map(|(candidate, ..)| candidate.effect).collect();
        if self.group.runs.len() == 1 {
            // Two stretches of one run cannot tell a wrong cause from a right one that is loosely known without them.
            let as_good = |other: &&CandidateFit| {
                let best = passed[0].0;
                other.fitted.is_some() && other.score() > best.score() - AS_GOOD - INEXACT * best.gain
            };
            let others = step
                .candidates
                .iter()
                .filter(as_good)
                .map(|candidate| candidate.effect);
            let others: Vec<&'static str> = others.filter(|id| !proved.contains(id)).collect();
            proved.extend(others);
        }
        let (_, own, _) = passed.swap_remove(0);
        let (null, directions) = self.null(&fitted, 1);
        let leftover = null.observe(self.group, &fitted.residuals(), &directions);
        Selection {
            p_leftover: self.p_left(&fitted, &null, &leftover, 1),
            leftover,
            model: fitted,
            held_out: Some(own),
            proved: Some(proved),
            ..selection
        }
    }

    /// Whether the best of `candidates` is taken.
    fn step(&self, null: &Null, model: &Fitted<'g>, candidates: &mut [CandidateFit<'g>]) -> bool {
        let Some(best) = candidates.first() else {
            return false;
        };
        let Some(fitted) = &best.fitted else {
            return false;
        };
        let readings = self.group.effective_readings().max(2.0);
        let price = (fitted.extra() - model.extra()) as f64 * readings.ln();
        null.p_of_gain(best.gain) < TAKEN && best.gain - price > BAYES
    }

    /// What came first was chosen before the others were known: each effect is left out in turn, and where another one
    /// then fits better by far, it takes the place. None where all stay. The exchange is added to the steps.
    fn exchanged(&self, model: &Fitted<'g>, steps: &mut Vec<SelectionStep<'g>>) -> Option<Fitted<'g>> {
        let count = model.problem.effects.len();
        if count < 2 {
            return None;
        }
        let mut found: Option<Fitted<'g>> = None;
        for place in 0..count {
            let current = found.as_ref().unwrap_or(model).clone();
            let own = current.problem.effects[0].effect.about().id;
            // What is left out goes from the front, what is taken comes to the end: every effect has its turn.
            let Some(without) = self.without(&current, 0) else {
                continue;
            };
            let (null, directions) = self.null(&without, (MOST_EFFECTS + 1 + place) as u64);
            let (mut candidates, dealt) =
                self.candidates_beside(&without, &directions, MOST_EFFECTS + 1 + place);
            let better = candidates.first().and_then(|best| {
                let fitted = best.fitted.clone()?;
                let price = PRICE * (fitted.extra() as f64 - current.extra() as f64);
                let is_other = best.effect != own && fitted.square + price < current.square - EXCHANGED;
                let p = p_of(&null, best, best.gain, &dealt);
                (is_other && p < TAKEN).then_some((fitted, p))
            });
            let rotated = match better {
                Some((fitted, p)) => {
                    steps.push(SelectionStep {
                        candidates: std::mem::take(&mut candidates),
                        rivals: Vec::new(),
                        p,
                        taken: true,
                    });
                    fitted
                }
                None => match self.rotated(&current) {
                    Some(rotated) => rotated,
                    None => continue,
                },
            };
            found = Some(rotated);
        }
        found.filter(|found| found.square < model.square - EXCHANGED)
    }

    /// The same effects, the first of them last.
    fn rotated(&self, model: &Fitted<'g>) -> Option<Fitted<'g>> {
        let mut effects = model.problem.effects.clone();
        let mut values = model.effect_values();
        effects.rotate_left(1);
        values.rotate_left(1);
        let problem = ExtendedProblem::new(self.group, &model.base(), effects);
        let start = problem.coordinates(&model.base(), &values);
        Fitted::search(problem, &[start], &[])
    }
}
