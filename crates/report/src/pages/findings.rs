//! The list of groups with what was found in each, and the ledger of every test made.

use ieap_domain::words::counted;
use std::collections::BTreeMap;

use serde::Serialize;

use super::Content;
use super::answers::next_words;
use super::finding_words::campaign_lead;
use super::wording::{RunLink, group_title, readable};
use crate::error::ReportError;
use crate::site::Site;
use ieap_analysis::shared_effects::{SharedEffect, SharedParameter, left_out};
use ieap_domain::finding_words::verdict_word;
use ieap_domain::number::probabilities::{counted_with_q, probability};
use ieap_domain::number::{interval, measured, significant};
use ieap_domain::{FromOthers, GroupDiagnosis, Verdict};

#[derive(Debug, Serialize)]
struct FindingsPage {
    /// Findings first.
    summary: Vec<String>,
    /// What to measure next, where anything is.
    next: String,
    groups: Vec<GroupRow>,
    shared: Vec<SharedSection>,
    ledger: Vec<LedgerRow>,
    runs: Vec<RunRow>,
}

#[derive(Debug, Serialize)]
struct GroupRow {
    link: RunLink,
    runs: String,
    verdict: &'static str,
    /// Stored name: class.
    key: &'static str,
    sentence: String,
    set: Vec<String>,
    p: String,
    q: String,
}

/// A cause of several samples.
#[derive(Debug, Serialize)]
struct SharedSection {
    title: String,
    sentence: String,
    parameters: Vec<SharedRow>,
    left_out: Vec<LeftOutRow>,
}

#[derive(Debug, Serialize)]
struct SharedRow {
    key: String,
    mean: String,
    interval: String,
    spread: String,
    is_one: &'static str,
}

#[derive(Debug, Serialize)]
struct LeftOutRow {
    sample: String,
    group: String,
    from: String,
    fall: String,
    own: String,
}

/// One test: what was asked, and how often chance answers as strongly.
#[derive(Debug, Serialize)]
struct LedgerRow {
    group: String,
    question: String,
    p: String,
    q: String,
}

#[derive(Debug, Serialize)]
struct RunRow {
    /// Link to the run's page; none where the run is gone.
    link: Option<RunLink>,
    path: String,
    verdict: &'static str,
    set: Vec<String>,
    p: String,
    q: String,
    /// Place in the order of arrival.
    place: String,
    /// Level at which it was tested when it came.
    level: String,
    /// Whether it was claimed then.
    claimed: &'static str,
}

/// Makes the page.
pub fn content(site: &Site) -> Result<Content, ReportError> {
    let findings = &site.input.findings;
    let groups = &findings.groups;
    let mut summary = vec![campaign_lead(groups)];
    if !groups.is_empty() {
        summary.push(format!(
            "{} and each of {} alone were asked whether the simulation leaves more than noise: {} laws as free curves, and {} textbook curves.",
            counted(groups.len(), "group"),
            counted(findings.runs.len(), "run"),
            findings.laws.len(),
            findings.effects.len()
        ));
    }
    let page = FindingsPage {
        summary,
        next: next_words(site),
        groups: (0..groups.len()).map(|place| group_row(site, place)).collect(),
        shared: findings
            .shared
            .iter()
            .map(|(effect, said)| shared_section(effect, said, groups))
            .collect(),
        ledger: groups.iter().flat_map(ledger).collect(),
        runs: findings.runs.iter().map(|found| run_row(site, found)).collect(),
    };
    Content::new("findings.html", &page, BTreeMap::new())
}

fn group_row(site: &Site, place: usize) -> GroupRow {
    let found = &site.input.findings.groups[place];
    let (p, q) = counted_with_q(found.p_misfit, found.q_misfit, found.draws);
    GroupRow {
        link: RunLink {
            href: site.finding_href(place),
            name: group_title(&found.group),
        },
        runs: counted(found.runs.len(), "run"),
        verdict: verdict_word(found.verdict),
        key: found.verdict.key(),
        sentence: readable(&found.sentence),
        // Parameters that differ are in the sentence.
        set: match found.verdict {
            Verdict::Differs => Vec::new(),
            _ => found.set.clone(),
        },
        p,
        q,
    }
}

fn shared_section(effect: &SharedEffect, said: &str, groups: &[GroupDiagnosis]) -> SharedSection {
    let row = |parameter: &SharedParameter| {
        let mean = parameter.mean;
        let spread = mean.and_then(|mean| mean.between_samples);
        SharedRow {
            key: parameter.key.clone(),
            mean: mean.map_or_else(
                || "not determined".to_owned(),
                |mean| measured(mean.value, mean.standard_error),
            ),
            interval: mean.map_or_else(String::new, |mean| interval(mean.low_95, mean.high_95)),
            spread: spread.map_or_else(String::new, |spread| significant(spread, 2)),
            is_one: match parameter.p_equal {
                Some(_) if parameter.is_one() => "one value for all",
                Some(_) => "samples differ",
                None => "not asked: no errors",
            },
        }
    };
    let held = |(sample, group, held): (&str, &str, &FromOthers)| LeftOutRow {
        sample: sample.to_owned(),
        group: group.to_owned(),
        from: held.samples.join(", "),
        fall: if held.fall.is_finite() {
            measured(held.fall, held.standard_error)
        } else {
            "cannot be held against it".to_owned()
        },
        own: if held.fall_own_strength.is_finite() {
            significant(held.fall_own_strength, 4)
        } else {
            String::new()
        },
    };
    SharedSection {
        title: format!("{} in {}", effect.effect, effect.material),
        sentence: said.to_owned(),
        parameters: effect.parameters.iter().map(row).collect(),
        left_out: left_out(effect, groups).map(held).collect(),
    }
}

fn ledger(found: &GroupDiagnosis) -> Vec<LedgerRow> {
    let row = |question: String, p: Option<f64>, q: Option<f64>| {
        let (p, q) = counted_with_q(p, q, found.draws);
        LedgerRow {
            group: group_title(&found.group),
            question,
            p,
            q,
        }
    };
    let mut rows = Vec::new();
    if found.p_misfit.is_some() {
        rows.push(row(
            "Does the simulation leave more than noise?".to_owned(),
            found.p_misfit,
            found.q_misfit,
        ));
    }
    for effect in &found.effects {
        let question = format!(
            "Does {} describe the readings better than chance would?",
            effect.effect
        );
        rows.push(row(question, Some(effect.p), effect.q));
    }
    if found.p_leftover.is_some() {
        let question = "Does the extended simulation leave more than noise?";
        rows.push(row(question.to_owned(), found.p_leftover, None));
    }
    rows
}

fn run_row(site: &Site, found: &GroupDiagnosis) -> RunRow {
    let turn = site.input.findings.turns.get(&found.group);
    let (p, q) = counted_with_q(found.p_misfit, found.q_misfit, found.draws);
    RunRow {
        place: turn.map_or_else(String::new, |turn| turn.place.to_string()),
        level: probability(turn.map(|turn| turn.level)),
        claimed: match turn {
            Some(turn) if turn.is_claimed => "wrong",
            Some(_) => "not shown",
            None => "",
        },
        link: site.run_of(&found.group).map(|run| RunLink::to(site, run)),
        path: found.group.clone(),
        verdict: verdict_word(found.verdict),
        set: found.set.clone(),
        p,
        q,
    }
}
