//! Which effects the readings ask for: forward, at most three, then backward.

use crate::cause::between::p_of;
use crate::cause::candidates::CandidateFit;
use crate::cause::policy::{EXCHANGED, MOST_EFFECTS, PRICE, TAKEN_BY_CRITERION};
use crate::cause::selection_input::SelectionInput;
use crate::fitting::fitted::Fitted;
use crate::fitting::problem::ExtendedProblem;
use crate::levels::TAKEN;
use crate::misfit::null::Null;
use crate::misfit::signature::Direction;

/// One step forward.
pub(crate) struct SelectionStep<'g> {
    pub(crate) candidates: Vec<CandidateFit<'g>>,
    /// Chance of the best candidate's gain.
    pub(crate) p: f64,
}

/// What was selected.
pub(crate) struct Selection<'g> {
    pub(crate) steps: Vec<SelectionStep<'g>>,
    /// The model with everything that was taken.
    pub(crate) model: Fitted<'g>,
    /// Tags that differ in the group, by the ids of their effects, with the chance that others explain as much beside the
    /// base.
    pub(crate) dealt: Vec<(&'static str, f64)>,
}

impl<'g> SelectionInput<'_, 'g> {
    /// Selects, from the null distribution and directions beside the base.
    pub(crate) fn select(&self, null: &Null, beside_base: &[Direction]) -> Selection<'g> {
        let mut model = self.base.clone();
        let mut steps: Vec<SelectionStep<'g>> = Vec::new();
        let mut later: Option<(Null, Vec<Direction>)> = None;
        let mut p_leftover = 0.0;
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
            steps.push(SelectionStep { candidates, p });
            let Some(taken) = taken else { break };
            model = taken;
            let beside = self.null(&model, steps.len() as u64);
            let leftover = beside.0.observe(self.group, &model.residuals(), &beside.1);
            p_leftover = self.p_left(&model, &beside.0, &leftover, steps.len() as u64);
            later = Some(beside);
            if p_leftover >= TAKEN {
                break;
            }
        }
        let mut model = self.backward(model);
        if p_leftover < TAKEN
            && let Some(better) = self.exchanged(&model, &mut steps)
        {
            model = self.backward(better);
        }
        Selection {
            steps,
            model,
            dealt: first_dealt.unwrap_or_default(),
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
        null.p_of_gain(best.gain) < TAKEN && best.gain - price > TAKEN_BY_CRITERION
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
                        p,
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

    /// The model without one of its effects, refitted.
    pub(crate) fn without(&self, model: &Fitted<'g>, place: usize) -> Option<Fitted<'g>> {
        let mut effects = model.problem.effects.clone();
        let mut values = model.effect_values();
        effects.remove(place);
        values.remove(place);
        let problem = ExtendedProblem::new(self.group, &model.base(), effects);
        let start = problem.coordinates(&model.base(), &values);
        Fitted::search(problem, &[start], &[]).map(Fitted::polished)
    }

    /// Drops effects that the others have made needless.
    pub(crate) fn backward(&self, model: Fitted<'g>) -> Fitted<'g> {
        let count = model.problem.effects.len();
        if count < 2 {
            return model;
        }
        let mut model = model;
        for drop in (0..count).rev() {
            let price = PRICE + TAKEN_BY_CRITERION * model.problem.effects[drop].free() as f64;
            let Some(without) = self.without(&model, drop) else {
                continue;
            };
            if without.square - model.square < price {
                model = without;
            }
        }
        model
    }
}
