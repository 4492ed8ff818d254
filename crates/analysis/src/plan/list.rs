//! One list of the runs to make next: proposals merged, ranked, numbered and named.

use serde::Serialize;

use std::collections::{BTreeMap, BTreeSet};

use super::proposed::{Proposal, of_group};
use super::untie::untying;
use crate::laws::covariate::Covariate;
use crate::laws::facts::facts;
use crate::study::Study;
use ieap_domain::number::digits;
use ieap_domain::{Campaign, GroupDiagnosis, RunRecord};

/// A run that is planned, with the name that its file is to have.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct PlannedRun {
    /// Place in the list, from 1.
    pub rank: usize,
    /// Planned id, `P01`.
    pub planned: String,
    /// Name to save the file under, without its ending.
    pub file: String,
    /// Cycle number, where the sample's runs have one.
    pub cycle: Option<u32>,
    /// What is to be measured, and why.
    #[serde(flatten)]
    pub run: Proposal,
    /// Run sheet that it stands on already, relative to the campaign.
    pub on_sheet: Option<String>,
}

/// A row of a run sheet: what identifies the planned run, and its name there.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct RowOfSheet {
    /// Planned id.
    pub planned: String,
    /// Name to save the file under, without its ending.
    pub file: String,
    /// Path of the sheet.
    pub sheet: String,
    /// Sample id.
    pub sample: Option<String>,
    /// Environment id.
    pub environment: Option<String>,
    /// Relative humidity, percent.
    pub relative_humidity_percent: Option<f64>,
    /// Nominal voltage, V.
    pub voltage_v: Option<f64>,
    /// Cycle number.
    pub cycle: Option<u32>,
    /// The drive in words.
    pub drive: String,
}

/// What was found, that runs are planned from.
#[derive(Debug, Clone, Copy)]
pub struct Grounds<'a> {
    /// Current runs.
    pub runs: &'a [RunRecord],
    /// The campaign.
    pub campaign: &'a Campaign,
    /// What the study says.
    pub study: &'a Study,
    /// Findings of groups.
    pub groups: &'a [GroupDiagnosis],
    /// Rows of run sheets that are not done yet.
    pub open: &'a [RowOfSheet],
    /// Number of the last planned id that any sheet has used.
    pub last_number: u32,
}

/// The runs to make next, those first that close the largest part of what is open. A run that stands on a sheet already keeps its name.
pub fn next_runs(grounds: &Grounds) -> Vec<PlannedRun> {
    let mut proposals = untying(grounds.study, grounds.runs, grounds.campaign);
    let of_groups = grounds
        .groups
        .iter()
        .filter_map(|group| of_group(group, grounds.runs, grounds.campaign));
    for proposal in of_groups {
        merge(&mut proposals, proposal);
    }
    proposals.sort_by(|a, b| b.closes.total_cmp(&a.closes));
    named(proposals, grounds)
}

/// Adds a run; one that is to be made anyway gains a reason instead.
fn merge(all: &mut Vec<Proposal>, proposal: Proposal) {
    let Some(known) = all.iter_mut().find(|known| is_same(known, &proposal)) else {
        all.push(proposal);
        return;
    };
    known.closes = known.closes.max(proposal.closes);
    known.why.extend(proposal.why);
    for split in proposal.splits {
        if !known.splits.contains(&split) {
            known.splits.push(split);
        }
    }
    if known.set_size.is_none() {
        (known.set_size, known.expected_set_size) = (proposal.set_size, proposal.expected_set_size);
    }
}

fn is_same(a: &Proposal, b: &Proposal) -> bool {
    (&a.sample, &a.environment, &a.drive) == (&b.sample, &b.environment, &b.drive)
        && near(a.relative_humidity_percent, b.relative_humidity_percent, 4.0)
        && near(a.voltage_v, b.voltage_v, 0.01)
        && near(a.rest_before_s, b.rest_before_s, 1.0)
}

fn near(a: Option<f64>, b: Option<f64>, within: f64) -> bool {
    match (a, b) {
        (Some(a), Some(b)) => (a - b).abs() <= within,
        (a, b) => a.is_none() && b.is_none(),
    }
}

fn named(proposals: Vec<Proposal>, grounds: &Grounds) -> Vec<PlannedRun> {
    let mut open: Vec<&RowOfSheet> = grounds.open.iter().collect();
    let mut cycles = Cycles::of(grounds);
    let mut number = grounds.last_number;
    let mut list = Vec::new();
    for run in proposals {
        let known = open.iter().position(|row| {
            row.sample.as_deref() == Some(run.sample.as_str())
                && row.environment == run.environment
                && row.drive == run.drive
                && near(row.relative_humidity_percent, run.relative_humidity_percent, 4.0)
                && near(row.voltage_v, run.voltage_v, 0.01)
        });
        let (planned, file, cycle, on_sheet) = match known.map(|at| open.remove(at)) {
            Some(row) => (
                row.planned.clone(),
                row.file.clone(),
                row.cycle,
                Some(row.sheet.clone()),
            ),
            None => {
                number += 1;
                let id = format!("P{number:02}");
                let file = stem(&id, &run);
                (id, file, cycles.next(&run.sample), None)
            }
        };
        list.push(PlannedRun {
            rank: list.len() + 1,
            planned,
            file,
            cycle,
            run,
            on_sheet,
        });
    }
    list
}

/// `P03-CNaf-01-vacuum-rh34-1200mV`: letters, digits and `-`, so that every file system and every bench program keeps
/// it, and no dot is taken for an ending.
fn stem(id: &str, run: &Proposal) -> String {
    let plain = |text: &str| -> String {
        let sign = |c: char| if c.is_ascii_alphanumeric() { c } else { '-' };
        text.chars().map(sign).collect()
    };
    let mut parts = vec![id.to_owned(), plain(&run.sample)];
    parts.extend(run.environment.as_deref().map(plain));
    parts.extend(
        run.relative_humidity_percent
            .map(|rh| format!("rh{}", digits(rh, 0))),
    );
    parts.extend(run.voltage_v.map(|volts| {
        let sign = if volts < 0.0 { "minus" } else { "" };
        format!("{sign}{}mV", digits(1000.0 * volts.abs(), 0))
    }));
    parts.join("-")
}

/// The next cycle of each sample.
struct Cycles {
    last: BTreeMap<String, u32>,
    are_counted: bool,
}

impl Cycles {
    fn of(grounds: &Grounds) -> Cycles {
        let mut last: BTreeMap<String, u32> = BTreeMap::new();
        let mut uncounted = BTreeSet::new();
        let facts = facts(grounds.runs, grounds.campaign);
        for fact in &facts {
            match fact.numbers.get(&Covariate::Cycle) {
                Some(known) if (0.0..1e9).contains(&known.value) => {
                    let cycle = last.entry(fact.sample.clone()).or_insert(0);
                    *cycle = (*cycle).max(known.value as u32);
                }
                _ => {
                    uncounted.insert(fact.sample.clone());
                }
            }
        }
        for row in grounds.open {
            if let (Some(sample), Some(cycle)) = (&row.sample, row.cycle) {
                let known = last.entry(sample.clone()).or_insert(0);
                *known = (*known).max(cycle);
            }
        }
        Cycles {
            are_counted: !last.is_empty() && uncounted.is_empty(),
            last,
        }
    }

    fn next(&mut self, sample: &str) -> Option<u32> {
        if !self.are_counted {
            return None;
        }
        let last = self.last.entry(sample.to_owned()).or_insert(0);
        *last += 1;
        Some(*last)
    }
}

impl PlannedRun {
    /// `CNaf-1, air, 33 % RH`: what is to be measured and where.
    pub fn place(&self) -> String {
        let run = &self.run;
        let mut place = vec![run.sample.clone()];
        place.extend(run.environment.clone());
        place.extend(
            run.relative_humidity_percent
                .map(|rh| format!("{} % RH", digits(rh, 0))),
        );
        place.extend(run.temperature_c.map(|celsius| format!("{celsius} °C")));
        place.extend(run.rest_before_s.map(|rest| format!("{rest} s of rest before")));
        place.join(", ")
    }
}
