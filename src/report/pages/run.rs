//! The page of one run: curves with the fit and its residuals, parameters, and everything they rest on.

use std::collections::BTreeMap;

use serde::Serialize;

use super::Content;
use super::run_climate::{ClimatePanel, climate_panel};
use super::run_evidence::{Evidence, evidence};
use super::wording::{
    EstimateText, IssueText, RunLink, counted, humidity_label, in_unit, voltage_label, why_unfitted,
};
use crate::analysis::ParameterInfo;
use crate::analysis::conditions::{material, nominal_voltage_v};
use crate::domain::{ChannelNoise, ClimateCurve, Drive, Fit, Level, RunCurve, RunRecord};
use crate::report::error::ReportError;
use crate::report::figures;
use crate::report::figures::response::{TimeView, response};
use crate::report::number::{fixed, score, significant};
use crate::report::site::Site;

/// Residual over noise up to which the model describes the readings.
const WITHIN_NOISE: f64 = 1.3;
/// Residual over noise from which a misfit is called systematic whatever its shape.
const SYSTEMATIC: f64 = 3.0;
/// Lag-1 autocorrelation from which neighbouring residuals clearly go together.
const CORRELATED: f64 = 0.5;

#[derive(Debug, Serialize)]
struct RunPage {
    name: String,
    path: String,
    condition: String,
    /// Findings first: what the fit says, or why there is none.
    summary: Vec<String>,
    responses: Vec<Response>,
    /// What is drawn in them.
    drawn: String,
    along: Option<AlongLine>,
    parameters: Vec<ParameterRow>,
    /// Whether a parameter has a remark.
    remarks: bool,
    fit: Option<FitText>,
    issues: Vec<IssueText>,
    same_condition: Vec<RunLink>,
    diagnosis: Option<DiagnosisLine>,
    evidence: Evidence,
    climate: Option<ClimatePanel>,
}

/// What the diagnosis says of the run alone, and where its group's page is.
#[derive(Debug, Serialize)]
struct DiagnosisLine {
    alone: String,
    group: Option<RunLink>,
}

/// What was measured along the strip, and where it is shown.
#[derive(Debug, Serialize)]
struct AlongLine {
    places: String,
    href: String,
    /// Whether the distributed model is needed; empty where nothing says so.
    decision: String,
}

#[derive(Debug, Serialize)]
struct Response {
    heading: String,
    /// Ids of the figures.
    figures: Vec<String>,
    /// `All 491 readings are drawn.`
    note: String,
    /// Whether its figure stands in a row of its own.
    own_row: bool,
}

#[derive(Debug, Serialize)]
struct ParameterRow {
    symbol: String,
    name: String,
    unit: String,
    estimate: EstimateText,
}

#[derive(Debug, Serialize)]
struct FitText {
    model: String,
    method: String,
    convergence: String,
    r_squared: Vec<(String, String)>,
}

/// Makes the page of run number `run` with its curves.
pub fn content(
    site: &Site,
    run: usize,
    curves: &[RunCurve],
    climate: &[ClimateCurve],
) -> Result<Content, ReportError> {
    let record = &site.input.runs[run];
    let mut figures = BTreeMap::new();
    let views = views(record.drive.as_ref(), curves);
    let responses: Result<Vec<Response>, ReportError> = curves
        .iter()
        .map(|curve| drawn(&views, curve, &mut figures))
        .collect();
    let climate = climate_panel(record, climate, site.run_name(run), &mut figures)?;
    let mut issues: Vec<IssueText> = worst_first(record).collect();
    issues.dedup();
    let mut responses: Vec<Response> = responses?
        .into_iter()
        .filter(|response| !response.figures.is_empty())
        .collect();
    if let Some(voltage) = voltage(record.drive.as_ref(), curves, &mut figures)? {
        responses.insert(0, voltage);
    }
    let rows = record.fit.as_ref().map_or_else(Vec::new, parameters);
    let page = RunPage {
        name: site.run_name(run).to_owned(),
        path: record.path.clone(),
        condition: condition(site, run),
        summary: summary(record),
        drawn: drawn_words(&views, curves),
        responses,
        along: record.is_along().then(|| AlongLine {
            places: super::along::places(record),
            href: site.strip_href(run),
            decision: super::along::decision(record),
        }),
        remarks: rows.iter().any(|row| !row.estimate.reason.is_empty()),
        parameters: rows,
        fit: record.fit.as_ref().map(|fit| fit_text(fit, record)),
        issues,
        same_condition: same_condition(site, run),
        diagnosis: diagnosis(site, run),
        evidence: evidence(site, record),
        climate,
    };
    Content::new("run.html", &page, figures)
}

/// `CNaf in air, 34 % RH, 2.5 V`, as far as it is known.
pub(super) fn condition(site: &Site, run: usize) -> String {
    let record = &site.input.runs[run];
    let conditions = &site.conditions;
    let place = conditions
        .measured
        .iter()
        .find(|condition| condition.runs.contains(&run));
    let mut parts: Vec<String> = Vec::new();
    parts.extend(material(record, &site.input.campaign).map(str::to_owned));
    if let Some(surroundings) = place.map(|place| &conditions.surroundings[place.surroundings]) {
        parts.push(format!("in {}", surroundings.environment));
        if let Some(percent) = record.tag_number(crate::domain::tag::keys::RELATIVE_HUMIDITY_PERCENT) {
            parts.push(format!("at {} % RH", significant(percent, 3)));
        } else if surroundings.humidity_varies {
            parts.push(humidity_label(surroundings));
        }
    }
    parts.extend(nominal_voltage_v(record).map(|voltage| format!("stepped to {}", voltage_label(voltage))));
    parts.join(" ").trim().to_owned()
}

fn summary(record: &RunRecord) -> Vec<String> {
    let Some(fit) = &record.fit else {
        return vec![format!("Not fitted: {}.", why_unfitted(record))];
    };
    let mut sentences = Vec::new();
    if !fit.converged {
        sentences.push(format!(
            "The fit did not converge: {}. Its numbers are not to be used.",
            fit.why_stopped
        ));
    }
    sentences.extend(fit.noise.iter().map(noise_sentence));
    let undetermined = fit
        .parameters
        .iter()
        .filter(|parameter| parameter.estimate.value.is_none());
    let symbols: Vec<String> = undetermined.map(|parameter| symbol_of(&parameter.key)).collect();
    if !symbols.is_empty() {
        sentences.push(format!(
            "Not determined by this run: {}.",
            super::wording::listed(&symbols)
        ));
    }
    sentences
}

fn diagnosis(site: &Site, run: usize) -> Option<DiagnosisLine> {
    let findings = &site.input.findings;
    let path = &site.input.runs[run].path;
    let alone = findings.runs.iter().find(|found| found.group == *path);
    let group = site.finding_of_run(run).map(|place| RunLink {
        href: site.finding_href(place),
        name: findings.groups[place].group.clone(),
    });
    let alone = alone.map_or_else(String::new, |found| found.sentence.clone());
    (group.is_some() || !alone.is_empty()).then_some(DiagnosisLine { alone, group })
}

/// How the residual of one channel compares with its noise.
fn noise_sentence(noise: &ChannelNoise) -> String {
    let channel = noise.quantity.label();
    let ratio = noise.residual_rms / noise.standard_deviation;
    if !ratio.is_finite() {
        return format!("{channel}: the noise could not be estimated, so the residuals cannot be judged.");
    }
    let times = format!("{} × the noise", significant(ratio, 2));
    let correlated = noise.residual_autocorrelation >= CORRELATED;
    let correlation = format!(
        "lag-1 autocorrelation {}",
        fixed(noise.residual_autocorrelation, 2)
    );
    if ratio <= WITHIN_NOISE && !correlated {
        return format!("{channel}: residual rms {times}; the model describes the readings.");
    }
    if ratio >= SYSTEMATIC {
        return format!(
            "{channel}: systematic misfit, residual rms {times} ({correlation}); the model lacks something."
        );
    }
    if correlated {
        return format!(
            "{channel}: residual rms {times}, but neighbouring residuals go together ({correlation}): a small systematic misfit."
        );
    }
    format!("{channel}: residual rms {times}; more than noise alone.")
}

fn symbol_of(key: &str) -> String {
    ParameterInfo::of(key).map_or_else(|| key.to_owned(), |parameter| parameter.symbol.to_owned())
}

fn drawn(
    views: &[View],
    curve: &RunCurve,
    figures: &mut BTreeMap<String, String>,
) -> Result<Response, ReportError> {
    let quantity = curve.quantity;
    let mut ids = Vec::new();
    for &(suffix, view, words) in views {
        let id = format!("{}-{suffix}", quantity.key().replace('_', "-"));
        let title = format!("{} over {words}", quantity.label());
        let figure = response(curve, view, &title, "").map_err(|reason| ReportError::Figure {
            figure: id.clone(),
            reason,
        })?;
        if let Some(svg) = figure {
            figures.insert(id.clone(), svg);
            ids.push(id);
        }
    }
    let shown = curve.time_s.len();
    Ok(Response {
        heading: quantity.label().to_owned(),
        figures: ids,
        note: match shown < curve.readings {
            true => format!("{shown} of {} readings.", curve.readings),
            false => format!("{}.", counted(curve.readings, "reading")),
        },
        own_row: false,
    })
}

/// The drive over the whole run, where it changes more than once.
fn voltage(
    drive: Option<&Drive>,
    curves: &[RunCurve],
    figures: &mut BTreeMap<String, String>,
) -> Result<Option<Response>, ReportError> {
    const ID: &str = "voltage";
    let Some(drive) = drive.filter(|drive| drive.segments.len() > 1) else {
        return Ok(None);
    };
    let times = || curves.iter().flat_map(|curve| curve.time_s.iter().copied());
    let (first_s, last_s) = (
        times().fold(f64::INFINITY, f64::min),
        times().fold(f64::NEG_INFINITY, f64::max),
    );
    if first_s >= last_s {
        return Ok(None);
    }
    let drawn = figures::drive::drive(drive, (first_s, last_s), "Voltage over the whole run");
    let svg = drawn.map_err(|reason| ReportError::Figure {
        figure: ID.to_owned(),
        reason,
    })?;
    figures.insert(ID.to_owned(), svg);
    let opens = drive
        .segments
        .iter()
        .any(|segment| segment.level == Level::OpenCircuit);
    Ok(Some(Response {
        heading: "Voltage".to_owned(),
        figures: vec![ID.to_owned()],
        note: match opens {
            true => "What drives the run; no line where the circuit is open.".to_owned(),
            false => "What drives the run.".to_owned(),
        },
        own_row: true,
    }))
}

/// What dots, lines and the time axis are, once for all responses of a page.
fn drawn_words(views: &[View], curves: &[RunCurve]) -> String {
    let fitted = curves.iter().any(|curve| !curve.fitted.is_empty());
    let mut words = match fitted {
        true => "Dots are readings, lines the fit; below, residuals over the noise.".to_owned(),
        false => "Dots are readings; nothing is fitted.".to_owned(),
    };
    if matches!(views, [(_, TimeView::AboutStep { .. }, _)]) {
        words.push_str(" Time is logarithmic after the step.");
    }
    words.push_str(" Extremes are kept to within a pixel.");
    words
}

/// End of a figure's id, its view, and what the view is of.
type View = (&'static str, TimeView, &'static str);

/// The time axes of the responses: see [`crate::report::figures::response`].
fn views(drive: Option<&Drive>, curves: &[RunCurve]) -> Vec<View> {
    let segments = drive.map_or(&[][..], |drive| &drive.segments);
    let step_s = segments.first().map_or(0.0, |segment| segment.start_s);
    let about_step = TimeView::about_step(step_s, curves).filter(|_| segments.len() == 1);
    if let Some(view) = about_step {
        return vec![("step", view, "the time since the step")];
    }
    let since = TimeView::SinceStep {
        step_s,
        until_s: segments.get(1).map_or(f64::INFINITY, |next| next.start_s),
    };
    vec![
        ("whole", TimeView::Whole, "the whole run"),
        ("step", since, "the logarithm of the time since the step"),
    ]
}

fn parameters(fit: &Fit) -> Vec<ParameterRow> {
    let row = |parameter: &crate::domain::Parameter| {
        let known = ParameterInfo::of(&parameter.key);
        let (unit, factor) = known.map_or(("", 1.0), |known| known.shown_in(fit));
        ParameterRow {
            symbol: symbol_of(&parameter.key),
            name: known.map_or_else(String::new, |known| known.name.to_owned()),
            unit: unit.to_owned(),
            estimate: EstimateText::of(&parameter.estimate, factor),
        }
    };
    fit.parameters.iter().map(row).collect()
}

fn fit_text(fit: &Fit, record: &RunRecord) -> FitText {
    let r_squared = [
        ("current", fit.r_squared_current),
        ("curvature", fit.r_squared_curvature),
    ];
    let program = record
        .fit_code_version
        .as_deref()
        .unwrap_or("a program version that is not stored");
    let verb = if fit.converged {
        "converged"
    } else {
        "did not converge"
    };
    FitText {
        model: format!("{} version {}, fitted by {program}", fit.model, fit.model_version),
        method: fit.method.clone(),
        convergence: format!(
            "{verb} after {}{}",
            counted(fit.evaluations as usize, "evaluation"),
            // Where a search ended well there is one reason, which says nothing of this run.
            match fit.converged {
                true => String::new(),
                false => format!(": {}", said_once(&fit.why_stopped)),
            }
        ),
        r_squared: r_squared
            .into_iter()
            .filter_map(|(of, value)| Some((format!("R² of {of}"), score(value?))))
            .chain(fit.noise.iter().map(noise_pair))
            .collect(),
    }
}

/// `current: x; curvature: x` as `x`.
fn said_once(reasons: &str) -> &str {
    let of_each = || {
        reasons
            .split("; ")
            .map(|reason| reason.split_once(": ").map(|(_, why)| why))
    };
    match of_each().next().flatten() {
        Some(first) if of_each().count() > 1 && of_each().all(|reason| reason == Some(first)) => first,
        _ => reasons,
    }
}

/// Noise of a channel and where its estimate comes from.
fn noise_pair(noise: &ChannelNoise) -> (String, String) {
    let amount = in_unit(noise.standard_deviation, noise.quantity.unit());
    let label = format!("{} noise", noise.quantity.label().to_lowercase());
    (
        label,
        format!(
            "{amount} ({}; {})",
            noise.basis,
            counted(noise.readings, "reading")
        ),
    )
}

/// Issues of the run and of its fit, errors first.
fn worst_first(record: &RunRecord) -> impl Iterator<Item = IssueText> {
    let mut issues: Vec<_> = record
        .issues
        .iter()
        .chain(record.fit.iter().flat_map(|fit| &fit.issues))
        .collect();
    issues.sort_by_key(|issue| std::cmp::Reverse(issue.severity));
    issues
        .into_iter()
        .map(IssueText::from)
        .collect::<Vec<_>>()
        .into_iter()
}

fn same_condition(site: &Site, run: usize) -> Vec<RunLink> {
    let conditions = &site.conditions.measured;
    let here = conditions.iter().find(|condition| condition.runs.contains(&run));
    let runs = here.map_or(&[][..], |condition| &condition.runs);
    runs.iter()
        .filter(|&&other| other != run)
        .map(|&other| RunLink::to(site, other))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::domain::Quantity;

    fn noise(residual_rms: f64, residual_autocorrelation: f64) -> ChannelNoise {
        ChannelNoise {
            quantity: Quantity::Current,
            standard_deviation: 1e-6,
            basis: "differences of neighbours".to_owned(),
            character: Default::default(),
            residual_autocorrelation,
            residual_rms,
            readings: 1200,
            r_squared: None,
        }
    }

    #[test]
    fn one_step_has_one_figure_and_a_logarithmic_view_ends_at_the_next_change_of_the_drive() {
        let curves = [RunCurve {
            quantity: Quantity::Current,
            time_s: vec![-1.0, 0.5, 600.0],
            measured: vec![0.0; 3],
            fitted: vec![],
            residual_sigma: vec![],
            readings: 3,
        }];
        let mut drive = Drive::step(2.5);
        let about = TimeView::AboutStep {
            step_s: 0.0,
            first_s: -1.0,
            next_s: 0.5,
            last_s: 600.0,
        };
        assert_eq!(views(Some(&drive), &curves)[0].1, about);
        drive.segments[0].start_s = 10.0;
        drive.segments.push(crate::domain::Segment {
            start_s: 300.0,
            level: crate::domain::Level::OpenCircuit,
        });
        let since = |step_s, until_s| TimeView::SinceStep { step_s, until_s };
        assert_eq!(views(Some(&drive), &curves)[1].1, since(10.0, 300.0));
        assert_eq!(views(None, &curves)[1].1, since(0.0, f64::INFINITY));
    }

    #[test]
    fn residuals_are_judged_against_noise_and_correlation() {
        assert!(noise_sentence(&noise(1.2e-6, 0.1)).contains("1.2 × the noise; the model describes"));
        assert!(noise_sentence(&noise(1.2e-6, 0.9)).contains("small systematic misfit"));
        assert!(
            noise_sentence(&noise(20e-6, 0.99)).contains("systematic misfit, residual rms 20 × the noise")
        );
        assert!(noise_sentence(&noise(2e-6, 0.0)).contains("more than noise alone"));
        let silent = ChannelNoise {
            standard_deviation: 0.0,
            ..noise(1.0, 0.0)
        };
        assert!(noise_sentence(&silent).contains("could not be estimated"));
    }
}
