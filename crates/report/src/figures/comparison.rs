//! One parameter of one material over all conditions: the panels of the thesis's figure 26.

use plotters::element::{Circle, PathElement};
use plotters::style::text_anchor::{HPos, VPos};
use plotters::style::{Color, ShapeStyle};

use super::aside::{AsideMark, draw_aside};
use super::axis::{Axis, Scale};
use super::canvas::{Area, Ink, TENTHS, svg};
use super::group::{Group as Series, grouped};
use super::panel::{Chart, Margins, TICK_SIZE, label, panel, text_style};
use super::shape::PAGE_WIDTH;
use ieap_domain::Estimate;

/// Size of one panel, px.
const SIZE: (u32, u32) = (PAGE_WIDTH, 230);
/// Size of one of small multiples, px.
const SMALL: (u32, u32) = (310, 190);
const MARGINS: Margins = Margins {
    left: 66,
    right: 12,
    top: 10,
    bottom: 66,
};
/// Estimated width of a character of a tick label, px.
const CHARACTER: f64 = 6.2;

/// The marks of one surroundings.
#[derive(Debug, Clone, PartialEq)]
pub struct Group {
    /// Environment.
    pub label: String,
    /// Humidity, where it is known.
    pub humidity: String,
    /// Index of the environment: its colour and marker.
    pub style: usize,
    /// One slot per voltage.
    pub slots: Vec<Slot>,
}

/// The marks of one condition.
#[derive(Debug, Clone, PartialEq)]
pub struct Slot {
    /// Voltage.
    pub label: String,
    /// One estimate per run, in shown units; repeats stand side by side.
    pub estimates: Vec<Estimate>,
    /// The run of each estimate; empty where an estimate is of several.
    pub runs: Vec<usize>,
    /// Runs that no result is made from; where they stand across follows from the slot.
    pub aside: Vec<AsideMark>,
}

/// Draws one panel. `y` must cover every number of the groups that is to be seen.
///
/// # Errors
/// The message of the drawing library.
pub fn comparison(groups: &[Group], y: &Axis, title: &str, desc: &str) -> Result<String, String> {
    svg(SIZE, title, desc, |area| comparison_on(area, groups, y))
}

/// The same as one of small multiples.
///
/// # Errors
/// The message of the drawing library.
pub fn small_comparison(groups: &[Group], y: &Axis, title: &str, desc: &str) -> Result<String, String> {
    svg(SMALL, title, desc, |area| comparison_on(area, groups, y))
}

/// Draws one panel over the whole of `area`.
///
/// # Errors
/// The message of the drawing library.
pub fn comparison_on(area: &Area, groups: &[Group], y: &Axis) -> Result<(), String> {
    let slots: usize = groups.iter().map(|group| group.slots.len()).sum();
    let width = slots as f64 + GAP * groups.len().saturating_sub(1) as f64;
    let x = Axis {
        scale: Scale::Names,
        title: String::new(),
        ticks: vec![],
        ..Axis::linear(-0.5, width - 0.5, "", "", 2)
    };
    let pixels = f64::from(area.dim_in_pixel().0) / f64::from(TENTHS);
    let pixels_per_slot = (pixels - f64::from(MARGINS.left + MARGINS.right)) / width.max(1.0);
    let names = Names::of(groups, pixels_per_slot);
    let lower = (names.lanes - 1) * LANE;
    let margins = Margins {
        bottom: MARGINS.bottom + lower,
        ..MARGINS
    };
    let mut chart = panel(area, margins, &x, y, true)?;
    // A title wider than the plot ends with it: room for what is longer is on the left.
    let is_wide = names.axis_title.chars().count() as f64 * CHARACTER > width * pixels_per_slot;
    let (at, anchor) = if is_wide {
        (width - 0.5, HPos::Right)
    } else {
        (0.5 * width - 0.5, HPos::Center)
    };
    let axis_title = text_style(Ink::Muted, TICK_SIZE, anchor, VPos::Top);
    let below = (0, 51 + lower as i32);
    label(&mut chart, (at, y.low), below, &names.axis_title, &axis_title)?;
    let mut left = 0.0;
    for (index, group) in groups.iter().enumerate() {
        draw_names(&mut chart, y, (index, group), left, &names)?;
        let of_group = Series::Series {
            name: group.label.clone(),
            runs: marked_runs(group),
            form: 0,
            to_the_pixel: false,
            aside: false,
        };
        grouped(&mut chart, of_group, |chart| {
            draw_estimates(chart, y, group, left)
        })?;
        draw_aside(&mut chart, (&x, y), &placed_aside(group, left))?;
        left += group.slots.len() as f64 + GAP;
    }
    Ok(())
}

/// Room between two groups, in slots.
const GAP: f64 = 0.6;
/// Distance of two lanes of group names, px.
const LANE: u32 = 14;

/// How voltages and surroundings are written under the groups of a panel.
struct Names {
    pixels_per_slot: f64,
    /// One voltage of so many is written.
    every: usize,
    /// Room that a voltage takes, in slots.
    slots_per_voltage: f64,
    /// Lanes that neighbouring groups' names take in turn: two where a name does not fit under its group.
    lanes: u32,
    /// `Step voltage (V)`, with the voltages of every group where not all are written under it.
    axis_title: String,
    /// Environments of several groups, whose humidity names them where there is no room for both.
    by_humidity: Vec<String>,
    /// Where there is no room for these either they are numbers under an axis, of which one of so many is written.
    every_humidity: Option<usize>,
}

impl Names {
    fn of(groups: &[Group], pixels_per_slot: f64) -> Names {
        let slots = || groups.iter().flat_map(|group| &group.slots);
        let longest = slots().map(|slot| slot.label.chars().count()).max().unwrap_or(0);
        let slots_per_voltage = (longest as f64 * CHARACTER + 5.0) / pixels_per_slot;
        let every = slots_per_voltage.ceil().max(1.0) as usize;
        let fits = |group: &Group| group.label.chars().count() <= room(group, pixels_per_slot);
        let voltages =
            |group: &Group| -> Vec<String> { group.slots.iter().map(|slot| slot.label.clone()).collect() };
        let all = groups.first().map(voltages).unwrap_or_default();
        let said = every > 1 && all.len() <= SAID && groups.iter().all(|group| voltages(group) == all);
        let is_repeated = |group: &&Group| {
            let same = groups.iter().filter(|other| other.label == group.label);
            !group.humidity.is_empty() && same.count() > 1
        };
        let repeated: Vec<&Group> = groups.iter().filter(is_repeated).collect();
        let mut by_humidity: Vec<String> = repeated.iter().map(|group| group.label.clone()).collect();
        by_humidity.dedup();
        let over = |own: &&Group, name: &str| {
            let characters = name.chars().count() as f64 + 1.0;
            characters * CHARACTER / ((own.slots.len() as f64 + GAP) * pixels_per_slot)
        };
        let is_cut = repeated.iter().any(|own| over(own, in_percent(own)) > 2.0);
        let numbers = repeated.iter().map(|own| over(own, number(own)));
        let every_humidity = is_cut.then(|| numbers.fold(1.0, f64::max).ceil() as usize);
        let fits = |group: &Group| is_cut && by_humidity.contains(&group.label) || fits(group);
        let humidity = if is_cut {
            format!("Relative humidity (%) in {}; ", by_humidity.join(", "))
        } else {
            String::new()
        };
        let voltage = if said {
            format!("Steps of {} V", all.join(", "))
        } else {
            "Step voltage (V)".to_owned()
        };
        Names {
            every_humidity,
            pixels_per_slot,
            every,
            slots_per_voltage,
            lanes: if groups.len() > 1 && !groups.iter().all(fits) {
                2
            } else {
                1
            },
            axis_title: if is_cut {
                humidity + &voltage.replace("Step", "step")
            } else {
                voltage
            },
            by_humidity,
        }
    }
}

/// `28–38 %`
fn in_percent(group: &Group) -> &str {
    group.humidity.trim_end_matches("RH").trim_end()
}

/// `28–38`
fn number(group: &Group) -> &str {
    in_percent(group).trim_end_matches('%').trim_end()
}

/// Voltages that an axis title names.
const SAID: usize = 4;

/// Characters that fit under a group.
fn room(group: &Group, pixels_per_slot: f64) -> usize {
    ((group.slots.len() as f64 + GAP) * pixels_per_slot / CHARACTER) as usize
}

/// The runs of the marks of a group, in the order of drawing: a bound has no mark.
fn marked_runs(group: &Group) -> Vec<usize> {
    let of_slot = |slot: &Slot| -> Vec<usize> {
        let marked = slot.runs.iter().zip(&slot.estimates);
        let marked = marked.filter(|(_, estimate)| estimate.value.is_some());
        marked.map(|(run, _)| *run).collect()
    };
    group.slots.iter().flat_map(of_slot).collect()
}

/// The values of a group, repeats of a condition side by side.
fn draw_estimates(chart: &mut Chart, y: &Axis, group: &Group, left: f64) -> Result<(), String> {
    let mut placed: Vec<(f64, &Estimate)> = Vec::new();
    for (index, slot) in group.slots.iter().enumerate() {
        let n = slot.estimates.len() as f64;
        for (repeat, estimate) in slot.estimates.iter().enumerate() {
            let beside = (repeat as f64 - 0.5 * (n - 1.0)) * (0.7 / n).min(0.22);
            placed.push((left + index as f64 + beside, estimate));
        }
    }
    for &(at, estimate) in &placed {
        draw_bar(chart, y, at, estimate, group.style)?;
    }
    for (at, estimate) in placed {
        if let Some(value) = estimate.value {
            let up = position(y, value);
            marker(chart, (at, up), group.style, y.shows(value))?;
        }
    }
    Ok(())
}

/// Room right of the repeats of a slot, from its middle, in which runs stand that no result is made from: they leave the
/// others where they are.
const ASIDE: std::ops::Range<f64> = 0.38..0.5;

/// The runs of a group that no result is made from, right of the others of their slot.
fn placed_aside(group: &Group, left: f64) -> Vec<AsideMark> {
    let mut placed = Vec::new();
    for (index, slot) in group.slots.iter().enumerate() {
        let step = (ASIDE.end - ASIDE.start) / slot.aside.len().max(1) as f64;
        placed.extend(slot.aside.iter().enumerate().map(|(at, mark)| AsideMark {
            x: left + index as f64 + ASIDE.start + at as f64 * step,
            ..mark.clone()
        }));
    }
    placed
}

/// Position of a number, brought to the ends of the axis. One at or below zero has no place on a log axis: it stands at
/// the frame.
fn position(y: &Axis, number: f64) -> f64 {
    if number > 0.0 || y.shows(number) {
        y.position(number).clamp(y.low, y.high)
    } else {
        y.low
    }
}

/// Voltages and surroundings under a group.
fn draw_names(
    chart: &mut Chart,
    y: &Axis,
    (index, group): (usize, &Group),
    left: f64,
    names: &Names,
) -> Result<(), String> {
    let is_repeated = !group.humidity.is_empty() && names.by_humidity.contains(&group.label);
    let every_humidity = names.every_humidity.filter(|_| is_repeated);
    let lane = if every_humidity.is_some() {
        0
    } else {
        index as u32 % names.lanes
    };
    let tick = text_style(Ink::Muted, TICK_SIZE, HPos::Center, VPos::Top);
    for (index, slot) in group.slots.iter().enumerate() {
        let at = left + index as f64;
        // The next group's first voltage is written too.
        let to_next = (group.slots.len() - index) as f64 + GAP;
        if index % names.every == 0 && (index == 0 || to_next >= names.slots_per_voltage) {
            label(chart, (at, y.low), (0, 7), &slot.label, &tick)?;
        }
    }
    let count = group.slots.len() as f64;
    let middle = left + 0.5 * (count - 1.0);
    let room = names.lanes as usize * room(group, names.pixels_per_slot);
    let name = text_style(Ink::Text, TICK_SIZE, HPos::Center, VPos::Top);
    let text = match every_humidity {
        Some(every) if index % every == 0 => number(group).to_owned(),
        Some(_) => String::new(),
        None if group.humidity.is_empty() => group.label.clone(),
        None => format!("{}, {}", group.label, group.humidity),
    };
    let short = if is_repeated {
        in_percent(group)
    } else {
        &group.label
    };
    let rule = [(left - 0.3, y.low), (left + count - 0.7, y.low)];
    let style = ink(group.style).color().stroke_width(20);
    chart
        .draw_series([PathElement::new(rule, style)])
        .map_err(|error| error.to_string())?;
    label(
        chart,
        (middle, y.low),
        (0, 27 + (lane * LANE) as i32),
        &match every_humidity {
            Some(_) => text,
            None => shortened(&text, short, room),
        },
        &name,
    )
}

/// The longest of the full text, the name alone and its beginning that fits into `room` characters.
fn shortened(text: &str, name: &str, room: usize) -> String {
    if text.chars().count() <= room {
        return text.to_owned();
    }
    if name.chars().count() <= room {
        return name.to_owned();
    }
    let kept: String = name.chars().take(room.saturating_sub(1)).collect();
    format!("{kept}…")
}

/// The interval of an estimate, an arrow for a bound, a dash where there is nothing.
fn draw_bar(chart: &mut Chart, y: &Axis, at: f64, estimate: &Estimate, style: usize) -> Result<(), String> {
    let line = ink(style).color().stroke_width(14);
    let position = |number: f64| position(y, number);
    let ends = (estimate.low_95.map(position), estimate.high_95.map(position));
    match (estimate.value, ends) {
        (Some(value), (low, high)) => {
            let bar = [
                (at, low.unwrap_or(position(value))),
                (at, high.unwrap_or(position(value))),
            ];
            draw_path(chart, &bar, line)
        }
        (None, (Some(low), Some(high))) => draw_path(chart, &[(at, low), (at, high)], line),
        (None, (None, Some(high))) => {
            let length = arrow_length(chart, high - y.low, y);
            arrow(chart, (at, high), length, line)
        }
        (None, (Some(low), None)) => {
            let length = -arrow_length(chart, y.high - low, y);
            arrow(chart, (at, low), length, line)
        }
        (None, (None, None)) => {
            let muted = text_style(Ink::Muted, TICK_SIZE, HPos::Center, VPos::Bottom);
            label(chart, (at, y.low), (0, -4), "–", &muted)
        }
    }
}

/// Length of an arrow, tenths of a pixel: as long as there is room up to the frame, never less than its tip.
fn arrow_length(chart: &Chart, room: f64, y: &Axis) -> i32 {
    let plot_height = f64::from(chart.plotting_area().dim_in_pixel().1) / f64::from(TENTHS);
    let pixels = room / (y.high - y.low) * plot_height;
    (10.0 * pixels.clamp(7.0, 18.0)) as i32
}

/// A bar at the bound and an arrow away from it, `down` tenths of a pixel long (negative: upward).
fn arrow(chart: &mut Chart, at: (f64, f64), down: i32, style: ShapeStyle) -> Result<(), String> {
    use plotters::element::EmptyElement;
    let shape = EmptyElement::at(at)
        + PathElement::new([(-45, 0), (45, 0)], style)
        + PathElement::new([(0, 0), (0, down)], style)
        + PathElement::new(
            [
                (-32, down - 45 * down.signum()),
                (0, down),
                (32, down - 45 * down.signum()),
            ],
            style,
        );
    chart
        .draw_series([shape])
        .map(|_| ())
        .map_err(|error| error.to_string())
}

/// Marker shapes differ as well as colours; a value outside the range shown is hollow.
pub fn marker(chart: &mut Chart, at: (f64, f64), style: usize, within: bool) -> Result<(), String> {
    use plotters::element::{EmptyElement, Polygon};
    let color = ink(style).color();
    let filled = color.filled();
    if !within || style.is_multiple_of(SHAPES) {
        let style = if within { filled } else { color.stroke_width(14) };
        let dot = Circle::new(at, 36, style);
        return chart
            .draw_series([dot])
            .map(|_| ())
            .map_err(|error| error.to_string());
    }
    let corners: &[(i32, i32)] = match style % SHAPES {
        1 => &[(-33, -33), (33, -33), (33, 33), (-33, 33)],
        2 => &[(0, -44), (42, 32), (-42, 32)],
        3 => &[(0, -48), (48, 0), (0, 48), (-48, 0)],
        _ => &[(0, 44), (42, -32), (-42, -32)],
    };
    let shape = EmptyElement::at(at) + Polygon::new(corners.to_vec(), filled);
    chart
        .draw_series([shape])
        .map(|_| ())
        .map_err(|error| error.to_string())
}

/// Number of marker shapes.
const SHAPES: usize = 5;

fn draw_path(chart: &mut Chart, points: &[(f64, f64)], style: ShapeStyle) -> Result<(), String> {
    let path = PathElement::new(points.to_vec(), style);
    chart
        .draw_series([path])
        .map(|_| ())
        .map_err(|error| error.to_string())
}

/// Colour of the environment with that index.
pub fn ink(style: usize) -> Ink {
    Ink::SERIES[style % Ink::SERIES.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn group(estimates: Vec<Estimate>) -> Group {
        Group {
            label: "air".to_owned(),
            humidity: "28–38 % RH".to_owned(),
            style: 2,
            slots: vec![Slot {
                label: "2.5".to_owned(),
                estimates,
                runs: vec![],
                aside: vec![],
            }],
        }
    }

    fn drawn(estimates: Vec<Estimate>, y: &Axis) -> String {
        comparison(&[group(estimates)], y, "t", "d").unwrap()
    }

    #[test]
    fn a_bound_is_an_arrow_and_a_gap_a_dash() {
        let y = Axis::log(1e-5, 1e-2, "λ", "s⁻¹");
        let empty = drawn(vec![], &y);
        let bound = drawn(vec![Estimate::below(1e-4, "r")], &y);
        // A bar, a shaft and a tip.
        let starts = |svg: &str| svg.matches(['M', 'm']).count() - svg.matches("mid").count();
        assert_eq!(starts(&bound), starts(&empty) + 3);
        let gap = drawn(vec![Estimate::not_determined("r")], &y);
        assert!(gap.contains(">–</text>") && !empty.contains(">–</text>"));
    }

    #[test]
    fn an_interval_that_reaches_zero_stays_inside_a_log_axis() {
        let y = Axis::log(1e-5, 1e-2, "λ", "s⁻¹");
        let text = drawn(vec![Estimate::determined(1e-5, 1e-5, -1e-5, 3e-5)], &y);
        assert!(!text.contains("NaN") && !text.contains("inf"), "{text}");
    }

    #[test]
    fn long_names_are_cut_not_overlapped() {
        assert_eq!(shortened("air, 28–38 % RH", "air", 15), "air, 28–38 % RH");
        assert_eq!(shortened("air, 28–38 % RH", "air", 6), "air");
        assert_eq!(shortened("glove box, dry", "glove box", 5), "glov…");
    }

    #[test]
    fn in_a_narrow_panel_names_take_two_lanes_and_the_axis_says_the_voltages() {
        let of = |environment: &str| Group {
            label: environment.to_owned(),
            slots: ["1.2", "2", "2.5"]
                .map(|voltage| Slot {
                    label: voltage.to_owned(),
                    estimates: vec![],
                    runs: vec![],
                    aside: vec![],
                })
                .to_vec(),
            ..group(vec![])
        };
        let groups = [of("vacuum"), of("inert"), of("air")];
        let narrow = Names::of(&groups, 8.7);
        assert_eq!((narrow.lanes, narrow.every), (2, 3));
        assert_eq!(narrow.axis_title, "Steps of 1.2, 2, 2.5 V");
        assert!(narrow.by_humidity.is_empty());
        let wide = Names::of(&groups, 40.0);
        assert_eq!((wide.lanes, wide.every), (1, 1));
        assert_eq!(wide.axis_title, "Step voltage (V)");
    }

    #[test]
    fn groups_of_one_environment_are_named_by_their_humidity() {
        let at = |humidity: &str| Group {
            humidity: humidity.to_owned(),
            ..group(vec![])
        };
        let y = Axis::linear_rounded(0.0, 1.0, "α", "", 5);
        let groups: Vec<Group> = (1..=9).map(|tens| at(&format!("{tens}0 % RH"))).collect();
        let text = small_comparison(&groups, &y, "t", "d").unwrap();
        for tens in 1..=9 {
            assert!(text.contains(&format!(">{tens}0 %</text>")), "{text}");
        }
    }

    #[test]
    fn of_many_humidities_numbers_stand_under_an_axis_and_none_is_cut() {
        let at = |humidity: usize| Group {
            humidity: format!("{humidity} % RH"),
            slots: vec![group(vec![]).slots[0].clone(); 2],
            ..group(vec![])
        };
        let y = Axis::linear_rounded(0.0, 1.0, "α", "", 5);
        let groups: Vec<Group> = (0..24).map(|k| at(20 + 3 * k)).collect();
        let text = small_comparison(&groups, &y, "t", "d").unwrap();
        assert!(text.contains("Relative humidity (%) in air"), "{text}");
        assert!(text.contains(">20</text>") && !text.contains('…'), "{text}");
        let written = (0..24).filter(|k| text.contains(&format!(">{}</text>", 20 + 3 * k)));
        assert!((4..24).contains(&written.count()), "{text}");
    }

    #[test]
    fn another_environment_beside_them_takes_no_humidity_from_their_names() {
        let at = |label: &str, humidity: &str| Group {
            label: label.to_owned(),
            humidity: humidity.to_owned(),
            ..group(vec![])
        };
        let y = Axis::linear_rounded(0.0, 1.0, "α", "", 5);
        let mut groups: Vec<Group> = (1..=8).map(|tens| at("air", &format!("{tens}0 % RH"))).collect();
        groups.insert(0, at("dry", ""));
        let text = small_comparison(&groups, &y, "t", "d").unwrap();
        assert!(
            text.contains(">dry</text>") && text.contains(">80 %</text>"),
            "{text}"
        );
        assert!(!text.contains(">air</text>"), "{text}");
    }

    #[test]
    fn fifteen_voltages_fit() {
        let slots = (0..15)
            .map(|k| Slot {
                label: format!("−0.{:02}", 5 * k),
                estimates: vec![],
                runs: vec![],
                aside: vec![],
            })
            .collect();
        let group = Group {
            slots,
            ..group(vec![])
        };
        let y = Axis::linear_rounded(0.0, 1.0, "α", "", 5);
        let text = comparison(&[group], &y, "t", "d").unwrap();
        assert!(text.matches("−0.").count() < 10, "labels are thinned");
    }
}
