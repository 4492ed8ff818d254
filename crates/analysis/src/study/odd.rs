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

/// Values of runs that are likelier of something else than like their own in one of the parameters.
fn of_runs(odd: &[OddValue]) -> BTreeMap<&str, Vec<&OddValue>> {
    let mut of_runs: BTreeMap<&str, Vec<&OddValue>> = BTreeMap::new();
    let is_said = |own: &&OddValue| own.weight < 0.5 && COMPARED.contains(&own.parameter);
    for own in odd.iter().filter(is_said) {
        of_runs.entry(&own.run).or_default().push(own);
    }
    of_runs
}

/// What the first screen says of them, in a sentence; none where there is none. Of two that stand off to opposite sides in all
/// that both are odd in, each has what is the other's.
pub fn odd_in_short(odd: &[OddValue]) -> Option<String> {
    let of_runs = of_runs(odd);
    let all: Vec<(&str, &Vec<&OddValue>)> = of_runs.iter().map(|(run, values)| (*run, values)).collect();
    let is_opposite = |a: &[&OddValue], b: &[&OddValue]| {
        let same = |own: &&OddValue| b.iter().find(|other| other.parameter == own.parameter).copied();
        let mut both = a.iter().filter_map(|own| Some((*own, same(own)?))).peekable();
        both.peek().is_some() && both.all(|(a, b)| a.off_standard_errors * b.off_standard_errors < 0.0)
    };
    let far = |values: &[&OddValue]| {
        let each = values.iter().map(|own| own.off_standard_errors.abs());
        each.fold(0.0, f64::max)
    };
    let times = |values: &[&OddValue]| significant(far(values), 2);
    let (furthest, its) = all.iter().max_by(|a, b| far(a.1).total_cmp(&far(b.1)))?;
    match &all[..] {
        [(a, of_a), (b, of_b)] if is_opposite(of_a, of_b) => Some(format!(
            "{a} and {b} may be swapped: they are not like the other runs of their conditions ({} and {} standard errors off, to opposite sides). They count for less until you say what they are (`ieap tag`).",
            times(of_a),
            times(of_b)
        )),
        [_] => Some(format!(
            "{furthest} is not like the other runs of its condition ({} standard errors off). It counts for less: is it of another strip, or at another voltage (`ieap tag`)?",
            times(its)
        )),
        several => Some(format!(
            "{} runs are not like the others of their conditions, {furthest} the least ({} standard errors off). They count for less: are they of other strips, or at other voltages (`ieap tag`)?",
            several.len(),
            times(its)
        )),
    }
}

/// A sentence for each run that is likelier of something else than like its own in one of the parameters.
pub fn odd_runs(odd: &[OddValue]) -> Vec<String> {
    let of_runs = of_runs(odd);
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
