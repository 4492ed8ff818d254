//! Monitoring: alarms first, when limits are reached, then every parameter over the life of the samples in the reference
//! condition.

use ieap_domain::quantiles::NORMAL_95_ROUNDED;
use ieap_domain::range_of;
use ieap_domain::words::counted;
use std::collections::{BTreeMap, BTreeSet};

use serde::Serialize;

use super::Content;
use super::control_chart::{ChartNumbers, chart_numbers, draw_chart};
use super::electrodes::{Electrodes, electrodes};
use super::forecasts::{Forecast, forecasts, moment};
use super::wording::{RunLink, readable};
use crate::aside::{AsideRow, Shown, beyond_words, marks};
use crate::error::ReportError;
use crate::figures::aside::AsideMark;
use crate::figures::axis::Axis;
use crate::figures::law::{Beside, Curve, LawFigure, Mark};
use crate::input::Input;
use crate::pages::policy::OPEN_ALARMS;
use crate::site::Site;
use ieap_analysis::ParameterInfo;
use ieap_analysis::laws::doubt::Doubted;
use ieap_analysis::laws::words::{moves, symbol};
use ieap_analysis::monitoring::{Watched, words};
use ieap_domain::number::significant;

/// Places at which a trend is drawn.
const DRAWN: usize = 60;
/// Readings at most that are drawn one by one.
const MOST_MARKS: usize = 300;

#[derive(Debug, Serialize)]
struct MonitoringPage {
    summary: Vec<String>,
    alarms: Vec<AlarmRow>,
    /// Alarms that are folded.
    more_alarms: Vec<AlarmRow>,
    forecasts: Vec<Forecast>,
    steps: Vec<StepRow>,
    split: Vec<String>,
    samples: Vec<SampleSection>,
    /// The electrodes by the probe.
    #[serde(skip_serializing_if = "Option::is_none")]
    electrodes: Option<Electrodes>,
    charts: String,
    /// Runs whose readings are known to be wrong.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    aside: Vec<AsideRow>,
}

#[derive(Debug, Serialize)]
struct AlarmRow {
    id: String,
    message: String,
    link: Option<RunLink>,
    acknowledged: bool,
}

#[derive(Debug, Serialize)]
struct SampleSection {
    sample: String,
    panels: Vec<Panel>,
}

#[derive(Debug, Serialize)]
struct Panel {
    parameter: String,
    sentence: String,
    figure: Option<String>,
    /// Runs set aside that lie beyond the axes.
    #[serde(skip_serializing_if = "String::is_empty")]
    beyond: String,
    /// Id of the figure of the control chart.
    control: Option<String>,
    /// Whether it signals.
    is_alarm: bool,
    chart: ChartNumbers,
    axes: Vec<String>,
}

#[derive(Debug, Serialize)]
struct StepRow {
    parameter: String,
    when: String,
    size: String,
    what: String,
}

/// Whether a report of that input has the page.
pub fn is_shown(input: &Input) -> bool {
    let rules = &input.campaign.monitoring;
    !input.monitoring.watched.is_empty()
        || !input.electrodes.is_empty()
        || !rules.reference.is_empty()
        || !rules.limits.is_empty()
}

/// Makes the page.
pub fn content(site: &Site) -> Result<Content, ReportError> {
    let monitoring = &site.input.monitoring;
    let mut figures = BTreeMap::new();
    let mut samples: Vec<SampleSection> = Vec::new();
    let mut shown = Shown::default();
    for (number, watched) in monitoring.watched.iter().enumerate() {
        let aside = aside(site, watched);
        let drawn = draw(watched, &aside, number)?;
        if drawn.is_some() {
            shown.note(&aside);
        }
        let (figure, beyond) = match drawn {
            Some(Drawn { id, svg, beyond }) => {
                figures.insert(id.clone(), svg);
                (Some(id), beyond)
            }
            None => (None, String::new()),
        };
        let control = draw_chart(site, (number, watched), &life_axis(watched), &mut figures)?;
        if samples.last().is_none_or(|last| last.sample != watched.sample) {
            samples.push(SampleSection {
                sample: watched.sample.clone(),
                panels: Vec::new(),
            });
        }
        if let Some(last) = samples.last_mut() {
            last.panels.push(panel(site, watched, (figure, beyond), control));
        }
    }
    let electrodes = electrodes(site, &mut figures)?;
    let mut alarms: Vec<AlarmRow> = monitoring
        .alarms
        .iter()
        .map(|alarm| AlarmRow {
            id: alarm.id.clone(),
            message: readable(&alarm.message),
            link: site.run_of(&alarm.run).map(|run| RunLink::to(site, run)),
            acknowledged: alarm.acknowledged,
        })
        .collect();
    // Those that are known stand last.
    alarms.sort_by_key(|alarm| alarm.acknowledged);
    let more_alarms = alarms.split_off(OPEN_ALARMS.min(alarms.len()));
    let page = MonitoringPage {
        summary: summary(site),
        alarms,
        more_alarms,
        forecasts: forecasts(site),
        steps: monitoring
            .watched
            .iter()
            .flat_map(|watched| steps(site, watched))
            .collect(),
        split: monitoring.split.clone(),
        samples,
        electrodes,
        charts: charts_text(site),
        aside: shown.rows(site),
    };
    Content::new("monitoring.html", &page, figures)
}

fn summary(site: &Site) -> Vec<String> {
    let monitoring = &site.input.monitoring;
    let Some(reference) = &monitoring.reference else {
        return vec![format!("Nothing is watched: {}.", monitoring.why_not)];
    };
    let new = monitoring
        .alarms
        .iter()
        .filter(|alarm| !alarm.acknowledged)
        .count();
    let lead = match new {
        0 => "No alarm.".to_owned(),
        some => format!("{}.", counted(some, "alarm")),
    };
    let how = if reference.is_named {
        "named in campaign.toml"
    } else {
        "the condition repeated most"
    };
    let mut sentences = vec![
        lead,
        format!(
            "The reference condition is {} ({how}): {} of {} return to it.",
            reference.text,
            counted(reference.places.len(), "run"),
            site.input.runs.len()
        ),
    ];
    sentences.extend(in_doubt(site));
    sentences
}

/// Groups of watched runs whose fits a finding doubts. None is left out: what is wrong in all of them alike is no change.
fn in_doubt(site: &Site) -> Option<String> {
    let watched = site
        .input
        .monitoring
        .watched
        .iter()
        .flat_map(|watched| &watched.runs);
    let watched: BTreeSet<&str> = watched.map(|&run| site.input.runs[run].path.as_str()).collect();
    let has_some = |found: &&Doubted| found.runs.iter().any(|run| watched.contains(run.as_str()));
    let groups: BTreeSet<&str> = site
        .input
        .laws
        .doubted
        .iter()
        .filter(has_some)
        .map(|found| found.group.as_str())
        .collect();
    let names: Vec<&str> = groups.into_iter().collect();
    (!names.is_empty()).then(|| {
        format!(
            "The model is wrong for {}: its runs are watched all the same, since what is wrong in all of them alike is no \
             change; where the cause is known the errors hold what it moves each parameter by.",
            names.join("; ")
        )
    })
}

fn charts_text(site: &Site) -> String {
    let monitoring = &site.input.monitoring;
    format!(
        "Control charts (EWMA): centre at 0 and limits in standard deviations; what lies beyond a limit is marked, the first \
         such run with its date. All {} of a sample together give a false alarm every {} reference runs on average (from the \
         third run on) or more rarely. A shift by one standard deviation is seen after {} runs on average, \
         later while few runs are known.",
        counted(monitoring.charts_of_a_sample, "chart"),
        significant(monitoring.false_alarm_runs, 3),
        significant(monitoring.shifted_run_length(), 2),
    )
}

/// Condemned runs of the sample in the reference condition, where they would stand in a chart.
pub fn aside(site: &Site, watched: &Watched) -> Vec<AsideMark> {
    let (input, rules) = (site.input, &site.input.campaign.monitoring);
    marks(site, &watched.parameter, |aside| {
        let (facts, reference) = (aside.facts.as_ref()?, input.monitoring.reference.as_ref()?);
        let is_here = facts.sample == watched.sample
            && reference.holds(input.record(aside.run), facts, &input.laws.facts, rules);
        let place = facts.numbers.get(&watched.axis).filter(|_| is_here)?;
        Some(place.value)
    })
}

fn steps(site: &Site, watched: &Watched) -> Vec<StepRow> {
    let row = |step: words::StepText| StepRow {
        parameter: format!("{} of {}", symbol(&watched.parameter), watched.sample),
        when: moment(site, watched, step.at),
        size: step.size,
        what: step.what,
    };
    words::steps(watched).into_iter().map(row).collect()
}

fn panel(
    site: &Site,
    watched: &Watched,
    (figure, beyond): (Option<String>, String),
    control: Option<String>,
) -> Panel {
    let info = ParameterInfo::of(&watched.parameter);
    let name = info.map_or_else(String::new, |info| format!(" {}", info.name));
    let axes = watched.other_axes.iter().map(|(axis, law)| {
        let unit = match axis.unit() {
            "" => String::new(),
            unit => format!(" ({unit})"),
        };
        format!(
            "over {}{unit}: {}, {}",
            axis.label(),
            moves(law.size, watched.series.is_log),
            law.law.key(),
        )
    });
    Panel {
        parameter: format!("{}{name}", symbol(&watched.parameter)),
        sentence: readable(&words::life(watched)),
        figure,
        beyond,
        control,
        is_alarm: watched.study.chart.first_alarm.is_some(),
        chart: chart_numbers(site, watched),
        axes: axes.collect(),
    }
}

/// A chart over the life of a sample.
struct Drawn {
    id: String,
    svg: String,
    beyond: String,
}

/// The axis of a life, with a little room at its ends.
fn life_axis(watched: &Watched) -> Axis {
    let span = watched.study.span;
    let mut label = watched.axis.label().to_owned();
    label[..1].make_ascii_uppercase();
    let margin = 0.04 * span.length();
    let x = Axis::linear(span.low - margin, span.high + margin, &label, "", 5);
    Axis {
        title: match watched.axis.unit() {
            "" => label,
            unit => format!("{label} ({unit})"),
        },
        ..x
    }
}

fn draw(watched: &Watched, aside: &[AsideMark], number: usize) -> Result<Option<Drawn>, ReportError> {
    let Some(figure) = figure_of(watched, aside) else {
        return Ok(None);
    };
    let id = format!("life-{number}");
    let svg = figure.svg().map_err(|reason| ReportError::Figure {
        figure: id.clone(),
        reason,
    })?;
    let unit = ParameterInfo::of(&watched.parameter).map_or("", |info| info.shown_unit);
    let beyond = beyond_words(aside, (Some(&figure.x), &figure.y), unit);
    Ok(Some(Drawn { id, svg, beyond }))
}

/// The figure of a watched parameter over the life of its sample; none where there is nothing to draw.
pub fn figure_of(watched: &Watched, aside: &[AsideMark]) -> Option<LawFigure> {
    let (series, study) = (&watched.series, &watched.study);
    if study.span.length() <= 0.0 {
        return None;
    }
    let info = ParameterInfo::of(&watched.parameter);
    let factor = info.map_or(1.0, |info| info.shown_factor);
    let (name, unit) = info.map_or((watched.parameter.as_str(), ""), |info| {
        (info.symbol, info.shown_unit)
    });
    let on_scale = |y: f64| factor * if series.is_log { y.exp() } else { y };
    let every = series.x.len().div_ceil(MOST_MARKS);
    let marks: Vec<Mark> = (0..series.x.len())
        .step_by(every)
        .map(|k| {
            let reach = NORMAL_95_ROUNDED * series.variance[k].sqrt();
            Mark {
                run: None,
                came_from: 0,
                x: series.x[k],
                x_error: 0.0,
                y: on_scale(series.y[k]),
                bar: (on_scale(series.y[k] - reach), on_scale(series.y[k] + reach)),
                style: 0,
            }
        })
        .collect();
    let law = study.trends.first().filter(|_| study.is_shown());
    let mut curve = Curve::default();
    if let Some(law) = law {
        let last_step = study
            .steps
            .last()
            .map_or(study.span.low, |step| series.x[step.at]);
        for k in 0..DRAWN {
            let x = last_step + (study.span.high - last_step) * k as f64 / (DRAWN - 1) as f64;
            let at = |size: f64| on_scale(series.course(study, law, size)(x));
            let ends = [law.size.low_95, law.size.high_95].map(|end| at(end.unwrap_or(law.size.value)));
            curve.x.push(x);
            curve.y.push(at(law.size.value));
            curve.band.push((ends[0].min(ends[1]), ends[0].max(ends[1])));
        }
    }
    let limits: Vec<f64> = watched
        .limit
        .iter()
        .filter_map(|(limit, _)| limit.below.or(limit.above))
        .map(|limit| limit * factor)
        .collect();
    let shown = marks
        .iter()
        .flat_map(|mark| [mark.y, mark.bar.0, mark.bar.1])
        .chain(curve.y.iter().copied())
        .chain(limits.iter().copied());
    let (low, high) = range_of(shown);
    let y = if series.is_log && low > 0.0 && high / low > 5.0 {
        Axis::log(low / 1.2, high * 1.2, name, unit)
    } else {
        Axis::linear_rounded(low, high, name, unit, 5)
    };
    let beside = Beside {
        law: curve,
        limits,
        changes: words::steps(watched).iter().map(|step| step.at).collect(),
        aside: aside.to_vec(),
        ..Beside::default()
    };
    Some(LawFigure {
        title: format!("{name} of {} over {}", watched.sample, watched.axis.label()),
        desc: words::life(watched),
        x: life_axis(watched),
        y,
        marks,
        beside,
    })
}
