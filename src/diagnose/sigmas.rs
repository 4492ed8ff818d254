//! How strong a hidden effect is: what it leaves after the base parameters are refitted, in standard deviations.

use crate::domain::Drive;
use crate::model::LumpedModel;
use crate::model::extended::Responses;
use crate::numerics::sums::dot;

use super::tangent::Tangent;

/// Relative step of the difference quotients.
const STEP: f64 = 1e-5;

/// Noise as it was put into simulated readings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KnownNoise {
    /// Standard deviation of the current, A.
    pub current_a: f64,
    /// Standard deviation of the curvature, 1/cm.
    pub curvature_per_cm: f64,
    /// Correlation between neighbouring readings.
    pub autocorrelation: f64,
}

/// A run of a design.
#[derive(Debug, Clone)]
pub struct DesignRun {
    /// Drive.
    pub drive: Drive,
    /// Active area, cm2.
    pub area_cm2: f64,
    /// Times of the current readings, s.
    pub current_time_s: Vec<f64>,
    /// Times of the curvature readings, s.
    pub curvature_time_s: Vec<f64>,
}

/// Norm, in standard deviations of the noise, of what is left of the deviation of `responses` from the base model
/// after its parameters are refitted, to first order.
pub fn sigmas_after_refit(
    base: &LumpedModel,
    design: &[DesignRun],
    responses: &[Responses],
    noise: KnownNoise,
) -> f64 {
    let plain = of_base(base, design, noise);
    let mut away = Vec::with_capacity(plain.len());
    for responses in responses {
        away.extend(white(
            &responses.current_a,
            noise.current_a,
            noise.autocorrelation,
        ));
        away.extend(white(
            &responses.curvature_per_cm,
            noise.curvature_per_cm,
            noise.autocorrelation,
        ));
    }
    away.iter_mut().zip(&plain).for_each(|(a, p)| *a -= p);
    let mut tangent = Tangent::default();
    for k in 0..2 * base.branches.len() + 3 {
        let moved = of_base(&nudged(base, k), design, noise);
        tangent.add(moved.iter().zip(&plain).map(|(m, p)| (m - p) / STEP).collect());
    }
    tangent.remove(&mut away);
    dot(&away, &away).sqrt()
}

fn of_base(base: &LumpedModel, design: &[DesignRun], noise: KnownNoise) -> Vec<f64> {
    let mut out = Vec::new();
    for run in design {
        let current = base.current_a(&run.drive, run.area_cm2, &run.current_time_s);
        out.extend(white(&current, noise.current_a, noise.autocorrelation));
        let curvature = base.curvature_per_cm(&run.drive, run.area_cm2, &run.curvature_time_s);
        out.extend(white(&curvature, noise.curvature_per_cm, noise.autocorrelation));
    }
    out
}

/// The base with its parameter `k` larger by a small part.
fn nudged(base: &LumpedModel, k: usize) -> LumpedModel {
    let mut moved = base.clone();
    let n = base.branches.len();
    let factor = 1.0 + STEP;
    match k {
        k if k < n => moved.branches[k].resistance_ohm_cm2 *= factor,
        k if k < 2 * n => moved.branches[k - n].capacitance_f_per_cm2 *= factor,
        k if k == 2 * n => moved.steady_state_resistance_ohm_cm2 *= factor,
        k if k == 2 * n + 1 => moved.charge_to_curvature_per_c_cm *= factor,
        _ => moved.relaxation_rate_per_s *= factor,
    }
    moved
}

/// The series in units of noise of that size and lag-1 correlation, made white.
fn white(series: &[f64], sd: f64, correlation: f64) -> Vec<f64> {
    let new = (1.0 - correlation * correlation).sqrt();
    let mut before = None;
    let each = series.iter().map(|&value| {
        let own = value / sd;
        let out = before.map_or(own, |before: f64| (own - correlation * before) / new);
        before = Some(own);
        out
    });
    each.collect()
}
