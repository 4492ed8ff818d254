//! What the overview says first, in at most three sentences: what the campaign shows, what the model lacks, what to do next.

use ieap_domain::words::{counted, in_a_row};
use std::collections::BTreeMap;

use serde::Serialize;

use super::finding_words::{Outcome, campaign_lead, outcome_of};
use super::wording::group_title;
use crate::pages::policy::MOST_GROUPS_NAMED;
use crate::site::Site;
use ieap_analysis::monitoring::forecasts::{Dates, forecasts};
use ieap_domain::GroupDiagnosis;
use ieap_domain::finding_words::{causes, proof};

/// A sentence with the page that tells more.
#[derive(Debug, Serialize)]
pub struct Said {
    text: String,
    href: String,
    more: &'static str,
}

impl Said {
    fn new(text: String, href: &str, more: &'static str) -> Said {
        let href = href.to_owned();
        Said { text, href, more }
    }
}

/// The sentences of a campaign.
pub fn answers(site: &Site) -> Vec<Said> {
    let said = [shows(site), lacks(site), next(site)];
    said.into_iter().flatten().collect()
}

/// When a limit is reached.
fn shows(site: &Site) -> Option<Said> {
    let dates = Dates::of(&site.input.campaign, &site.input.runs);
    let told = forecasts(&site.input.monitoring, &dates);
    let told = told.into_iter().find(|one| one.is_told)?;
    Some(Said::new(told.sentence(), "monitoring.html", "monitoring"))
}

/// What the model lacks: the counts, the causes with their groups, and what one of a single group gains.
fn lacks(site: &Site) -> Option<Said> {
    let findings = &site.input.findings;
    let groups = &findings.groups;
    if groups.is_empty() {
        return None;
    }
    let mut text = campaign_lead(groups);
    let mut by_cause: BTreeMap<String, Vec<&GroupDiagnosis>> = BTreeMap::new();
    for found in groups
        .iter()
        .filter(|found| outcome_of(found) == Outcome::WrongWithCause)
    {
        let about = |id: &str| findings.effect(id).map(|effect| effect.summary.as_str());
        by_cause.entry(causes(found, &about)).or_default().push(found);
    }
    for (cause, of) in by_cause {
        let gain = match of.as_slice() {
            [only] => proof(only, "it"),
            _ => String::new(),
        };
        text += &format!(" {}: {cause}.{gain}", groups_words(&of));
    }
    Some(Said::new(text, "findings.html", "all findings"))
}

/// Which groups, at the head of a sentence.
fn groups_words(groups: &[&GroupDiagnosis]) -> String {
    let names: Vec<String> = groups.iter().map(|found| group_title(&found.group)).collect();
    if names.len() > MOST_GROUPS_NAMED {
        format!("In {} groups", names.len())
    } else {
        in_a_row(&names)
    }
}

/// The first run to make, and how much of the conditions is measured.
fn next(site: &Site) -> Option<Said> {
    let conditions = &site.conditions;
    let measured = conditions.measured.len();
    let possible = conditions.materials.len() * conditions.surroundings.len() * conditions.voltages_v.len();
    let coverage = match measured {
        0 => String::new(),
        all if all == possible => {
            "Every combination of material, environment and voltage is measured.".to_owned()
        }
        some => {
            format!("{some} of {possible} combinations of material, environment and voltage are measured.")
        }
    };
    match site.input.next_runs.first() {
        Some(planned) => {
            let text = format!(
                "Next: {}, {} (the first of {}). {coverage}",
                planned.place(),
                planned.run.drive,
                counted(site.input.next_runs.len(), "planned run")
            );
            Some(Said::new(text, "study.html", "the plan and its reasons"))
        }
        None if coverage.is_empty() => None,
        None => Some(Said::new(coverage, "#conditions", "the conditions")),
    }
}

/// `3 runs to make next`; empty where there is none.
pub fn next_words(site: &Site) -> String {
    match site.input.next_runs.len() {
        0 => String::new(),
        count => format!("{} to make next", counted(count, "run")),
    }
}
