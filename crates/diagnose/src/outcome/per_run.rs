//! The runs of a group by themselves, where no cause is found for them together: one parameter set may be too few.

use ieap_domain::{RunAlone, Verdict};

/// Part of the runs that must be described alone before it is said that they differ in their parameters.
const NEARLY_ALL: f64 = 0.75;
/// Causes that are mentioned at most.
const MENTIONED: usize = 4;

/// What the runs have in common by themselves.
pub(crate) fn in_words(per_run: &[RunAlone]) -> Option<String> {
    let count = per_run.len();
    let right = per_run
        .iter()
        .filter(|run| run.verdict == Verdict::Consistent)
        .count();
    if right as f64 >= NEARLY_ALL * count as f64 {
        return Some(format!(
            "by itself each of {right} of {count} runs is described to within the noise: the runs differ in their \
             parameters, and one set does not describe them"
        ));
    }
    let mut causes: Vec<(&str, usize)> = Vec::new();
    for id in per_run.iter().flat_map(|run| &run.set) {
        match causes.iter_mut().find(|(known, _)| known == id) {
            Some((_, times)) => *times += 1,
            None => causes.push((id, 1)),
        }
    }
    causes.sort_by(|a, b| b.1.cmp(&a.1).then(a.0.cmp(b.0)));
    let most = causes.first()?.1;
    let leading = causes.iter().take_while(|(_, times)| *times == most);
    let ids: Vec<&str> = leading.take(MENTIONED).map(|(id, _)| *id).collect();
    Some(format!(
        "by themselves, {right} of {count} runs are described to within the noise, and {} may be the cause in {most}: what \
         one run alone allows to be said, not proved on others",
        ids.join(", ")
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(verdict: Verdict, set: &[&str]) -> RunAlone {
        RunAlone {
            run: "run".to_owned(),
            verdict,
            gains_clearly: true,
            p_misfit: None,
            set: set.iter().map(|id| (*id).to_owned()).collect(),
        }
    }

    #[test]
    fn runs_that_are_right_alone_differ_in_their_parameters() {
        let right = || run(Verdict::Consistent, &[]);
        let said = in_words(&[right(), right(), right(), run(Verdict::Undecided, &[])]).unwrap();
        assert!(
            said.contains("each of 3 of 4 runs") && said.contains("parameters"),
            "{said}"
        );
    }

    #[test]
    fn causes_that_most_runs_allow_are_mentioned() {
        let found = [
            run(Verdict::Unknown, &[]),
            run(Verdict::Set, &["warburg", "slow-branch"]),
            run(Verdict::Partial, &["creep", "warburg"]),
        ];
        let said = in_words(&found).unwrap();
        assert!(
            said.contains("0 of 3 runs") && said.contains("and warburg may be the cause in 2"),
            "{said}"
        );
        assert_eq!(
            in_words(&[run(Verdict::Unknown, &[]), run(Verdict::Unknown, &[])]),
            None
        );
    }
}
