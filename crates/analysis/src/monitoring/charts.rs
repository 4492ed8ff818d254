//! Pictures of parameters over the life of their samples.

use ieap_domain::quantiles::NORMAL_95_ROUNDED;
use ieap_domain::range_of;
use ieap_domain::words::capital;
use ieap_show::{Chart, Ink, Layer, Mark, Panel, Range};

use super::lives::Lives;
use super::series::{Series, Study};
use super::{Watched, words};
use crate::laws::words::symbol;
use crate::parameters::usable;
use ieap_domain::ParameterInfo;

/// Places at which a trend is drawn.
const DRAWN: usize = 60;
/// Readings at most that are drawn one by one.
const MOST_MARKS: usize = 300;
/// Numbers that span more than this factor stand on a logarithmic axis.
const SPANS: f64 = 5.0;

/// A watched parameter over the life of its sample, with its control chart below; none where all runs stand at one place.
pub fn life(lives: &Lives, watched: &Watched) -> Option<Chart> {
    let name = ParameterInfo::of(&watched.parameter).map_or("", |info| info.name);
    let title = format!("{} {name}", symbol(&watched.parameter));
    let panels = [Some(of_life(lives, watched)?), control(lives, watched)];
    let chart = Chart::new(title.trim_end(), panels.into_iter().flatten().collect());
    Some(chart.told(words::life(watched)))
}

/// The same for print: without the control chart, and with the name of the sample.
pub fn printed(lives: &Lives, watched: &Watched) -> Option<Chart> {
    let title = format!("{} of {}", symbol(&watched.parameter), watched.sample);
    Some(Chart::new(title, vec![of_life(lives, watched)?]))
}

/// The axis of a life.
fn axis(watched: &Watched) -> Range {
    let label = capital(watched.axis.label());
    Range::linear(
        match watched.axis.unit() {
            "" => label,
            unit => format!("{label} ({unit})"),
        },
        "",
    )
}

fn of_life(lives: &Lives, watched: &Watched) -> Option<Panel> {
    let (series, study) = (&watched.series, &watched.study);
    if study.span.length() <= 0.0 {
        return None;
    }
    let info = ParameterInfo::of(&watched.parameter);
    let factor = info.map_or(1.0, |info| info.shown_factor());
    let on_scale = |y: f64| factor * if series.is_log { y.exp() } else { y };
    let every = series.x.len().div_ceil(MOST_MARKS);
    let drawn = || (0..series.x.len()).step_by(every);
    let bar = |k: usize| {
        let reach = NORMAL_95_ROUNDED * series.variance[k].sqrt();
        (on_scale(series.y[k] - reach), on_scale(series.y[k] + reach))
    };
    let points = drawn().map(|k| (series.x[k], on_scale(series.y[k])));
    let runs = drawn().map(|k| lives.of.runs[watched.runs[k]].path.clone());
    let marks = Layer::new("Runs", Mark::Marks, Ink::FIRST, points)
        .with_bars(drawn().map(bar).collect())
        .of_runs(runs.collect());
    let limits = (watched.limit.iter()).filter_map(|(limit, _)| limit.below.or(limit.above));
    let limits = limits.map(|limit| (0.0, limit * factor));
    let mut layers = vec![
        Layer::new("Limit", Mark::Level, Ink::Limit, limits),
        Layer::guides(Mark::Upright, words::steps(watched).iter().map(|step| step.at)),
    ];
    layers.extend(trend(series, study, on_scale));
    layers.push(marks);
    let shown = layers.iter().flat_map(|layer| {
        let bars = layer.bars.iter().flat_map(|bar| [bar.0, bar.1]);
        let is_seen = layer.mark != Mark::Upright;
        let points = layer.points.iter().map(|at| at.1).filter(move |_| is_seen);
        points.chain(bars.filter(|_| layer.mark == Mark::Marks))
    });
    let (low, high) = range_of(shown);
    layers.extend(set_aside(lives, watched, factor));
    layers.retain(|layer| !layer.points.is_empty());
    let (name, unit) = info.map_or((watched.parameter.clone(), ""), |info| {
        (info.symbol.to_owned(), info.shown_unit())
    });
    let y = if series.is_log && low > 0.0 && high / low > SPANS {
        Range::log(name, unit)
    } else {
        Range::linear(name, unit)
    };
    let x = axis(watched);
    Some(Panel { x, y, layers })
}

/// The trend since the last jump with its band, where one is shown, by what a number of the series is on the axis.
pub fn trend(series: &Series, study: &Study, on_axis: impl Fn(f64) -> f64) -> Option<Layer> {
    let law = study.trends.first().filter(|_| study.is_shown())?;
    let from = study
        .steps
        .last()
        .map_or(study.span.low, |step| series.x[step.at]);
    let place = |k: usize| from + (study.span.high - from) * k as f64 / (DRAWN - 1) as f64;
    let of_size = |size: f64| -> Vec<f64> {
        let course = series.course(study, law, size);
        (0..DRAWN).map(|k| on_axis(course(place(k)))).collect()
    };
    let [value, low, high] = [Some(law.size.value), law.size.low_95, law.size.high_95]
        .map(|size| of_size(size.unwrap_or(law.size.value)));
    let bars = low.iter().zip(&high).map(|(a, b)| (a.min(*b), a.max(*b)));
    let points = value.into_iter().enumerate().map(|(k, y)| (place(k), y));
    Some(Layer::new("Trend", Mark::Line, Ink::Readings, points).with_bars(bars.collect()))
}

/// Condemned runs of the sample in the reference condition, each where it would stand.
fn set_aside(lives: &Lives, watched: &Watched, factor: f64) -> Vec<Layer> {
    let campaign = lives.of.campaign;
    let layer = |aside: &crate::condemned::Aside| {
        let run = &lives.of.set_aside[aside.run - lives.of.runs.len()];
        let (facts, reference) = (aside.facts.as_ref()?, lives.monitoring.reference.as_ref()?);
        let is_here =
            facts.sample == watched.sample && reference.holds(run, facts, lives.facts, &campaign.monitoring);
        let place = facts.numbers.get(&watched.axis).filter(|_| is_here)?;
        let estimate = usable(run, &watched.parameter)?;
        let value = estimate.value.filter(|value| value.is_finite())?;
        let end = |end: Option<f64>| factor * end.filter(|end| end.is_finite()).unwrap_or(value);
        let name = format!("{}, set aside", campaign.run_name(&run.path));
        let point = [(place.value, factor * value)];
        let bars = vec![(end(estimate.low_95), end(estimate.high_95))];
        let layer = Layer::new(name, Mark::Marks, Ink::Guide, point)
            .with_bars(bars)
            .aside();
        Some(layer.of_runs(vec![run.path.clone()]))
    };
    lives.aside.iter().filter_map(layer).collect()
}

/// The control chart: the statistic between its limits, and what lies beyond them. None where it has no two readings.
fn control(lives: &Lives, watched: &Watched) -> Option<Panel> {
    let chart = &watched.study.chart;
    if chart.statistic.len() < 2 {
        return None;
    }
    let of = |readings: Vec<&(usize, f64)>, name: &str, mark: Mark, ink: Ink| {
        let points = readings.iter().map(|(at, value)| (watched.series.x[*at], *value));
        let runs = readings
            .iter()
            .map(|(at, _)| lives.of.runs[watched.runs[*at]].path.clone());
        Layer::new(name, mark, ink, points).of_runs(runs.collect())
    };
    let beyond = chart
        .statistic
        .iter()
        .filter(|(_, value)| value.abs() > chart.limit);
    let beyond = of(beyond.collect(), "Beyond its limits", Mark::Marks, Ink::Limit);
    let limits = [-chart.limit, chart.limit].map(|limit| (0.0, limit));
    let mut layers = vec![
        Layer::guides(Mark::Level, [0.0]),
        Layer::new("", Mark::Level, Ink::Limit, limits),
        of(
            chart.statistic.iter().collect(),
            "EWMA",
            Mark::DottedLine,
            Ink::FIRST,
        ),
    ];
    layers.extend((!beyond.points.is_empty()).then_some(beyond));
    let (x, y) = (axis(watched), Range::linear("EWMA", ""));
    Some(Panel { x, y, layers })
}
