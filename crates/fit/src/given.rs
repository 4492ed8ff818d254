//! A run under a model whose parameters were found elsewhere: its estimates from a covariance, its noise, residuals
//! and curves as a fit of its own would have them.

use ieap_domain::{Channel, Drive, Fit, Parameter, Quantity};
use ieap_model::{FitModel, LumpedModel};
use ieap_numerics::slopes::gradient;
use ieap_numerics::symmetric::Symmetric;

use super::joint::feature::Feature;
use super::joint::layout::Layout;
use super::joint::profile::Interval;
use super::outcome::{joint_parameters, judged_response};
use super::sampled::Sampled;
use crate::options::FitInput;
use crate::outliers::Cleaned;

/// Step of the gradient of a feature, in the local parameters.
const STEP: f64 = 1e-5;

/// What is known of the base parameters of a model: the place and the covariance of `ln R_k, ln C_k, 1/R_ss` and, where
/// the runs bend, `alpha, lambda`, in this order.
#[derive(Debug, Clone)]
pub struct BaseKnowledge {
    /// Number of branches.
    pub branches: usize,
    /// Values of the local parameters.
    pub local: Vec<f64>,
    /// Their covariance.
    pub covariance: Symmetric,
    /// Half width of a 95 % interval in standard errors.
    pub quantile: f64,
}

impl BaseKnowledge {
    /// The base parameters that `local` stands for.
    pub fn place(base: &LumpedModel, bends: bool) -> Vec<f64> {
        let mut local: Vec<f64> = base
            .branches
            .iter()
            .map(|branch| branch.resistance_ohm_cm2.ln())
            .collect();
        local.extend(base.branches.iter().map(|b| b.capacitance_f_per_cm2.ln()));
        local.push(base.steady_state_resistance_ohm_cm2.recip());
        if bends {
            local.extend([base.charge_to_curvature_per_c_cm, base.relaxation_rate_per_s]);
        }
        local
    }

    /// Estimates in the order of `model`'s parameters, by the rules of every fit: values, bounds or reasons.
    pub fn parameters(&self, model: &FitModel, drive: &Drive) -> Vec<Parameter> {
        let layout = Layout {
            branches: self.branches,
        };
        let bends = self.local.len() > layout.coupling();
        let features = Feature::all(self.branches).filter(|feature| feature.is_electrical() || bends);
        let found: Vec<_> = features
            .map(|feature| (feature, self.interval(feature, layout), None))
            .collect();
        joint_parameters(model, &found, drive)
    }

    fn interval(&self, feature: Feature, layout: Layout) -> Interval {
        let value = feature.of(layout, &self.local);
        let step = |k: usize| STEP * self.local[k].abs().max(1e-3);
        let gradient = gradient(&self.local, step, |local| feature.of(layout, local));
        Interval::linear(value, self.covariance.error_along(&gradient), self.quantile)
    }
}

/// Readings of a channel that a fit uses.
fn usable(channels: &[Channel], drive: &Drive, quantity: Quantity) -> Option<Sampled> {
    let channel = channels.iter().find(|channel| channel.is_whole(quantity))?;
    let sampled = Sampled::new(channel, drive, quantity == Quantity::Curvature);
    (sampled.len() > 0).then_some(sampled)
}

/// Current, A, and curvature, 1/cm, at the times of each, s.
pub type Predict<'a> = dyn Fn(&[f64], &[f64]) -> [Vec<f64>; 2] + 'a;

/// A run under a model: `predict` gives current and curvature at the times of each.
///
/// `head` holds the model's name, how it was found and its parameters; the rest is filled in.
pub fn fit_of_run(input: &FitInput, searched: usize, head: Fit, predict: &Predict) -> Fit {
    let quantities = [Quantity::Current, Quantity::Curvature];
    let cleaned = Cleaned::of(input);
    let sampled = quantities.map(|quantity| usable(&cleaned.channels, input.drive, quantity));
    let times = |k: usize| sampled[k].as_ref().map_or(&[][..], |s| &s.time_s);
    let fitted = predict(times(0), times(1));
    let mut fit = head;
    fit.issues.extend(cleaned.issues_of_whole());
    for ((quantity, sampled), fitted) in quantities.into_iter().zip(&sampled).zip(fitted) {
        let Some(sampled) = sampled else { continue };
        let (noise, curve) = judged_response(quantity, sampled, fitted, input.drive, searched);
        match quantity {
            Quantity::Current => fit.r_squared_current = noise.r_squared,
            _ => fit.r_squared_curvature = noise.r_squared,
        }
        fit.n_samples += noise.readings;
        fit.noise.push(noise);
        fit.curves.push(curve);
    }
    fit
}
