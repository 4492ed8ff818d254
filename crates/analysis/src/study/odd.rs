//! Runs that are not like the others of their condition: they count for less in the model, and are named.

use std::collections::BTreeMap;

use ieap_domain::number::significant;
use ieap_domain::words::in_a_row;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::measured::{Measured, Value};
use super::policy::MOST_NAMED;
use crate::laws::words::symbol;
use crate::parameters::COMPARED;
use crate::word::{self, Word};

/// A value of a run that may be of something else than its condition says.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct OddValue {
    /// The run.
    pub run: String,
    /// The parameter, or what is made of several.
    #[serde(deserialize_with = "word::read")]
    pub parameter: Word,
    /// How far it stands off what the others say, in the standard errors that they leave.
    pub off_standard_errors: f64,
    /// As how many runs it counts: the chance that it is like the others.
    pub weight: f64,
}

/// Those of all models, in the order of the runs.
pub(super) fn odd_values<'a>(
    measured: impl Iterator<Item = (&'static str, &'a Measured)>,
    run: impl Fn(&Value) -> String,
) -> Vec<OddValue> {
    let of = |(parameter, of): (&'static str, &'a Measured)| {
        let odd = |own: &Value| {
            Some(OddValue {
                run: run(own),
                parameter,
                off_standard_errors: own.off?,
                weight: own.weight,
            })
        };
        of.values.iter().filter_map(odd).collect::<Vec<_>>()
    };
    let mut found: Vec<OddValue> = measured.flat_map(of).collect();
    found.sort_by(|a, b| a.run.cmp(&b.run));
    found
}

/// A sentence for each run that is likelier of something else than like its own in one of the parameters.
pub fn odd_runs(odd: &[OddValue]) -> Vec<String> {
    let mut of_runs: BTreeMap<&str, Vec<&OddValue>> = BTreeMap::new();
    let is_said = |own: &&OddValue| own.weight < 0.5 && COMPARED.contains(&own.parameter);
    for own in odd.iter().filter(is_said) {
        of_runs.entry(&own.run).or_default().push(own);
    }
    let sentence = |(run, values): (&&str, &Vec<&OddValue>)| {
        let off = |own: &&OddValue| {
            let times = significant(own.off_standard_errors.abs(), 2);
            format!("{times} times in {}", symbol(own.parameter))
        };
        let all: Vec<String> = values.iter().map(off).collect();
        format!(
            "{run} is not like the other runs of its condition: it lies off by more than they scatter, {}. It counts for less there. Is it of another strip, or at another voltage?",
            in_a_row(&all)
        )
    };
    let mut said: Vec<String> = of_runs.iter().take(MOST_NAMED).map(sentence).collect();
    let more = of_runs.len().saturating_sub(MOST_NAMED);
    said.extend(
        (more > 0).then(|| format!("{more} more runs are like that (`odd` in `ieap study --json`).")),
    );
    said
}
