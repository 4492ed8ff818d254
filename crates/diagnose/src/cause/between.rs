//! Whether a tag explains how runs differ, or any other order of its values would.
//!
//! Parameters scatter from run to run by more than the noise of readings, and whatever differs between the runs goes with
//! that scatter to some degree. So a tag is held against chance as an experiment in random order is: its values are dealt
//! to the runs anew, all tags by the same deal, and what the best of all questions then explains is what chance does
//! (Fisher 1935, Westfall and Young 1993). What goes with the voltage stays with it: only the rest is dealt (Freedman and
//! Lane 1983), so that a tag that cannot be told from the voltage is never told.

use ieap_domain::number::probabilities::equation;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use ieap_model::effects::effect;
use ieap_numerics::interrupt;
use ieap_numerics::sums::dot;

use crate::cause::candidates::{CandidateFit, fit_candidates};
use crate::cause::policy::ABSORBED_SQUARE;
use crate::cause::selection_input::SelectionInput;
use crate::fitting::fitted::Fitted;
use crate::fitting::tangent::Tangent;
use crate::levels::TAKEN;
use crate::misfit::null::Null;
use crate::misfit::signature::Direction;
use crate::readings::group::RunGroup;
use crate::readings::tags::{Tag, tags};

/// Deals that explain as much to within rounding count.
const ROUNDING: f64 = 1e-9;
/// Set apart from other uses of the same seed.
const STREAM: u64 = 1 << 41;

/// What is said of tags that were asked and that chance explains as well.
pub(crate) fn refused_in_words(dealt: &[(&'static str, f64)]) -> Vec<String> {
    let refused = dealt.iter().filter(|(_, p)| *p >= TAKEN);
    refused
        .filter_map(|(id, p)| {
            let summary = effect(id)?.about().summary;
            Some(format!(
                "{summary} is no cause that is proved: dealt to the runs at random, values of tags explain as much with {}",
                equation("p", *p)
            ))
        })
        .collect()
}

/// For every tag that is asked and that the model does not hold yet, the chance that a deal of the values lets the best of
/// all questions explain as much of the residuals as this tag does.
pub(crate) fn p_dealt(
    group: &RunGroup,
    fitted: &Fitted,
    deals: usize,
    seed: u64,
) -> Vec<(&'static str, f64)> {
    let has = |id: &str| {
        fitted
            .problem
            .effects
            .iter()
            .any(|own| own.effect.about().id == id)
    };
    let mut tags = tags(group);
    tags.retain(|tag| tag.can_be_told() && !has(tag.id));
    if tags.is_empty() {
        return Vec::new();
    }
    let forms = forms(group, fitted);
    let explained = |at: &[f64]| forms.iter().map(|form| form.gain(at)).fold(0.0, f64::max);
    let observed: Vec<f64> = tags.iter().map(|tag| explained(&tag.at)).collect();
    let with_voltage = with_voltage(group);
    let rests: Vec<Vec<f64>> = tags
        .iter()
        .map(|tag| {
            let mut rest = tag.at.clone();
            with_voltage.remove(&mut rest);
            rest
        })
        .collect();
    let mut generator = ChaCha8Rng::seed_from_u64(seed ^ STREAM);
    let mut order: Vec<usize> = (0..group.runs.len()).collect();
    let mut reached = vec![0_usize; tags.len()];
    for _ in 0..deals {
        interrupt::check();
        for k in (1..order.len()).rev() {
            order.swap(k, generator.random_range(0..=k));
        }
        let of_tag = |(tag, rest): (&Tag, &Vec<f64>)| {
            let deal = |(run, at): (usize, &f64)| at - rest[run] + rest[order[run]];
            let dealt: Vec<f64> = tag.at.iter().enumerate().map(deal).collect();
            explained(&dealt)
        };
        let most = tags.iter().zip(&rests).map(of_tag).fold(0.0, f64::max);
        for (reached, observed) in reached.iter_mut().zip(&observed) {
            *reached += usize::from(most >= observed * (1.0 - ROUNDING));
        }
    }
    let p = |reached: usize| (1 + reached) as f64 / (1 + deals) as f64;
    tags.iter()
        .zip(reached)
        .map(|(tag, reached)| (tag.id, p(reached)))
        .collect()
}

impl<'g> SelectionInput<'_, 'g> {
    /// Looks at every candidate but tags whose values explain as much in any order; those with how often chance does.
    pub(crate) fn candidates_beside(
        &self,
        model: &Fitted<'g>,
        directions: &[Direction],
        step: usize,
    ) -> (Vec<CandidateFit<'g>>, Vec<(&'static str, f64)>) {
        let seed = self.seed.wrapping_add(step as u64);
        let dealt = p_dealt(self.group, model, self.draws, seed);
        let refused: Vec<&'static str> = dealt
            .iter()
            .filter(|(_, p)| *p >= TAKEN)
            .map(|(id, _)| *id)
            .collect();
        let candidates = fit_candidates(model, &model.residuals(), self.signatures, directions, &refused);
        (candidates, dealt)
    }
}

/// Chance of a candidate's gain: by the noise over all candidates, and where it follows a tag by any order of the values.
pub(crate) fn p_of(null: &Null, candidate: &CandidateFit, gain: f64, dealt: &[(&'static str, f64)]) -> f64 {
    let own = dealt.iter().find(|(id, _)| *id == candidate.effect);
    null.p_of_gain(gain).max(own.map_or(0.0, |(_, p)| *p))
}

/// One parameter that may differ between the runs, to first order: what each run's own change of it does to the residuals
/// once the model is refitted.
struct Form {
    /// Product of each run's change with the residuals.
    with_residuals: Vec<f64>,
    /// Square of each run's change.
    squares: Vec<f64>,
    /// Parts of each run's change that the refit takes up, direction by direction.
    absorbed: Vec<Vec<f64>>,
}

impl Form {
    fn of(group: &RunGroup, column: &[f64], tangent: &Tangent, residuals: &[f64]) -> Form {
        let by_run = |other: &[f64]| {
            let mut sums = vec![0.0; group.runs.len()];
            for block in &group.blocks {
                let rows = block.first..block.end;
                sums[block.run] += dot(&column[rows.clone()], &other[rows]);
            }
            sums
        };
        let absorbed: Vec<Vec<f64>> = tangent
            .basis()
            .iter()
            .map(|direction| by_run(direction))
            .collect();
        let mut left = residuals.to_vec();
        tangent.remove(&mut left);
        Form {
            with_residuals: by_run(&left),
            squares: by_run(column),
            absorbed,
        }
    }

    /// Fall of the sum of squares where the runs differ as `at` says.
    fn gain(&self, at: &[f64]) -> f64 {
        let whole: f64 = at
            .iter()
            .zip(&self.squares)
            .map(|(x, square)| x * x * square)
            .sum();
        let absorbed: f64 = self.absorbed.iter().map(|parts| dot(at, parts).powi(2)).sum();
        let left = whole - absorbed;
        if left > ABSORBED_SQUARE * whole {
            dot(at, &self.with_residuals).powi(2) / left
        } else {
            0.0
        }
    }
}

/// The forms in which a base parameter may differ, those of [`ieap_model::effects::tag_places`]' effects.
fn forms(group: &RunGroup, fitted: &Fitted) -> Vec<Form> {
    let (_, jacobian) = fitted.problem.slope(&fitted.at);
    let tangent = Tangent::of(&jacobian);
    let residuals = fitted.residuals();
    let branches = fitted.base().branches.len();
    let sum = |columns: &[Vec<f64>]| {
        let mut sum = vec![0.0; residuals.len()];
        for column in columns {
            sum.iter_mut().zip(column).for_each(|(sum, own)| *sum += own);
        }
        sum
    };
    let (of_branches, others) = jacobian[..fitted.problem.base_len()].split_at(2 * branches);
    let (resistances, capacitances) = of_branches.split_at(branches);
    let mut columns = vec![sum(resistances), sum(capacitances)];
    columns.extend(others.iter().cloned());
    columns
        .iter()
        .map(|column| Form::of(group, column, &tangent, &residuals))
        .collect()
}

/// What of a tag goes with the step's voltage or its size, run by run.
fn with_voltage(group: &RunGroup) -> Tangent {
    let volts: Vec<f64> = group
        .runs
        .iter()
        .map(|run| run.drive().nominal_step_v())
        .collect();
    let sizes = volts.iter().map(|v| v.abs()).collect();
    Tangent::of(&[vec![1.0; volts.len()], volts, sizes])
}
