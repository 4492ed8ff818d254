//! What the fit of one run came to, as a row of a table: how results travel between computers. Each carries a checksum: a disk and
//! a cable change what they carry.

use serde::{Deserialize, Serialize};

use crate::domain::{AskedFit, Fit, Issue, MadeBy};
use crate::pipeline::campaign::context::{BUILT_FROM, CODE_VERSION};

/// Schema of a row.
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
    /// Commit that it was built from; empty where an earlier version fitted.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub built_from: String,
    /// How the fit was asked for by hand.
    #[serde(default)]
    pub asked: AskedFit,
    /// The fit without its curves, which follow from the readings; none where it could not be made.
    pub fit: Option<Fit>,
    /// Why it could not be made.
    pub issue: Option<Issue>,
    /// BLAKE3 of all the others, hexadecimal: see [`FitResult::sum`]. Empty where there is none.
    #[serde(default)]
    pub checksum: String,
}

impl FitResult {
    /// What the fit of that run came to, here and now, with its checksum.
    pub fn of(
        run: &str,
        data_hash: &str,
        input_hash: &str,
        asked: &AskedFit,
        outcome: Result<Fit, Issue>,
    ) -> FitResult {
        let (fit, issue) = match outcome {
            Ok(fit) => (Some(without_curves(fit)), None),
            Err(issue) => (None, Some(issue)),
        };
        let result = FitResult {
            schema: SCHEMA.to_owned(),
            run: run.to_owned(),
            data_hash: data_hash.to_owned(),
            input_hash: input_hash.to_owned(),
            code_version: CODE_VERSION.to_owned(),
            built_from: BUILT_FROM.to_owned(),
            asked: asked.clone(),
            fit,
            issue,
            checksum: String::new(),
        };
        FitResult {
            checksum: result.sum(),
            ..result
        }
    }

    /// The program that fitted.
    pub fn made_by(&self) -> MadeBy {
        MadeBy::new(self.code_version.clone(), self.built_from.clone())
    }

    /// What the fit came to; none where the row says neither.
    pub fn outcome(&self) -> Option<Result<&Fit, &Issue>> {
        match (&self.fit, &self.issue) {
            (Some(fit), None) => Some(Ok(fit)),
            (None, Some(issue)) => Some(Err(issue)),
            _ => None,
        }
    }

    /// BLAKE3 of its JSON with an empty checksum: the same however it travelled, for numbers come back to the bit.
    pub fn sum(&self) -> String {
        let open = FitResult {
            checksum: String::new(),
            ..self.clone()
        };
        // What could not be written as JSON has no sum, and none that fits it either.
        let text = serde_json::to_string(&open).unwrap_or_default();
        blake3::hash(text.as_bytes()).to_hex().to_string()
    }
}

/// The numbers of a fit.
pub(crate) fn without_curves(fit: Fit) -> Fit {
    Fit {
        curves: Vec::new(),
        along: Vec::new(),
        ..fit
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::domain::Parameter;
    use crate::domain::testing::{fit, known};

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
        let key = |at: usize| format!("r{at}_ohm_cm2");
        let mut made = fit(&[]);
        made.parameters = (0..hard.len())
            .map(|at| Parameter {
                key: key(at),
                estimate: known(hard[at], hard[hard.len() - 1 - at]),
            })
            .collect();
        let asked = AskedFit::default();
        let result = FitResult::of("runs/a.csv", "d", "i", &asked, Ok(made.clone()));
        let text = serde_json::to_string(&result).unwrap();
        let back: FitResult = serde_json::from_str(&text).unwrap();
        let bits = |fit: &Fit| -> Vec<Option<u64>> {
            let values = fit.parameters.iter().map(|own| own.estimate.value);
            values.map(|value| value.map(f64::to_bits)).collect()
        };
        assert_eq!(bits(back.fit.as_ref().unwrap()), bits(&made));
        assert!(matches!(back.outcome(), Some(Ok(_))));
        assert_eq!(back.sum(), result.checksum);
        let neither = FitResult { fit: None, ..back };
        assert!(neither.outcome().is_none());
    }

    /// One that leaves what is said as it is, such as another spelling of a number, changes nothing.
    #[test]
    fn a_flipped_bit_is_noticed_or_changes_nothing() {
        let made = fit(&[("r1_ohm_cm2", known(1.0 / 3.0, 0.1))]);
        let result = FitResult::of("runs/a.csv", "d", "i", &AskedFit::default(), Ok(made));
        let text = serde_json::to_string(&result).unwrap();
        let mut noticed = 0;
        for (at, bit) in (0..text.len()).flat_map(|at| (0..8).map(move |bit| (at, bit))) {
            let mut flipped = text.clone().into_bytes();
            flipped[at] ^= 1 << bit;
            let Ok(read) = serde_json::from_slice::<FitResult>(&flipped) else {
                continue;
            };
            if read.sum() == read.checksum {
                assert_eq!(read, result, "byte {at}, bit {bit}")
            } else {
                noticed += 1
            }
        }
        assert!(noticed > 1000, "{noticed} were noticed by the checksum");
    }
}
