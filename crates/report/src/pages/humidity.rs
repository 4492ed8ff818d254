//! The humidity study and everything else that holds across runs: every parameter against humidity with its law, what
//! is claimed, what the design leaves open, environments and voltages compared.

use ieap_domain::range_of;
use std::collections::BTreeMap;

use serde::Serialize;

use super::Content;
use super::across::{self, MapTable, MatrixTable, NextRow};
use super::finding_words::probability;
use super::wording::counted;
use crate::aside::{AsideRow, Shown, beyond_words, marks};
use crate::error::ReportError;
use crate::figures::Ink;
use crate::figures::aside::AsideMark;
use crate::figures::axis::Axis;
use crate::figures::law::{Beside, Curve, Mark, law_panel};
use crate::input::Input;
use crate::site::Site;
use ieap_analysis::ParameterInfo;
use ieap_analysis::false_discovery::CLAIMED_BELOW;
use ieap_analysis::laws::{Covariate, Dependence, contrast, words};

/// Places at which a law is drawn.
const DRAWN: usize = 40;
/// Claims that are said before anything else.
const STRONGEST: usize = 3;

#[derive(Debug, Serialize)]
struct HumidityPage {
    /// Findings first, the strongest of them.
    summary: Vec<String>,
    /// What the design leaves open.
    tied: Vec<String>,
    /// Fits that are in doubt.
    doubted: Vec<String>,
    matrices: Vec<MatrixTable>,
    maps: Vec<MapTable>,
    untying: Vec<String>,
    next_runs: Vec<NextRow>,
    runs_folder: String,
    claims: Vec<Claim>,
    studies: Vec<Study>,
    compared: Vec<Compared>,
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
struct Study {
    material: String,
    samples: Vec<SampleKey>,
    panels: Vec<Panel>,
}

/// A sample with its marker.
#[derive(Debug, Serialize)]
pub struct SampleKey {
    class: String,
    /// Outline of the marker in a box of 100 by 100.
    path: &'static str,
    name: String,
}

/// Keys of samples in the order of their markers.
pub fn sample_keys(samples: &[String]) -> Vec<SampleKey> {
    const OUTLINES: [&str; 5] = [
        "M50 14a36 36 0 1 0 .1 0z",
        "M17 17h66v66h-66z",
        "M50 6l42 76h-84z",
        "M50 2l48 48-48 48-48-48z",
        "M50 94l42-76h-84z",
    ];
    let key = |(at, name): (usize, &String)| SampleKey {
        class: format!("k-{}", at % Ink::SERIES.len() + 1),
        path: OUTLINES[at % OUTLINES.len()],
        name: name.clone(),
    };
    samples.iter().enumerate().map(key).collect()
}

#[derive(Debug, Serialize)]
struct Panel {
    parameter: String,
    sentence: String,
    figure: Option<String>,
    /// Runs set aside that lie beyond the axes.
    #[serde(skip_serializing_if = "String::is_empty")]
    beyond: String,
    laws: Vec<LawRow>,
    note: String,
}

#[derive(Debug, Serialize)]
struct LawRow {
    law: &'static str,
    bic: String,
    left_out: String,
}

#[derive(Debug, Serialize)]
struct Compared {
    material: String,
    sentences: Vec<String>,
}

#[derive(Debug, Serialize)]
struct Asked {
    effect: &'static str,
    sentence: String,
    p: String,
    q: String,
}

/// Whether a report of that input has the page.
pub fn is_shown(input: &Input) -> bool {
    !input.laws.dependences.is_empty()
        || !input.laws.doubted.is_empty()
        || !input.contrasts.is_empty()
        || !input.next_runs.is_empty()
}

/// Makes the page.
pub fn content(site: &Site) -> Result<Content, ReportError> {
    let laws = &site.input.laws;
    let (mut figures, mut shown) = (BTreeMap::new(), Shown::default());
    let page = HumidityPage {
        summary: summary(site),
        tied: laws.tied.iter().map(|set| words::tied(set, laws)).collect(),
        doubted: laws.doubted.iter().map(words::doubted).collect(),
        matrices: across::matrix_tables(site),
        maps: across::map_tables(site),
        untying: across::untying(site),
        next_runs: across::next_rows(site),
        runs_folder: site.input.campaign.runs_folder.clone(),
        claims: claims(site),
        studies: studies(site, &mut shown, &mut figures)?,
        compared: compared(site),
        open: laws
            .dependences
            .iter()
            .filter(|found| found.q > CLAIMED_BELOW)
            .map(|found| Asked {
                effect: found.covariate.effect().unwrap_or(""),
                sentence: words::sentence(found),
                p: probability(Some(found.p)),
                q: probability(Some(found.q)),
            })
            .collect(),
        aside: shown.rows(site),
    };
    Content::new("humidity.html", &page, figures)
}

fn summary(site: &Site) -> Vec<String> {
    let laws = &site.input.laws;
    let claimed = laws
        .claimed()
        .filter(|found| found.covariate != Covariate::Sample)
        .count();
    let mut sentences = vec![match claimed {
        0 => format!(
            "{} asked which parameter follows what from run to run: nothing is claimed.",
            counted(laws.questions, "question")
        ),
        some => format!(
            "{} asked which parameter follows what from run to run; {} claimed.",
            counted(laws.questions, "question"),
            if some == 1 {
                "1 answer is".to_owned()
            } else {
                format!("{some} answers are")
            }
        ),
    }];
    let mut strongest: Vec<&Dependence> = laws
        .claimed()
        .filter(|found| found.covariate != Covariate::Sample)
        .collect();
    strongest.sort_by(|a, b| a.q.total_cmp(&b.q).then(a.p.total_cmp(&b.p)));
    sentences.extend(strongest.into_iter().take(STRONGEST).map(words::sentence));
    sentences
}

fn claims(site: &Site) -> Vec<Claim> {
    let laws = &site.input.laws;
    let of_laws = laws.claimed().map(|found| Claim {
        effect: found.covariate.effect().unwrap_or(""),
        sentence: words::sentence(found),
        p: probability(Some(found.p)),
        q: probability(Some(found.q)),
    });
    let lengths = laws
        .lengths
        .iter()
        .filter(|found| found.q <= CLAIMED_BELOW && found.explains_all);
    let of_lengths = lengths.map(|found| Claim {
        effect: "geometry-error",
        sentence: words::length(found),
        p: probability(Some(found.p)),
        q: probability(Some(found.q)),
    });
    let selections = laws.selections.iter().filter(|found| found.q <= CLAIMED_BELOW);
    let of_failures = selections.map(|found| Claim {
        effect: "selection",
        sentence: words::selection(found),
        p: probability(Some(found.p)),
        q: probability(Some(found.q)),
    });
    of_laws.chain(of_lengths).chain(of_failures).collect()
}

fn studies(
    site: &Site,
    shown: &mut Shown,
    figures: &mut BTreeMap<String, String>,
) -> Result<Vec<Study>, ReportError> {
    let mut studies: Vec<Study> = Vec::new();
    let laws = &site.input.laws;
    let of_humidity = laws.dependences.iter().filter(|found| {
        let names = std::iter::once(found.covariate).chain(found.tied_to());
        let mut names = names.filter(|one| *one == Covariate::RelativeHumidity);
        names.next().is_some() && found.covariate != Covariate::Sample
    });
    for found in of_humidity {
        let number = figures.len();
        let aside = aside(site, found);
        let drawn = draw(found, &aside, number)?;
        if drawn.is_some() {
            shown.note(&aside);
        }
        let (id, beyond) = match drawn {
            Some(Drawn { id, svg, beyond }) => {
                figures.insert(id.clone(), svg);
                (Some(id), beyond)
            }
            None => (None, String::new()),
        };
        if studies
            .last()
            .is_none_or(|study| study.material != found.material)
        {
            studies.push(Study {
                material: found.material.clone(),
                samples: Vec::new(),
                panels: Vec::new(),
            });
        }
        if let Some(study) = studies.last_mut() {
            if study.samples.len() < found.samples.len() {
                study.samples = sample_keys(&found.samples);
            }
            study.panels.push(described(found, (id, beyond)));
        }
    }
    Ok(studies)
}

/// Condemned runs of the material on the axis of a dependence. None where values are brought to equal something else: of
/// such a run that cannot be done.
fn aside(site: &Site, found: &Dependence) -> Vec<AsideMark> {
    marks(site, &found.parameter, |aside| {
        let facts = aside.facts.as_ref()?;
        let is_here = facts.material == found.material && found.adjusted_for.is_empty();
        let place = facts.numbers.get(&found.covariate).filter(|_| is_here)?;
        Some(place.value)
    })
}

fn described(found: &Dependence, (figure, beyond): (Option<String>, String)) -> Panel {
    let info = ParameterInfo::of(&found.parameter);
    let name = info.map_or_else(String::new, |info| format!(" {}", info.name));
    let mut notes = Vec::new();
    if found.left_out > 0 {
        notes.push(format!(
            "{} left out: a bound, or not determined",
            counted(found.left_out, "run")
        ));
    }
    if !found.adjusted_for.is_empty() {
        notes.push(format!("brought to equal {}", words::listed(&found.adjusted_for)));
    }
    if let Some(part) = found.reliability {
        notes.push(format!(
            "{:.1} % of the covariate's variance is its own",
            100.0 * part
        ));
    }
    if figure.is_some() && shows_branches(found) {
        notes.push(
            "tails point to where the humidity came from: left after wetting, right after drying".to_owned(),
        );
    }
    let against = match found.covariate {
        Covariate::RelativeHumidity => String::new(),
        other => format!("drawn against {}", other.label()),
    };
    if !against.is_empty() && figure.is_some() {
        notes.push(against);
    }
    Panel {
        parameter: format!("{}{name}", words::symbol(&found.parameter)),
        sentence: words::sentence(found),
        figure,
        beyond,
        laws: found
            .laws
            .iter()
            .map(|law| LawRow {
                law: law.law.key(),
                bic: format!("{:.1}", law.bic - found.bic_of_none).replace('-', "−"),
                left_out: law
                    .left_out_rms
                    .map_or_else(|| "–".to_owned(), |rms| format!("{:.2}", rms / found.rms_of_none)),
            })
            .collect(),
        note: notes.join("; "),
    }
}

/// Whether runs after wetting and after drying stand in the figure over humidity.
fn shows_branches(found: &Dependence) -> bool {
    let has = |direction: i8| found.points.iter().any(|point| point.direction == direction);
    found.covariate == Covariate::RelativeHumidity && has(1) && has(-1)
}

/// The figure of a dependence.
struct Drawn {
    id: String,
    svg: String,
    beyond: String,
}

/// Draws the points of a dependence with its law; none where there is nothing to draw.
fn draw(found: &Dependence, aside: &[AsideMark], number: usize) -> Result<Option<Drawn>, ReportError> {
    let (Some(span), false) = (found.span, found.points.is_empty()) else {
        return Ok(None);
    };
    let info = ParameterInfo::of(&found.parameter);
    let factor = info.map_or(1.0, |info| info.shown_factor);
    let (symbol, unit) = info.map_or((found.parameter.as_str(), ""), |info| {
        (info.symbol, info.shown_unit)
    });
    let tails = shows_branches(found);
    let marks: Vec<Mark> = found
        .points
        .iter()
        .map(|point| Mark {
            run: None,
            // Humidity that rose came from below.
            came_from: if tails { -point.direction } else { 0 },
            x: point.x,
            x_error: point.x_error.unwrap_or(0.0),
            y: point.value * factor,
            bar: (point.low_95 * factor, point.high_95 * factor),
            style: point.sample,
        })
        .collect();
    let mut curve = Curve::default();
    for k in 0..DRAWN {
        let x = span.low + span.length() * k as f64 / (DRAWN - 1) as f64;
        if let Some((y, low, high)) = found.curve_at(x) {
            curve.x.push(x);
            curve.y.push(y * factor);
            curve.band.push((low * factor, high * factor));
        }
    }
    let shown = marks.iter().map(|mark| mark.y).chain(curve.y.iter().copied());
    let (low, high) = range_of(shown);
    let y = match found.is_log && low > 0.0 {
        true => Axis::log(low / 1.25, high * 1.25, symbol, unit),
        false => Axis::linear_rounded(low, high, symbol, unit, 5),
    };
    let margin = 0.04 * span.length();
    let x_unit = match found.covariate {
        Covariate::RelativeHumidity => "%",
        other => other.unit(),
    };
    let mut label = found.covariate.label().to_owned();
    label[..1].make_ascii_uppercase();
    let x = Axis {
        ticks: Axis::linear_rounded(span.low, span.high, "", "", 5)
            .ticks
            .into_iter()
            .filter(|tick| tick.at >= span.low - margin && tick.at <= span.high + margin)
            .collect(),
        title: if x_unit.is_empty() {
            label
        } else {
            format!("{label} ({x_unit})")
        },
        ..Axis::linear(span.low - margin, span.high + margin, "", "", 5)
    };
    let id = format!("law-{number}");
    let title = format!(
        "{symbol} of {} against {}",
        found.material,
        found.covariate.label()
    );
    let desc = words::sentence(found);
    let beside = Beside {
        law: curve,
        names: found.samples.clone(),
        aside: aside.to_vec(),
        ..Beside::default()
    };
    let svg = law_panel((&x, &y), &marks, &beside, &title, &desc).map_err(|reason| ReportError::Figure {
        figure: id.clone(),
        reason,
    })?;
    let beyond = beyond_words(aside, (Some(&x), &y), unit);
    Ok(Some(Drawn { id, svg, beyond }))
}

fn compared(site: &Site) -> Vec<Compared> {
    let mut compared: Vec<Compared> = Vec::new();
    for one in &site.input.contrasts {
        if compared.last().is_none_or(|last| last.material != one.material) {
            compared.push(Compared {
                material: one.material.clone(),
                sentences: Vec::new(),
            });
        }
        if let Some(last) = compared.last_mut() {
            last.sentences.push(contrast::sentence(one));
        }
    }
    compared
}
