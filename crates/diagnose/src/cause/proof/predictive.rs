//! How far held-out readings lie from what a model fitted to the others predicts, its own uncertainty allowed for.
//!
//! A model whose parameters the other readings hardly determine predicts anything, and its best guess may lie far off
//! without being contradicted. The deviance is twice the negative logarithm of the density that the readings of a part
//! have under the prediction from all others, less what is the same for every model. To first order in the parameters
//! about the fit to everything it is
//!
//! `S - S' + ln det(N + P) - ln det(N' + P)`,
//!
//! with the least sums of squares S of all readings and S' of the others, their normal matrices N and N', and P the
//! little that is known of the parameters before. A part that the others contradict raises S; parameters that only the
//! part itself tells are paid for by the determinants, so that none proves itself.

use ieap_numerics::sums::dot;
use ieap_numerics::symmetric::Symmetric;

use crate::cause::policy::PREDICTED_FROM;
use crate::fitting::fitted::Fitted;

/// A model at its fit to all readings, linear in its parameters from there.
pub(crate) struct Predictive {
    columns: Vec<Vec<f64>>,
    /// Precision of each parameter before any reading.
    known: Vec<f64>,
    square: f64,
    /// ln det(N + P).
    information: f64,
}

impl Predictive {
    pub(crate) fn of(fitted: &Fitted) -> Predictive {
        let (_, columns) = fitted.problem.slope(&fitted.at);
        let known: Vec<f64> = (fitted.problem.known().into_iter())
            .map(|known| known + PREDICTED_FROM)
            .collect();
        Predictive {
            information: information(&columns, &known, &[]),
            square: fitted.penalised(),
            known,
            columns,
        }
    }

    /// Slopes about the fit, in units of the noise.
    pub(crate) fn columns(&self) -> &[Vec<f64>] {
        &self.columns
    }

    /// Slopes about the fit with nothing in the rows that are `out`.
    pub(crate) fn columns_without(&self, out: &[bool]) -> Vec<Vec<f64>> {
        let own = |column: &Vec<f64>| {
            let rows = column.iter().zip(out);
            rows.map(|(v, is_out)| if *is_out { 0.0 } else { *v }).collect()
        };
        self.columns.iter().map(own).collect()
    }

    /// What is known of the parameters by the rows that are not `out`, and before.
    pub(crate) fn normal_without(&self, out: &[bool]) -> Symmetric {
        let mut normal = normal(&self.columns, out);
        for (k, precision) in self.known.iter().enumerate() {
            normal.add(k, k, *precision);
        }
        normal
    }

    /// Deviance of the rows that are `out`, where the others leave the least sum of squares `others`.
    pub(crate) fn deviance(&self, out: &[bool], others: f64) -> f64 {
        self.added((&[], self.square), (out, others))
    }

    /// Deviance of the rows that are out of the second fit and not of the first: each with its least sum of squares.
    pub(crate) fn added(&self, with: (&[bool], f64), without: (&[bool], f64)) -> f64 {
        let of = |(out, square): (&[bool], f64)| {
            let told = if out.is_empty() {
                self.information
            } else {
                information(&self.columns, &self.known, out)
            };
            square + told
        };
        of(with) - of(without)
    }
}

/// ln det(N + P) of the rows that are not `out`.
fn information(columns: &[Vec<f64>], known: &[f64], out: &[bool]) -> f64 {
    let mut normal = normal(columns, out);
    for (k, precision) in known.iter().enumerate() {
        normal.add(k, k, *precision);
    }
    normal.log_determinant()
}

/// J'J of the rows that are not `out`.
pub(crate) fn normal(columns: &[Vec<f64>], out: &[bool]) -> Symmetric {
    let kept: Vec<Vec<f64>> = columns.iter().map(|column| kept(column, out)).collect();
    Symmetric::from_fn(columns.len(), |a, b| dot(&kept[a], &kept[b]))
}

/// Rows that are not `out`; all where nothing is said.
pub(crate) fn kept(column: &[f64], out: &[bool]) -> Vec<f64> {
    let is_out = |row: usize| out.get(row).copied().unwrap_or(false);
    let rows = column.iter().enumerate();
    rows.filter(|(row, _)| !is_out(*row)).map(|(_, v)| *v).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The density of some readings of a line given the others, by the covariance of the prediction.
    #[test]
    fn it_is_the_density_of_the_held_out_readings_under_the_prediction() {
        let column: Vec<f64> = (0..12).map(|k| 1.0 + 0.3 * f64::from(k)).collect();
        let readings: Vec<f64> = (0..12)
            .map(|k| (1.7 * f64::from(k)).sin() + 0.1 * f64::from(k))
            .collect();
        let out: Vec<bool> = (0..12).map(|k| k > 7).collect();
        let least = |out: &[bool]| {
            let (c, r) = (kept(&column, out), kept(&readings, out));
            let normal = dot(&c, &c) + PREDICTED_FROM;
            (
                dot(&r, &r) - dot(&c, &r).powi(2) / normal,
                dot(&c, &r) / normal,
                normal,
            )
        };
        let ((whole, ..), (others, at, normal)) = (least(&[]), least(&out));
        let found = whole - others + information(std::slice::from_ref(&column), &[PREDICTED_FROM], &[])
            - information(std::slice::from_ref(&column), &[PREDICTED_FROM], &out);
        // Prediction c x with variance 1 + c c / N': by Sherman and Morrison.
        let held: Vec<usize> = (8..12).collect();
        let off: Vec<f64> = held.iter().map(|&k| readings[k] - at * column[k]).collect();
        let c: Vec<f64> = held.iter().map(|&k| column[k]).collect();
        let growth = 1.0 + dot(&c, &c) / normal;
        let expected = dot(&off, &off) - dot(&c, &off).powi(2) / normal / growth + growth.ln();
        assert!((found - expected).abs() < 1e-9, "{found} {expected}");
    }
}
