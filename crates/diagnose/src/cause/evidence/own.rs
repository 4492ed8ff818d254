//! Every run of a group with parameters of its own.

use ieap_model::FitModel;
use ieap_numerics::least_squares::Local;
use ieap_numerics::symmetric::Symmetric;

use crate::fitting::base_fit::of_each_run;
use crate::fitting::fitted::Fitted;
use crate::readings::group::RunGroup;

/// The base model fitted to each run by itself, in the coordinates of the group's.
pub(super) struct OwnFits {
    /// Coordinates of every run.
    pub(super) at: Vec<Vec<f64>>,
    slopes: Vec<Local>,
}

/// What one run says of its parameters: half of the rise of its sum of squares about `b`'s place.
pub(super) struct RunForm {
    /// J'J.
    pub(super) precision: Symmetric,
    /// Precision times the best place.
    pub(super) pull: Vec<f64>,
    /// Sum of squares at the origin of the coordinates, as this form has it.
    pub(super) at_origin: f64,
}

impl OwnFits {
    /// From the parameters of the group's base, and from those that a fit of the run alone gives.
    pub(super) fn of(group: &RunGroup, base: &Fitted, model: &'static FitModel) -> Option<OwnFits> {
        let alone = of_each_run(group, model);
        let mut found = OwnFits {
            at: Vec::new(),
            slopes: Vec::new(),
        };
        for (run, alone) in alone.iter().enumerate() {
            let problem = base.problem.over(vec![run]);
            let mut starts = vec![base.at.clone()];
            let whole = alone
                .as_ref()
                .filter(|own| own.branches.len() == base.base().branches.len());
            starts.extend(whole.map(|own| problem.coordinates(own, &[])));
            let own = Fitted::search(problem, &starts, &[])?.converged();
            let (slope, _) = own.problem.slope(&own.at);
            found.at.push(own.at);
            found.slopes.push(slope);
        }
        Some(found)
    }

    /// What each run says of its parameters.
    pub(super) fn forms(&self) -> Vec<RunForm> {
        let each = self.at.iter().zip(&self.slopes);
        each.map(|(at, slope)| RunForm::of(at, slope)).collect()
    }
}

impl RunForm {
    pub(super) fn of(at: &[f64], slope: &Local) -> RunForm {
        let n = at.len();
        let row = |k: usize| -> f64 { (0..n).map(|l| slope.normal.get(k, l) * at[l]).sum() };
        let bend: Vec<f64> = (0..n).map(row).collect();
        let dot = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(x, y)| x * y).sum() };
        RunForm {
            at_origin: slope.square + dot(&bend, at) + 2.0 * dot(&slope.descent, at),
            pull: bend.iter().zip(&slope.descent).map(|(b, d)| b + d).collect(),
            precision: slope.normal.clone(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_form_gives_back_its_sum_of_squares() {
        let mut normal = Symmetric::zero(2);
        for (a, b, value) in [(0, 0, 4.0), (0, 1, 1.0), (1, 0, 1.0), (1, 1, 9.0)] {
            normal.add(a, b, value);
        }
        let slope = Local {
            square: 7.0,
            descent: vec![0.0, -0.5],
            normal: normal.clone(),
        };
        let at = [0.3, -0.2];
        let form = RunForm::of(&at, &slope);
        let square = |x: [f64; 2]| {
            let (d0, d1) = (x[0] - at[0], x[1] - at[1]);
            7.0 + 1.0 * d1 + normal.form(&[d0, d1], &[d0, d1])
        };
        let by_form = |x: [f64; 2]| {
            let pull: f64 = form.pull.iter().zip(x).map(|(p, x)| p * x).sum();
            form.at_origin - 2.0 * pull + form.precision.form(&x, &x)
        };
        for x in [[0.0, 0.0], [0.3, -0.2], [1.0, 2.0]] {
            assert!((square(x) - by_form(x)).abs() < 1e-9, "{x:?}");
        }
    }
}
