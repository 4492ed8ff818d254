//! Runs that no tag tells apart.

use std::collections::BTreeMap;

use ieap_domain::tag::keys;
use ieap_domain::{Drive, Issue, RunRecord, RunState};

/// Tags that say nothing of what was measured.
const BESIDE_THE_POINT: [&str; 3] = [keys::NOTE, keys::OPERATOR, keys::INSTRUMENT];

/// Names at most in a message.
const NAMED: usize = 3;

/// Adds an issue to every run that carries exactly the tags of another one.
pub fn annotate(runs: &mut [RunRecord]) {
    let mut alike: BTreeMap<Vec<(String, String)>, Vec<usize>> = BTreeMap::new();
    for (index, run) in runs
        .iter()
        .enumerate()
        .filter(|(_, run)| run.state != RunState::Untagged && !run.drive.as_ref().is_some_and(Drive::moves))
    {
        alike.entry(identity(run)).or_default().push(index);
    }
    for group in alike.values().filter(|group| group.len() > 1) {
        for &index in group {
            let issue = issue(runs, group, index);
            runs[index].issues.push(issue);
        }
    }
}

/// The chosen tags that describe the measurement, in order of their keys.
fn identity(run: &RunRecord) -> Vec<(String, String)> {
    let mut tags: BTreeMap<&str, &str> = BTreeMap::new();
    for tag in run
        .tags
        .iter()
        .filter(|tag| !BESIDE_THE_POINT.contains(&tag.key.as_str()))
    {
        // The chosen tag of a key stands first.
        tags.entry(&tag.key).or_insert(&tag.value);
    }
    tags.into_iter()
        .map(|(key, value)| (key.to_owned(), value.to_owned()))
        .collect()
}

fn issue(runs: &[RunRecord], group: &[usize], index: usize) -> Issue {
    // Only those that are named are looked at: a group may be the whole campaign.
    let others = group.iter().filter(|&&other| other != index);
    let named: Vec<&str> = others
        .take(NAMED)
        .map(|&other| runs[other].path.as_str())
        .collect();
    let mut named = named.join(", ");
    if group.len() - 1 > NAMED {
        named += &format!(" and {} more", group.len() - 1 - NAMED);
    }
    Issue::warning(
        "same-tags",
        format!("every tag is the same as that of {named}: they are compared as repeats"),
    )
    .mend("give repeats a cycle (cycle = 1, 2, ...), or correct the tag that is wrong")
}

#[cfg(test)]
mod tests {
    use super::*;
    use ieap_domain::testing::{run, tag};

    #[test]
    fn only_runs_that_nothing_tells_apart_are_named() {
        let mut runs: Vec<RunRecord> = ["a", "b", "c", "d"]
            .map(|name| run(name, "S", "air", None, 2.0))
            .into();
        runs[0].tags.push(tag(keys::NOTE, "first try"));
        runs[2].tags.push(tag(keys::CYCLE, "2"));
        runs[3].state = RunState::Untagged;
        let before: Vec<usize> = runs.iter().map(|run| run.issues.len()).collect();
        annotate(&mut runs);
        let added: Vec<usize> = runs
            .iter()
            .zip(before)
            .map(|(run, before)| run.issues.len() - before)
            .collect();
        assert_eq!(added, [1, 1, 0, 0]);
        let message = &runs[0].issues.last().unwrap().message;
        assert!(
            message.contains(&runs[1].path) && !message.contains(&runs[2].path),
            "{message}"
        );
    }

    /// Every run named all others before it was cut to three: 46 s for 20,000 of them, so that this would not end.
    #[test]
    fn a_whole_campaign_of_one_condition_is_named() {
        let count = 20_000;
        let mut runs: Vec<RunRecord> = (0..count)
            .map(|index| run(&format!("r{index}"), "S", "air", None, 2.0))
            .collect();
        annotate(&mut runs);
        let message = &runs[count - 1].issues.last().unwrap().message;
        assert!(
            message.contains(&format!("and {} more", count - 1 - NAMED)),
            "{message}"
        );
    }
}
