//! Verdicts and names of many groups, as rows of a Markdown table.

use std::collections::BTreeMap;

use ieap_domain::{GroupDiagnosis, Verdict};
use ieap_model::effects::mechanism_of;

use crate::benchmark::percent;

/// What is said, for a line of a log.
pub fn in_short(found: &GroupDiagnosis) -> String {
    let node = found.node.as_ref();
    let node = node.map_or_else(String::new, |node| {
        format!("{} {:.2}", node.path.join("/"), node.probability)
    });
    format!("{} {:?} {node}", found.verdict.key(), found.set)
}

/// Groups of a row.
#[derive(Debug, Clone, Default)]
pub struct Count {
    pub groups: usize,
    /// Groups with p below 0.05.
    seen: usize,
    /// Groups with the truth among the causes given.
    within: usize,
    /// Groups whose node the truth lies under, by the node's depth: a list without a node, a place, a mechanism, an effect.
    right: [usize; 4],
    /// Groups whose node it does not lie under, likewise; several names of which one is wrong count as a wrong effect.
    wrong: [usize; 4],
    verdicts: BTreeMap<&'static str, usize>,
    /// Wrong names.
    called: BTreeMap<String, usize>,
}

/// The way to an effect from the root of the tree of causes.
fn path_of(id: &str) -> Vec<String> {
    mechanism_of(id).map_or_else(Vec::new, |own| {
        vec![own.site.name().to_owned(), own.id.to_owned(), id.to_owned()]
    })
}

impl Count {
    /// Adds a group in which `truth` is hidden, or nothing that has a name.
    pub fn add(&mut self, found: &GroupDiagnosis, truth: Option<&str>) {
        self.groups += 1;
        self.seen += usize::from(found.p_misfit.is_some_and(|p| p < 0.05));
        *self.verdicts.entry(found.verdict.key()).or_default() += 1;
        if found.set.is_empty() {
            return;
        }
        let within = found.set.iter().any(|id| Some(id.as_str()) == truth);
        self.within += usize::from(within);
        let named = found.verdict == Verdict::Named;
        let (depth, is_right) = match (&found.node, named) {
            (_, true) => (3, found.set.iter().all(|id| Some(id.as_str()) == truth)),
            (None, false) => (0, within),
            (Some(node), false) => (node.depth, path_of(truth.unwrap_or("")).starts_with(&node.path)),
        };
        if is_right {
            self.right[depth] += 1
        } else {
            self.wrong[depth] += 1
        }
        if named && !is_right {
            *self.called.entry(found.set.join(" + ")).or_default() += 1;
        }
    }

    /// Heading of a table whose first column is `first`, with further columns at its end.
    pub fn heading_with(first: &str, further: &[&str]) -> String {
        let verdicts = Verdict::ALL.map(Verdict::key);
        let rule = "---|".repeat(12 + verdicts.len() + further.len());
        let further: String = further.iter().map(|name| format!(" {name} |")).collect();
        format!(
            "| {first} | groups | seen, % | truth in the causes given, % | right: effect, % | mechanism, % | place, % | list, % | wrong: effect, % | mechanism, % | place, % | list, % | {}, % |{further}\n|{rule}",
            verdicts.join(", % | ")
        )
    }

    /// A row of it.
    pub fn row(&self, first: &str) -> String {
        let of_verdict = |verdict: Verdict| self.verdicts.get(verdict.key()).copied().unwrap_or(0);
        let numbers = [self.seen, self.within];
        let nodes = self.right.iter().rev().chain(self.wrong.iter().rev()).copied();
        let cells: Vec<String> = numbers
            .into_iter()
            .chain(nodes)
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
            self.right[3],
            verdict(Verdict::Unknown),
            self.called()
        )
    }

    /// Heading of such rows.
    pub fn short_heading(first: &str) -> String {
        format!(
            "| {first} | groups | seen | truth given | named rightly | unknown | named wrongly |\n|{}",
            "---|".repeat(7)
        )
    }
}
