//! Runs whose readings are those that the others lead to expect times a number that no strip has: a wrong unit, or a
//! sensor or leads the other way round.

use ieap_domain::CondemnedRun;
use ieap_model::extended::ExtendedModel;
use ieap_model::{FitModel, LumpedModel};
use ieap_numerics::sums::{about_mean, dot};

use crate::fitting::base_fit::of_each_run;
use crate::misfit::policy::{
    ALIKE_FACTOR, FEWEST_FOR_ODD, MOST_DECADES, OFF_LENGTHS_DECADES, OFF_PREFIXES_DECADES, SAME_SHAPE,
};
use crate::readings::group::{GroupRun, RunGroup};

/// What is odd about a channel of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Odd {
    Turned,
    Times(f64),
}

/// How a channel compares with what another run's parameters predict of it.
#[derive(Debug, Clone, Copy)]
struct Likeness {
    factor: f64,
    /// Cosine between the two, and between their departures from their means.
    shape: f64,
    variation: f64,
}

impl Likeness {
    fn agrees(self) -> bool {
        self.shape > SAME_SHAPE && self.factor < ALIKE_FACTOR && self.factor > 1.0 / ALIKE_FACTOR
    }

    fn odd(self) -> Option<Odd> {
        if self.variation.abs() < SAME_SHAPE || self.shape.abs() < SAME_SHAPE {
            return None;
        }
        let decades = self.factor.abs().log10();
        let prefix = 3.0 * (decades / 3.0).round();
        let (nearest, off) = if (decades - prefix).abs() < OFF_PREFIXES_DECADES {
            (prefix, OFF_PREFIXES_DECADES)
        } else {
            (decades.round(), OFF_LENGTHS_DECADES)
        };
        let turned =
            self.factor < 0.0 && self.factor.abs() < ALIKE_FACTOR && self.factor.abs() > 1.0 / ALIKE_FACTOR;
        let scaled = (1.0..=MOST_DECADES).contains(&nearest.abs()) && (decades - nearest).abs() < off;
        match (turned, scaled && self.factor > 0.0) {
            (true, _) => Some(Odd::Turned),
            (_, true) => Some(Odd::Times(10f64.powf(nearest))),
            _ => None,
        }
    }
}

/// The runs whose readings are scaled or turned, where more runs agree without that. What a person said is right is not among
/// them.
pub(crate) fn odd_runs(group: &RunGroup, model: &'static FitModel) -> Vec<CondemnedRun> {
    if group.runs.len() < FEWEST_FOR_ODD {
        return Vec::new();
    }
    let bases: Vec<LumpedModel> = of_each_run(group, model).into_iter().flatten().collect();
    let mut odd: Vec<CondemnedRun> = Vec::new();
    for found in (0..2).flat_map(|channel| of_channel(group, &bases, channel)) {
        if !odd.iter().any(|known| known.run == found.run) {
            odd.push(found);
        }
    }
    odd
}

/// The odd runs of a channel, seen from the run with which most others agree; `bases` are the parameters of
/// each run by itself.
fn of_channel(group: &RunGroup, bases: &[LumpedModel], channel: usize) -> Vec<CondemnedRun> {
    let views = bases.iter().map(|base| {
        let model = ExtendedModel {
            base: base.clone(),
            effects: Vec::new(),
        };
        let runs = group.runs.iter().enumerate();
        let view = |channel: usize| -> Vec<Option<Likeness>> {
            let runs = runs.clone();
            runs.map(|(index, run)| likeness(&model, index, run, channel))
                .collect()
        };
        (view(channel), view(1 - channel))
    });
    let agreeing = |view: &Vec<Option<Likeness>>| view.iter().flatten().filter(|l| l.agrees()).count();
    // The first of several equally good ones, for the same answer each time.
    let Some((view, other)) = views.reduce(|best, next| {
        if agreeing(&next.0) > agreeing(&best.0) {
            next
        } else {
            best
        }
    }) else {
        return Vec::new();
    };
    let odd: Vec<(usize, Odd)> = view
        .iter()
        .enumerate()
        .filter_map(|(run, likeness)| Some((run, likeness.filter(|l| !l.agrees())?.odd()?)))
        .filter(|(run, _)| !group.runs[*run].given.is_right)
        // A current may be a thousand times another by its voltage alone, but then its bending is no longer that of the
        // others; and a strip may bend one way whatever the sign of the voltage.
        .filter(|(run, _)| other[*run].is_some_and(Likeness::agrees))
        .filter(|(run, odd)| *odd != Odd::Turned || has_witness(group, &view, *run))
        .collect();
    if agreeing(&view) < 2 || odd.len() >= agreeing(&view) {
        return Vec::new();
    }
    let of_quantity = ["current", "bending"][channel];
    let others = agreeing(&view);
    let said = |(run, odd): &(usize, Odd)| CondemnedRun {
        run: group.runs[*run].given.name.to_owned(),
        reason: match odd {
            Odd::Turned => format!(
                "its {of_quantity} has the sign opposite to that of the other {others} runs: a sensor or leads are the other way round"
            ),
            Odd::Times(times) => format!(
                "its {of_quantity} is {times} times what the other {others} runs lead to expect: its unit is wrong"
            ),
        },
    };
    odd.iter().map(said).collect()
}

/// Whether a run that agrees steps to the same side.
fn has_witness(group: &RunGroup, view: &[Option<Likeness>], run: usize) -> bool {
    let side = |run: usize| group.runs[run].drive().nominal_step_v().signum();
    let mut others = view.iter().enumerate();
    others.any(|(other, likeness)| likeness.is_some_and(Likeness::agrees) && side(other) == side(run))
}

fn likeness(model: &ExtendedModel, index: usize, run: &GroupRun, channel: usize) -> Option<Likeness> {
    let measured = run.channels[channel].as_ref()?.values();
    let predicted = run.fitted(model, &run.context(index, None))[channel].clone();
    let factor = dot(&predicted, measured) / dot(&predicted, &predicted);
    let likeness = Likeness {
        factor,
        shape: cosine(&predicted, measured),
        variation: cosine(&about_mean(&predicted), &about_mean(measured)),
    };
    let parts = [likeness.factor, likeness.shape, likeness.variation];
    parts.iter().all(|part| part.is_finite()).then_some(likeness)
}

fn cosine(one: &[f64], other: &[f64]) -> f64 {
    dot(one, other) / (dot(one, one) * dot(other, other)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn like(factor: f64, variation: f64) -> Option<Odd> {
        let shape = 0.9_f64.copysign(variation);
        Likeness {
            factor,
            shape,
            variation,
        }
        .odd()
    }

    #[test]
    fn powers_of_ten_and_turned_signs_are_odd_and_nothing_between() {
        assert_eq!(like(980.0, 0.99), Some(Odd::Times(1e3)));
        assert_eq!(like(1800.0, 0.9), Some(Odd::Times(1e3)));
        assert_eq!(like(1.1e-6, 0.99), Some(Odd::Times(1e-6)));
        assert_eq!(like(9.8, 0.99), Some(Odd::Times(10.0)));
        assert_eq!(like(0.0104, 0.99), Some(Odd::Times(0.01)));
        assert_eq!(like(-1.3, -0.99), Some(Odd::Turned));
        for (factor, variation) in [
            (1.0, 0.99),
            (2.5, 0.99),
            (14.0, 0.99),
            (70.0, 0.99),
            (300.0, 0.99),
            (1000.0, 0.5),
            (-1.0, -0.5),
            (-30.0, -0.99),
        ] {
            assert_eq!(like(factor, variation), None, "{factor} {variation}");
        }
    }
}
