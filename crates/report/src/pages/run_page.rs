//! The page of the runs of one group: what they differ by and what was fitted side by side, then run by run, then what
//! holds for all of them. A run without a group has such a page for itself.

use ieap_domain::words::counted;
use std::collections::{BTreeMap, BTreeSet};

use serde::Serialize;

use super::Content;
use super::run::{DrawnRun, RunSection, note_fact, section};
use super::run_condition::own_condition;
use super::run_evidence::{ChannelText, Fact, channels};
use super::run_fit::{model_free, r_squared};
use super::run_overlay::{Overlay, overlay};
use super::run_tables::{ParametersTable, parameters_table, runs_table};
use super::run_tags::{TagGroup, TagText, grouped, tags, take_common};
use super::wording::RunLink;
use crate::blocks::{Item, Writer};
use crate::error::ReportError;
use crate::fault::{guarded, reason_of};
use crate::pages::policy::MOST_BESIDE;
use crate::site::Site;
use ieap_analysis::conditions::material;
use ieap_analysis::model_free::ModelFree;
use ieap_domain::{Fault, Issue, RunRecord, Severity};
use ieap_show::Block;

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
    /// What its runs differ by.
    table: Vec<Item>,
    parameters: Option<ParametersTable>,
    /// All runs on one axis.
    overlay: Option<Overlay>,
    drawn: String,
    runs: Vec<RunSection>,
    facts: Vec<Fact>,
    tags: Vec<TagGroup>,
    beside: Vec<RunLink>,
}

/// What the site says of a page of runs, without their curves. The page follows from it and the curves alone, so that one
/// that stands is right as long as both are what they were. Tables that follow from it are no part: they are made with the
/// page, and of most pages that is never.
#[derive(Debug)]
pub struct Outline<'a> {
    title: String,
    lead: String,
    before: Option<RunLink>,
    next: Option<RunLink>,
    beside: Vec<RunLink>,
    runs: Vec<RunOutline<'a>>,
}

/// The same of one of its runs.
#[derive(Debug)]
struct RunOutline<'a> {
    record: &'a RunRecord,
    slug: &'a str,
    name: &'a str,
    href: String,
    condition: String,
    tags: Vec<TagText>,
    /// What it says without a model.
    model_free: Option<&'a ModelFree>,
    /// What is known of it, or the fault that it cannot be said for.
    section: Result<RunSection, String>,
}

impl<'a> Outline<'a> {
    /// Of page number `page` of the runs' pages.
    ///
    /// # Errors
    /// [`ReportError`]: a fault of the program.
    pub fn of(site: &'a Site, page: usize) -> Result<Outline<'a>, ReportError> {
        let runs = site.run_pages[page].runs.iter();
        let own: Result<Vec<RunOutline>, ReportError> = runs.map(|&run| run_outline(site, run)).collect();
        Ok(Outline {
            title: site.run_page_title(page),
            lead: lead(site, page),
            before: (page > 0).then(|| part(site, page, page - 1)).flatten(),
            next: part(site, page, page + 1),
            beside: beside(site, page),
            runs: own?,
        })
    }
}

fn run_outline<'a>(site: &'a Site, run: usize) -> Result<RunOutline<'a>, ReportError> {
    let record = site.input.record(run);
    let section = match guarded(|| Ok(section(site, run))) {
        Ok(section) => Ok(section),
        Err(error) => Err(reason_of(error)?),
    };
    Ok(RunOutline {
        record,
        slug: site.run_slug(run),
        name: site.run_name(run),
        href: site.run_href(run),
        condition: own_condition(site, run),
        tags: tags(record, &site.zone()),
        model_free: site.model_free(run),
        section,
    })
}

/// Makes page number `page` of the runs' pages; `drawn` are its runs in its order.
///
/// # Errors
/// [`ReportError`]: a fault of the program.
pub fn content(site: &Site, page: usize, drawn: &[DrawnRun]) -> Result<Content, ReportError> {
    drawn_content(site, Outline::of(site, page)?, drawn)
}

/// Makes the page of that outline; `drawn` are its runs in its order.
///
/// # Errors
/// [`ReportError`]: a fault of the program.
pub fn drawn_content(site: &Site, outline: Outline, drawn: &[DrawnRun]) -> Result<Content, ReportError> {
    let mut figures = BTreeMap::new();
    let mut faults = Vec::new();
    let several = outline.runs.len() > 1;
    let mut sections = Vec::new();
    let mut runs = Vec::new();
    for (place, (mut own, drawn)) in outline.runs.into_iter().zip(drawn).enumerate() {
        let section = std::mem::replace(&mut own.section, Err(String::new()));
        let made = drawn_section(site, (place, &own), section, drawn, &mut figures);
        sections.push(made.or_else(|error| {
            let reason = reason_of(error)?;
            let box_of_it = RunSection::failed(own.slug, own.name, &reason);
            faults.push(Fault {
                place: own.href.clone(),
                runs: vec![own.record.path.clone()],
                reason,
            });
            Ok::<_, ReportError>(box_of_it)
        })?);
        runs.push((own, drawn));
    }
    let records: Vec<(&RunRecord, &DrawnRun)> =
        runs.iter().map(|(own, drawn)| (own.record, *drawn)).collect();
    let overlay = if several {
        overlay(&records, &mut figures)?
    } else {
        None
    };
    let indices: Vec<usize> = drawn.iter().map(|own| own.run).collect();
    let mut page = Page {
        title: outline.title,
        lead: outline.lead,
        several,
        level: if several { 3 } else { 2 },
        before: outline.before,
        next: outline.next,
        diagnosis: None,
        table: Vec::new(),
        parameters: several.then(|| parameters_table(site, &indices)).flatten(),
        overlay,
        drawn: String::new(),
        runs: sections,
        facts: Vec::new(),
        tags: Vec::new(),
        beside: outline.beside,
    };
    if several {
        page.say_once(runs)
    } else {
        page.say_all(runs)
    }
    page.runs.iter_mut().for_each(RunSection::tell_notes);
    let mut writer = Writer::new(site, 2, &mut figures);
    let table = several.then(|| Block::Table(runs_table(site, &indices)));
    writer.write(table.map(|table| Block::part("Runs", vec![table])))?;
    page.table = writer.taken();
    let mut writer = Writer::new(site, page.level, &mut figures);
    for section in &mut page.runs {
        section.lay_out(&mut writer)?;
    }
    Ok(Content {
        faults,
        ..Content::new("run.html", &page, figures)?
    })
}

/// What is known of a run with what is drawn of it.
fn drawn_section(
    site: &Site,
    (place, own): (usize, &RunOutline),
    section: Result<RunSection, String>,
    drawn: &DrawnRun,
    figures: &mut BTreeMap<String, String>,
) -> Result<RunSection, ReportError> {
    let mut section = section.map_err(ReportError::Fault)?;
    guarded(|| {
        section.without_model.splice(0..0, own.model_free.map(model_free));
        section.draw(site, place, own.record, drawn, figures)
    })?;
    Ok(section)
}

/// A run of a page with its curves.
type Shown<'a, 'b> = (RunOutline<'a>, &'b DrawnRun);

impl Page {
    /// Everything of the only run stands with it.
    fn say_all(&mut self, runs: Vec<Shown>) {
        for (section, (own, drawn)) in self.runs.iter_mut().zip(runs) {
            if let Some(fit) = &own.record.fit {
                section.fit.splice(3..3, r_squared(fit));
            }
            section.readings = in_full(channels(own.record, &drawn.curves));
            section.remarks = remarks(section);
            section.tags = grouped(own.tags);
        }
    }

    /// Moves what holds for all runs from them to the page.
    fn say_once(&mut self, shown: Vec<Shown>) {
        for (section, (own, _)) in self.runs.iter_mut().zip(&shown) {
            section.condition.clone_from(&own.condition);
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
        self.share_channels(&shown);
        let mut own: Vec<Vec<TagText>> = shown.into_iter().map(|(own, _)| own.tags).collect();
        self.tags = grouped(take_common(&mut own));
        for (section, tags) in self.runs.iter_mut().zip(own) {
            section.tags = grouped(tags);
        }
    }

    /// Channels are named once where all runs have the same ones with as many readings.
    fn share_channels(&mut self, shown: &[Shown]) {
        let of = |(own, drawn): &Shown| channels(own.record, &drawn.curves);
        let all: Vec<Vec<ChannelText>> = shown.iter().map(of).collect();
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
fn taken_notes(sections: &mut [RunSection]) -> Vec<Issue> {
    let mut common = sections[0].issues.clone();
    common.retain(|issue| {
        issue.severity == Severity::Note && sections.iter().all(|section| section.issues.contains(issue))
    });
    for section in sections {
        section.issues.retain(|issue| !common.contains(issue));
    }
    common
}

/// `R₁, C₁`: what is said of them.
fn remarks(section: &RunSection) -> Vec<Fact> {
    let mut said: Vec<Fact> = Vec::new();
    for number in &section.parameters {
        let remark = number.remark();
        match said.iter_mut().find(|(_, own)| *own == remark) {
            _ if remark.is_empty() => {}
            Some((symbols, _)) => symbols.push_str(&format!(", {}", number.symbol)),
            None => said.push((number.symbol.clone(), remark)),
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
        let ranged = if channel.range.is_empty() {
            channel.what
        } else {
            format!("{}, {}", channel.what, channel.range)
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
    if words.is_empty() {
        Vec::new()
    } else {
        vec![("Readings".to_owned(), words.join("; "))]
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
    let shared: BTreeSet<usize> = here
        .runs
        .iter()
        .filter_map(|&run| site.condition_of(run))
        .collect();
    let conditions = shared.iter().map(|&place| &site.conditions.measured[place]);
    let pages = conditions.flat_map(|condition| condition.runs.iter().map(|&run| site.page_of_run(run)));
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
    others.into_iter().take(MOST_BESIDE).map(link).collect()
}
