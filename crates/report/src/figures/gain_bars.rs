//! How much better each candidate describes the readings, beside what chance alone gives.

use plotters::element::{PathElement, Rectangle};
use plotters::style::Color;

use super::axis::{Axis, Scale, Tick};
use super::canvas::{Ink, svg};
use super::panel::{Margins, panel};
use ieap_domain::Candidate;

const WIDTH: u32 = 760;
const ROW_HEIGHT: u32 = 26;
/// Room for the names, px.
const NAMES_WIDTH: u32 = 210;
const AXIS_HEIGHT: u32 = 46;

/// Draws the gains of `candidates`, the first at the top, with the band that chance fills in 95 % of groups in
/// which nothing is wrong. None where there is no candidate.
///
/// # Errors
/// The message of the drawing library.
pub fn gain_bars(
    candidates: &[&Candidate],
    gain_at_5_percent: Option<f64>,
    title: &str,
    desc: &str,
) -> Result<Option<String>, String> {
    if candidates.is_empty() {
        return Ok(None);
    }
    let x = horizontal(candidates, gain_at_5_percent);
    let y = rows(candidates);
    let height = candidates.len() as u32 * ROW_HEIGHT + AXIS_HEIGHT + 10;
    let drawn = svg((WIDTH, height), title, desc, |area| {
        let margins = Margins {
            left: NAMES_WIDTH,
            right: 20,
            top: 10,
            bottom: AXIS_HEIGHT,
        };
        let mut chart = panel(area, margins, &x, &y, true)?;
        let mut bar = |from: f64, to: f64, row: (f64, f64), ink: Ink, opacity: f64| {
            let corners = [(from, row.0), (to, row.1)];
            let style = ink.color().mix(opacity).filled();
            chart
                .draw_series([Rectangle::new(corners, style)])
                .map(|_| ())
                .map_err(|error| error.to_string())
        };
        if let Some(chance) = gain_at_5_percent.filter(|gain| *gain > 0.0) {
            bar(x.low, x.position(chance), (y.low, y.high), Ink::Muted, 0.22)?;
        }
        for (place, candidate) in candidates.iter().enumerate() {
            let middle = row_of(place);
            let ink = if candidate.accepted { Ink::Blue } else { Ink::Sky };
            if let Some(end) = end_of(&x, Some(candidate.forecast_gain)) {
                bar(x.low, end, (middle + 0.08, middle + 0.36), Ink::Orange, 1.0)?;
            }
            if let Some(end) = end_of(&x, candidate.fitted_gain) {
                bar(x.low, end, (middle - 0.36, middle + 0.02), ink, 1.0)?;
            }
        }
        if let Some(chance) = gain_at_5_percent.filter(|gain| *gain > 0.0) {
            let line = [(x.position(chance), y.low), (x.position(chance), y.high)];
            chart
                .draw_series([PathElement::new(line, Ink::Text.color().stroke_width(12))])
                .map_err(|error| error.to_string())?;
        }
        Ok(())
    })?;
    Ok(Some(drawn))
}

/// End of a bar; none where there is nothing to show.
fn end_of(x: &Axis, gain: Option<f64>) -> Option<f64> {
    let gain = gain.filter(|gain| gain.is_finite() && *gain > 0.0)?;
    Some(x.position(gain).clamp(x.low, x.high))
}

/// A logarithmic axis from below what chance gives to the best candidate.
fn horizontal(candidates: &[&Candidate], gain_at_5_percent: Option<f64>) -> Axis {
    let gains = candidates
        .iter()
        .flat_map(|candidate| [Some(candidate.forecast_gain), candidate.fitted_gain])
        .flatten()
        .chain(gain_at_5_percent);
    let most = gains.filter(|gain| gain.is_finite()).fold(10.0, f64::max);
    Axis::log(
        1.0,
        1.2 * most,
        "Gain (fall of the sum of squares in units of the noise)",
        "",
    )
}

fn row_of(place: usize) -> f64 {
    -(place as f64)
}

fn rows(candidates: &[&Candidate]) -> Axis {
    let tick = |(place, candidate): (usize, &&Candidate)| Tick {
        at: row_of(place),
        label: candidate.effect.clone(),
    };
    Axis {
        scale: Scale::Names,
        low: row_of(candidates.len()) + 0.5,
        high: 0.5,
        ticks: candidates.iter().enumerate().map(tick).collect(),
        title: String::new(),
        shown_factor: 1.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ieap_domain::testing::candidate;

    #[test]
    fn every_candidate_is_named_and_odd_gains_do_no_harm() {
        let all = [
            candidate("faradaic-leak", 812.0, Some(790.0)),
            candidate("warburg", f64::INFINITY, None),
            candidate("creep", 0.0, Some(f64::NAN)),
        ];
        let shown: Vec<&Candidate> = all.iter().collect();
        let drawn = gain_bars(&shown, Some(8.2), "t", "d").unwrap().unwrap();
        assert!(all.iter().all(|candidate| drawn.contains(&candidate.effect)));
        assert_eq!(gain_bars(&[], None, "t", "d").unwrap(), None);
    }
}
