//! How to fit a group, and what its bootstrap says.

use ieap_domain::Fit;
use ieap_model::FitModel;

use crate::options::FitOptions;

/// Evaluations of one search over the condensed readings.
pub(super) const LIMIT: u64 = 150;

/// How to fit a group.
#[derive(Debug, Clone)]
pub struct GroupOptions {
    /// The model.
    pub model: &'static FitModel,
    /// Keys of the parameters that all runs share, as in [`shareable`]; the others are free in every run.
    pub shared: Vec<String>,
    /// How intervals are found.
    pub intervals: Intervals,
    /// Bootstrap as a further opinion; none to do without.
    pub bootstrap: Option<Bootstrap>,
}

/// How intervals are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Intervals {
    /// From the covariance where it is narrow, else by profile likelihood.
    #[default]
    Automatic,
    /// By profile likelihood always.
    Profile,
}

/// A block bootstrap of the residuals.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Bootstrap {
    /// Seed of the generator.
    pub seed: u64,
    /// Number of refits; 200 tell a standard error to 5 %.
    pub replicates: usize,
}

impl Default for GroupOptions {
    /// Two branches, everything shared.
    fn default() -> GroupOptions {
        GroupOptions::sharing_all(FitOptions::default().model)
    }
}

impl GroupOptions {
    /// Every parameter shared: the runs are repeats of one sample in one condition.
    pub fn sharing_all(model: &'static FitModel) -> GroupOptions {
        GroupOptions {
            model,
            shared: shareable(model).into_iter().map(str::to_owned).collect(),
            intervals: Intervals::default(),
            bootstrap: None,
        }
    }
}

/// Keys of the parameters that a group may share: those of the model that are not derived.
pub fn shareable(model: &FitModel) -> Vec<&'static str> {
    let own = model.parameters.iter().filter(|parameter| !parameter.derived);
    own.map(|parameter| parameter.key).collect()
}

/// What the bootstrap says of one parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct Resampled {
    /// Key of the parameter.
    pub key: String,
    /// Standard deviation of the refits, unit of the parameter.
    pub standard_deviation: f64,
    /// 2.5 % point of the refits.
    pub low_95: f64,
    /// 97.5 % point.
    pub high_95: f64,
    /// Refits that counted.
    pub replicates: usize,
}

impl Resampled {
    /// Widened as the parameter's own error is from one fit to the other.
    pub(crate) fn widen(&mut self, before: &Fit, after: &Fit) {
        let error = |fit: &Fit| fit.parameter(&self.key)?.standard_error;
        let wider = error(after)
            .zip(error(before))
            .map(|(after, before)| after / before);
        let Some(wider) = wider.filter(|wider| wider.is_finite()) else {
            return;
        };
        let (middle, half) = (
            0.5 * (self.low_95 + self.high_95),
            0.5 * (self.high_95 - self.low_95),
        );
        self.standard_deviation *= wider;
        (self.low_95, self.high_95) = (middle - wider * half, middle + wider * half);
    }
}
