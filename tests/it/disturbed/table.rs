//! The table of what came of all trials.

use std::collections::BTreeMap;
use std::fmt;

use super::judge::Verdict;
use super::verbs::Verb;

/// Trials of each row and verb, counted by what came of them.
#[derive(Debug, Default)]
pub struct Table {
    counts: BTreeMap<(&'static str, Verb), [usize; 5]>,
    order: Vec<&'static str>,
}

impl Table {
    pub fn add(&mut self, row: &'static str, verb: Verb, verdict: Verdict) {
        if !self.order.contains(&row) {
            self.order.push(row);
        }
        self.counts.entry((row, verb)).or_default()[verdict as usize] += 1;
    }
}

impl fmt::Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "| disturbance | verb | placed | no effect | refused or said | SILENT LOSS | SILENT CHANGE | NOT AS REBUILT |"
        )?;
        writeln!(f, "|---|---|---|---|---|---|---|---|")?;
        let mut sum = [0; 5];
        for row in &self.order {
            for ((_, verb), counts) in self.counts.iter().filter(|((name, _), _)| name == row) {
                line(f, row, verb.name(), counts)?;
                sum.iter_mut().zip(counts).for_each(|(sum, count)| *sum += count);
            }
        }
        line(f, "all", "", &sum)
    }
}

fn line(f: &mut fmt::Formatter<'_>, row: &str, verb: &str, counts: &[usize; 5]) -> fmt::Result {
    let cells = counts.map(|count| count.to_string()).join(" | ");
    writeln!(
        f,
        "| {row} | {verb} | {} | {cells} |",
        counts.iter().sum::<usize>()
    )
}
