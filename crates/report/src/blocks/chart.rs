//! Draws a chart: on a page, and for print as wide as it is asked.

use std::collections::{BTreeMap, BTreeSet};

use plotters::element::{Circle, PathElement, Polygon, Rectangle};
use plotters::series::DashedLineSeries;
use plotters::style::{Color, ShapeStyle};
use serde::Serialize;

use crate::aside::beyond_words;
use crate::figures::Ink;
use crate::figures::aside::{AsideMark, draw_aside};
use crate::figures::axis::{Axis, finite_range};
use crate::figures::calendar::calendar_axis;
use crate::figures::canvas::{Area, Drawing, PAGE_WIDTH, TENTHS, drawing as drawn};
use crate::figures::comparison::{self, marker};
use crate::figures::group::{Group, aside_series, grouped, series};
use crate::figures::panel::{self, Margins, panel};
use crate::figures::{svg, thin};
use crate::print_figures::grid;
use crate::site::Site;
use ieap_analysis::zone::Zone;
use ieap_domain::words::in_a_row;
use ieap_show as show;
use ieap_show::{Chart, Form, Layer, Mark, Panel, Range, Scale};

/// Height of a panel, px.
const PANEL_HEIGHT: u32 = 150;
/// Height of one that stands alone, px.
const HIGH: u32 = 210;
/// Height of those after the first one of many, px.
const LOW_HEIGHT: u32 = 100;
/// Width of a wide picture on a page, px.
const WIDE: u32 = 760;
/// Width and height of a picture with equal scales on a page, px.
const SQUARE: (u32, u32) = (380, 330);
/// Room under the lowest panel for its axis, px.
const AXIS_HEIGHT: u32 = 42;
/// Room about what is drawn, as a part of its range, or as a factor on a logarithmic axis.
const ROOM: f64 = 0.06;
const LOG_ROOM: f64 = 1.2;
/// Width of lines, tenths of a px.
const LINE: u32 = 14;
const GUIDE: u32 = 8;
const RING: u32 = 9;
/// Radius of readings, tenths of a px, and the least.
const DOT: i32 = 22;
const SMALL_DOT: i32 = 9;
/// The same of series that have an order: rings of several would hide each other.
const ORDERED_DOT: i32 = 14;
/// Fewer readings than these hide nothing.
const FEW: usize = 20;
/// From so many readings on they are drawn as dots.
const MOST_RINGS: usize = 80;
/// The marks of [`marker`] as paths in a square of 100.
const MARKS: [&str; 5] = [
    "M50 14a36 36 0 1 0 .1 0z",
    "M17 17h66v66h-66z",
    "M50 6l42 76h-84z",
    "M50 2l48 48l-48 48l-48-48z",
    "M50 94l42-76h-84z",
];
/// Marks on a line.
const MARKS_ALONG: usize = 9;
/// Dashes of an upright line.
const DASHES: u32 = 12;
/// Opacity of bands and of what is shaded, and the least width of that as a part of the axis.
const PALE: f64 = 0.18;
const LEAST_SPAN: f64 = 0.0015;
/// Opacity of curves that are set aside, their open dots, about, and dash and gap of their lines, tenths of a px.
const OF_ASIDE: f64 = 0.45;
const MOST_OPEN: usize = 60;
const DASH: (u32, u32) = (60, 45);
/// What a legend calls runs that no result is made from.
const SET_ASIDE: &str = "Set aside";

/// How a layer is told on a page.
#[derive(Debug, PartialEq, Serialize)]
pub struct Key {
    /// Class of its colour.
    class: &'static str,
    /// Whether it is drawn as a line, not as dots.
    is_line: bool,
    /// Path of its mark in a square of 100, where it has marks of its own.
    mark: Option<&'static str>,
    /// Whether no result is made from it.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    is_aside: bool,
    name: String,
    /// Its colour in a print.
    #[serde(skip)]
    ink: Ink,
}

impl Key {
    /// Of a line in that ink.
    pub fn line(name: &str, ink: Ink) -> Key {
        Key {
            class: Ink::class_of(ink),
            is_line: true,
            mark: None,
            is_aside: false,
            name: name.to_owned(),
            ink,
        }
    }

    /// Of names, each with the mark of its place.
    pub fn marks(names: &[String]) -> Vec<Key> {
        let key = |(at, name): (usize, &String)| Key {
            is_line: false,
            mark: Some(MARKS[at % MARKS.len()]),
            ..Key::line(name, Ink::SERIES[at % Ink::SERIES.len()])
        };
        names.iter().enumerate().map(key).collect()
    }
}

/// The legend: each named layer once.
pub fn keys(chart: &Chart) -> Vec<Key> {
    let mut keys: Vec<Key> = Vec::new();
    for layer in chart.panels.iter().flat_map(|panel| &panel.layers) {
        let is_aside = layer.is_aside;
        let name = if is_aside { SET_ASIDE } else { layer.name.as_str() };
        let is_ordered = matches!(layer.ink, show::Ink::Ordered(..));
        let is_known = |key: &Key| key.name == name || is_ordered && key.ink == ink(layer.ink);
        if !name.is_empty() && !keys.iter().any(is_known) {
            keys.push(Key {
                is_aside,
                class: Ink::class_of(ink(layer.ink)),
                ink: ink(layer.ink),
                mark: (layer.mark == Mark::Marks && !is_aside)
                    .then(|| MARKS[style_of(layer.ink) % MARKS.len()]),
                is_line: is_ordered
                    || matches!(
                        layer.mark,
                        Mark::Line | Mark::DottedLine | Mark::MarkedLine | Mark::Level | Mark::Upright
                    ),
                name: name.to_owned(),
            });
        }
    }
    keys
}

/// What a picture shows, for who does not see it.
pub fn described(chart: &Chart) -> String {
    let names = keys(chart).into_iter().map(|key| key.name);
    let names = names.collect::<Vec<_>>().join(", ");
    [names.as_str(), chart.caption.as_str()].join(". ")
}

/// Width of a picture on a page, px.
pub fn width_on_page(chart: &Chart) -> u32 {
    match chart.form {
        Form::Plain => PAGE_WIDTH,
        Form::Wide => WIDE,
        Form::EqualScales => SQUARE.0,
    }
}

/// Runs that lie beyond the axes, in words; empty where none does.
pub fn beyond(chart: &Chart) -> String {
    let of_panel = |panel: &Panel| {
        let (x, y) = axes(chart, panel, None);
        let marks: Vec<AsideMark> = panel.layers.iter().flat_map(aside_marks).collect();
        if marks.is_empty() {
            return String::new();
        }
        beyond_words(&marks, (Some(&x), &y), &panel.y.unit)
    };
    chart.panels.iter().map(of_panel).collect()
}

/// Draws a chart for print: that wide, with its legend above and its caption below.
///
/// # Errors
/// The message of the drawing library.
pub fn print(chart: &Chart, width: u32) -> Result<Drawing, String> {
    prints(std::slice::from_ref(chart), 1, width)
}

/// The same of several, in so many columns: with one legend where no colour has two names, else each has its own.
///
/// # Errors
/// The message of the drawing library.
pub fn prints(charts: &[Chart], columns: usize, width: u32) -> Result<Drawing, String> {
    let (mut legend, mut notes, mut tallest) = (Vec::new(), Vec::new(), 0);
    let mut panels = Vec::new();
    for chart in charts {
        legend.extend(legend_of(chart));
        notes.extend((!chart.caption.is_empty()).then(|| chart.caption.clone()));
        tallest = tallest.max(height(chart, width));
    }
    let (mut named, mut told) = (BTreeSet::new(), BTreeSet::new());
    legend.retain(|(name, _): &(String, Ink)| named.insert(name.clone()));
    notes.retain(|note: &String| told.insert(note.clone()));
    let is_shared = tells_apart(&legend) || charts.iter().all(|chart| legend_of(chart) == legend);
    for chart in charts {
        panels.push(grid::Panel {
            title: chart.title.clone(),
            draw: Box::new(move |area| {
                if is_shared {
                    return draw(area, chart, None);
                }
                draw(&grid::draw_entries(area, &legend_of(chart))?, chart, None)
            }),
        });
    }
    if !is_shared {
        legend.clear();
    }
    notes.extend(set_aside_words(charts));
    grid::grid(width, columns, tallest, &legend, &panels, &notes)
}

/// What a print says of the runs that no result is made from.
fn set_aside_words(charts: &[Chart]) -> Vec<String> {
    let mut marked: BTreeSet<&str> = BTreeSet::new();
    // Whether the curves of a run lie within the axes of any chart.
    let mut curves: BTreeMap<&str, bool> = BTreeMap::new();
    for chart in charts {
        for panel in &chart.panels {
            let (x, y) = axes(chart, panel, None);
            for layer in panel.layers.iter().filter(|layer| layer.is_aside) {
                if layer.mark == Mark::Marks {
                    marked.insert(&layer.name);
                } else {
                    let seen = layer.points.iter().filter(|at| x.shows(at.0) && y.shows(at.1));
                    *curves.entry(&layer.name).or_default() |= 2 * seen.count() > layer.points.len();
                }
            }
        }
    }
    let of_curve = |(name, is_within)| {
        if is_within {
            format!("Open dots, dashed: set aside, in no result: {name}.")
        } else {
            format!("Set aside, mostly outside the axes: {name}.")
        }
    };
    let mut said: Vec<String> = curves.into_iter().map(of_curve).collect();
    if !marked.is_empty() {
        let names: Vec<&str> = marked.into_iter().collect();
        said.push(format!(
            "Crossed, in no number, at an arrow where beyond the axes: {}.",
            in_a_row(&names)
        ));
    }
    said
}

/// The legend of a print: readings are told by their dots, of which a legend of lines has none.
fn legend_of(chart: &Chart) -> Vec<(String, Ink)> {
    let lines = keys(chart)
        .into_iter()
        .filter(|key| !key.is_aside && (key.is_line || key.mark.is_some()));
    lines.map(|key| (key.name, key.ink)).collect()
}

/// Whether every colour of a legend has one name.
fn tells_apart(legend: &[(String, Ink)]) -> bool {
    let is_other = |one: &(String, Ink), other: &(String, Ink)| one.0 == other.0 || one.1 != other.1;
    legend
        .iter()
        .all(|one| legend.iter().all(|other| is_other(one, other)))
}

/// Draws a chart that is `width` px wide; its points lead to the runs of `site`, whose clock it goes by.
///
/// # Errors
/// The message of the drawing library.
pub fn drawing(chart: &Chart, width: u32, site: Option<&Site>) -> Result<Drawing, String> {
    drawn((width, height(chart, width)), |area| draw(area, chart, site))
}

/// A chart as wide as a column of a page, for one that is no block.
///
/// # Errors
/// The message of the drawing library.
pub fn inline(chart: &Chart, title: &str, desc: &str) -> Result<String, String> {
    Ok(svg::inline(&drawing(chart, PAGE_WIDTH, None)?, title, desc))
}

fn height(chart: &Chart, width: u32) -> u32 {
    match chart.form {
        Form::EqualScales => SQUARE.1 * width / SQUARE.0,
        Form::Plain | Form::Wide => {
            (0..chart.panels.len())
                .map(|at| panel_height(chart, at))
                .sum::<u32>()
                + AXIS_HEIGHT
        }
    }
}

/// Of many panels the first one, which all is about, is the highest.
fn panel_height(chart: &Chart, at: usize) -> u32 {
    match (at, chart.panels.len()) {
        (_, 1) => HIGH,
        (1.., 3..) => LOW_HEIGHT,
        _ => PANEL_HEIGHT,
    }
}

fn draw(area: &Area, chart: &Chart, site: Option<&Site>) -> Result<(), String> {
    let mut rest = area.clone();
    for (at, own) in chart.panels.iter().enumerate() {
        let is_last = at + 1 == chart.panels.len();
        let (this, below) = if is_last {
            (rest.clone(), rest)
        } else {
            rest.split_vertically(panel_height(chart, at) as i32 * TENTHS)
        };
        let margins = Margins {
            left: 62,
            right: 16,
            top: 8,
            bottom: if is_last { AXIS_HEIGHT } else { 6 },
        };
        let (x, y) = axes(chart, own, site);
        let mut drawn = panel(&this, margins, &x, &y, is_last)?;
        own.layers
            .iter()
            .try_for_each(|layer| draw_layer(&mut drawn, layer, (&x, &y), site))?;
        rest = below;
    }
    Ok(())
}

/// Axes that show what the panel holds; the horizontal one is that of all panels.
fn axes(chart: &Chart, own: &Panel, site: Option<&Site>) -> (Axis, Axis) {
    let all: Vec<&Layer> = chart.panels.iter().flat_map(|panel| &panel.layers).collect();
    let own_layers: Vec<&Layer> = own.layers.iter().collect();
    let x = shown(&own.x, &all, Mark::Level, |layer| {
        layer.points.iter().map(|at| at.0).collect()
    });
    let y = shown(&own.y, &own_layers, Mark::Upright, |layer| {
        let bars = layer.bars.iter().flat_map(|bar| [bar.0, bar.1]);
        layer
            .points
            .iter()
            .map(|at| at.1)
            .chain(bars.filter(|_| layer.mark != Mark::Line))
            .collect()
    });
    if chart.form == Form::EqualScales {
        let span = (1.0 + ROOM) * (x.1 - x.0).max(y.1 - y.0);
        let axis = |range: &Range, low: f64| Axis::linear(low, low + span, &range.quantity, &range.unit, 5);
        return (axis(&own.x, x.0), axis(&own.y, y.0));
    }
    (axis(&own.x, x, 6, site), axis(&own.y, y, 5, site))
}

/// The least and the greatest number that an axis must show: a line widens it only where nothing else is drawn.
fn shown(range: &Range, layers: &[&Layer], guide: Mark, of: fn(&Layer) -> Vec<f64>) -> (f64, f64) {
    let never = [guide, Mark::Span];
    let is_line = |layer: &&&Layer| layer.mark == Mark::Line;
    let is_counted = |layer: &&&Layer| !layer.is_aside && !never.contains(&layer.mark) && !is_line(layer);
    let is_bare = !layers
        .iter()
        .any(|layer| is_counted(&layer) && layer.mark != Mark::Upright);
    let counted = layers
        .iter()
        .filter(|layer| is_counted(layer) || is_bare && is_line(layer));
    let numbers = counted.flat_map(|layer| of(layer));
    let numbers = numbers.filter(|at| range.scale != Scale::Log || *at > 0.0);
    finite_range(numbers.chain(range.always.iter().copied()))
}

fn axis(range: &Range, (low, high): (f64, f64), ticks: usize, site: Option<&Site>) -> Axis {
    let room = ROOM * (high - low);
    match range.scale {
        Scale::Names => Axis::names(&range.names),
        Scale::Log => Axis::log(low / LOG_ROOM, high * LOG_ROOM, &range.quantity, &range.unit),
        Scale::SinceStep { unit_s } => Axis::about_step(low.min(0.0), unit_s, high, &range.quantity),
        Scale::Calendar => {
            let zone = site.map_or_else(Zone::utc, Site::zone);
            calendar_axis(low - room, high + room, ticks, &zone)
        }
        Scale::Linear => {
            // What begins at zero stands on the axis.
            let below = if low == 0.0 { 0.0 } else { room };
            Axis::linear(low - below, high + room, &range.quantity, &range.unit, ticks)
        }
    }
}

fn draw_layer(
    chart: &mut panel::Chart,
    layer: &Layer,
    (x, y): (&Axis, &Axis),
    site: Option<&Site>,
) -> Result<(), String> {
    if layer.is_aside {
        return aside_layer(chart, layer, (x, y));
    }
    let ink = ink(layer.ink).color();
    let place = |at: &(f64, f64)| (x.position(at.0), y.position(at.1));
    let is_shown = |at: &(f64, f64)| x.shows(at.0) && y.shows(at.1);
    let points: Vec<(f64, f64)> = layer.points.iter().filter(|at| is_shown(at)).map(place).collect();
    let positions = layer.points.iter();
    // Those of the points that are shown; a point of a run that has no page leaves all without.
    let runs = || -> Vec<usize> {
        let shown = layer
            .runs
            .iter()
            .zip(&layer.points)
            .filter(|(_, at)| is_shown(at));
        let runs = shown.map(|(path, _)| site.and_then(|site| site.run_of(path)));
        runs.collect::<Option<_>>().unwrap_or_default()
    };
    match layer.mark {
        Mark::Readings => {
            let is_ordered = matches!(layer.ink, show::Ink::Ordered(..));
            let (points, radius, style) = match points.len() {
                ..FEW if is_ordered => (points, DOT, ink.filled()),
                MOST_RINGS.. => {
                    let dots = thin::dots(&points);
                    let radius = radius_of(dots.len());
                    (dots, radius, ink.mix(0.6).filled())
                }
                _ if is_ordered => (points, ORDERED_DOT, ink.filled()),
                _ => (points, DOT, ink.stroke_width(RING)),
            };
            dots(chart, group(&layer.name, runs()), points, radius, style)
        }
        Mark::Marks => marks(chart, layer, (x, y), runs()),
        Mark::Span => {
            let least = LEAST_SPAN * (x.high - x.low);
            let ends = layer
                .bars_across
                .iter()
                .map(|bar| (x.inside(bar.0), x.inside(bar.1)));
            let shades = ends.map(|(from, to)| {
                let corners = [(from, y.low), (to.max(from + least).min(x.high), y.high)];
                Rectangle::new(corners, ink.mix(PALE).filled())
            });
            series(chart, "", |chart| {
                let drawn = chart.draw_series(shades).map(|_| ());
                drawn.map_err(|error| error.to_string())
            })
        }
        Mark::Line | Mark::DottedLine | Mark::MarkedLine => {
            let stretches = layer
                .points
                .split(|at| !is_shown(at))
                .filter(|some| some.len() > 1);
            let pixels = panel::pixels(chart);
            let thinned =
                |some: &[(f64, f64)]| thin::line(&some.iter().map(place).collect::<Vec<_>>(), pixels);
            let stretches = stretches.map(thinned).collect();
            let name = match layer.mark {
                Mark::DottedLine => "",
                _ => layer.name.as_str(),
            };
            if layer.mark == Mark::Line && !layer.bars.is_empty() {
                band(chart, layer, (x, y))?;
            }
            lines(chart, name, stretches, ink.stroke_width(LINE))?;
            match layer.mark {
                Mark::DottedLine => dots(chart, group(&layer.name, runs()), points, DOT / 2, ink.filled()),
                Mark::MarkedLine => marks_along(chart, &points, style_of(layer.ink)),
                _ => Ok(()),
            }
        }
        Mark::Upright => {
            let upright = positions.flat_map(|at| dashes(x.position(at.0), y));
            lines(chart, &layer.name, upright.collect(), ink.stroke_width(GUIDE))
        }
        Mark::Level => {
            let level = positions.map(|at| vec![(x.low, y.position(at.1)), (x.high, y.position(at.1))]);
            lines(chart, "", level.collect(), ink.stroke_width(GUIDE))
        }
    }
}

/// Radius of readings that are many: their area together stays.
fn radius_of(count: usize) -> i32 {
    let part = MOST_RINGS as f64 / count.max(MOST_RINGS) as f64;
    ((f64::from(DOT) * part.sqrt()).round() as i32).max(SMALL_DOT)
}

/// The band of a line, brought to the ends of the axis.
fn band(chart: &mut panel::Chart, layer: &Layer, (x, y): (&Axis, &Axis)) -> Result<(), String> {
    let pixels = panel::pixels(chart);
    let edge = |of: fn(&(f64, f64)) -> f64| {
        let places = layer.points.iter().zip(&layer.bars);
        let places = places.map(|(at, bar)| (x.position(at.0), y.inside(of(bar))));
        thin::line(&places.collect::<Vec<_>>(), pixels)
    };
    let (low, high) = (edge(|bar| bar.0), edge(|bar| bar.1));
    let corners: Vec<(f64, f64)> = low.into_iter().chain(high.into_iter().rev()).collect();
    let band = Polygon::new(corners, Ink::Muted.color().mix(PALE).filled());
    series(chart, "", |chart| {
        let drawn = chart.draw_series([band]).map(|_| ());
        drawn.map_err(|error| error.to_string())
    })
}

/// A layer of a run that no result is made from.
fn aside_layer(chart: &mut panel::Chart, layer: &Layer, (x, y): (&Axis, &Axis)) -> Result<(), String> {
    if layer.mark == Mark::Marks {
        return draw_aside(chart, (x, y), &aside_marks(layer));
    }
    let pale = ink(layer.ink).color().mix(OF_ASIDE);
    let shown = layer.points.iter().filter(|at| x.shows(at.0) && y.shows(at.1));
    let points: Vec<(f64, f64)> = shown.map(|at| (x.position(at.0), y.position(at.1))).collect();
    aside_series(chart, &layer.name, |chart| {
        let drawn = if layer.mark == Mark::Readings {
            // Open dots are large, and so fewer of them are told apart.
            let open = points.iter().step_by((points.len() / MOST_OPEN).max(1));
            let open = open.map(|&at| Circle::new(at, DOT, pale.stroke_width(RING)));
            chart.draw_series(open).map(|_| ())
        } else {
            let (dash, gap) = DASH;
            let line = DashedLineSeries::new(points, dash, gap, pale.stroke_width(LINE));
            chart.draw_series(line).map(|_| ())
        };
        drawn.map_err(|error| error.to_string())
    })
}

/// The runs of a layer that no result is made from.
fn aside_marks(layer: &Layer) -> Vec<AsideMark> {
    let points = layer.points.iter().zip(&layer.bars);
    let points = points.filter(|_| layer.is_aside && layer.mark == Mark::Marks);
    let mark = |(&(x, y), &bar): (&(f64, f64), &(f64, f64))| AsideMark {
        run: 0,
        x,
        y,
        bar,
        name: layer.name.clone(),
    };
    points.map(mark).collect()
}

/// Marks over their bars; a bar that reaches beyond the axis ends at it.
fn marks(
    chart: &mut panel::Chart,
    layer: &Layer,
    (x, y): (&Axis, &Axis),
    runs: Vec<usize>,
) -> Result<(), String> {
    let style = style_of(layer.ink);
    let bars = layer.points.iter().zip(&layer.bars);
    let bars = bars.filter(|(at, _)| x.shows(at.0)).map(|(at, bar)| {
        let x = x.position(at.0);
        vec![(x, y.inside(bar.0)), (x, y.inside(bar.1))]
    });
    let across = layer.points.iter().zip(&layer.bars_across);
    let across = across.filter(|(at, _)| y.shows(at.1)).map(|(at, bar)| {
        let y = y.position(at.1);
        vec![(x.inside(bar.0), y), (x.inside(bar.1), y)]
    });
    let bars: Vec<Vec<(f64, f64)>> = bars.chain(across).collect();
    let line = ink(layer.ink).color().stroke_width(GUIDE);
    grouped(chart, group(&layer.name, runs), |chart| {
        let paths = bars.into_iter().map(|bar| PathElement::new(bar, line));
        chart.draw_series(paths).map_err(|error| error.to_string())?;
        let shown = layer.points.iter().filter(|at| x.shows(at.0) && y.shows(at.1));
        let mut places = shown.map(|at| (x.position(at.0), y.position(at.1)));
        places.try_for_each(|at| marker(chart, at, style, true))
    })
}

/// A series whose points stand for these runs.
fn group(name: &str, runs: Vec<usize>) -> Group {
    Group::Series {
        name: name.to_owned(),
        runs,
        form: 0,
        to_the_pixel: false,
        aside: false,
    }
}

/// A few marks on a line, at other places on each so that they do not hide each other.
fn marks_along(chart: &mut panel::Chart, points: &[(f64, f64)], style: usize) -> Result<(), String> {
    let spacing = (points.len() / MARKS_ALONG).max(1);
    let first = spacing * (style + 1) / (Ink::SERIES.len() + 1);
    series(chart, "", |chart| {
        let mut marked = points.iter().skip(first).step_by(spacing);
        marked.try_for_each(|at| marker(chart, *at, style, true))
    })
}

fn dots(
    chart: &mut panel::Chart,
    group: Group,
    points: Vec<(f64, f64)>,
    radius: i32,
    style: ShapeStyle,
) -> Result<(), String> {
    grouped(chart, group, |chart| {
        let circles = points.into_iter().map(|at| Circle::new(at, radius, style));
        let drawn = chart.draw_series(circles).map(|_| ());
        drawn.map_err(|error| error.to_string())
    })
}

fn lines(
    chart: &mut panel::Chart,
    name: &str,
    lines: Vec<Vec<(f64, f64)>>,
    style: ShapeStyle,
) -> Result<(), String> {
    series(chart, name, |chart| {
        let paths = lines.into_iter().map(|line| PathElement::new(line, style));
        let drawn = chart.draw_series(paths).map(|_| ());
        drawn.map_err(|error| error.to_string())
    })
}

fn dashes(at: f64, y: &Axis) -> Vec<Vec<(f64, f64)>> {
    let place = |part: f64| (at, y.low + (y.high - y.low) * part / f64::from(DASHES));
    (0..DASHES)
        .map(|k| vec![place(f64::from(k)), place(f64::from(k) + 0.6)])
        .collect()
}

/// Which of the colours and marks a layer has.
fn style_of(of: show::Ink) -> usize {
    match of {
        show::Ink::Series(at) => at % Ink::SERIES.len(),
        // The colour of the second series is that of limits.
        show::Ink::Limit => 1,
        show::Ink::Readings | show::Ink::Ordered(..) | show::Ink::Guide => 0,
    }
}

fn ink(of: show::Ink) -> Ink {
    match of {
        show::Ink::Readings => Ink::Text,
        show::Ink::Series(_) | show::Ink::Limit => comparison::ink(style_of(of)),
        show::Ink::Ordered(at, count) => Ink::ordered(at, count),
        show::Ink::Guide => Ink::Muted,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chart() -> Chart {
        let readings = [(0.0, 1.0), (1.0, 10.0), (10.0, f64::NAN), (100.0, 7.0)];
        let panel = Panel {
            x: Range::log("Frequency", "Hz"),
            y: Range::linear("|Z|", "Ω").with(0.0),
            layers: vec![
                Layer::guides(Mark::Upright, [3.0]),
                Layer::new(
                    "fit",
                    Mark::Line,
                    show::Ink::FIRST,
                    [(1.0, 1e9), (10.0, 5.0), (20.0, 6.0)],
                ),
                Layer::new("Readings", Mark::Readings, show::Ink::Readings, readings),
                Layer::new("levels", Mark::Marks, show::Ink::SECOND, [(2.0, 5.0)])
                    .with_bars(vec![(4.0, 6.0)]),
            ],
        };
        Chart::new("t", vec![panel.clone(), panel])
    }

    #[test]
    fn axes_have_units_and_what_cannot_be_shown_leaves_no_hole() {
        let drawn = drawing(&chart(), PAGE_WIDTH, None).unwrap();
        let svg = crate::figures::svg::inline(&drawn, "t", "d");
        assert!(!svg.contains("NaN"), "{svg}");
        assert!(svg.contains("Frequency (Hz)") && svg.contains("|Z| (Ω)"));
        assert_eq!(
            svg.matches("Frequency (Hz)").count(),
            1,
            "only the lowest panel has it"
        );
        let names: Vec<String> = keys(&chart()).into_iter().map(|key| key.name).collect();
        assert_eq!(names, ["fit", "Readings", "levels"]);
    }

    #[test]
    fn a_line_far_beyond_the_readings_does_not_widen_the_axes() {
        let (_, y) = axes(&chart(), &chart().panels[0], None);
        assert!(y.high < 12.0 && y.low == 0.0, "{y:?}");
    }

    #[test]
    fn a_print_has_its_legend_in_it() {
        let drawn = print(&chart(), 480).unwrap();
        let svg = crate::figures::svg::inline(&drawn, "t", "d");
        assert!(svg.contains("levels") && svg.contains("fit"), "{svg}");
    }
}
