//! What the fit of one run came to, as a line of JSON: how results travel between computers.

use serde::{Deserialize, Serialize};

use crate::domain::{AskedFit, Fit, Issue};

/// Schema of a line.
pub const SCHEMA: &str = "ieap/fit-result/1";

/// The fit of a run, or why it could not be made; with what it was made from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FitResult {
    /// Always [`SCHEMA`].
    pub schema: String,
    /// The run's name.
    pub run: String,
    /// Hash of its readings.
    pub data_hash: String,
    /// Hash of everything that the fit depends on.
    pub input_hash: String,
    /// Version of the program that fitted.
    pub code_version: String,
    /// How the fit was asked for by hand.
    #[serde(default)]
    pub asked: AskedFit,
    /// The fit; none where it could not be made.
    pub fit: Option<Fit>,
    /// Why it could not be made.
    pub issue: Option<Issue>,
}

impl FitResult {
    /// What the fit came to; none where the line says neither.
    pub fn outcome(&self) -> Option<Result<&Fit, &Issue>> {
        match (&self.fit, &self.issue) {
            (Some(fit), None) => Some(Ok(fit)),
            (None, Some(issue)) => Some(Err(issue)),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::sample_campaign::{fit, known};
    use crate::domain::{AlongCurve, Quantity, RunCurve};

    #[test]
    fn a_fit_comes_back_to_the_bit() {
        // Numbers whose shortest decimals a careless reader misses by the last bit.
        let hard = [
            0.1 + 0.2,
            1.0 / 3.0,
            5e-324,
            f64::MIN_POSITIVE - f64::from_bits(1),
            123456789.12345679,
            8.41e21,
        ];
        let mut made = fit(&[("r1_ohm_cm2", known(hard[1], hard[0]))]);
        made.curves = vec![RunCurve {
            quantity: Quantity::Current,
            time_s: hard.to_vec(),
            measured: hard.to_vec(),
            fitted: hard.iter().map(|number| -number).collect(),
            residual_sigma: vec![],
            readings: 6,
        }];
        made.along = vec![AlongCurve {
            quantity: Quantity::Curvature,
            position_mm: vec![1.0],
            noise: vec![f64::NAN],
            time_s: vec![0.0],
            measured: vec![f64::NAN],
            fitted: vec![hard[4]],
            frames: 1,
        }];
        let result = FitResult {
            schema: SCHEMA.to_owned(),
            run: "runs/a.csv".to_owned(),
            data_hash: "d".to_owned(),
            input_hash: "i".to_owned(),
            code_version: "0.1.0".to_owned(),
            asked: AskedFit::default(),
            fit: Some(made.clone()),
            issue: None,
        };
        let text = serde_json::to_string(&result).unwrap();
        let back: FitResult = serde_json::from_str(&text).unwrap();
        let read = back.fit.clone().unwrap();
        let bits = |numbers: &[f64]| numbers.iter().map(|number| number.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&read.curves[0].measured), bits(&hard));
        assert_eq!(bits(&read.curves[0].fitted), bits(&made.curves[0].fitted));
        assert_eq!(read.parameters, made.parameters);
        assert!(read.along[0].noise[0].is_nan() && read.along[0].measured[0].is_nan());
        assert!(matches!(back.outcome(), Some(Ok(_))));
        let neither = FitResult { fit: None, ..back };
        assert!(neither.outcome().is_none());
    }
}
