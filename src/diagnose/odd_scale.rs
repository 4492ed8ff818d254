//! Runs whose readings are those that the others lead to expect times a number that no strip has: a wrong unit, or a
//! sensor or leads the other way round.

use crate::domain::GroupDiagnosis;
use crate::model::FitModel;
use crate::model::extended::ExtendedModel;
use crate::numerics::sums::dot;

use super::base_fit::alone;
use super::group::{Group, GroupRun};

/// Runs agree whose readings are those that one of them predicts times a number within this factor of one ...
const ALIKE: f64 = 3.0;
/// ... and of that likeness of shape at least.
const ALIKE_SHAPE: f64 = 0.8;
/// A run is only judged where its readings have the predicted shape that closely.
const SAME_SHAPE: f64 = 0.95;
/// Departure from a power of ten, in decades, that the scatter between runs leaves: for a factor of ten, and for more.
const OFF_TEN: f64 = 0.05;
const OFF_MORE: f64 = 0.15;
/// Largest power of ten between units of the same quantity that are mistaken for each other, nA and A.
const MOST_DECADES: f64 = 9.0;

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
    /// Cosine between the two.
    shape: f64,
}

impl Likeness {
    fn agrees(self) -> bool {
        self.shape > ALIKE_SHAPE && self.factor < ALIKE && self.factor > 1.0 / ALIKE
    }

    fn odd(self) -> Option<Odd> {
        if self.shape.abs() < SAME_SHAPE {
            return None;
        }
        let decades = self.factor.abs().log10();
        let nearest = decades.round();
        let off = if nearest.abs() <= 1.0 { OFF_TEN } else { OFF_MORE };
        let turned = self.factor < 0.0 && self.factor.abs() < ALIKE && self.factor.abs() > 1.0 / ALIKE;
        let scaled = (1.0..=MOST_DECADES).contains(&nearest.abs()) && (decades - nearest).abs() < off;
        match (turned, scaled && self.factor > 0.0) {
            (true, _) => Some(Odd::Turned),
            (_, true) => Some(Odd::Times(10f64.powf(nearest))),
            _ => None,
        }
    }
}

/// The group without a finding, where some runs' readings are scaled or turned and more runs agree without that.
pub(super) fn found(name: &str, group: &Group, model: &'static FitModel) -> Option<GroupDiagnosis> {
    if group.runs.len() < 3 {
        return None;
    }
    let odd: Vec<String> = (0..2)
        .flat_map(|channel| of_channel(group, model, channel))
        .collect();
    (!odd.is_empty()).then(|| {
        let runs = group.runs.iter().map(|run| run.given.name.to_owned()).collect();
        let sentence = format!(
            "{}. Correct its files or their units, or leave it out; until then nothing is said of this group.",
            odd.join("; ")
        );
        GroupDiagnosis::data_problem(name, runs, model.id, sentence)
    })
}

/// Sentences on the odd runs of a channel, seen from the run with which most others agree.
fn of_channel(group: &Group, model: &'static FitModel, channel: usize) -> Vec<String> {
    let bases = alone(group, model);
    let views = bases.into_iter().flatten().map(|base| {
        let model = ExtendedModel {
            base,
            effects: Vec::new(),
        };
        let runs = group.runs.iter().enumerate();
        runs.map(|(index, run)| likeness(&model, index, run, channel))
            .collect::<Vec<_>>()
    });
    let agreeing = |view: &Vec<Option<Likeness>>| view.iter().flatten().filter(|l| l.agrees()).count();
    // The first of several equally good ones, for the same answer each time.
    let Some(view) = views.reduce(|best, view| {
        if agreeing(&view) > agreeing(&best) {
            view
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
        .filter(|(run, odd)| *odd != Odd::Turned || has_witness(group, &view, *run))
        .collect();
    if agreeing(&view) < 2 || odd.len() >= agreeing(&view) {
        return Vec::new();
    }
    let of_quantity = ["current", "bending"][channel];
    let said = |(run, odd): &(usize, Odd)| {
        let name = group.runs[*run].given.name;
        match odd {
            Odd::Turned => format!(
                "The {of_quantity} of {name} has the sign opposite to that of the other {} runs: a sensor or leads are the other way round",
                agreeing(&view)
            ),
            Odd::Times(times) => format!(
                "The {of_quantity} of {name} is {times} times what the other {} runs lead to expect: its unit is wrong",
                agreeing(&view)
            ),
        }
    };
    odd.iter().map(said).collect()
}

/// Whether a run that agrees steps to the same side: else a strip that bends the same way whatever the sign of the
/// voltage would look turned.
fn has_witness(group: &Group, view: &[Option<Likeness>], run: usize) -> bool {
    let side = |run: usize| group.runs[run].given.input.drive.nominal_step_v().signum();
    let mut others = view.iter().enumerate();
    others.any(|(other, likeness)| likeness.is_some_and(Likeness::agrees) && side(other) == side(run))
}

fn likeness(model: &ExtendedModel, index: usize, run: &GroupRun, channel: usize) -> Option<Likeness> {
    let measured = run.channels[channel].as_ref()?.values();
    let found = model.responses(&run.context(index, None), run.times(0), run.times(1));
    let predicted = [found.current_a, found.curvature_per_cm][channel].clone();
    let together = dot(&predicted, measured);
    let (own, seen) = (dot(&predicted, &predicted), dot(measured, measured));
    let likeness = Likeness {
        factor: together / own,
        shape: together / (own * seen).sqrt(),
    };
    (likeness.factor.is_finite() && likeness.shape.is_finite()).then_some(likeness)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn like(factor: f64, shape: f64) -> Option<Odd> {
        Likeness { factor, shape }.odd()
    }

    #[test]
    fn powers_of_ten_and_turned_signs_are_odd_and_nothing_between() {
        assert_eq!(like(980.0, 0.99), Some(Odd::Times(1e3)));
        assert_eq!(like(1.1e-6, 0.99), Some(Odd::Times(1e-6)));
        assert_eq!(like(9.8, 0.99), Some(Odd::Times(10.0)));
        assert_eq!(like(-1.3, -0.99), Some(Odd::Turned));
        for (factor, shape) in [
            (1.0, 0.99),
            (2.5, 0.99),
            (14.0, 0.99),
            (300.0, 0.99),
            (1000.0, 0.9),
            (-1.0, -0.9),
            (-30.0, -0.99),
        ] {
            assert_eq!(like(factor, shape), None, "{factor} {shape}");
        }
    }
}
