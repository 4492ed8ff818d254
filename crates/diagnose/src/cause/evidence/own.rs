//! Every run of a group with parameters of its own.

use ieap_model::FitModel;
use ieap_numerics::least_squares::Local;
use ieap_numerics::random_effects::Form;

use crate::fitting::base_fit::of_each_run;
use crate::fitting::fitted::Fitted;
use crate::readings::group::RunGroup;

/// The base model fitted to each run by itself, in the coordinates of the group's.
pub(super) struct OwnFits {
    /// Coordinates of every run.
    pub(super) at: Vec<Vec<f64>>,
    slopes: Vec<Local>,
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

    /// What all of them leave.
    pub(super) fn square(&self) -> f64 {
        self.slopes.iter().map(|slope| slope.square).sum()
    }

    /// What each run says of its parameters.
    pub(super) fn forms(&self) -> Vec<Form> {
        let each = self.at.iter().zip(&self.slopes);
        each.map(|(at, slope)| Form::of(at, slope)).collect()
    }
}
