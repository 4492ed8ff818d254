//! Laws across runs as figures, each with its answer in a line.

use ieap_domain::number::{fixed, percent};
use ieap_domain::words::counted;
use std::collections::BTreeMap;

use ieap_domain::range_of;
use serde::Serialize;

use crate::aside::{Shown, beyond_words, marks};
use crate::error::ReportError;
use crate::figures::Ink;
use crate::figures::aside::AsideMark;
use crate::figures::axis::Axis;
use crate::figures::law::{Beside, Curve, LawFigure, Mark};
use crate::site::Site;
use ieap_analysis::ParameterInfo;
use ieap_analysis::laws::{Covariate, Dependence, words};
use ieap_domain::number::probabilities::equation;

/// Places at which a law is drawn.
const DRAWN: usize = 40;

/// A law with its figure.
#[derive(Debug, Serialize)]
pub struct LawCard {
    symbol: String,
    name: &'static str,
    material: String,
    /// The answer.
    said: String,
    /// What else it may follow; empty where the design or the readings tell.
    badge: String,
    q: String,
    figure: Option<String>,
    /// Runs set aside that lie beyond the axes.
    #[serde(skip_serializing_if = "String::is_empty")]
    beyond: String,
    laws: Vec<LawRow>,
    /// What else is to be known of it.
    notes: Vec<String>,
}

impl LawCard {
    /// Whether several laws were compared.
    pub fn has_rivals(&self) -> bool {
        !self.laws.is_empty()
    }
}

/// Takes out of the cards what all of them say, where there are several: it is said once.
pub fn common_notes(cards: &mut [LawCard]) -> Vec<String> {
    let [first, rest @ ..] = &mut *cards else {
        return Vec::new();
    };
    let is_common = |note: &String| rest.iter().all(|card| card.notes.contains(note));
    let common: Vec<String> = if rest.is_empty() {
        Vec::new()
    } else {
        first
            .notes
            .iter()
            .filter(|note| is_common(note))
            .cloned()
            .collect()
    };
    for card in cards {
        card.notes.retain(|note| !common.contains(note));
    }
    common
}

#[derive(Debug, Serialize)]
struct LawRow {
    law: &'static str,
    bic: String,
    left_out: String,
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

/// The laws of `found`; their figures go to `figures`.
///
/// # Errors
/// [`ReportError::Figure`] where a figure cannot be drawn.
pub fn law_cards<'a>(
    site: &Site,
    found: impl Iterator<Item = &'a Dependence>,
    shown: &mut Shown,
    figures: &mut BTreeMap<String, String>,
) -> Result<Vec<LawCard>, ReportError> {
    let mut cards = Vec::new();
    for found in found {
        let aside = aside(site, found);
        let (figure, beyond) = match draw(found, &aside, figures.len())? {
            Some(Drawn { id, svg, beyond }) => {
                shown.note(&aside);
                figures.insert(id.clone(), svg);
                (Some(id), beyond)
            }
            None => (None, String::new()),
        };
        cards.push(described(found, (figure, beyond)));
    }
    Ok(cards)
}

/// Condemned runs of the material on the axis of a dependence. None where values are brought to equal something else: of
/// such a run that cannot be done.
pub fn aside(site: &Site, found: &Dependence) -> Vec<AsideMark> {
    marks(site, &found.parameter, |aside| {
        let facts = aside.facts.as_ref()?;
        let is_here = facts.material == found.material && found.adjusted_for.is_empty();
        let place = facts.numbers.get(&found.covariate).filter(|_| is_here)?;
        Some(place.value)
    })
}

fn described(found: &Dependence, (figure, beyond): (Option<String>, String)) -> LawCard {
    let is_claimed = found.is_claimed();
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
            "{} of the covariate's variance is its own",
            percent(part, 1)
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
    LawCard {
        symbol: words::symbol(&found.parameter).to_owned(),
        name: ParameterInfo::of(&found.parameter).map_or("", |info| info.name),
        material: found.material.clone(),
        said: if is_claimed {
            words::brief(found)
        } else {
            format!("open: {}", words::allowed(found))
        },
        badge: if is_claimed && !found.confounded_with.is_empty() {
            format!("or {}", one_of(&found.confounded_with))
        } else {
            String::new()
        },
        q: equation("q", found.q),
        figure,
        beyond,
        laws: found
            .laws
            .iter()
            .map(|law| LawRow {
                law: law.law.key(),
                bic: fixed(law.bic - found.bic_of_none, 1),
                left_out: law
                    .left_out_rms
                    .map_or_else(|| "–".to_owned(), |rms| fixed(rms / found.rms_of_none, 2)),
            })
            .collect(),
        notes,
    }
}

/// `cycle`, `cycle or age`, `one of 6 others`.
pub(super) fn one_of(covariates: &[Covariate]) -> String {
    let labels: Vec<&str> = covariates.iter().map(|covariate| covariate.label()).collect();
    match labels.as_slice() {
        [one] => (*one).to_owned(),
        [one, other] => format!("{one} or {other}"),
        [first, rest @ ..] => format!("{first} or one of {} others", rest.len()),
        [] => String::new(),
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
    let Some(figure) = figure_of(found, aside) else {
        return Ok(None);
    };
    let id = format!("law-{number}");
    let svg = figure.svg().map_err(|reason| ReportError::Figure {
        figure: id.clone(),
        reason,
    })?;
    let unit = ParameterInfo::of(&found.parameter).map_or("", |info| info.shown_unit);
    let beyond = beyond_words(aside, (Some(&figure.x), &figure.y), unit);
    Ok(Some(Drawn { id, svg, beyond }))
}

/// The figure of a dependence; none where there is nothing to draw.
pub fn figure_of(found: &Dependence, aside: &[AsideMark]) -> Option<LawFigure> {
    let span = found.span.filter(|_| !found.points.is_empty())?;
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
    let y = if found.is_log && low > 0.0 {
        Axis::log(low / 1.25, high * 1.25, symbol, unit)
    } else {
        Axis::linear_rounded(low, high, symbol, unit, 5)
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
    let title = format!(
        "{symbol} of {} against {}",
        found.material,
        found.covariate.label()
    );
    Some(LawFigure {
        x,
        y,
        marks,
        beside: Beside {
            law: curve,
            names: found.samples.clone(),
            aside: aside.to_vec(),
            ..Beside::default()
        },
        title,
        desc: words::sentence(found),
    })
}
