//! One run on its page: curves with the fit and its residuals, and everything that holds for it alone.

use std::collections::BTreeMap;

use serde::Serialize;

use super::estimates::{self, Number};
use super::run_condition::condition;
use super::run_evidence::{Evidence, Fact, evidence};
use super::run_figures::{Response, Subject, responses};
use super::run_fit as fits;
use super::run_tags::TagGroup;
use super::wording::{IssueText, RunLink, group_title};
use crate::blocks::{self, Item, Writer};
use crate::error::ReportError;
use crate::fault::REPORT_IT;
use crate::site::Site;
use ieap_analysis::{along, climate};
use ieap_domain::{ClimateCurve, Issue, RunCurve, RunRecord, Severity};
use ieap_show::Block;

/// A run with what is drawn of it.
#[derive(Debug, Clone, PartialEq)]
pub struct DrawnRun {
    /// Index of the run.
    pub run: usize,
    /// Its curves.
    pub curves: Vec<RunCurve>,
    /// The climate around it.
    pub climate: Vec<ClimateCurve>,
    /// Why there are none of these; none where they could be had.
    pub failed: Option<String>,
}

/// A run as its page shows it. What the page says of all its runs is taken out of it before it is printed.
#[derive(Debug, Serialize)]
pub struct RunSection {
    /// Anchor on the page.
    pub slug: String,
    /// Name.
    pub name: String,
    /// `CNaf in air at 34 % RH stepped to 2.5 V`
    pub condition: String,
    /// Findings first: what the fit says, or why there is none.
    summary: Vec<String>,
    responses: Vec<Response>,
    /// What is drawn in them.
    pub drawn: String,
    /// What is told of it: along the strip, its numbers, its diagnosis.
    told: Vec<Item>,
    /// The climate during it.
    climate: Vec<Item>,
    /// What is to be known of it.
    known: Vec<Item>,
    /// Remarks on parameters: symbols with what is said of them.
    pub remarks: Vec<Fact>,
    /// How the fit was made.
    pub fit: Vec<Fact>,
    /// What it rests on.
    pub evidence: Evidence,
    /// Channels with their readings.
    pub readings: Vec<Fact>,
    /// Tags by source.
    pub tags: Vec<TagGroup>,
    /// What stands below all that.
    below: Vec<Item>,
    #[serde(skip)]
    along: Option<AlongLine>,
    /// Every parameter, for a run that has its page for itself.
    #[serde(skip)]
    pub parameters: Vec<Number>,
    /// What it says without a model, and of its cycles.
    #[serde(skip)]
    pub without_model: Vec<Block>,
    /// What the diagnosis says of the run alone.
    #[serde(skip)]
    alone: Option<String>,
    /// The page of the group that it was diagnosed in.
    #[serde(skip)]
    pub group: Option<RunLink>,
    /// What is to be known of it, errors first.
    #[serde(skip)]
    pub issues: Vec<Issue>,
}

impl RunSection {
    /// The box that stands for a run whose section could not be made: of this anchor and name.
    pub fn failed(slug: &str, name: &str, reason: &str) -> RunSection {
        let fault = Issue::error(
            "section-fault",
            format!("this section could not be made: {reason}"),
        );
        RunSection {
            issues: vec![fault.mend(REPORT_IT)],
            ..RunSection::empty(slug, name)
        }
    }

    fn empty(slug: &str, name: &str) -> RunSection {
        RunSection {
            slug: slug.to_owned(),
            name: name.to_owned(),
            condition: String::new(),
            summary: Vec::new(),
            responses: Vec::new(),
            drawn: String::new(),
            told: Vec::new(),
            climate: Vec::new(),
            known: Vec::new(),
            remarks: Vec::new(),
            fit: Vec::new(),
            evidence: Evidence::default(),
            readings: Vec::new(),
            tags: Vec::new(),
            below: Vec::new(),
            along: None,
            parameters: Vec::new(),
            without_model: Vec::new(),
            alone: None,
            group: None,
            issues: Vec::new(),
        }
    }

    /// Adds what is drawn of the run, which is number `place` of its page; its figures go to `figures`.
    ///
    /// # Errors
    /// [`ReportError`]: the curves could not be had, or a fault of the program.
    pub fn draw(
        &mut self,
        site: &Site,
        place: usize,
        record: &RunRecord,
        drawn: &DrawnRun,
        figures: &mut BTreeMap<String, String>,
    ) -> Result<(), ReportError> {
        if let Some(reason) = &drawn.failed {
            return Err(ReportError::Curves {
                run: record.path.clone(),
                reason: reason.clone(),
            });
        }
        let id = format!("{place}-");
        let subject = Subject {
            name: &self.name,
            id: &id,
            drive: record.drive.as_ref(),
            curves: &drawn.curves,
            aside: !record.standing.speaks(),
        };
        (self.responses, self.drawn) = responses(&subject, figures)?;
        let climate = climate::view::of_run(record, &drawn.climate);
        self.climate = blocks::items(site, climate, 3, figures)?;
        Ok(())
    }

    /// Tells mere notes among the facts of the fit: what is worth more stands above them.
    pub fn tell_notes(&mut self) {
        let (notes, issues): (Vec<_>, Vec<_>) = std::mem::take(&mut self.issues)
            .into_iter()
            .partition(|issue| issue.severity == Severity::Note);
        self.issues = issues;
        self.fit.extend(notes.iter().map(note_fact));
    }

    /// Lays out what is told of it.
    ///
    /// # Errors
    /// A fault of the program.
    pub fn lay_out(&mut self, page: &mut Writer) -> Result<(), ReportError> {
        if let Some(along) = &self.along {
            page.part("Along the strip", |part| {
                let read = format!("Read: {}.", along.places);
                part.leading(
                    &read,
                    &along.href,
                    "Maps of curvature, shapes, voltages".to_owned(),
                );
                part.write(along.decision.clone().map(Block::Say))
            })?;
        }
        if !self.parameters.is_empty() {
            let table = Block::Table(estimates::table("Parameter", &self.parameters));
            page.write([Block::part("Parameters", vec![table])])?;
        }
        page.write(std::mem::take(&mut self.without_model))?;
        self.lay_out_diagnosis(page)?;
        self.told = page.taken();
        let known = Block::issues(&self.issues);
        page.write(known.map(|issues| Block::part("What to know", vec![issues])))?;
        self.known = page.taken();
        page.write(std::mem::take(&mut self.evidence.tables))?;
        self.below = page.taken();
        Ok(())
    }

    fn lay_out_diagnosis(&self, page: &mut Writer) -> Result<(), ReportError> {
        if self.alone.is_none() && self.group.is_none() {
            return Ok(());
        }
        page.part("Diagnosis", |part| {
            let alone = self.alone.iter();
            part.write(alone.map(|said| Block::say(format!("This run alone: {said}"))))?;
            if let Some(group) = &self.group {
                let with = "With the other runs of its group:";
                part.leading(with, &group.href, group.name.clone());
            }
            Ok(())
        })
    }
}

/// A note as a fact.
pub fn note_fact(note: &Issue) -> Fact {
    let IssueText {
        place, message, mend, ..
    } = note.into();
    let said = [place, message, mend].into_iter().filter(|part| !part.is_empty());
    ("Note".to_owned(), said.collect::<Vec<_>>().join(" "))
}

/// What was measured along the strip, and where it is shown.
#[derive(Debug)]
struct AlongLine {
    places: String,
    href: String,
    /// Whether the distributed model is needed; none where nothing says so.
    decision: Option<String>,
}

/// What is known of a run without its curves; [`RunSection::draw`] adds what is drawn.
pub fn section(site: &Site, run: usize) -> RunSection {
    let record = site.input.record(run);
    let group = site.finding_of_run(run).map(|place| RunLink {
        href: site.finding_href(place),
        name: group_title(&site.input.findings.groups[place].group),
    });
    let alone = site.finding_alone(run);
    RunSection {
        condition: condition(site, run),
        summary: summary(record, site.input.doubts.is_of(&record.path)),
        along: (record.is_along() && record.standing.speaks()).then(|| AlongLine {
            places: along::places(record),
            href: site.strip_href(run),
            decision: Some(along::decision(record)).filter(|said| !said.is_empty()),
        }),
        parameters: record.fit.as_ref().map_or_else(Vec::new, |fit| {
            fits::parameters(&site.input.doubts, &record.path, fit)
        }),
        without_model: site.cycles(run).map(fits::cycles).into_iter().collect(),
        fit: record
            .fit
            .as_ref()
            .map_or_else(Vec::new, |fit| fits::facts(fit, record)),
        alone: alone.map(|found| found.sentence.clone()),
        group,
        issues: worst_first(record),
        evidence: evidence(site, run),
        ..RunSection::empty(site.run_slug(run), site.run_name(run))
    }
}

/// What the fit says; of a run that no result is made from, that instead: its fit describes readings that are not used.
fn summary(record: &RunRecord, doubted: bool) -> Vec<String> {
    let (standing, reason) = (&record.standing, record.standing.reason());
    if !standing.speaks() {
        let mend = format!("To change that: {}.", standing.mend(&record.path));
        return vec![format!("Set aside, in no result: {reason}."), mend];
    }
    let mut summary = fits::summary(record, doubted);
    if standing.is_vouched() {
        summary.insert(0, format!("Used on a person's word: {reason}."));
    }
    summary
}

/// Issues of the run and of its fit, errors first, each once; whether the strip is lumped stands with what was read along it.
fn worst_first(record: &RunRecord) -> Vec<Issue> {
    let of_fit = record.fit.iter().flat_map(|fit| &fit.issues);
    let said = along::decision_issue(record).filter(|_| record.is_along() && record.standing.speaks());
    let is_new = |issue: &&Issue| said.is_none_or(|said| said.message != issue.message);
    let all = record.issues.iter().chain(of_fit).filter(is_new);
    let mut issues: Vec<Issue> = all.cloned().collect();
    issues.sort_by_key(|issue| std::cmp::Reverse(issue.severity));
    issues.dedup();
    issues
}
