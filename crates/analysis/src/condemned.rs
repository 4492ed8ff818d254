//! Which runs are condemned, and where they would have stood.

use crate::conditions::Conditions;
use crate::laws::facts::{RunFacts, facts_beside};
use ieap_domain::{Campaign, Issue, RunRecord, Standing};
use ieap_show::Block;

/// A run that is condemned, and where it would have stood.
#[derive(Debug, Clone, PartialEq)]
pub struct Aside {
    /// Its number among all that have a page.
    pub run: usize,
    /// What is known of it; none without a sample.
    pub facts: Option<RunFacts>,
    /// Material, surroundings and voltage; none where no other run has them.
    pub condition: Option<(usize, usize, usize)>,
}

/// The condemned ones among the runs that are `set_aside`, beside the `runs` of these conditions and facts.
pub fn aside(
    (runs, set_aside): (&[RunRecord], &[RunRecord]),
    campaign: &Campaign,
    conditions: &Conditions,
    facts: &[RunFacts],
) -> Vec<Aside> {
    let is_condemned = |run: &RunRecord| matches!(run.standing, Standing::Condemned { .. });
    let condemned = set_aside.iter().enumerate();
    let condemned = condemned.filter(|(_, run)| is_condemned(run));
    let aside = condemned.map(|(place, run)| Aside {
        run: runs.len() + place,
        facts: facts_beside(run, runs, facts, campaign),
        condition: conditions.place_of(run, campaign),
    });
    aside.collect()
}

/// What a page tells of these runs, whose pictures are among its `blocks`; none where there are none.
pub fn issues(
    (runs, set_aside): (&[RunRecord], &[RunRecord]),
    aside: &[Aside],
    blocks: &[Block],
) -> Option<Block> {
    let charts = blocks.iter().flat_map(Block::charts);
    let layers = charts.flat_map(|chart| chart.panels.iter().flat_map(|panel| &panel.layers));
    let drawn: Vec<&String> = (layers.filter(|layer| layer.is_aside))
        .flat_map(|layer| &layer.runs)
        .collect();
    let issue = |aside: &Aside| {
        let run = &set_aside[aside.run - runs.len()];
        let not_drawn = if drawn.contains(&&run.path) {
            ""
        } else {
            " (not drawn here: its fit gives no value, or nothing else stands where it would)"
        };
        let reason = run.standing.reason();
        let message =
            format!("set aside for wrong readings, in no number, law or alarm: {reason}{not_drawn}");
        Issue::note("set-aside", message).at(&run.path)
    };
    let issues: Vec<Issue> = aside.iter().map(issue).collect();
    Block::issues(&issues)
}
