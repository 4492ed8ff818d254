//! What a verb prints and a page shows.

use ieap_domain::tag::keys;
use ieap_domain::{Campaign, Issue, RunRecord};

use crate::chart::Chart;
use crate::table::Table;

/// A piece of what is shown, in every medium.
#[derive(Debug, Clone, PartialEq)]
pub enum Block {
    /// A sentence or a few; between back quotes stands what is to be typed.
    Say(String),
    /// What is known of a thing: names and texts.
    Facts(Vec<(&'static str, String)>),
    /// A table.
    Table(Table),
    /// A picture; a terminal leaves it out.
    Chart(Chart),
    /// What a reader must know, each with its mend.
    Issues(Vec<Issue>),
    /// Runs by their paths, after a word of what they are; a page leads to them.
    Runs(&'static str, Vec<String>),
    /// Blocks under a title.
    Part(String, Vec<Block>),
}

impl Block {
    /// A sentence.
    pub fn say(sentence: impl Into<String>) -> Block {
        Block::Say(sentence.into())
    }

    /// Blocks under a title.
    pub fn part(title: impl Into<String>, blocks: Vec<Block>) -> Block {
        Block::Part(title.into(), blocks)
    }

    /// What is known of a record: its material, what is its `own`, and where it comes from.
    pub fn facts_of(
        record: &RunRecord,
        campaign: &Campaign,
        own: impl IntoIterator<Item = (&'static str, String)>,
    ) -> Block {
        let sample = record.tag(keys::SAMPLE).and_then(|id| campaign.sample(id));
        let of_tag = |name, key| record.tag(key).map(|text| (name, text.to_owned()));
        let (path, format, revision) = (&record.path, &record.format, record.revision);
        let mut facts = Vec::from_iter(sample.map(|sample| ("material", sample.material.clone())));
        facts.extend(own);
        facts.extend(of_tag("instrument", keys::INSTRUMENT));
        facts.extend(of_tag("started", keys::STARTED_AT));
        facts.push(("file", format!("{path} ({format}, revision {revision})")));
        Block::Facts(facts)
    }

    /// The pictures in it.
    pub fn charts(&self) -> Vec<&Chart> {
        match self {
            Block::Chart(chart) => vec![chart],
            Block::Part(_, blocks) => blocks.iter().flat_map(Block::charts).collect(),
            _ => Vec::new(),
        }
    }

    /// Whether it is all pictures, of which a terminal shows nothing.
    pub fn is_drawn(&self) -> bool {
        match self {
            Block::Chart(_) => true,
            Block::Part(_, blocks) => blocks.iter().all(Block::is_drawn),
            _ => false,
        }
    }

    /// Issues, or nothing where there are none.
    pub fn issues<'i>(issues: impl IntoIterator<Item = &'i Issue>) -> Option<Block> {
        let issues: Vec<Issue> = issues.into_iter().cloned().collect();
        (!issues.is_empty()).then_some(Block::Issues(issues))
    }
}
