//! The page of one run along its strip: maps of curvature, shapes, curves at places, voltages.

use ieap_domain::words::{counted, in_a_row};

use super::Content;
use super::run_condition::condition;
use crate::blocks::{self, Writer};
use crate::error::ReportError;
use crate::figures::along::frames;
use crate::figures::along::map::{self, Shown, residual_end};
use crate::figures::along::shapes::{self, Layout};
use crate::figures::svg;
use crate::site::Site;
use ieap_analysis::along::{charts, millimetres, places, residual_ratio, seconds};
use ieap_domain::number::{fixed, measured, rounded_bound, significant};
use ieap_domain::{AlongCurve, AlongStrip, EndsRatio, Fit};
use ieap_show::Block;

/// Width of a drawing, px.
const WIDTH: u32 = crate::figures::canvas::PAGE_WIDTH;

/// Makes the page of run number `run`. Without a strip, as where the readings lie at places but hold no number, it says so.
pub fn content(site: &Site, run: usize, strip: Option<&AlongStrip>) -> Result<Content, ReportError> {
    let nothing = AlongStrip::default();
    let strip = strip.unwrap_or(&nothing);
    let record = &site.input.runs[run];
    let name = site.run_name(run);
    blocks::page(site, "strip.html", |page| {
        let sentences = summary(strip, record.fit.as_ref());
        page.write(sentences.into_iter().map(Block::Say))?;
        let said = [condition(site, run), places(record)];
        let said = said.into_iter().filter(|words| !words.is_empty());
        let said = said.collect::<Vec<_>>().join("; ");
        page.leading(
            &format!("{said}."),
            &site.run_href(run),
            "Page of the run".to_owned(),
        );
        maps(page, name, strip)?;
        shape(page, name, strip)?;
        let charts = [charts::places(strip), charts::voltages(strip)]
            .into_iter()
            .flatten();
        let charts: Vec<Block> = charts.map(Block::Chart).collect();
        page.write((!charts.is_empty()).then(|| Block::part("At places and times", charts)))
    })
}

/// Sentences that stand first: how unevenly the strip bends, and how well the model describes it.
fn summary(strip: &AlongStrip, fit: Option<&Fit>) -> Vec<String> {
    let mut sentences = Vec::new();
    if strip.curvature.is_some() {
        sentences.push(unevenness(strip));
    }
    let curves = || [&strip.curvature, &strip.voltage].into_iter().flatten();
    if curves().next().is_none() {
        return vec!["The columns of places hold no readings.".to_owned()];
    }
    if curves().all(|curve| curve.fitted.is_empty()) {
        sentences.push(
            "No distributed model is fitted to this run, so that measured values stand alone: ieap run --only fit --model distributed fits one."
                .to_owned(),
        );
        return sentences;
    }
    let ratios: Vec<String> = fit
        .iter()
        .flat_map(|fit| curves().map(move |curve| (fit, curve.quantity)))
        .filter_map(|(fit, quantity)| {
            let ratio = significant(residual_ratio(fit, quantity)?, 3);
            Some(format!(
                "{ratio} × the noise in the {}",
                quantity.label().to_lowercase()
            ))
        })
        .collect();
    if !ratios.is_empty() {
        sentences.push(format!(
            "The distributed model leaves a residual of {}.",
            in_a_row(&ratios)
        ));
    }
    if fit.is_some_and(|fit| !fit.converged) {
        sentences.push(format!("But {}.", super::wording::NOT_CONVERGED));
    }
    sentences
}

fn unevenness(strip: &AlongStrip) -> String {
    let at = |ratio: &EndsRatio| seconds(ratio.time_s - strip.step_s);
    let times = |ratio: &EndsRatio| match (ratio.ratio.value, ratio.ratio.low_95) {
        (Some(value), _) => {
            let error = ratio.ratio.standard_error.unwrap_or(0.0);
            format!("{} times", measured(value, error))
        }
        (None, low) => {
            let low = rounded_bound(low.unwrap_or(1.0), false);
            format!("more than {} times", low.value_text())
        }
    };
    let ends = strip.ends_mm.map_or_else(Default::default, |[clamp, tip]| {
        [clamp, tip].map(|(from, to)| {
            if from == to {
                format!("at {}", millimetres(from))
            } else {
                format!("{} to {}", fixed(from, 1), millimetres(to))
            }
        })
    });
    let [clamp, tip] = &ends;
    match &strip.unevenness[..] {
        [] => "How much more the strip bends near the clamp than near its tip cannot be said: at no time does the bending near the clamp stand ten times above a noise that is known.".to_owned(),
        [only] => format!(
            "At {} the strip bends {} as much near the clamp ({clamp}) as near its tip ({tip}).",
            at(only),
            times(only)
        ),
        [first, .., last] => format!(
            "At {} the strip bends {} as much near the clamp ({clamp}) as near its tip ({tip}), at {} {} as much.",
            at(first),
            times(first),
            at(last),
            times(last)
        ),
    }
}

fn map_note(strip: &AlongStrip, curve: &AlongCurve) -> String {
    let time = if strip.changes_again {
        "Time is linear, since the drive changes again after the step."
    } else {
        "Time is logarithmic: the strip charges in seconds and creeps back far more slowly."
    };
    let frames = if curve.time_s.len() < curve.frames {
        format!(
            "{} of {} frames are drawn: of each of 60 stretches of time those two in which some place lies farthest above and below its mean over the stretch.",
            curve.time_s.len(),
            curve.frames
        )
    } else {
        format!("All {} are drawn.", counted(curve.frames, "frame"))
    };
    format!(
        "Position counts from the clamp. Each cell is one reading at one place and reaches half-way to the next; hatched is where there is none. {time} {frames} Curvature is counted from the initial shape of the strip."
    )
}

fn shapes_note(strip: &AlongStrip) -> String {
    let simulated = if strip.shapes.iter().any(|shape| !shape.fitted_mm.is_empty()) {
        "Broad lines are measured, thin dashes over them simulated."
    } else {
        "Lines are measured."
    };
    let length = match strip.length_mm {
        Some(_) => "",
        None => " The strip's length is not known: it is drawn as far as its last place speaks.",
    };
    format!(
        "To scale, the clamp at the left. Each place bends its stretch of the strip as an arc of a circle; arcs joined from the clamp on are the shape. The initial shape is subtracted from the readings: a strip that was bent beforehand is drawn as if it had been straight. {simulated}{length}"
    )
}

/// Maps of the curvature over place and time: measured, simulated, and what is between them.
fn maps(page: &mut Writer, name: &str, strip: &AlongStrip) -> Result<(), ReportError> {
    let desc =
        "A map of colours: time to the right, distance from the clamp upward, one cell for each reading.";
    let curve = strip.curvature.as_ref();
    let Some(curve) = curve.filter(|curve| frames::frames(strip, curve).is_some()) else {
        return Ok(());
    };
    let plain = |figure, caption, shown| (figure, caption, String::new(), shown);
    let mut maps = vec![plain("map-measured", "Measured curvature", Shown::Measured)];
    if !curve.fitted.is_empty() {
        maps.push(plain("map-simulated", "Simulated curvature", Shown::Simulated));
        let note = format!(
            "In units of the noise σ of each place, {}; beyond ±{} σ the colour stays.",
            noise_range(curve),
            significant(residual_end(curve), 1)
        );
        maps.push(("map-difference", "Measured less simulated", note, Shown::Residual));
    }
    page.part("Curvature over place and time", |part| {
        for (figure, caption, note, shown) in maps {
            let title = format!("{caption} of {name}");
            let drawn = svg(map::SIZE, &title, desc, |area| {
                map::draw(area, strip, curve, shown)
            });
            part.drawing(figure, (caption, &note), drawn)?;
        }
        part.below(&map_note(strip, curve));
        Ok(())
    })
}

/// The strip at a few times; its drawing holds the frames of the moving picture.
fn shape(page: &mut Writer, name: &str, strip: &AlongStrip) -> Result<(), ReportError> {
    let desc = "The strip seen from its side at a few times, drawn to scale from the clamp to the tip.";
    let Some(layout) = Layout::of(strip, WIDTH) else {
        return Ok(());
    };
    let title = format!("Shape of {name}");
    let drawn = svg(layout.size(), &title, desc, |area| {
        shapes::draw(area, strip, &layout)
    });
    let film = format!("<svg data-film=\"{}\"", shapes::film(strip, &layout));
    let drawn = drawn.map(|svg| svg.replacen("<svg", &film, 1));
    page.drawing("shapes", ("Shape of the strip", &shapes_note(strip)), drawn)
}

/// `0.0021 cm⁻¹` or `0.0019 to 0.0023 cm⁻¹`
fn noise_range(curve: &AlongCurve) -> String {
    let known = curve.noise.iter().copied().filter(|noise| noise.is_finite());
    let (low, high) = known.fold((f64::INFINITY, 0.0f64), |(low, high), noise| {
        (low.min(noise), high.max(noise))
    });
    let [low, high] = [low, high].map(|noise| significant(noise, 2));
    if low == high {
        format!("{low} cm⁻¹")
    } else {
        format!("{low} to {high} cm⁻¹")
    }
}
