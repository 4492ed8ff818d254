//! What the overview says first, in at most three sentences: what the campaign shows, what the model lacks, what to do next.

use ieap_domain::words::{counted, in_a_row};
use std::collections::BTreeMap;

use serde::Serialize;

use super::across;
use super::finding_words::{Outcome, campaign_lead, outcome_of};
use super::humidity::strongest_first;
use super::law_cards::{LawCard, SampleKey, law_cards, one_of, sample_keys};
use super::wording::group_title;
use crate::aside::Shown;
use crate::error::ReportError;
use crate::pages::policy::MOST_GROUPS_NAMED;
use crate::site::Site;
use ieap_analysis::laws::words;
use ieap_analysis::laws::{Covariate, Dependence};
use ieap_analysis::monitoring::forecasts::{Dates, forecasts};
use ieap_analysis::study;
use ieap_domain::GroupDiagnosis;
use ieap_domain::finding_words::{causes, proof};

/// The first sentences with the figure of the first.
#[derive(Debug, Default, Serialize)]
pub struct Answers {
    said: Vec<Said>,
    /// The law that the first sentence states; none where it states none.
    law: Option<LawCard>,
    /// Markers of its samples.
    samples: Vec<SampleKey>,
}

/// A sentence with the page that tells more.
#[derive(Debug, Serialize)]
struct Said {
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

/// The sentences of a campaign; the figure goes to `figures`.
///
/// # Errors
/// [`ReportError::Figure`]: a fault of the program.
pub fn answers(site: &Site, figures: &mut BTreeMap<String, String>) -> Result<Answers, ReportError> {
    let claimed = strongest_first(site);
    // What surrounds and drives the strip is a cause; how long it was used may be one; the order of measuring is none.
    let law = claimed.first().filter(|found| found.covariate.remoteness() == 0);
    let said = [shows(site, &claimed), lacks(site), next(site)];
    let mut answers = Answers {
        said: said.into_iter().flatten().collect(),
        ..Answers::default()
    };
    if let Some(found) = law.filter(|found| !found.points.is_empty()) {
        let cards = law_cards(site, std::iter::once(*found), &mut Shown::default(), figures)?;
        answers.law = cards.into_iter().next();
        if found.samples.len() > 1 {
            answers.samples = sample_keys(&found.samples);
        }
    }
    Ok(answers)
}

/// The strongest law of what surrounds or drives the strip; else, without a study, what follows use; else when a limit is
/// reached.
fn shows(site: &Site, claimed: &[&Dependence]) -> Option<Said> {
    // What the study says of the humidity is not said again.
    let mut asked = site.input.study.asked();
    let says_humidity = asked.any(|own| own.kind == study::Kind::HumidityLaw);
    let is_said = |found: &Dependence| says_humidity && found.covariate == Covariate::RelativeHumidity;
    // Where the study has answers, what follows cycle or order heads no page: it may be the same difference.
    let has_study = study::view::is_told(&site.input.study);
    let first = claimed.iter().find(|found| !is_said(found));
    if let Some(found) = first.filter(|found| found.covariate.remoteness() == 0 || !has_study) {
        return Some(Said::new(law_words(found), "humidity.html", "all laws"));
    }
    let dates = Dates::of(&site.input.campaign, &site.input.runs);
    let told = forecasts(&site.input.monitoring, &dates);
    let told = told.into_iter().find(|one| one.is_told)?;
    Some(Said::new(told.sentence(), "monitoring.html", "monitoring"))
}

/// `λ of NC rises by a factor of 23 [20, 27] from 0 to 75 % RH (2 samples).`
fn law_words(found: &Dependence) -> String {
    let or = if found.confounded_with.is_empty() {
        String::new()
    } else {
        format!(
            ", or with {}, which changed with it",
            one_of(&found.confounded_with)
        )
    };
    format!(
        "{} of {} {}{or} ({}).",
        words::symbol(&found.parameter),
        found.material,
        words::brief(found),
        counted(found.samples.len(), "sample")
    )
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
                across::place_words(planned),
                planned.run.drive,
                counted(site.input.next_runs.len(), "planned run")
            );
            Some(Said::new(text, "humidity.html#next", "the plan and its reasons"))
        }
        None if coverage.is_empty() => None,
        None => Some(Said::new(coverage, "coverage.html", "the map")),
    }
}
