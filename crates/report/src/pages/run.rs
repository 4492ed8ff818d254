//! One run on its page: curves with the fit and its residuals, and everything that holds for it alone.

use std::collections::BTreeMap;

use serde::Serialize;

use super::run_condition::condition;
use super::run_evidence::{Evidence, Fact, evidence};
use super::run_figures::{Response, Subject, responses};
use super::run_fit::{self as fits, ParameterRow};
use super::run_tags::TagGroup;
use super::wording::{IssueText, RunLink, group_title, readable};
use crate::blocks::{self, Item};
use crate::error::ReportError;
use crate::fault::REPORT_IT;
use crate::site::Site;
use ieap_analysis::{along, climate};
use ieap_domain::{ClimateCurve, Issue, RunCurve, RunRecord, Severity};

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
    along: Option<AlongLine>,
    /// Every parameter, for a run that has its page for itself.
    pub parameters: Vec<ParameterRow>,
    /// What it says without a model.
    model_free: Vec<ParameterRow>,
    /// What it says of its cycles, where it has any.
    cycles: Vec<String>,
    /// Remarks on parameters: symbols with what is said of them.
    pub remarks: Vec<Fact>,
    /// How the fit was made.
    pub fit: Vec<Fact>,
    /// What the diagnosis says of the run alone.
    pub alone: String,
    /// The page of the group that it was diagnosed in.
    pub group: Option<RunLink>,
    /// What is to be known of it, errors first.
    pub issues: Vec<IssueText>,
    /// The climate during it.
    climate: Vec<Item>,
    /// What it rests on.
    pub evidence: Evidence,
    /// Channels with their readings.
    pub readings: Vec<Fact>,
    /// Tags by source.
    pub tags: Vec<TagGroup>,
}

impl RunSection {
    /// The box that stands for a run whose section could not be made: of this anchor and name.
    pub fn failed(slug: &str, name: &str, reason: &str) -> RunSection {
        let fault = Issue::error(
            "section-fault",
            format!("this section could not be made: {reason}"),
        );
        RunSection {
            issues: vec![IssueText::from(&fault.mend(REPORT_IT))],
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
            along: None,
            parameters: Vec::new(),
            model_free: Vec::new(),
            cycles: Vec::new(),
            remarks: Vec::new(),
            fit: Vec::new(),
            alone: String::new(),
            group: None,
            issues: Vec::new(),
            climate: Vec::new(),
            evidence: Evidence::default(),
            readings: Vec::new(),
            tags: Vec::new(),
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
        let is_note = |issue: &IssueText| issue.severity == Severity::Note.key();
        let (notes, issues): (Vec<_>, Vec<_>) =
            std::mem::take(&mut self.issues).into_iter().partition(is_note);
        self.issues = issues;
        self.fit.extend(notes.iter().map(note_fact));
    }
}

/// A note as a fact.
pub fn note_fact(note: &IssueText) -> Fact {
    let said = [&note.place, &note.message, &note.mend];
    let said: Vec<&str> = said
        .into_iter()
        .map(String::as_str)
        .filter(|part| !part.is_empty())
        .collect();
    ("Note".to_owned(), said.join(" "))
}

/// What was measured along the strip, and where it is shown.
#[derive(Debug, Serialize)]
struct AlongLine {
    places: String,
    href: String,
    /// Whether the distributed model is needed; empty where nothing says so.
    decision: String,
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
            decision: along::decision(record),
        }),
        parameters: record.fit.as_ref().map_or_else(Vec::new, |fit| {
            fits::parameters(&site.input.doubts, &record.path, fit)
        }),
        model_free: fits::model_free(site.model_free(run)),
        cycles: fits::cycles(site.cycles(run)),
        fit: record
            .fit
            .as_ref()
            .map_or_else(Vec::new, |fit| fits::facts(fit, record)),
        alone: alone.map_or_else(String::new, |found| readable(&found.sentence)),
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
fn worst_first(record: &RunRecord) -> Vec<IssueText> {
    let of_fit = record.fit.iter().flat_map(|fit| &fit.issues);
    let mut issues: Vec<&Issue> = record.issues.iter().chain(of_fit).collect();
    issues.sort_by_key(|issue| std::cmp::Reverse(issue.severity));
    let said = along::decision_issue(record).filter(|_| record.is_along() && record.standing.speaks());
    let is_new = |issue: &&Issue| said.is_none_or(|said| said.message != issue.message);
    let mut texts: Vec<IssueText> = issues.into_iter().filter(is_new).map(IssueText::from).collect();
    texts.dedup();
    texts
}
