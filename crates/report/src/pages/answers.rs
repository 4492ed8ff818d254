//! What the overview says behind the study, each in a sentence: when a limit is reached, what humidity does to moduli, what the
//! model lacks, what to do next.

use ieap_domain::words::{counted, in_a_row};
use std::collections::BTreeMap;

use serde::Serialize;

use super::finding_words::{Outcome, outcome_of, wrong_in};
use super::wording::group_title;
use crate::pages::policy::MOST_GROUPS_NAMED;
use crate::site::Site;
use ieap_analysis::dma::view::in_short;
use ieap_analysis::monitoring::forecasts::{Dates, forecasts};
use ieap_analysis::study;
use ieap_domain::GroupDiagnosis;
use ieap_domain::finding_words::{causes, gain_in_short, short_name};

/// A sentence with the page that tells more.
#[derive(Debug, PartialEq, Serialize)]
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

    /// What humidity does to the moduli.
    fn of_moduli(text: String) -> Said {
        Said::new(text, "dma.html", "modulus logs")
    }
}

/// What the study says, with what humidity does to the moduli where its size puts it.
pub fn first_screen(site: &Site) -> Vec<Said> {
    let asked = &site.input.study;
    if !study::view::is_told(asked) {
        return Vec::new();
    }
    let moduli = in_short(&site.input.modulus_logs);
    let said = |text: String| {
        if moduli.as_ref().is_some_and(|own| own.text == text) {
            Said::of_moduli(text)
        } else {
            Said::new(text, "", "")
        }
    };
    let texts = study::first_screen(asked, moduli.as_ref());
    texts.into_iter().map(said).collect()
}

/// The sentences of a campaign behind those.
pub fn answers(site: &Site, first: &[Said]) -> Vec<Said> {
    let moduli = in_short(&site.input.modulus_logs).map(|own| Said::of_moduli(own.text));
    let moduli = moduli.filter(|own| !first.contains(own));
    let said = [shows(site), moduli, lacks(site), next(site)];
    said.into_iter().flatten().collect()
}

/// When a limit is reached.
fn shows(site: &Site) -> Option<Said> {
    let dates = Dates::of(&site.input.campaign, &site.input.runs);
    let told = forecasts(&site.input.monitoring, &dates);
    let told = told.into_iter().find(|one| one.is_told)?;
    Some(Said::new(told.sentence(), "monitoring.html", "monitoring"))
}

/// What the model lacks, in one sentence: each cause with its groups, and what one of a single group gains.
fn lacks(site: &Site) -> Option<Said> {
    let findings = &site.input.findings;
    let groups = &findings.groups;
    if groups.is_empty() {
        return None;
    }
    let of = |wanted: Outcome| groups.iter().filter(move |found| outcome_of(found) == wanted);
    let mut by_cause: BTreeMap<String, Vec<&GroupDiagnosis>> = BTreeMap::new();
    for found in of(Outcome::WrongWithCause) {
        let about = |id: &str| findings.effect(id).map(|effect| effect.summary.as_str());
        // One law in full; of several what each is called: the page of the group says more.
        let cause = match found.missing.as_slice() {
            [] | [_] => causes(found, &about),
            several => in_a_row(&several.iter().map(short_name).collect::<Vec<_>>()),
        };
        by_cause.entry(cause).or_default().push(found);
    }
    let uncaused: Vec<&GroupDiagnosis> = of(Outcome::Wrong).collect();
    let cause = |(cause, of): (&String, &Vec<&GroupDiagnosis>)| {
        let gain = match of.as_slice() {
            [only] => only.gain.as_ref().and_then(|gain| gain_in_short(&gain.proof)),
            _ => None,
        };
        let with = gain.map_or(String::new(), |gain| format!(", with it {gain}"));
        (groups_words(of), format!("{cause}{with}"))
    };
    let mut text = String::new();
    for (of, misses) in by_cause.iter().map(cause) {
        text += &if text.is_empty() {
            format!("For {of} the model misses {misses}")
        } else {
            format!("; for {of} {misses}")
        };
    }
    if text.is_empty() {
        text = wrong_in(groups);
    }
    text += &match (by_cause.is_empty(), uncaused.len()) {
        (_, 0) => String::new(),
        (true, _) => ", and what it misses cannot be told".to_owned(),
        (false, more) => format!("; in {} it is wrong without a cause", counted(more, "more group")),
    };
    Some(Said::new(text + ".", "findings.html", "all findings"))
}

/// Which groups.
fn groups_words(groups: &[&GroupDiagnosis]) -> String {
    let names: Vec<String> = groups.iter().map(|found| group_title(&found.group)).collect();
    if names.len() > MOST_GROUPS_NAMED {
        format!("{} groups", names.len())
    } else {
        in_a_row(&names)
    }
}

/// The first run to make.
fn next(site: &Site) -> Option<Said> {
    let planned = site.input.next_runs.first()?;
    let text = format!("Next: {}, {}.", planned.place(), planned.run.drive);
    Some(Said::new(text, "study.html", "why"))
}

/// How many of the combinations are measured; empty where none is.
pub fn coverage(site: &Site) -> String {
    let conditions = &site.conditions;
    let possible = conditions.materials.len() * conditions.surroundings.len() * conditions.voltages_v.len();
    match conditions.measured.len() {
        0 => String::new(),
        all if all == possible => {
            "Every combination of material, environment and voltage is measured.".to_owned()
        }
        some => {
            format!("{some} of {possible} combinations of material, environment and voltage are measured.")
        }
    }
}

/// `3 runs to make next`; none where there is none.
pub fn next_words(site: &Site) -> Option<String> {
    let count = site.input.next_runs.len();
    (count > 0).then(|| format!("{} to make next", counted(count, "run")))
}
