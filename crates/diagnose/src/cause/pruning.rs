//! Whether each of several causes is needed.
//!
//! Two or three causes of the library can be pieced together into much that no library holds: each then explains a little
//! that the others leave, or they stand in for one another. Causes that are there are needed: of 20 hidden pairs of 16
//! standard deviations each, leaving one out cost the sum of squares 170 or more in 19, and both costs made up 0.76 to 1.1 of
//! what the pair explained; of 15 pairs and triples that were pieced together for a play of the charge of 16 standard
//! deviations the least cost was 20 to 98, of 10 for one of 32 it was 20 to 123.

use crate::cause::candidates::{BAYES, PRICE};
use crate::cause::proof::held_out;
use crate::cause::selection_input::SelectionInput;
use crate::fitting::fitted::Fitted;
use crate::fitting::problem::ExtendedProblem;

/// A cause is needed where leaving it out raises the sum of squares by so much ...
const COST: f64 = 150.0;
/// ... or by this part of what all explain together, if the costs of all sum to this part of it: else they stand in for
/// one another.
const PART: f64 = 0.3;
const APART: f64 = 0.7;

impl<'g> SelectionInput<'_, 'g> {
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
            let price = PRICE + BAYES * model.problem.effects[drop].free() as f64;
            let Some(without) = self.without(&model, drop) else {
                continue;
            };
            if without.square - model.square < price {
                model = without;
            }
        }
        model
    }

    /// The model without those of several effects that it does not need: the one that costs least is left out first.
    pub(crate) fn pruned(&self, model: Fitted<'g>) -> Fitted<'g> {
        let mut model = model;
        while let Some(fewer) = self.without_needless(&model) {
            model = fewer;
        }
        model
    }

    /// The model with one effect less; none where it needs all that it has.
    fn without_needless(&self, model: &Fitted<'g>) -> Option<Fitted<'g>> {
        let count = model.problem.effects.len();
        if count < 2 {
            return None;
        }
        let explained = self.base.square - model.square;
        let mut without: Vec<Fitted> = (0..count)
            .filter_map(|place| self.without(model, place))
            .collect();
        without.sort_by(|a, b| a.square.total_cmp(&b.square));
        let costs = without.iter().map(|fewer| fewer.square - model.square);
        let least = costs.clone().next()?;
        let is_apart = without.len() == count && costs.sum::<f64>() > APART * explained;
        if least < COST && !(least > PART * explained && is_apart) {
            return Some(without.swap_remove(0));
        }
        // What is needed also predicts: several must do so better than any of them less.
        let own = self.predicted(model);
        without.into_iter().find(|fewer| self.predicted(fewer) <= own)
    }

    /// Deviance of the held-out parts.
    fn predicted(&self, model: &Fitted) -> f64 {
        let parts = held_out::parts(model, self.group);
        parts.iter().map(|part| part.deviance).sum()
    }
}
