//! Whether the samples of a material differ by more than their runs do, and whether one differs as a wrong free
//! length would make it.

use super::chance_of::ask;
use super::covariate::Covariate;
use super::dependence::{Asking, Dependence};
use super::facts::RunFacts;
use super::fitted::Interval;
use super::jump::Jump;
use super::policy::FEWEST_SAMPLES;
use super::table::Table;
use super::values::Values;
use crate::policy::DIFFERS_BELOW;
use ieap_numerics::grouped::{Grouped, dot, shared_variance};
use ieap_numerics::student::{quantile_95, two_sided_chance};

impl Asking<'_> {
    /// Asks whether samples differ. None with one sample, or where runs repeat too little.
    pub fn about_samples(&self) -> Option<Dependence> {
        let table = Table::new(self.values, self.within, self.within);
        let samples = table.sample.iter().max().map_or(0, |last| last + 1);
        if samples < 2 {
            return None;
        }
        let covariates: Vec<Covariate> = table.columns.keys().copied().collect();
        let even = vec![1.0; table.y.len()];
        let mut kept = Vec::new();
        let mut model = Grouped::new(&even, &table.sample, &[]);
        for column in table.columns_of(&covariates) {
            if model.freedom() > 3 && model.take_out(&column) {
                kept.push(column);
            }
        }
        let shared = shared_variance(&table.y, &table.variance, &table.sample, &kept);
        let variance: Vec<f64> = table.variance.iter().map(|v| (v + shared).max(1e-18)).collect();
        let one_group = vec![0; table.y.len()];
        let null = Grouped::new(&variance, &one_group, &kept);
        let own = Grouped::new(&variance, &table.sample, &kept);
        let answer = ask(&table.y, &null, std::slice::from_ref(&own), &one_group, self.seed)?;
        let mut found = self.empty_of(&table, Covariate::Sample, answer);
        // What differs between samples only cannot be told from the samples themselves.
        found.confounded_with = self.rows.columns.keys().copied().collect();
        found.adjusted_for = covariates;
        let left = own.residual(&table.y);
        let whole = null.residual(&table.y);
        let within = dot(&left, &left) / own.freedom() as f64;
        let between = (dot(&whole, &whole) - dot(&left, &left)) / (samples - 1) as f64;
        // In units of the mean variance of a run.
        let runs_a_sample = table.y.len() as f64 / samples as f64;
        let unit = variance.len() as f64 / variance.iter().map(|v| v.recip()).sum::<f64>();
        let deviation = ((between - within).max(0.0) / runs_a_sample * unit).sqrt();
        found.jump = Some(Jump {
            from: String::new(),
            to: String::new(),
            size: Interval {
                value: deviation,
                low_95: None,
                high_95: None,
            },
        });
        Some(found)
    }
}

/// A sample whose parameters lie off the others' as a wrong free length would put them.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct LengthDoubt {
    /// Material.
    pub material: String,
    /// Sample.
    pub sample: String,
    /// True length over stated length that would explain it.
    pub factor: Interval,
    /// Probability of such an offset among as many samples, of this one.
    pub p: f64,
    /// The same over all questions of the campaign; 1 until all are asked.
    pub q: f64,
    /// Whether the length explains all that is off.
    pub explains_all: bool,
    /// Number of samples compared.
    pub samples: usize,
}

/// Change of a parameter's logarithm where the stated length is too large by a factor e. Parameters per area follow
/// the area; a curvature that was made from a displacement follows the square of the length.
fn direction(key: &str, from_displacement: bool) -> Option<f64> {
    match key {
        "r1_ohm_cm2" | "r2_ohm_cm2" | "rss_ohm_cm2" | "rc_ohm_cm2" => Some(1.0),
        "c1_f_per_cm2" | "c2_f_per_cm2" | "c_f_per_cm2" => Some(-1.0),
        "alpha_per_c_cm" if from_displacement => Some(-2.0),
        "alpha_per_c_cm" | "lambda_per_s" => Some(0.0),
        _ => None,
    }
}

/// Asks of every sample of a material whether its length is doubtful.
pub fn length_doubts(
    facts: &[RunFacts],
    material: &str,
    all: &[(&Values, Table)],
    from_displacement: bool,
) -> Vec<LengthDoubt> {
    let tables: Vec<(f64, &Table)> = all
        .iter()
        .filter(|(values, _)| values.is_log)
        .filter_map(|(values, table)| Some((direction(&values.key, from_displacement)?, table)))
        .collect();
    let Some((_, first)) = tables.first() else {
        return Vec::new();
    };
    let samples = first.y.len();
    let whole = tables.iter().all(|(_, table)| table.y.len() == samples);
    let norm: f64 = tables.iter().map(|(d, _)| d * d).sum();
    if samples < FEWEST_SAMPLES || !whole || norm == 0.0 {
        return Vec::new();
    }
    let along = |sample: usize| tables.iter().map(|(d, table)| d * table.y[sample]).sum::<f64>() / norm;
    let doubt = |sample: usize| {
        let lengths: Vec<f64> = (0..samples).map(along).collect();
        let (shift, error, p) = against_others(&lengths, sample)?;
        let rest = |(d, table): &(f64, &Table)| {
            let left: Vec<f64> = (0..samples).map(|s| table.y[s] - d * along(s)).collect();
            against_others(&left, sample).map_or(1.0, |(_, _, p)| p)
        };
        let unexplained = tables.iter().map(rest).fold(1.0, f64::min) * tables.len() as f64;
        let reach = quantile_95((samples - 2) as f64) * error;
        let size = Interval {
            value: shift,
            low_95: Some(shift - reach),
            high_95: Some(shift + reach),
        };
        Some(LengthDoubt {
            material: material.to_owned(),
            sample: facts[first.members[sample][0]].sample.clone(),
            factor: size.map(|shift| (-shift).exp()),
            p,
            q: 1.0,
            explains_all: unexplained > DIFFERS_BELOW,
            samples,
        })
    };
    (0..samples).filter_map(doubt).collect()
}

/// How far one number lies from the mean of the others, with its standard error and the probability of it.
fn against_others(numbers: &[f64], one: usize) -> Option<(f64, f64, f64)> {
    let others: Vec<f64> = (0..numbers.len())
        .filter(|k| *k != one)
        .map(|k| numbers[k])
        .collect();
    let n = others.len() as f64;
    let mean = others.iter().sum::<f64>() / n;
    let square: f64 = others.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (n - 1.0);
    let error = (square * (1.0 + 1.0 / n)).sqrt();
    let shift = numbers[one] - mean;
    (error > 0.0).then(|| (shift, error, two_sided_chance(shift / error, n - 1.0)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_far_from_the_others_is_improbable() {
        let (shift, _, p) = against_others(&[0.1, -0.1, 0.05, 2.0, 0.0], 3).unwrap();
        assert!((shift - 1.9875).abs() < 1e-9 && p < 1e-3, "{p}");
        let (_, _, p) = against_others(&[0.1, -0.1, 0.05, 0.02, 0.0], 3).unwrap();
        assert!(p > 0.5);
        assert!(against_others(&[1.0, 1.0, 1.0], 0).is_none());
    }
}
