//! Where the store meets the model for pages: what is known along the strip of a run, with shapes from curvatures.

use crate::domain::quantiles::NORMAL_95_ROUNDED;
use crate::domain::{
    AlongCurve, AlongStrip, Campaign, Channel, ClimateCurve, CurveSource, Drive, EndsRatio, Estimate,
    PlaceSeries, Quantity, RunCurve, RunRecord, StripShape, tag::keys,
};
use crate::model::geometry::Shape;
use crate::numerics::noise::scatter_between;
use crate::pipeline::fits::drawn::DrawnFits;
use crate::pipeline::{Context, PipelineError};
use crate::store::Store;
use std::collections::BTreeMap;

/// Shapes that a page shows at once.
const SHAPES: usize = 6;
/// Shapes of a moving picture.
const FILM: usize = 28;
/// Links of a drawn chain at least.
const LINKS: usize = 19;
/// Share of the places that are compared at either end.
const END_SHARE: usize = 4;
/// Bending near the clamp over its noise from which it is compared with that near the tip.
const CLEAR: f64 = 10.0;
/// Bending near the tip over its noise below which a ratio to it is only bounded.
const SEEN: f64 = 3.0;

/// Curves of runs as pages and figures ask for them.
pub(crate) struct PageCurves<'a> {
    store: &'a Store,
    campaign: &'a Campaign,
    fits: DrawnFits<'a>,
    by_id: BTreeMap<i64, &'a RunRecord>,
}

impl<'a> PageCurves<'a> {
    pub(crate) fn new(context: &'a Context, runs: &'a [RunRecord]) -> PageCurves<'a> {
        PageCurves {
            store: &context.store,
            campaign: &context.campaign,
            fits: DrawnFits::new(context),
            by_id: runs.iter().map(|run| (run.id, run)).collect(),
        }
    }

    fn strip(&self, run: &RunRecord) -> Result<Option<AlongStrip>, PipelineError> {
        let mut curves = self.fits.of(run)?.along;
        let step_s = step_s(run.drive.as_ref());
        if curves.is_empty() {
            let edges_s = run.drive.as_ref().map_or(vec![step_s], Drive::edges_s);
            curves = measured(&self.store.channels(run.id)?, &edges_s);
        }
        let mut take = |quantity: Quantity, is_measured: bool| {
            let at = curves
                .iter()
                .position(|curve| curve.quantity == quantity && curve.measured.is_empty() != is_measured)?;
            Some(curves.remove(at))
        };
        let curvature = take(Quantity::Curvature, true).filter(|curve| curve.places() > 1);
        let voltage = take(Quantity::Voltage, true).filter(|curve| curve.places() > 1);
        let voltage_profile = take(Quantity::Voltage, false);
        if curvature.is_none() && voltage.is_none() {
            return Ok(None);
        }
        let length_mm = run
            .tag(keys::SAMPLE)
            .and_then(|id| self.campaign.sample(id))
            .and_then(|sample| sample.length_mm);
        let last_s = [&curvature, &voltage].into_iter().flatten();
        let last_s = last_s.fold(step_s, |last, curve| {
            curve.time_s.last().map_or(last, |t| t.max(last))
        });
        let mut strip = AlongStrip {
            length_mm,
            step_s,
            changes_again: changes_again(run.drive.as_ref(), step_s, last_s),
            curvature,
            voltage_frames: Vec::new(),
            voltage,
            voltage_profile,
            shapes: Vec::new(),
            film: Vec::new(),
            ends_mm: None,
            unevenness: Vec::new(),
        };
        derive(&mut strip);
        Ok(Some(strip))
    }
}

impl CurveSource for PageCurves<'_> {
    fn curves(&self, run_id: i64) -> Result<Vec<RunCurve>, String> {
        let of_fit = self.by_id.get(&run_id).map(|run| self.fits.of(run));
        match of_fit.transpose().map_err(|error| error.to_string())? {
            Some(of_fit) if !of_fit.curves.is_empty() => Ok(of_fit.curves),
            _ => self.store.curves(run_id),
        }
    }

    fn climate_curves(&self, run_id: i64) -> Result<Vec<ClimateCurve>, String> {
        self.store.climate_curves(run_id)
    }

    fn drawn_from(&self, run_id: i64) -> Result<Option<String>, String> {
        self.store.drawn_from(run_id)
    }

    fn along(&self, run_id: i64) -> Result<Option<AlongStrip>, String> {
        match self.by_id.get(&run_id) {
            Some(run) if run.is_along() => self.strip(run).map_err(|error| error.to_string()),
            _ => Ok(None),
        }
    }
}

/// When the drive first changes, s.
fn step_s(drive: Option<&Drive>) -> f64 {
    drive
        .and_then(|drive| drive.segments.first())
        .map_or(0.0, |segment| segment.start_s())
}

fn changes_again(drive: Option<&Drive>, step_s: f64, last_s: f64) -> bool {
    let later = |drive: &Drive| {
        let mut starts = drive.segments.iter().map(|segment| segment.start_s());
        starts.any(|start_s| start_s > step_s && start_s < last_s)
    };
    drive.is_some_and(later)
}

/// Readings along the strip of a run that no distributed model was fitted to.
fn measured(channels: &[Channel], edges_s: &[f64]) -> Vec<AlongCurve> {
    let of = |quantity: Quantity| {
        let placed = channels
            .iter()
            .filter(|channel| channel.quantity == quantity && !channel.is_empty());
        let readings: Vec<_> = placed
            .filter_map(|channel| Some((channel.position_mm?, channel.included())))
            .collect();
        let places: Vec<PlaceSeries> = readings
            .iter()
            .map(|(position_mm, (time_s, values))| PlaceSeries {
                position_mm: *position_mm,
                time_s,
                measured: values,
                fitted: &[],
                noise: noise(time_s, values, edges_s),
            })
            .collect();
        AlongCurve::of(quantity, &places, edges_s)
    };
    [Quantity::Curvature, Quantity::Voltage]
        .into_iter()
        .filter_map(of)
        .collect()
}

/// Noise of a series without a model; NaN where it is too short to tell.
fn noise(time_s: &[f64], values: &[f64], edges_s: &[f64]) -> f64 {
    scatter_between(time_s, values, edges_s).map_or(f64::NAN, |scatter| scatter.standard_deviation)
}

/// Fills in what follows from the curves.
fn derive(strip: &mut AlongStrip) {
    if let Some(voltage) = &strip.voltage {
        strip.voltage_frames = chosen(voltage, strip, SHAPES);
    }
    let Some(curvature) = &strip.curvature else { return };
    let shape = |frame: usize| shape(curvature, frame, strip.length_mm);
    let few: Vec<StripShape> = chosen(curvature, strip, SHAPES).into_iter().map(shape).collect();
    let film: Vec<StripShape> = chosen(curvature, strip, FILM).into_iter().map(shape).collect();
    let near = (curvature.places() / END_SHARE).max(1);
    let last = curvature.places() - 1;
    let at = &curvature.position_mm;
    strip.ends_mm = Some([(at[0], at[near - 1]), (at[last + 1 - near], at[last])]);
    let ratios: Vec<EndsRatio> = few
        .iter()
        .filter_map(|shape| ends_ratio(curvature, shape.frame, near))
        .collect();
    let ends = [ratios.first(), ratios.last().filter(|_| ratios.len() > 1)];
    strip.unevenness = ends.into_iter().flatten().cloned().collect();
    (strip.shapes, strip.film) = (few, film);
}

/// At most `count` frames in which every place has a reading, spread evenly over the logarithm of the time since the
/// step, or over time where the drive changes again.
fn chosen(curve: &AlongCurve, strip: &AlongStrip, count: usize) -> Vec<usize> {
    let on_scale = |frame: usize| {
        let since_s = curve.time_s[frame] - strip.step_s;
        if strip.changes_again {
            since_s
        } else {
            since_s.ln()
        }
    };
    let whole = |frame: &usize| (0..curve.places()).all(|place| curve.measured_at(place)[*frame].is_finite());
    let after = (0..curve.time_s.len()).filter(|&frame| curve.time_s[frame] > strip.step_s);
    let known: Vec<usize> = after.filter(whole).collect();
    let (Some(&first), Some(&last)) = (known.first(), known.last()) else {
        return Vec::new();
    };
    let (low, high) = (on_scale(first), on_scale(last));
    let mut frames: Vec<usize> = (0..count)
        .filter_map(|k| {
            let wanted = low + (high - low) * k as f64 / (count - 1) as f64;
            let off = |frame: &usize| (on_scale(*frame) - wanted).abs();
            known.iter().copied().min_by(|a, b| off(a).total_cmp(&off(b)))
        })
        .collect();
    frames.dedup();
    frames
}

/// The strip as a chain of arcs, one for the cell of each place; those of the outermost places reach to clamp and tip.
fn shape(curve: &AlongCurve, frame: usize, length_mm: Option<f64>) -> StripShape {
    let cells = curve.cell_edges_mm(length_mm);
    let last = cells.len() - 1;
    let parts = LINKS.div_ceil(cells.len());
    let placed = |values: &dyn Fn(usize) -> f64| -> Vec<(f64, f64)> {
        let mut links = Vec::new();
        for (place, &(from, to)) in cells.iter().enumerate() {
            let from = if place == 0 { 0.0 } else { from };
            let to = if place == last {
                length_mm.unwrap_or(to).max(to)
            } else {
                to
            };
            let link_cm = 0.1 * (to - from) / parts as f64;
            links.extend(std::iter::repeat_n((values(place), link_cm), parts));
        }
        let shape = Shape::from_links(&links);
        let joints = shape.x_cm.iter().zip(&shape.y_cm);
        joints.map(|(x, y)| (10.0 * x, 10.0 * y)).collect()
    };
    StripShape {
        frame,
        measured_mm: placed(&|place| curve.measured_at(place)[frame]),
        fitted_mm: if curve.fitted.is_empty() {
            Vec::new()
        } else {
            placed(&|place| curve.fitted_at(place)[frame])
        },
    }
}

/// Mean curvature of the `near` places at the clamp over that of as many at the tip. Neighbouring places of a traced
/// strip err together, so that a mean is taken to be known no better than one place.
fn ends_ratio(curve: &AlongCurve, frame: usize, near: usize) -> Option<EndsRatio> {
    let places = curve.places();
    let mean = |from: usize| {
        (from..from + near)
            .map(|k| curve.measured_at(k)[frame])
            .sum::<f64>()
            / near as f64
    };
    let error = |from: usize| {
        let squares = curve.noise[from..from + near].iter().map(|noise| noise * noise);
        (squares.sum::<f64>() / near as f64).sqrt()
    };
    let (clamp, clamp_error) = (mean(0), error(0));
    let (tip, tip_error) = (mean(places - near), error(places - near));
    // An error that is not known is no reason to call the bending clear.
    if clamp_error.is_nan() || clamp.abs() <= CLEAR * clamp_error {
        return None;
    }
    let ratio = if tip.abs() > SEEN * tip_error {
        let ratio = clamp / tip;
        let error = ratio.abs() * (clamp_error / clamp).hypot(tip_error / tip);
        Estimate::determined(
            ratio,
            error,
            ratio - NORMAL_95_ROUNDED * error,
            ratio + NORMAL_95_ROUNDED * error,
        )
    } else {
        let least = clamp.abs() - NORMAL_95_ROUNDED * clamp_error;
        let most = tip.abs() + NORMAL_95_ROUNDED * tip_error;
        Estimate::above(least / most, "the bending near the tip cannot be told from none")
    };
    Some(EndsRatio {
        time_s: curve.time_s[frame],
        ratio,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(values: &[&[f64]], noise: f64) -> AlongCurve {
        let time_s: Vec<f64> = (0..values[0].len()).map(|k| 10f64.powi(k as i32 - 1)).collect();
        let places: Vec<PlaceSeries> = values
            .iter()
            .zip(0..)
            .map(|(measured, k)| PlaceSeries {
                position_mm: 5.0 + 10.0 * f64::from(k),
                time_s: &time_s,
                measured,
                fitted: &[],
                noise,
            })
            .collect();
        AlongCurve::of(Quantity::Curvature, &places, &[0.0]).unwrap()
    }

    fn strip(curvature: AlongCurve) -> AlongStrip {
        let mut strip = AlongStrip {
            length_mm: Some(20.0),
            step_s: 0.0,
            changes_again: false,
            curvature: Some(curvature),
            voltage: None,
            voltage_profile: None,
            voltage_frames: Vec::new(),
            shapes: Vec::new(),
            film: Vec::new(),
            ends_mm: None,
            unevenness: Vec::new(),
        };
        derive(&mut strip);
        strip
    }

    #[test]
    fn an_even_curvature_gives_an_arc_that_ends_where_the_circle_says() {
        let kappa = 0.9;
        let strip = strip(curve(&[&[0.0, kappa], &[0.0, kappa]], 1e-3));
        let tip = *strip.shapes.last().unwrap().measured_mm.last().unwrap();
        let turn = kappa * 2.0;
        assert!((tip.0 - 10.0 * f64::sin(turn) / kappa).abs() < 1e-12);
        assert!((tip.1 - 10.0 * (1.0 - f64::cos(turn)) / kappa).abs() < 1e-12);
        assert_eq!(strip.shapes.last().unwrap().measured_mm.len(), 21);
    }

    #[test]
    fn frames_with_a_hole_have_no_shape() {
        let strip = strip(curve(&[&[0.1, 0.2, 0.3], &[0.1, f64::NAN, 0.2]], 1e-3));
        let frames: Vec<usize> = strip.shapes.iter().map(|shape| shape.frame).collect();
        assert_eq!(frames, [0, 2]);
    }

    #[test]
    fn the_ends_are_compared_with_their_noise() {
        let found = strip(curve(&[&[0.01, 0.6, 0.5], &[0.0, 0.001, 0.25]], 0.01)).unevenness;
        assert_eq!(found.len(), 2, "{found:?}");
        let early = &found[0].ratio;
        assert!(early.value.is_none() && early.low_95.is_some_and(|low| low > 25.0 && low < 29.0));
        let late = &found[1].ratio;
        assert_eq!(late.value, Some(2.0));
        let error = 2.0 * f64::hypot(0.02, 0.04);
        assert!((late.standard_error.unwrap() - error).abs() < 1e-12);
        let unknown = strip(curve(&[&[0.5], &[0.2]], f64::NAN));
        assert!(unknown.unevenness.is_empty());
    }
}
