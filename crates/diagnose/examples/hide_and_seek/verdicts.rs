//! Verdicts and names of many groups, as rows of a Markdown table.

use std::collections::BTreeMap;

use ieap_diagnose::{by_evidence, set_of};
use ieap_domain::{GroupDiagnosis, Verdict};

use crate::benchmark::percent;

/// What the rules and the probabilities say, for a line of a log.
pub fn both(found: &GroupDiagnosis) -> String {
    format!(
        "by rules {} {:?}, by probability {} {:?}",
        found.verdict.key(),
        found.set,
        by_evidence(&found.posterior).key(),
        set_of(&found.posterior)
    )
}

/// Groups of a row.
#[derive(Debug, Clone, Default)]
pub struct Count {
    pub groups: usize,
    /// Groups with p below 0.05.
    seen: usize,
    /// Groups with the truth among the causes given.
    within: usize,
    /// The truth alone, and one wrong name: outright `named`, and under any other verdict but `unknown`.
    alone: [usize; 2],
    wrong: [usize; 2],
    verdicts: BTreeMap<&'static str, usize>,
    /// Wrong names.
    called: BTreeMap<String, usize>,
}

impl Count {
    /// Adds a group in which `truth` is hidden, or nothing that has a name.
    pub fn add(&mut self, found: &GroupDiagnosis, truth: Option<&str>) {
        self.add_said(found, (found.verdict, &found.set), truth);
    }

    /// The same, judged by the probabilities of what may be behind the misfit where it is claimed.
    pub fn add_by_evidence(&mut self, found: &GroupDiagnosis, truth: Option<&str>) {
        if found.posterior.is_empty() {
            return self.add(found, truth);
        }
        let set = set_of(&found.posterior);
        self.add_said(found, (by_evidence(&found.posterior), &set), truth);
    }

    fn add_said(
        &mut self,
        found: &GroupDiagnosis,
        (verdict, set): (Verdict, &[String]),
        truth: Option<&str>,
    ) {
        self.groups += 1;
        self.seen += usize::from(found.p_misfit.is_some_and(|p| p < 0.05));
        *self.verdicts.entry(verdict.key()).or_default() += 1;
        if verdict == Verdict::Unknown {
            return;
        }
        let is_truth = |id: &String| Some(id.as_str()) == truth;
        self.within += usize::from(set.iter().any(is_truth));
        if let [one] = set {
            let how = usize::from(verdict != Verdict::Named);
            if is_truth(one) {
                self.alone[how] += 1;
            } else {
                self.wrong[how] += 1;
                *self.called.entry(one.clone()).or_default() += 1;
            }
        }
    }

    /// Heading of a table whose first column is `first`, with further columns at its end.
    pub fn heading_with(first: &str, further: &[&str]) -> String {
        let verdicts = Verdict::ALL.map(Verdict::key);
        let rule = "---|".repeat(8 + verdicts.len() + further.len());
        let further: String = further.iter().map(|name| format!(" {name} |")).collect();
        format!(
            "| {first} | groups | seen, % | truth in the causes given, % | right and alone: `named`, % | by another verdict, % | one wrong name: `named`, % | by another verdict, % | {}, % |{further}\n|{rule}",
            verdicts.join(", % | ")
        )
    }

    /// A row of it.
    pub fn row(&self, first: &str) -> String {
        let of_verdict = |verdict: Verdict| self.verdicts.get(verdict.key()).copied().unwrap_or(0);
        let numbers = [
            self.seen,
            self.within,
            self.alone[0],
            self.alone[1],
            self.wrong[0],
            self.wrong[1],
        ];
        let cells: Vec<String> = numbers
            .into_iter()
            .chain(Verdict::ALL.map(of_verdict))
            .map(|part| percent(part, self.groups))
            .collect();
        format!("| {first} | {} | {} |", self.groups, cells.join(" | "))
    }

    /// Wrong names and how often each.
    pub fn called(&self) -> String {
        let each = self.called.iter().map(|(id, count)| format!("{id} {count}"));
        each.collect::<Vec<_>>().join(", ")
    }

    /// A short row in counts, with the wrong names.
    pub fn short_row(&self, first: &str) -> String {
        let verdict = |verdict: Verdict| self.verdicts.get(verdict.key()).copied().unwrap_or(0);
        format!(
            "| {first} | {} | {} | {} | {} | {} | {} |",
            self.groups,
            self.seen,
            self.within,
            self.alone[0] + self.alone[1],
            verdict(Verdict::Unknown),
            self.called()
        )
    }

    /// Heading of such rows.
    pub fn short_heading(first: &str) -> String {
        format!(
            "| {first} | groups | seen | truth given | alone | unknown | one wrong name |\n|{}",
            "---|".repeat(7)
        )
    }
}
