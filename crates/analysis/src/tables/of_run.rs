//! Sheets whose rows are each of a run.

use crate::conditions::material;
use ieap_domain::tag::keys;
use ieap_domain::{Campaign, RunRecord};
use ieap_show::quantities::{ENVIRONMENT, MATERIAL, RUN, SAMPLE};
use ieap_show::{Sheet, Source, SourceOrigin};

/// The run that a row is of.
#[derive(Clone, Copy)]
pub struct OfRun<'a> {
    campaign: Option<&'a Campaign>,
    id: i64,
    path: &'a str,
    /// The run itself.
    pub record: Option<&'a RunRecord>,
}

impl<'a> OfRun<'a> {
    /// That of these runs which has that row id.
    pub fn new((runs, campaign): (&'a [RunRecord], &'a Campaign), id: i64, path: &'a str) -> OfRun<'a> {
        OfRun {
            campaign: Some(campaign),
            id,
            path,
            record: runs.iter().find(|run| run.id == id),
        }
    }

    /// A run that is at hand.
    pub fn of(campaign: &'a Campaign, run: &'a RunRecord) -> OfRun<'a> {
        OfRun {
            campaign: Some(campaign),
            id: run.id,
            path: &run.path,
            record: Some(run),
        }
    }

    /// A run that no campaign holds.
    pub fn alone(path: &'a str) -> OfRun<'a> {
        OfRun {
            campaign: None,
            id: 0,
            path,
            record: None,
        }
    }

    /// It as the source of a row.
    pub fn sources(&self) -> Vec<Source> {
        vec![Source::of(SourceOrigin::Run(self.id), self.path)]
    }

    /// A tag as words.
    pub fn tag(&self, key: &str) -> Option<&'a str> {
        self.record.and_then(|run| run.tag(key))
    }

    /// A tag as a number.
    pub fn number(&self, key: &str) -> Option<f64> {
        self.record.and_then(|run| run.tag_number(key))
    }
}

/// Of a run, and what else a row is made from.
pub type Own<'a, X> = (OfRun<'a>, X);

/// A sheet whose first column names the run.
pub fn of_runs<'s, 'a: 's, X: 's>(
    name: &'static str,
    title: &'static str,
    stub: usize,
) -> Sheet<'s, Own<'a, X>> {
    Sheet::new(name, title, stub)
        .made_from(|(run, _): &Own<X>| run.sources())
        .column(RUN, |(run, _)| run.path)
}

/// The same with sample, material and environment.
pub fn of_runs_and_what<'s, 'a: 's, X: 's>(name: &'static str, title: &'static str) -> Sheet<'s, Own<'a, X>> {
    let material_of = |run: &OfRun<'a>| material(run.record?, run.campaign?);
    of_runs(name, title, 1)
        .column(SAMPLE, |(run, _)| run.tag(keys::SAMPLE))
        .column(MATERIAL, move |(run, _)| material_of(run))
        .column(ENVIRONMENT, |(run, _)| run.tag(keys::ENVIRONMENT))
}
