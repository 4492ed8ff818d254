//! What is watched.

use super::series::{Reaches, Series, Study};
use crate::laws::covariate::Covariate;
use crate::laws::fitted::Fitted;
use ieap_domain::Limit;

/// One parameter of one sample in the reference condition.
#[derive(Debug, Clone, PartialEq)]
pub struct Watched {
    /// Material.
    pub material: String,
    /// Sample.
    pub sample: String,
    /// Stored key of the parameter.
    pub parameter: String,
    /// What the series goes over.
    pub axis: Covariate,
    /// Runs of the readings.
    pub runs: Vec<usize>,
    /// Readings.
    pub series: Series,
    /// What is made of them.
    pub study: Study,
    /// The best law over every other axis that is known and over which one is shown.
    pub other_axes: Vec<(Covariate, Fitted)>,
    /// The limit that holds for it, with when it is reached.
    pub limit: Option<(Limit, Reaches)>,
    /// Runs that give a bound or nothing.
    pub left_out: usize,
}
