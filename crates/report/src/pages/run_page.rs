//! The page of the runs of one group: what they differ by and what was fitted side by side, then run by run, then what
//! holds for all of them. A run without a group has such a page for itself.

use std::collections::BTreeMap;

use serde::Serialize;

use super::Content;
use super::run::{DrawnRun, RunSection, note_fact, section};
use super::run_condition::own_condition;
use super::run_evidence::{ChannelText, Fact, channels};
use super::run_fit::r_squared;
use super::run_overlay::{Overlay, overlay};
use super::run_tables::{ParametersTable, RunsTable, parameters_table, runs_table};
use super::run_tags::{TagGroup, TagText, grouped, tags, take_common};
use super::wording::{IssueText, RunLink, counted};
use crate::error::ReportError;
use crate::fault::{guarded, reason_of};
use crate::site::Site;
use ieap_analysis::conditions::material;
use ieap_domain::{Fault, Severity};

/// Links to other samples in the same condition: of more, the first stand there.
const BESIDE: usize = 12;
/// A run with more channels than this names each with its range, and not among what all runs share.
const FEW_CHANNELS: usize = 6;

#[derive(Debug, Serialize)]
struct Page {
    title: String,
    lead: String,
    /// Whether it has several runs.
    several: bool,
    /// Level of the headings within a run.
    level: usize,
    before: Option<RunLink>,
    next: Option<RunLink>,
    /// The diagnosis of all of them together.
    diagnosis: Option<RunLink>,
    table: Option<RunsTable>,
    parameters: Option<ParametersTable>,
    /// All runs on one axis.
    overlay: Option<Overlay>,
    drawn: String,
    runs: Vec<RunSection>,
    facts: Vec<Fact>,
    tags: Vec<TagGroup>,
    beside: Vec<RunLink>,
}

/// Makes page number `page` of the runs' pages; `drawn` are its runs in its order.
///
/// # Errors
/// [`ReportError`]: a fault of the program.
pub fn content(site: &Site, page: usize, drawn: &[DrawnRun]) -> Result<Content, ReportError> {
    let mut figures = BTreeMap::new();
    let mut faults = Vec::new();
    let mut one = |(place, drawn): (usize, &DrawnRun)| {
        let made = guarded(|| section(site, place, drawn, &mut figures));
        made.or_else(|error| {
            let fault = Fault {
                place: site.run_href(drawn.run),
                runs: vec![site.input.record(drawn.run).path.clone()],
                reason: reason_of(error)?,
            };
            let box_of_it = RunSection::failed(site, drawn.run, &fault.reason);
            faults.push(fault);
            Ok(box_of_it)
        })
    };
    let sections: Result<Vec<RunSection>, ReportError> = drawn.iter().enumerate().map(&mut one).collect();
    let sections = sections?;
    let runs: Vec<usize> = drawn.iter().map(|drawn| drawn.run).collect();
    let several = runs.len() > 1;
    let overlay = match several {
        true => overlay(site, drawn, &mut figures)?,
        false => None,
    };
    let mut page = Page {
        title: site.run_page_title(page),
        lead: lead(site, page),
        several,
        level: if several { 3 } else { 2 },
        before: (page > 0).then(|| part(site, page, page - 1)).flatten(),
        next: part(site, page, page + 1),
        diagnosis: None,
        table: several.then(|| runs_table(site, &runs)),
        parameters: several.then(|| parameters_table(site, &runs)).flatten(),
        overlay,
        drawn: String::new(),
        runs: sections,
        facts: Vec::new(),
        tags: Vec::new(),
        beside: beside(site, page),
    };
    match several {
        true => page.say_once(site, drawn),
        false => page.say_all(site, drawn),
    }
    page.runs.iter_mut().for_each(RunSection::tell_notes);
    Ok(Content {
        faults,
        ..Content::new("run.html", &page, figures)?
    })
}

impl Page {
    /// Everything of the only run stands with it.
    fn say_all(&mut self, site: &Site, drawn: &[DrawnRun]) {
        for (section, drawn) in self.runs.iter_mut().zip(drawn) {
            let record = site.input.record(drawn.run);
            if let Some(fit) = &record.fit {
                section.fit.splice(3..3, r_squared(fit));
            }
            section.readings = in_full(channels(record, &drawn.curves));
            section.remarks = remarks(section);
            section.tags = grouped(tags(record, &site.zone()));
        }
    }

    /// Moves what holds for all runs from them to the page.
    fn say_once(&mut self, site: &Site, drawn: &[DrawnRun]) {
        for (section, drawn) in self.runs.iter_mut().zip(drawn) {
            section.condition = own_condition(site, drawn.run);
            // What an issue says already is not said again.
            let mut remarks = remarks(section);
            let told = |reason: &str| section.issues.iter().any(|issue| issue.message.contains(reason));
            remarks.retain(|(_, reason)| !told(reason));
            section.remarks = remarks;
            section.parameters.clear();
        }
        let runs = &mut self.runs;
        self.facts = taken(runs, |section| &mut section.fit);
        self.facts
            .extend(taken(runs, |section| &mut section.evidence.facts));
        self.facts.extend(taken_notes(runs).iter().map(note_fact));
        if runs.iter().all(|section| section.drawn == runs[0].drawn) {
            self.drawn = std::mem::take(&mut runs[0].drawn);
            runs.iter_mut().for_each(|section| section.drawn.clear());
        }
        let group = |section: &RunSection| section.group.as_ref().map(|link| link.href.clone());
        if runs.iter().all(|section| group(section) == group(&runs[0])) {
            self.diagnosis = runs[0].group.take();
            runs.iter_mut().for_each(|section| section.group = None);
        }
        self.share_channels(site, drawn);
        let record = |drawn: &DrawnRun| site.input.record(drawn.run);
        let mut own: Vec<Vec<TagText>> = drawn
            .iter()
            .map(|drawn| tags(record(drawn), &site.zone()))
            .collect();
        self.tags = grouped(take_common(&mut own));
        for (section, tags) in self.runs.iter_mut().zip(own) {
            section.tags = grouped(tags);
        }
    }

    /// Channels are named once where all runs have the same ones with as many readings.
    fn share_channels(&mut self, site: &Site, drawn: &[DrawnRun]) {
        let of = |drawn: &DrawnRun| channels(site.input.record(drawn.run), &drawn.curves);
        let all: Vec<Vec<ChannelText>> = drawn.iter().map(of).collect();
        let named = |channels: &[ChannelText]| -> Vec<Fact> {
            let pair = |channel: &ChannelText| (channel.quantity.clone(), channel.what.clone());
            channels.iter().map(pair).collect()
        };
        let first = named(&all[0]);
        let shared = first.len() <= FEW_CHANNELS && all.iter().all(|channels| named(channels) == first);
        if shared {
            self.facts.extend(first);
        }
        for (section, channels) in self.runs.iter_mut().zip(all) {
            section.readings = if shared {
                ranges(&channels)
            } else {
                in_full(channels)
            };
        }
    }
}

/// Takes what all sections have.
fn taken<T: Clone + PartialEq>(
    sections: &mut [RunSection],
    of: impl Fn(&mut RunSection) -> &mut Vec<T>,
) -> Vec<T> {
    let mut common = of(&mut sections[0]).clone();
    for section in sections.iter_mut().skip(1) {
        let own = of(section);
        common.retain(|fact| own.contains(fact));
    }
    for section in sections {
        of(section).retain(|fact| !common.contains(fact));
    }
    common
}

/// Takes the notes that all sections have. Warnings and errors stay with each run: who comes for one must not miss them.
fn taken_notes(sections: &mut [RunSection]) -> Vec<IssueText> {
    let note = Severity::Note.key();
    let mut common = sections[0].issues.clone();
    common.retain(|issue| {
        issue.severity == note && sections.iter().all(|section| section.issues.contains(issue))
    });
    for section in sections {
        section.issues.retain(|issue| !common.contains(issue));
    }
    common
}

/// `R₁, C₁`: what is said of them.
fn remarks(section: &RunSection) -> Vec<Fact> {
    let mut said: Vec<Fact> = Vec::new();
    for row in section
        .parameters
        .iter()
        .filter(|row| !row.estimate.reason.is_empty())
    {
        match said.iter_mut().find(|(_, reason)| *reason == row.estimate.reason) {
            Some((symbols, _)) => symbols.push_str(&format!(", {}", row.symbol)),
            None => said.push((row.symbol.clone(), row.estimate.reason.clone())),
        }
    }
    said
}

/// Channels of one quantity that stand in a row are named by the first and the last where there are more than this.
const FEW_PLACES: usize = 3;

fn in_full(channels: Vec<ChannelText>) -> Vec<Fact> {
    let of_one = channels.chunk_by(|a, b| a.quantity == b.quantity);
    of_one.flat_map(of_quantity).collect()
}

fn of_quantity(channels: &[ChannelText]) -> Vec<Fact> {
    if let [first, between @ .., last] = channels
        && channels.len() > FEW_PLACES
    {
        let said = format!(
            "{} columns from {} to {}; of the first: {}",
            between.len() + 2,
            first.name,
            last.name,
            first.what
        );
        return vec![(first.quantity.clone(), said)];
    }
    let fact = |channel: ChannelText| {
        let ranged = match channel.range.is_empty() {
            true => channel.what,
            false => format!("{}, {}", channel.what, channel.range),
        };
        (channel.quantity, ranged)
    };
    channels.iter().cloned().map(fact).collect()
}

/// The ranges of all channels in a line.
fn ranges(channels: &[ChannelText]) -> Vec<Fact> {
    let known = channels.iter().filter(|channel| !channel.range.is_empty());
    let words: Vec<String> = known
        .map(|channel| format!("{} {}", channel.quantity.to_lowercase(), channel.range))
        .collect();
    match words.is_empty() {
        true => Vec::new(),
        false => vec![("Readings".to_owned(), words.join("; "))],
    }
}

/// What the page holds, under its title.
fn lead(site: &Site, page: usize) -> String {
    let page = &site.run_pages[page];
    if page.runs.len() == 1 {
        return String::new();
    }
    let record = site.input.record(page.runs[0]);
    let material = material(record, &site.input.campaign).map(|material| format!("{material}: "));
    let more = match page.parts {
        1 => String::new(),
        parts => format!("; page {} of {parts}", page.part),
    };
    format!(
        "{}{} in the order of voltage and start{more}",
        material.unwrap_or_default(),
        counted(page.runs.len(), "run")
    )
}

/// A link from a page to another of its group; none where that is of another one.
fn part(site: &Site, here: usize, there: usize) -> Option<RunLink> {
    let (here, other) = (&site.run_pages[here], site.run_pages.get(there)?);
    let same = !here.group.is_empty() && here.group == other.group;
    same.then(|| RunLink {
        href: site.run_page_href(there),
        name: format!("page {} of {}", other.part, other.parts),
    })
}

/// Pages on which other runs were measured in the conditions of this one's.
fn beside(site: &Site, page: usize) -> Vec<RunLink> {
    let here = &site.run_pages[page];
    let conditions = site.conditions.measured.iter();
    let shared = conditions.filter(|condition| condition.runs.iter().any(|run| here.runs.contains(run)));
    let pages = shared.flat_map(|condition| condition.runs.iter().map(|&run| site.page_of_run(run)));
    let mut others: Vec<usize> = pages.filter(|&other| other != page).collect();
    others.sort_unstable();
    others.dedup();
    others.retain(|&other| here.group.is_empty() || site.run_pages[other].group != here.group);
    others.dedup_by_key(|other| match site.run_pages[*other].group.as_str() {
        "" => other.to_string(),
        group => group.to_owned(),
    });
    let link = |other: usize| RunLink {
        href: site.run_page_href(other),
        name: site.run_page_title(other),
    };
    others.into_iter().take(BESIDE).map(link).collect()
}
