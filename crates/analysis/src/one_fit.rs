//! Runs whose parameters were found together: the fit of a group gives all of its runs one parameter set, which is one
//! measurement however many runs it is stored with.

use ieap_domain::tag::keys;
use ieap_domain::{Estimate, RunRecord};

/// What tells the estimates of one fit from those of another.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct SharedEstimate(String, [Option<u64>; 4]);

impl SharedEstimate {
    /// The identity of an estimate that a run shares with the others of its group; none for a run fitted alone. Only
    /// extended models are fitted to groups, and what they share agrees to the last bit.
    pub fn of(run: &RunRecord, estimate: &Estimate) -> Option<SharedEstimate> {
        let fit = run.fit.as_ref()?;
        if !fit.is_of_group() {
            return None;
        }
        let bits = [
            estimate.value,
            estimate.standard_error,
            estimate.low_95,
            estimate.high_95,
        ]
        .map(|number| number.map(f64::to_bits));
        let sample = run.tag(keys::SAMPLE).unwrap_or_default();
        Some(SharedEstimate(format!("{} {sample}", fit.model), bits))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ieap_domain::testing::{fit, known, run};

    #[test]
    fn one_parameter_set_is_one_measurement() {
        let of = |model: &str, sample: &str, value: f64| {
            let mut run = run("r", sample, "air", None, 2.0);
            let mut found = fit(&[("lambda_per_s", known(value, 0.1))]);
            found.model = model.to_owned();
            run.fit = Some(found);
            SharedEstimate::of(&run, &known(value, 0.1))
        };
        let extended = "lumped-2 + faradaic-leak";
        assert_eq!(of("lumped-2", "A", 1.0), None);
        assert!(of(extended, "A", 1.0).is_some());
        assert_eq!(of(extended, "A", 1.0), of(extended, "A", 1.0));
        assert_ne!(of(extended, "A", 1.0), of(extended, "B", 1.0));
        assert_ne!(of(extended, "A", 1.0), of(extended, "A", 1.1));
    }
}
