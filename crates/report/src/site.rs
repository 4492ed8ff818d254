//! What pages are made from: the input in the order of the site, and the addresses of its pages.

use std::collections::BTreeMap;

use super::input::Input;
use super::lookup::Lookup;
use super::moved::Numbers;
use super::run_pages::{RunPage, run_pages};
use super::slug::slugs;
use super::sparkline::Sparks;
use ieap_analysis::condemned::{Aside, aside};
use ieap_analysis::cycles::CycleRun;
use ieap_analysis::laws::facts::{RunFacts, facts};
use ieap_analysis::model_free::ModelFree;
use ieap_analysis::monitoring::lives::Lives;
use ieap_analysis::zone::Zone;
use ieap_analysis::{Conditions, conditions};
use ieap_domain::number::fixed;
use ieap_domain::tag::keys;
use ieap_domain::{Drive, Fault, GroupDiagnosis, RunRecord};

/// How the time of a run is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Clock {
    /// Since the step, so that seconds and hours have equal room.
    SinceStep,
    /// Evenly, as a voltage that moves all the time asks for.
    Even,
}

/// What pages are made from: the input with the conditions and the names of the run pages.
pub struct Site<'a> {
    /// The input.
    pub input: &'a Input,
    /// Conditions of its runs.
    pub conditions: Conditions,
    /// What is known of the runs that parameters may follow; charges are not among it.
    pub facts: Vec<RunFacts>,
    /// Runs whose readings are known to be wrong, and where they would have stood.
    pub aside: Vec<Aside>,
    /// Pages of the runs.
    pub run_pages: Vec<RunPage>,
    /// What could not be made, for the overview, which is made last.
    pub faults: Vec<Fault>,
    /// Responses of the runs as small pictures, by run: known once the pages of the runs are drawn, as the overview is.
    pub sparks: BTreeMap<usize, Sparks>,
    /// What the report says of the runs, with what it said before.
    pub numbers: Numbers,
    /// Of each run the index of its page.
    pages_of_runs: Vec<usize>,
    slugs: Vec<String>,
    finding_slugs: Vec<String>,
    lookup: Lookup<'a>,
}

impl<'a> Site<'a> {
    /// The clock by which moments are shown.
    pub fn zone(&self) -> Zone {
        Zone::of(&self.input.campaign)
    }

    /// What monitoring says.
    pub fn lives(&self) -> Lives<'_> {
        Lives {
            monitoring: &self.input.monitoring,
            study: &self.input.study,
            facts: &self.facts,
            doubted: &self.input.doubted,
            aside: &self.aside,
            of: self.input.of_tables(),
        }
    }

    /// Sorts the runs of `input` into conditions and names their pages.
    pub fn new(input: &'a Input) -> Site<'a> {
        let run_pages = run_pages(input);
        let mut pages_of_runs = vec![0; input.records().count()];
        for (index, page) in run_pages.iter().enumerate() {
            page.runs.iter().for_each(|&run| pages_of_runs[run] = index);
        }
        let conditions = conditions(&input.runs, &input.campaign);
        let facts = facts(&input.runs, &input.campaign);
        let lookup = Lookup::new(input, &conditions);
        Site {
            input,
            numbers: Numbers::default(),
            run_pages,
            pages_of_runs,
            faults: input.faults.clone(),
            sparks: BTreeMap::new(),
            aside: aside(
                (&input.runs, &input.set_aside),
                &input.campaign,
                &conditions,
                &facts,
            ),
            conditions,
            facts,
            slugs: slugs(input.records().map(|run| run.path.as_str())),
            lookup,
            finding_slugs: slugs(input.findings.groups.iter().map(|found| found.group.as_str())),
        }
    }

    /// Address of a run, relative to the site's root: its page, and its place there where others stand on it.
    pub fn run_href(&self, run: usize) -> String {
        let page = self.page_of_run(run);
        match self.run_pages[page].runs.len() {
            1 => self.run_page_href(page),
            _ => format!("{}#{}", self.run_page_href(page), self.slugs[run]),
        }
    }

    /// Index of a run's page.
    pub fn page_of_run(&self, run: usize) -> usize {
        self.pages_of_runs[run]
    }

    /// Address of a page of runs, relative to the site's root.
    pub fn run_page_href(&self, page: usize) -> String {
        format!("runs/{}.html", self.run_pages[page].slug)
    }

    /// Address of the page that shows a run along its strip, relative to the site's root.
    pub fn strip_href(&self, run: usize) -> String {
        format!("along/{}.html", self.slugs[run])
    }

    /// What stands for a run in addresses: its place on its page, and the name of the page along its strip.
    pub fn run_slug(&self, run: usize) -> &str {
        &self.slugs[run]
    }

    /// Address of a group's page, relative to the site's root.
    pub fn finding_href(&self, group: usize) -> String {
        format!("findings/{}.html", self.finding_slugs[group])
    }

    /// The current run of that path.
    pub fn run_of(&self, path: &str) -> Option<usize> {
        self.lookup.runs.get(path).copied()
    }

    /// How the time of the run of that path is drawn beside a model.
    pub fn clock_of(&self, path: &str) -> Clock {
        let drive = self
            .run_of(path)
            .and_then(|run| self.input.record(run).drive.as_ref());
        if drive.is_some_and(Drive::moves) {
            Clock::Even
        } else {
            Clock::SinceStep
        }
    }

    /// The group that a run was diagnosed in.
    pub fn finding_of_run(&self, run: usize) -> Option<usize> {
        let path = self.input.record(run).path.as_str();
        self.lookup.group_findings.get(path).copied()
    }

    /// What was found of a run alone.
    pub fn finding_alone(&self, run: usize) -> Option<&'a GroupDiagnosis> {
        let path = self.input.record(run).path.as_str();
        let place = self.lookup.run_findings.get(path)?;
        self.input.findings.runs.get(*place)
    }

    /// What a run says without a model.
    pub fn model_free(&self, run: usize) -> Option<&'a ModelFree> {
        let place = self.lookup.model_free.get(&self.input.record(run).id)?;
        self.input.model_free.get(*place)
    }

    /// The cycles of a run.
    pub fn cycles(&self, run: usize) -> Option<&'a CycleRun> {
        let place = self.lookup.cycles.get(&self.input.record(run).id)?;
        self.input.cycles.get(*place)
    }

    /// The condition that a run was measured in, by its place among those that were.
    pub fn condition_of(&self, run: usize) -> Option<usize> {
        self.lookup.conditions.get(&run).copied()
    }

    /// Earlier revisions of a run.
    pub fn superseded(&self, run: usize) -> impl Iterator<Item = &'a RunRecord> {
        let places = self.lookup.superseded.get(self.input.record(run).path.as_str());
        let input = self.input;
        places
            .into_iter()
            .flatten()
            .map(move |&place| &input.superseded[place])
    }

    /// Name of a run as lists show it: its path without the folder that all runs share.
    pub fn run_name(&self, run: usize) -> &str {
        self.input.campaign.run_name(&self.input.record(run).path)
    }

    /// What a page of runs shows: the name of its only run, or what all its runs share, `CNaf-01 in air at 34–36 % RH`.
    pub fn run_page_title(&self, page: usize) -> String {
        let page = &self.run_pages[page];
        if let [only] = page.runs[..] {
            return self.run_name(only).to_owned();
        }
        let runs = || page.runs.iter().map(|&run| self.input.record(run));
        let shared = |key: &str| {
            let first = self.input.record(page.runs[0]).tag(key)?;
            runs().all(|run| run.tag(key) == Some(first)).then_some(first)
        };
        let percents = || runs().filter_map(|run| run.tag_number(keys::RELATIVE_HUMIDITY_PERCENT));
        let humidity = percents().reduce(f64::min).zip(percents().reduce(f64::max));
        let parts = [
            shared(keys::SAMPLE).map(str::to_owned),
            shared(keys::ENVIRONMENT).map(|environment| format!("in {environment}")),
            humidity.map(|(low, high)| match (fixed(low, 0), fixed(high, 0)) {
                (low, high) if low == high => format!("at {low} % RH"),
                (low, high) => format!("at {low}–{high} % RH"),
            }),
        ];
        if parts[0].is_some() {
            parts.into_iter().flatten().collect::<Vec<_>>().join(" ")
        } else {
            page.group.clone()
        }
    }
}
