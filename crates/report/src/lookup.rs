//! Where what is asked for run by run stands in the input: a look through all of it for every run would make a report of
//! ten thousand runs take a hundred times as long as one of a thousand.

use std::collections::HashMap;
use std::hash::Hash;

use super::input::Input;
use ieap_analysis::Conditions;

/// Places in the lists of an input; of several the first.
#[derive(Debug)]
pub struct Lookup<'a> {
    /// Runs that have a page, by path.
    pub runs: HashMap<&'a str, usize>,
    /// The group that a run was diagnosed in, by the run's path.
    pub group_findings: HashMap<&'a str, usize>,
    /// What was found of a run alone, by its path.
    pub run_findings: HashMap<&'a str, usize>,
    /// What runs say without a model, by row id.
    pub model_free: HashMap<i64, usize>,
    /// Trains, by row id of their run.
    pub cycles: HashMap<i64, usize>,
    /// Conditions, by the run's number.
    pub conditions: HashMap<usize, usize>,
    /// Earlier revisions by path, in their order.
    pub superseded: HashMap<&'a str, Vec<usize>>,
}

impl<'a> Lookup<'a> {
    /// Of an input and the conditions of its runs.
    pub fn new(input: &'a Input, conditions: &Conditions) -> Lookup<'a> {
        let findings = &input.findings;
        let of_groups = findings.groups.iter().enumerate();
        let measured = conditions.measured.iter().enumerate();
        let mut superseded: HashMap<&str, Vec<usize>> = HashMap::new();
        for (place, old) in input.superseded.iter().enumerate() {
            superseded.entry(&old.path).or_default().push(place);
        }
        Lookup {
            runs: first(input.records().map(|run| run.path.as_str())),
            group_findings: first_of(
                of_groups.flat_map(|(place, found)| found.runs.iter().map(move |run| (run.as_str(), place))),
            ),
            run_findings: first(findings.runs.iter().map(|found| found.group.as_str())),
            model_free: first(input.model_free.iter().map(|own| own.run_id)),
            cycles: first(input.cycles.iter().map(|own| own.run_id)),
            conditions: first_of(
                measured.flat_map(|(place, condition)| condition.runs.iter().map(move |&run| (run, place))),
            ),
            superseded,
        }
    }
}

fn first<K: Hash + Eq>(keys: impl Iterator<Item = K>) -> HashMap<K, usize> {
    first_of(keys.enumerate().map(|(place, key)| (key, place)))
}

fn first_of<K: Hash + Eq>(places: impl Iterator<Item = (K, usize)>) -> HashMap<K, usize> {
    let mut found = HashMap::new();
    for (key, place) in places {
        found.entry(key).or_insert(place);
    }
    found
}
