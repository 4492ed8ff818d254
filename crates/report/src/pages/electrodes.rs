//! The electrodes' resistance over the life of the samples, by the probe: a section of the monitoring page.

use std::collections::BTreeMap;

use ieap_analysis::probe::{Course, cracks, life};
use ieap_domain::quantiles::NORMAL_95_ROUNDED;
use ieap_domain::range_of;
use serde::Serialize;

use crate::error::ReportError;
use crate::figures::axis::Axis;
use crate::figures::law::{Beside, Curve, Mark, law_panel};
use crate::site::Site;

/// Places at which a trend is drawn.
const DRAWN: usize = 60;

/// What the probe says.
#[derive(Debug, Serialize)]
pub struct Electrodes {
    /// Cracks, the answer first.
    findings: Vec<String>,
    samples: Vec<Electrode>,
}

#[derive(Debug, Serialize)]
struct Electrode {
    sample: String,
    sentence: String,
    figure: Option<String>,
}

/// The section; none without readings of a probe.
///
/// # Errors
/// [`ReportError::Figure`] where a figure cannot be drawn.
pub fn electrodes(
    site: &Site,
    figures: &mut BTreeMap<String, String>,
) -> Result<Option<Electrodes>, ReportError> {
    let courses = &site.input.electrodes;
    if courses.is_empty() {
        return Ok(None);
    }
    let mut samples = Vec::new();
    let mut findings = Vec::new();
    for (number, course) in courses.iter().enumerate() {
        let sample = course.series.sample.clone();
        findings.extend(
            cracks(course)
                .iter()
                .map(|crack| format!("Electrodes of {sample}: {crack}")),
        );
        samples.push(Electrode {
            figure: draw(course, number, figures)?,
            sentence: life(course),
            sample,
        });
    }
    if findings.is_empty() {
        findings.push("No crack of an electrode is seen by the probe.".to_owned());
    }
    Ok(Some(Electrodes { findings, samples }))
}

fn draw(
    course: &Course,
    number: usize,
    figures: &mut BTreeMap<String, String>,
) -> Result<Option<String>, ReportError> {
    let (series, study) = (&course.over_days, &course.study);
    if study.span.length() <= 0.0 {
        return Ok(None);
    }
    let mark = |(reading, &x): (&ieap_analysis::probe::ProbeReading, &f64)| {
        let reach = NORMAL_95_ROUNDED * reading.error_ohm_per_sq.unwrap_or(0.0);
        Mark {
            x,
            x_error: 0.0,
            y: reading.ohm_per_sq,
            bar: (reading.ohm_per_sq - reach, reading.ohm_per_sq + reach),
            style: 0,
            run: None,
            came_from: 0,
        }
    };
    let marks: Vec<Mark> = course.series.readings.iter().zip(&series.x).map(mark).collect();
    let curve = trend(course);
    let shown = marks.iter().flat_map(|mark| [mark.y, mark.bar.0, mark.bar.1]);
    let (low, high) = range_of(shown.chain(curve.y.iter().copied()));
    let margin = 0.04 * study.span.length();
    let x = Axis::linear(
        study.span.low - margin,
        study.span.high + margin,
        "Days since the first reading",
        "",
        5,
    );
    let y = Axis::linear_rounded(low, high, "Electrode resistance", "Ω/sq", 5);
    let crack = |&(at, _): &(usize, f64)| 0.5 * (series.x[at.saturating_sub(1)] + series.x[at]);
    let beside = Beside {
        law: curve,
        changes: course.cracks.iter().map(crack).collect(),
        names: vec![course.series.sample.clone()],
        ..Beside::default()
    };
    let id = format!("electrode-{number}");
    let title = format!("Electrode resistance of {}", course.series.sample);
    let svg = law_panel((&x, &y), &marks, &beside, &title, &life(course));
    let svg = svg.map_err(|reason| ReportError::Figure {
        figure: id.clone(),
        reason,
    })?;
    figures.insert(id.clone(), svg);
    Ok(Some(id))
}

/// The trend since the last jump, where one is shown.
fn trend(course: &Course) -> Curve {
    let (series, study) = (&course.over_days, &course.study);
    let mut curve = Curve::default();
    let Some(law) = study.trends.first().filter(|_| study.is_shown()) else {
        return curve;
    };
    let from = study
        .steps
        .last()
        .map_or(study.span.low, |step| series.x[step.at]);
    for k in 0..DRAWN {
        let x = from + (study.span.high - from) * k as f64 / (DRAWN - 1) as f64;
        let at = |size: f64| series.course(study, law, size)(x).exp();
        let ends = [law.size.low_95, law.size.high_95].map(|end| at(end.unwrap_or(law.size.value)));
        curve.x.push(x);
        curve.y.push(at(law.size.value));
        curve.band.push((ends[0].min(ends[1]), ends[0].max(ends[1])));
    }
    curve
}
