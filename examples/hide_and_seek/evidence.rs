//! What the masses of the hypotheses would say of groups, counted beside what is said.

use std::collections::BTreeMap;
use std::fmt;

use ieap::diagnose::{by_evidence, set_of};
use ieap::domain::{GroupDiagnosis, Verdict};

/// Counts of groups that were seen.
#[derive(Default)]
pub struct Tally {
    seen: usize,
    in_set: usize,
    alone: usize,
    wrong_name: usize,
    members: usize,
    verdicts: BTreeMap<&'static str, usize>,
}

impl Tally {
    /// Adds what is found of a group in which `truth` is hidden; nothing that the library holds where there is none.
    pub fn add(&mut self, found: &GroupDiagnosis, truth: Option<&str>) {
        if found.posterior.is_empty() {
            return;
        }
        let (verdict, set) = (by_evidence(&found.posterior), set_of(&found.posterior));
        let names = matches!(
            verdict,
            Verdict::Named | Verdict::Set | Verdict::Partial | Verdict::Resembles
        );
        let holds = names && truth.is_some_and(|id| set.iter().any(|own| own == id));
        self.seen += 1;
        self.in_set += usize::from(holds);
        self.alone += usize::from(holds && set.len() == 1);
        self.wrong_name += usize::from(matches!(verdict, Verdict::Named | Verdict::Partial) && !holds);
        self.members += if names { set.len() } else { 0 };
        *self.verdicts.entry(verdict.key()).or_default() += 1;
    }

    /// Adds another count.
    pub fn add_all(&mut self, other: &Tally) {
        self.seen += other.seen;
        self.in_set += other.in_set;
        self.alone += other.alone;
        self.wrong_name += other.wrong_name;
        self.members += other.members;
        for (verdict, count) in &other.verdicts {
            *self.verdicts.entry(verdict).or_default() += count;
        }
    }
}

impl fmt::Display for Tally {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "by evidence: of {} in the set {}, alone {}, one wrong name {}, members {}, {:?}",
            self.seen, self.in_set, self.alone, self.wrong_name, self.members, self.verdicts
        )
    }
}
