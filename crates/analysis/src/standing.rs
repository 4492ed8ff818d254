//! Which runs take part in results: decided here for every run, and nowhere else.
//!
//! A person's word goes before everything. Then, of runs that hold the same readings one speaks for all; runs of which what is
//! stated contradicts itself wait for an answer; then readings that are known to be wrong leave. Each step sees only the runs
//! that still speak, so that a run that is out says nothing against another.

use std::collections::BTreeMap;

use super::misread::misread;
use super::sequence;
use super::witnesses;
use ieap_domain::{Campaign, RunRecord, RunWord, SameReadings, Standing};

/// What is decided by, beside the runs.
#[derive(Debug, Clone, Copy)]
pub struct Grounds<'a> {
    /// The campaign.
    pub campaign: &'a Campaign,
    /// The newest word on each run, by its name.
    pub words: &'a BTreeMap<String, RunWord>,
    /// Runs whose readings stand in another one.
    pub same: &'a [SameReadings],
    /// Runs that the current diagnosis of their group condemns: row id and reason. None for what a diagnosis is to judge
    /// itself: then neither these nor broken series count.
    pub diagnosed: Option<&'a BTreeMap<i64, String>>,
}

/// How to mend what is condemned.
const MEND_UNIT: &str = "correct the unit in the file or in its profile";

/// Gives every run its standing.
pub fn decide(runs: &mut [RunRecord], grounds: &Grounds) {
    for run in runs.iter_mut() {
        run.standing = match grounds.words.get(&run.path) {
            Some(word) if word.drops => Standing::Dropped(word.clone()),
            // Of readings that came later nobody said that they are right.
            Some(word) if word.why.is_some() && word.data_hash == run.data_hash => {
                Standing::Vouched(word.clone())
            }
            _ => Standing::Speaks,
        };
    }
    set_aside_copies(runs, grounds.same);
    set_aside_contradicted(runs, grounds.campaign);
    if grounds.diagnosed.is_some() {
        condemn_broken_series(runs);
    }
    condemn_misread(runs, grounds.campaign);
    if let Some(condemned) = grounds.diagnosed {
        let found = |run: &RunRecord| Some((condemned.get(&run.id)?.clone(), MEND_UNIT.to_owned()));
        let found: Vec<_> = runs.iter().map(found).collect();
        condemn(runs, found);
    }
}

/// Condemns those of the runs that nobody said anything of.
fn condemn(runs: &mut [RunRecord], found: Vec<Option<(String, String)>>) {
    let open = runs.iter_mut().zip(found);
    for (run, found) in open.filter(|(run, _)| run.standing == Standing::Speaks) {
        if let Some((reason, mend)) = found {
            run.standing = Standing::Condemned { reason, mend };
        }
    }
}

/// Of runs that hold the same readings the one that holds most speaks; of equal ones the first by name. Its standing is not
/// asked: what is wrong with readings is wrong with their copies.
fn set_aside_copies(runs: &mut [RunRecord], same: &[SameReadings]) {
    let place: BTreeMap<i64, usize> = runs.iter().enumerate().map(|(at, run)| (run.id, at)).collect();
    let mut found: BTreeMap<usize, (usize, bool)> = BTreeMap::new();
    for pair in same {
        let (Some(&one), Some(&other)) = (place.get(&pair.run_id), place.get(&pair.in_run_id)) else {
            continue;
        };
        // Two runs that hold nothing more than each other: the first by name counts, and runs come by name.
        let is_copy = !pair.whole || other < one;
        let known = found.get(&one);
        if is_copy && known.is_none_or(|&(known, whole)| (whole, known) > (pair.whole, other)) {
            found.insert(one, (other, pair.whole));
        }
    }
    for (copy, (of, whole)) in found {
        if runs[copy].standing == Standing::Speaks {
            let of = runs[of].path.clone();
            runs[copy].standing = Standing::Copy { of, whole };
        }
    }
}

/// Runs of which statements contradict each other in what results hang on.
fn set_aside_contradicted(runs: &mut [RunRecord], campaign: &Campaign) {
    let found = witnesses::contradicted(&runs.iter().collect::<Vec<_>>(), campaign);
    for (at, (reason, mend)) in found {
        runs[at].standing = Standing::Contradicted { reason, mend };
    }
}

/// Runs that carry on the numbers of a series but not its dates: what they were measured on is in doubt.
fn condemn_broken_series(runs: &mut [RunRecord]) {
    let speaking: Vec<usize> = (0..runs.len()).filter(|&at| runs[at].standing.speaks()).collect();
    let of: Vec<&RunRecord> = speaking.iter().map(|&at| &runs[at]).collect();
    let mut found = vec![None; runs.len()];
    for broken in sequence::breaks(&of) {
        let issue = broken.issue(&of);
        for &at in &broken.runs {
            found[speaking[at]] = Some((issue.message.clone(), issue.mend.clone()));
        }
    }
    condemn(runs, found);
}

/// Runs that were read in another unit than the others.
fn condemn_misread(runs: &mut [RunRecord], campaign: &Campaign) {
    let speaking: Vec<usize> = (0..runs.len()).filter(|&at| runs[at].standing.speaks()).collect();
    let of: Vec<&RunRecord> = speaking.iter().map(|&at| &runs[at]).collect();
    let mut found = vec![None; runs.len()];
    for verdict in misread(&of, campaign) {
        found[speaking[verdict.run]] = Some((verdict.reason, verdict.mend));
    }
    condemn(runs, found);
}

#[cfg(test)]
mod tests {
    use super::*;
    use ieap_domain::testing::{campaign, run};

    fn runs() -> Vec<RunRecord> {
        let named = ["a", "b", "c", "d"].map(|name| run(name, "CNaf-01", "air", None, 2.0));
        let numbered = named.into_iter().enumerate();
        numbered
            .map(|(at, run)| RunRecord { id: at as i64, ..run })
            .collect()
    }

    fn word(run: &RunRecord, drops: bool, why: Option<&str>) -> (String, RunWord) {
        let word = RunWord {
            run_path: run.path.clone(),
            drops,
            why: why.map(str::to_owned),
            said_by: "a person".to_owned(),
            said_at: "2026-11-20T06:00:00Z".to_owned(),
            data_hash: run.data_hash.clone(),
        };
        (run.path.clone(), word)
    }

    fn keys(
        words: &BTreeMap<String, RunWord>,
        same: &[SameReadings],
        condemned: &[i64],
    ) -> Vec<&'static str> {
        let mut runs = runs();
        let condemned = condemned
            .iter()
            .map(|&id| (id, "a wrong unit".to_owned()))
            .collect();
        let grounds = Grounds {
            campaign: &campaign(),
            words,
            same,
            diagnosed: Some(&condemned),
        };
        decide(&mut runs, &grounds);
        runs.iter().map(|run| run.standing.key()).collect()
    }

    #[test]
    fn a_person_s_word_goes_before_everything() {
        let runs = runs();
        let words = [
            word(&runs[0], true, Some("clip slipped")),
            word(&runs[1], false, Some("looked")),
            word(&runs[2], false, None),
        ];
        let found = keys(&words.into(), &[], &[0, 1, 2]);
        assert_eq!(found, ["dropped", "vouched", "condemned", "speaks"]);
        let mut of_other_readings = word(&runs[1], false, Some("looked"));
        of_other_readings.1.data_hash = "earlier".to_owned();
        assert_eq!(keys(&[of_other_readings].into(), &[], &[1])[1], "condemned");
    }

    #[test]
    fn one_of_several_with_the_same_readings_speaks_and_a_part_never() {
        let pair = |run_id, in_run_id, whole| SameReadings {
            run_id,
            in_run_id,
            whole,
        };
        let same = [
            pair(0, 1, true),
            pair(1, 0, true),
            pair(2, 1, false),
            pair(2, 0, false),
        ];
        let none = BTreeMap::new();
        assert_eq!(keys(&none, &same, &[]), ["speaks", "copy", "copy", "speaks"]);
        // Whoever drops readings does not mean their copy to take their place.
        let dropped = [word(&runs()[0], true, Some("clip slipped"))].into();
        assert_eq!(keys(&dropped, &same, &[]), ["dropped", "copy", "copy", "speaks"]);
        let own = [word(&runs()[1], false, Some("measured twice"))].into();
        assert_eq!(keys(&own, &same, &[]), ["speaks", "vouched", "copy", "speaks"]);
    }
}
