//! What holds across runs: every law with its figure, parameters against covariates, conditions compared, runs to make
//! next; and folded below it what that rests on.

use ieap_domain::words::counted;
use std::collections::BTreeMap;

use serde::Serialize;

use super::Content;
use super::across::{self, MapTable, MatrixTable, NextRow};
use super::law_cards::{LawCard, SampleKey, common_notes, law_cards, sample_keys};
use crate::aside::{AsideRow, Shown};
use crate::error::ReportError;
use crate::input::Input;
use crate::pages::policy::MOST_LAWS_DRAWN;
use crate::site::Site;
use ieap_analysis::false_discovery::CLAIMED_BELOW;
use ieap_analysis::laws::{Covariate, Dependence, words};
use ieap_domain::number::probabilities::probability;

#[derive(Debug, Serialize)]
struct HumidityPage {
    /// The answer in a sentence.
    lead: String,
    /// What some runs do not state.
    lacking: Vec<String>,
    /// Laws that are claimed.
    laws: Vec<LawCard>,
    /// What is to be known of all of them.
    notes: Vec<String>,
    /// Whether any of them may follow something else.
    is_confounded: bool,
    /// Markers of the samples, by material.
    samples: Vec<Samples>,
    matrices: Vec<MatrixTable>,
    deconfounding: Vec<String>,
    /// `3 runs to make next`; empty where there is none.
    next: String,
    next_runs: Vec<NextRow>,
    runs_folder: String,
    /// Claims at length.
    claims: Vec<Claim>,
    /// What the design leaves open.
    tied: Vec<String>,
    /// Fits that are in doubt.
    doubted: Vec<String>,
    maps: Vec<MapTable>,
    /// Parameters against humidity of which nothing is claimed, and claims beyond those drawn above.
    others: Vec<LawCard>,
    /// Whether any of the laws drawn has others beside it.
    with_laws: bool,
    open: Vec<Asked>,
    /// Runs whose readings are known to be wrong.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    aside: Vec<AsideRow>,
}

#[derive(Debug, Serialize)]
struct Claim {
    effect: &'static str,
    sentence: String,
    p: String,
    q: String,
}

#[derive(Debug, Serialize)]
struct Samples {
    material: String,
    keys: Vec<SampleKey>,
}

#[derive(Debug, Serialize)]
struct Asked {
    parameter: String,
    covariates: String,
    allowed: String,
    p: String,
    q: String,
}

/// Whether a report of that input has the page.
pub fn is_shown(input: &Input) -> bool {
    !input.laws.dependences.is_empty()
        || !input.laws.doubted.is_empty()
        || !input.next_runs.is_empty()
        || input.laws.selections.iter().any(|found| found.q <= CLAIMED_BELOW)
}

/// Makes the page.
pub fn content(site: &Site) -> Result<Content, ReportError> {
    let laws = &site.input.laws;
    let (mut figures, mut shown) = (BTreeMap::new(), Shown::default());
    let claimed = strongest_first(site);
    let (drawn, more) = claimed.split_at(MOST_LAWS_DRAWN.min(claimed.len()));
    let open = laws.dependences.iter().filter(|found| found.q > CLAIMED_BELOW);
    let others = more
        .iter()
        .copied()
        .chain(open.clone().filter(|found| is_of_humidity(found)));
    let mut cards = law_cards(site, drawn.iter().copied(), &mut shown, &mut figures)?;
    let others = law_cards(site, others, &mut shown, &mut figures)?;
    let page = HumidityPage {
        with_laws: cards.iter().chain(&others).any(LawCard::has_rivals),
        lead: lead(site, claimed.len()),
        lacking: laws.lacking.iter().map(words::lacking).collect(),
        notes: common_notes(&mut cards),
        laws: cards,
        is_confounded: claimed.iter().any(|found| !found.confounded_with.is_empty()),
        others,
        samples: samples(site),
        matrices: across::matrix_tables(site),
        deconfounding: across::untying(site),
        next: across::next_words(site),
        next_runs: across::next_rows(site),
        runs_folder: site.input.campaign.runs_folder.clone(),
        claims: claims(site),
        tied: across::tied(site),
        doubted: laws.doubted.iter().map(words::doubted).collect(),
        maps: across::map_tables(site),
        open: open.map(asked).collect(),
        aside: shown.rows(site),
    };
    Content::new("humidity.html", &page, figures)
}

/// Claims but for those that samples differ: physical causes first, then use, then order; of each the strongest first.
pub fn strongest_first<'a>(site: &'a Site) -> Vec<&'a Dependence> {
    let claimed = site.input.laws.claimed();
    let mut claimed: Vec<&Dependence> = claimed
        .filter(|found| found.covariate != Covariate::Sample)
        .collect();
    let remoteness = |found: &Dependence| found.covariate.remoteness();
    claimed.sort_by(|a, b| {
        (remoteness(a).cmp(&remoteness(b)))
            .then(a.q.total_cmp(&b.q))
            .then(a.p.total_cmp(&b.p))
    });
    claimed
}

fn lead(site: &Site, claimed: usize) -> String {
    let asked = counted(site.input.laws.questions, "question");
    match claimed {
        0 => format!("No parameter is shown to follow anything from run to run ({asked} asked)."),
        1 => format!("One law holds from run to run ({asked} asked)."),
        some => format!("{some} laws hold from run to run ({asked} asked)."),
    }
}

fn is_of_humidity(found: &Dependence) -> bool {
    let names = std::iter::once(found.covariate).chain(found.tied_to());
    let mut names = names.filter(|one| *one == Covariate::RelativeHumidity);
    names.next().is_some() && found.covariate != Covariate::Sample
}

/// Materials of several samples with the markers of these.
fn samples(site: &Site) -> Vec<Samples> {
    let mut most: BTreeMap<&str, &[String]> = BTreeMap::new();
    for found in &site.input.laws.dependences {
        let known = most.entry(&found.material).or_default();
        if known.len() < found.samples.len() {
            *known = &found.samples;
        }
    }
    let several = most.into_iter().filter(|(_, samples)| samples.len() > 1);
    several
        .map(|(material, samples)| Samples {
            material: material.to_owned(),
            keys: sample_keys(samples),
        })
        .collect()
}

fn asked(found: &Dependence) -> Asked {
    let mut covariates = vec![found.covariate];
    covariates.extend(&found.confounded_with);
    Asked {
        parameter: format!("{} of {}", words::symbol(&found.parameter), found.material),
        covariates: words::listed(&covariates),
        allowed: words::allowed(found),
        p: probability(found.p),
        q: probability(found.q),
    }
}

fn claims(site: &Site) -> Vec<Claim> {
    let laws = &site.input.laws;
    let of_laws = laws.claimed().map(|found| Claim {
        effect: found.covariate.effect().unwrap_or(""),
        sentence: words::sentence(found),
        p: probability(found.p),
        q: probability(found.q),
    });
    let lengths = laws
        .lengths
        .iter()
        .filter(|found| found.q <= CLAIMED_BELOW && found.explains_all);
    let of_lengths = lengths.map(|found| Claim {
        effect: "geometry-error",
        sentence: words::length(found),
        p: probability(found.p),
        q: probability(found.q),
    });
    let selections = laws.selections.iter().filter(|found| found.q <= CLAIMED_BELOW);
    let of_failures = selections.map(|found| Claim {
        effect: "selection",
        sentence: words::selection(found),
        p: probability(found.p),
        q: probability(found.q),
    });
    of_laws.chain(of_lengths).chain(of_failures).collect()
}
