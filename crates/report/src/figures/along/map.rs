//! Curvature over place and time: each cell is one reading of one joint, nothing is drawn between them.

use plotters::element::PathElement;
use plotters::style::Color;
use plotters::style::text_anchor::{HPos, VPos};

use super::frames::{Frames, frames};
use crate::figures::axis::Axis;
use crate::figures::canvas::{Area, Ink, Shape, TENTHS};
use crate::figures::cells::Cells;
use crate::figures::colors::{LEVELS, diverging, level, sequential};
use crate::figures::group::note;
use crate::figures::panel::{Chart, Margins, TICK_SIZE, label, panel, text_style};
use ieap_domain::{AlongCurve, AlongStrip};

/// Size of a map on a page, px.
pub const SIZE: (u32, u32) = (370, 236);
const MARGINS: Margins = Margins {
    left: 46,
    right: 58,
    top: 22,
    bottom: 42,
};
/// Room between the map and its bar of colours, and the bar's width, px.
const BAR: (i32, i32) = (9, 12);
/// Distance of the lines that say "no reading", px.
const HATCH: i32 = 6;
/// Ends that a map of residuals may have, in units of the noise.
const RESIDUAL_ENDS: [f64; 8] = [3.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0];
/// Share of the residuals that lie within the ends.
const WITHIN: f64 = 0.98;

/// Which numbers a map shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shown {
    /// Readings.
    Measured,
    /// Simulated values.
    Simulated,
    /// Readings less simulated values, in units of the noise of their place.
    Residual,
}

/// Draws a map over the whole of `area`; nothing where fewer than two frames can be shown.
///
/// # Errors
/// The message of the drawing library.
pub fn draw(area: &Area, strip: &AlongStrip, curve: &AlongCurve, shown: Shown) -> Result<(), String> {
    let Some(frames) = frames(strip, curve) else {
        return Ok(());
    };
    let places = curve.cell_edges_mm(strip.length_mm);
    let top_mm = strip.length_mm.unwrap_or(places[places.len() - 1].1);
    let y = Axis::linear(0.0, top_mm, "Position", "mm", 5);
    let scale = Scale::of(curve, &frames, shown);
    let mut chart = panel(area, MARGINS, &frames.axis, &y, true)?;
    hatch(&mut chart)?;
    let cells = cells(&chart, curve, &frames, &places, shown, &scale);
    note(&mut chart, Shape::Cells(cells))?;
    bar(&mut chart, &y, &scale)
}

/// Largest number of units of noise that colours tell apart.
pub fn residual_end(curve: &AlongCurve) -> f64 {
    let mut sizes: Vec<f64> = (0..curve.places())
        .flat_map(|place| curve.residual_sigma_at(place))
        .filter(|residual| residual.is_finite())
        .map(f64::abs)
        .collect();
    sizes.sort_by(f64::total_cmp);
    let within = (WITHIN * sizes.len() as f64) as usize;
    let most = sizes
        .get(within.min(sizes.len().saturating_sub(1)))
        .copied()
        .unwrap_or(0.0);
    let ends = RESIDUAL_ENDS.into_iter();
    ends.clone()
        .find(|end| *end >= most)
        .or(ends.last())
        .unwrap_or(most)
}

/// How numbers become colours.
struct Scale {
    axis: Axis,
    diverges: bool,
}

impl Scale {
    /// Measured and simulated values have one scale, so that the maps can be compared.
    fn of(curve: &AlongCurve, frames: &Frames, shown: Shown) -> Scale {
        if shown == Shown::Residual {
            let end = residual_end(curve);
            return Scale {
                axis: Axis::linear(-end, end, "σ", "", 6),
                diverges: true,
            };
        }
        let rows = (0..curve.places()).flat_map(|place| [curve.measured_at(place), curve.fitted_at(place)]);
        let values = rows.filter(|row| !row.is_empty());
        let values = values.flat_map(|row| frames.shown.iter().map(|&frame| row[frame]));
        let (low, high) = values
            .filter(|value| value.is_finite())
            .fold((0.0f64, 0.0f64), |(low, high), value| {
                (low.min(value), high.max(value))
            });
        Scale {
            axis: Axis {
                title: "cm⁻¹".to_owned(),
                ..Axis::linear(low, high, "", "1/cm", 5)
            },
            diverges: false,
        }
    }

    fn color(&self, value: f64) -> Option<(u8, u8, u8)> {
        let share = level((value - self.axis.low) / (self.axis.high - self.axis.low));
        value.is_finite().then(|| {
            if self.diverges {
                diverging(2.0 * share - 1.0)
            } else {
                sequential(share)
            }
        })
    }
}

fn cells(
    chart: &Chart,
    curve: &AlongCurve,
    frames: &Frames,
    places: &[(f64, f64)],
    shown: Shown,
    scale: &Scale,
) -> Cells {
    let across = |at: f64| chart.backend_coord(&(at, 0.0)).0;
    let down = |mm: f64| chart.backend_coord(&(frames.axis.low, mm)).1;
    // Rows are counted from the top, where the tip is.
    let top = places.iter().rev().map(|(_, to)| down(*to));
    let rows = top.chain(places.first().map(|(from, _)| down(*from)));
    let values = |place: usize| match shown {
        Shown::Measured => curve.measured_at(place).to_vec(),
        Shown::Simulated => curve.fitted_at(place).to_vec(),
        Shown::Residual => curve.residual_sigma_at(place),
    };
    let colors = (0..curve.places()).rev().flat_map(|place| {
        let values = values(place);
        let color = |&frame: &usize| values.get(frame).and_then(|value| scale.color(*value));
        frames.shown.iter().map(color).collect::<Vec<_>>()
    });
    Cells {
        columns: frames.edges.iter().map(|&at| across(at)).collect(),
        rows: rows.collect(),
        colors: colors.collect(),
    }
}

/// Slanting lines over the whole panel: what no cell covers is seen to have no reading.
fn hatch(chart: &mut Chart) -> Result<(), String> {
    let (across, down) = chart.plotting_area().get_pixel_range();
    let (left, right, top, bottom) = (across.start, across.end, down.start, down.end);
    let mut lines = Vec::new();
    let mut offset = left + top;
    while offset < right + bottom {
        // x + y = offset, cut to the panel.
        let (x0, x1) = ((offset - bottom).max(left), (offset - top).min(right));
        lines.push(vec![(x0, offset - x0), (x1, offset - x1)]);
        offset += HATCH * TENTHS;
    }
    let color = plotters_backend::BackendColor {
        alpha: 1.0,
        rgb: rgb_of(Ink::Grid),
    };
    for points in lines {
        note(
            chart,
            Shape::Stroke {
                points,
                width: 9,
                color,
            },
        )?;
    }
    Ok(())
}

fn rgb_of(ink: Ink) -> (u8, u8, u8) {
    let color = ink.color();
    (color.0, color.1, color.2)
}

/// The bar of colours beside the map, with its ticks and its unit.
fn bar(chart: &mut Chart, y: &Axis, scale: &Scale) -> Result<(), String> {
    let (across, down) = chart.plotting_area().get_pixel_range();
    let left = across.end + BAR.0 * TENTHS;
    let edge =
        |k: usize| down.start + ((down.end - down.start) as f64 * k as f64 / LEVELS as f64).round() as i32;
    let shares = (0..LEVELS).rev().map(|k| k as f64 / (LEVELS - 1) as f64);
    let (low, span) = (scale.axis.low, scale.axis.high - scale.axis.low);
    note(
        chart,
        Shape::Cells(Cells {
            columns: vec![left, left + BAR.1 * TENTHS],
            rows: (0..=LEVELS).map(edge).collect(),
            colors: shares.map(|share| scale.color(low + share * span)).collect(),
        }),
    )?;
    let x_high = chart.x_range().end;
    let at = |value: f64| (x_high, y.low + (value - low) / span * (y.high - y.low));
    let style = text_style(Ink::Muted, TICK_SIZE, HPos::Left, VPos::Center);
    for tick in &scale.axis.ticks {
        let right = BAR.0 + BAR.1;
        let mark = plotters::prelude::EmptyElement::at(at(tick.at))
            + PathElement::new(
                [(right * TENTHS, 0), ((right + 3) * TENTHS, 0)],
                Ink::Muted.color().stroke_width(10),
            );
        chart.draw_series([mark]).map_err(|error| error.to_string())?;
        label(chart, at(tick.at), (right + 5, 0), &tick.label, &style)?;
    }
    let unit = text_style(Ink::Text, TICK_SIZE, HPos::Left, VPos::Bottom);
    label(chart, (x_high, y.high), (BAR.0, -6), &scale.axis.title, &unit)
}
