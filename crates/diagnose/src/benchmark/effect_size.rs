//! How strong a hidden effect is: what it leaves after the base parameters are refitted, in standard deviations.

use ieap_domain::Drive;
use ieap_model::LumpedModel;
use ieap_model::extended::Responses;
use ieap_numerics::least_squares::Local;
use ieap_numerics::sums::dot;

/// Relative step of the difference quotients.
const STEP: f64 = 1e-5;
/// Steps of the refit at most.
const REFITS: usize = 12;

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
/// after its parameters are refitted.
pub fn sigmas_after_refit(
    base: &LumpedModel,
    design: &[DesignRun],
    responses: &[Responses],
    noise: KnownNoise,
) -> f64 {
    let readings = in_units_of_noise(responses, noise);
    let mut model = base.clone();
    let mut least = f64::INFINITY;
    for _ in 0..REFITS {
        let plain = of_base(&model, design, noise);
        let left: Vec<f64> = readings.iter().zip(&plain).map(|(y, f)| y - f).collect();
        let size = dot(&left, &left).sqrt();
        if size >= least * (1.0 - 1e-4) {
            return least.min(size);
        }
        least = size;
        let step = step(&model, design, noise, &left);
        for (k, by) in step.into_iter().enumerate() {
            model = scaled(&model, k, by.clamp(-0.5, 0.5).exp());
        }
    }
    least
}

/// All readings in units of the noise, made white by its correlation: run by run, current before curvature.
pub fn in_units_of_noise(responses: &[Responses], noise: KnownNoise) -> Vec<f64> {
    let mut readings = Vec::new();
    for responses in responses {
        let series = [
            (&responses.current_a, noise.current_a),
            (&responses.curvature_per_cm, noise.curvature_per_cm),
        ];
        for (series, sd) in series {
            readings.extend(white(series, sd, noise.autocorrelation));
        }
    }
    readings
}

/// What small relative changes of the base parameters change in those readings, a column for each parameter.
pub fn base_columns(model: &LumpedModel, design: &[DesignRun], noise: KnownNoise) -> Vec<Vec<f64>> {
    let plain = of_base(model, design, noise);
    (0..2 * model.branches.len() + 3)
        .map(|k| {
            let moved = of_base(&scaled(model, k, 1.0 + STEP), design, noise);
            moved.iter().zip(&plain).map(|(m, p)| (m - p) / STEP).collect()
        })
        .collect()
}

/// Gauss-Newton step in the logarithms of the base parameters.
fn step(model: &LumpedModel, design: &[DesignRun], noise: KnownNoise, left: &[f64]) -> Vec<f64> {
    let told = Local::of(left, &base_columns(model, design, noise));
    told.normal.solve(&told.descent, 1e-12)
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

/// The base with its parameter `k` multiplied.
fn scaled(base: &LumpedModel, k: usize, factor: f64) -> LumpedModel {
    let mut moved = base.clone();
    let n = base.branches.len();
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
