//! The variances that are most likely.

use super::at::{At, Likely};
use super::estimated::Estimated;
use super::model::MixedModel;
use crate::symmetric::Symmetric;

/// Rounds of scoring at most: ten are usual.
const ROUNDS: usize = 300;
/// Change of the variances, part of their sum, below which they are found.
const SETTLED: f64 = 1e-12;
/// Part of a component's information that must be its own for it to be told from the others.
const OWN_PART: f64 = 1e-6;

impl MixedModel {
    /// The model at stated variances: of each component, and of readings, last. None where `X` loses a direction.
    pub fn at(&self, variances: &[f64]) -> Option<Estimated> {
        let at = Likely::of(self, variances)?;
        Some(Estimated::stated(at, variances.to_vec()))
    }

    /// The model at the variances that are most likely (REML). A component that the design does not tell from those before it
    /// (readings come first, then components in their order) is held at zero. None where `X` loses a direction, or where no
    /// reading is left over to tell a variance from.
    pub fn estimated(&self) -> Option<Estimated> {
        self.estimated_from(None)
    }

    /// The same, sought from the variances of a model that is nearly this one.
    pub(super) fn estimated_from(&self, near: Option<&Estimated>) -> Option<Estimated> {
        let fixed = self.units.first().map_or(0, |unit| unit.fixed.len());
        if self.readings() <= fixed as f64 {
            return None;
        }
        let (at, variances, told) = self.sought(near)?;
        Some(Estimated::found(at, variances, &told))
    }

    /// Seeks them; with them, which of them the design tells apart.
    fn sought(&self, near: Option<&Estimated>) -> Option<(At, Vec<f64>, Vec<usize>)> {
        let scale = self.scale();
        let told = self.told_apart(scale)?;
        let mut variances = vec![0.0; self.components() + 1];
        for &component in &told {
            variances[component] = match near {
                Some(near) => near.variances[component],
                None => scale / told.len() as f64,
            };
        }
        let mut at = At::of(self, &variances)?;
        for _ in 0..ROUNDS {
            let Some((next, moved)) = self.step(&at, &variances, &told) else {
                break;
            };
            let change: f64 = (next.iter().zip(&variances)).map(|(a, b)| (a - b).abs()).sum();
            let size: f64 = next.iter().sum();
            (variances, at) = (next, moved);
            if change <= SETTLED * size.max(SETTLED * scale) {
                break;
            }
        }
        Some((at, variances, told))
    }

    /// One step of Fisher's scoring within what is not negative, halved until it gains; none where nothing does.
    fn step(&self, at: &At, variances: &[f64], told: &[usize]) -> Option<(Vec<f64>, At)> {
        let free: Vec<usize> = told
            .iter()
            .copied()
            .filter(|&k| variances[k] > 0.0 || at.score[k] > 0.0)
            .collect();
        let score: Vec<f64> = free.iter().map(|&k| at.score[k]).collect();
        let step = at.information.part(&free).solve(&score, 1e-12);
        let mut part = 1.0;
        for _ in 0..40 {
            let mut next = variances.to_vec();
            for (&k, step) in free.iter().zip(&step) {
                next[k] = (next[k] + part * step).max(0.0);
            }
            if next == variances {
                return None;
            }
            if let Some(moved) = Likely::of(self, &next)
                && moved.log_likelihood >= at.log_likelihood
            {
                return Some((next, At::whole(moved)));
            }
            part *= 0.5;
        }
        None
    }

    /// Variance of the readings about their mean: the size of all that is sought.
    fn scale(&self) -> f64 {
        let all = || self.units.iter().flat_map(|unit| &unit.readings);
        let count = self.readings();
        let mean = all().map(|reading| reading.weight * reading.value).sum::<f64>() / count;
        let square: f64 = all()
            .map(|reading| reading.weight * (reading.value - mean).powi(2))
            .sum();
        (square / count).max(f64::MIN_POSITIVE)
    }

    /// Components that the design tells apart; that of readings is the last number.
    fn told_apart(&self, scale: f64) -> Option<Vec<usize>> {
        let components = self.components();
        let information = At::of(self, &vec![scale; components + 1])?.information;
        let mut told: Vec<usize> = Vec::new();
        for k in std::iter::once(components).chain(0..components) {
            let mut with = told.clone();
            with.push(k);
            if is_whole(&information.part(&with)) {
                told = with;
            }
        }
        Some(told)
    }
}

/// Whether every row of a matrix of information says something that the ones before do not.
fn is_whole(information: &Symmetric) -> bool {
    let diagonal = (0..information.order()).all(|k| information.get(k, k) > 0.0);
    diagonal && information.cholesky(OWN_PART).is_some()
}
