//! What is known along a strip, as it is drawn: readings of several places at common times, the simulated values
//! beside them, and shapes that follow from curvatures.

use serde::{Deserialize, Serialize};

use super::{Estimate, Quantity, number_or_null};

/// Frames of a drawn map at most, about: see [`drawn_frames`].
pub const DRAWN_FRAMES: usize = 120;

/// Readings of one place before they are put beside those of others.
#[derive(Debug, Clone, Copy)]
pub struct PlaceSeries<'a> {
    /// Distance from the clamp, mm.
    pub position_mm: f64,
    /// Times, s, increasing.
    pub time_s: &'a [f64],
    /// Readings at these times; empty where only a model speaks of the place.
    pub measured: &'a [f64],
    /// Simulated values at these times; empty where nothing was fitted.
    pub fitted: &'a [f64],
    /// Noise of the readings, same unit; NaN where it is not known.
    pub noise: f64,
}

/// A quantity at several places and common times (frames), thinned for drawing.
///
/// Fits store these, so that pages draw what was computed and never compute.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct AlongCurve {
    /// What is drawn.
    pub quantity: Quantity,
    /// Places, mm from the clamp, increasing.
    pub position_mm: Vec<f64>,
    /// Noise of each place, canonical unit; NaN where it is not known.
    #[serde(deserialize_with = "number_or_null::many")]
    pub noise: Vec<f64>,
    /// Times of the kept frames, s, increasing.
    pub time_s: Vec<f64>,
    /// Readings, place after place, each over all frames; NaN where a place has none. Empty: only a model speaks.
    #[serde(deserialize_with = "number_or_null::many")]
    pub measured: Vec<f64>,
    /// Simulated values in the same order; NaN where the place has no reading. Empty where nothing was fitted.
    #[serde(deserialize_with = "number_or_null::many")]
    pub fitted: Vec<f64>,
    /// Number of frames before thinning.
    pub frames: usize,
}

impl AlongCurve {
    /// Puts places beside each other on all times that any of them has, and thins the frames.
    ///
    /// `edges_s` are the times at which the drive changes. Of several series at one place the first counts: two instruments at one
    /// place are no map. None where there is no place or no time.
    pub fn of(quantity: Quantity, places: &[PlaceSeries], edges_s: &[f64]) -> Option<AlongCurve> {
        let mut places: Vec<&PlaceSeries> = places.iter().collect();
        places.sort_by(|a, b| a.position_mm.total_cmp(&b.position_mm));
        places.dedup_by(|later, first| later.position_mm == first.position_mm);
        let mut time_s: Vec<f64> = places.iter().flat_map(|place| place.time_s).copied().collect();
        time_s.sort_by(f64::total_cmp);
        time_s.dedup();
        if time_s.is_empty() {
            return None;
        }
        let rows = |pick: for<'a> fn(&PlaceSeries<'a>) -> &'a [f64]| -> Vec<Vec<f64>> {
            if places.iter().all(|place| pick(place).is_empty()) {
                Vec::new()
            } else {
                places
                    .iter()
                    .map(|place| spread(&time_s, place.time_s, pick(place)))
                    .collect()
            }
        };
        let (measured, fitted) = (rows(|place| place.measured), rows(|place| place.fitted));
        let told = if measured.is_empty() { &fitted } else { &measured };
        let kept = drawn_frames(&time_s, told, edges_s);
        let thinned = |rows: &[Vec<f64>]| -> Vec<f64> {
            let picked = rows.iter().map(|row| kept.iter().map(|&frame| row[frame]));
            picked.flatten().collect()
        };
        Some(AlongCurve {
            quantity,
            position_mm: places.iter().map(|place| place.position_mm).collect(),
            noise: places.iter().map(|place| place.noise).collect(),
            measured: thinned(&measured),
            fitted: thinned(&fitted),
            time_s: kept.iter().map(|&frame| time_s[frame]).collect(),
            frames: time_s.len(),
        })
    }

    /// Number of places.
    pub fn places(&self) -> usize {
        self.position_mm.len()
    }

    /// Readings of a place over all frames; empty where there are none.
    pub fn measured_at(&self, place: usize) -> &[f64] {
        row(&self.measured, place, self.time_s.len())
    }

    /// Simulated values of a place over all frames; empty where nothing was fitted.
    pub fn fitted_at(&self, place: usize) -> &[f64] {
        row(&self.fitted, place, self.time_s.len())
    }

    /// (measured - simulated) / noise of a place over all frames; NaN where one of them is missing.
    pub fn residual_sigma_at(&self, place: usize) -> Vec<f64> {
        let pairs = self.measured_at(place).iter().zip(self.fitted_at(place));
        pairs
            .map(|(measured, fitted)| (measured - fitted) / self.noise[place])
            .collect()
    }

    /// Ends of the cell that each place stands for, mm: half-way to its neighbours, and as far on the outer side of
    /// the first and the last as on their inner one, but not beyond clamp and tip.
    pub fn cell_edges_mm(&self, length_mm: Option<f64>) -> Vec<(f64, f64)> {
        let at = &self.position_mm;
        let half = |k: usize| 0.5 * (at[k + 1] - at[k]);
        let tip = length_mm.unwrap_or(f64::INFINITY);
        (0..at.len())
            .map(|k| {
                let below = k.checked_sub(1).map(half);
                let above = (k + 1 < at.len()).then(|| half(k));
                let below_mm = below.or(above).unwrap_or(0.5);
                let above_mm = above.or(below).unwrap_or(0.5);
                (
                    (at[k] - below_mm).max(0.0),
                    (at[k] + above_mm).min(tip.max(at[k])),
                )
            })
            .collect()
    }
}

fn row(values: &[f64], place: usize, frames: usize) -> &[f64] {
    values
        .get(place * frames..(place + 1) * frames)
        .unwrap_or_default()
}

/// `values` at `own_s` laid out over `time_s`, which holds all of `own_s`; NaN elsewhere.
fn spread(time_s: &[f64], own_s: &[f64], values: &[f64]) -> Vec<f64> {
    let mut row = vec![f64::NAN; time_s.len()];
    for (time, value) in own_s.iter().zip(values) {
        row[time_s.partition_point(|t| t < time)] = *value;
    }
    row
}

/// Indices (increasing) of the frames that a drawn map keeps: all where there are few; else the first, the last, and
/// in each of 60 stretches of time the two in which some place lies farthest above and farthest below its own mean
/// over the stretch, so that no peak of any place is averaged away and every kept frame is one that was read.
///
/// Half of the stretches have equal length in time, half in the logarithm of the time since the last of `edges_s`, which
/// increase: what follows a change of the drive is fast at first. All edges have as many, and where there are more edges
/// than that the first ones have one each.
/// `rows` holds the values of each place, as long as `time_s`; NaN is passed over.
pub fn drawn_frames(time_s: &[f64], rows: &[Vec<f64>], edges_s: &[f64]) -> Vec<usize> {
    let n = time_s.len();
    if n <= DRAWN_FRAMES {
        return (0..n).collect();
    }
    let half = DRAWN_FRAMES / 4;
    let (first, last) = (time_s[0], time_s[n - 1]);
    let share = |k: usize| (k + 1) as f64 / half as f64;
    let mut kept = vec![0, n - 1];
    let even = (0..half).map(|k| first + (last - first) * share(k));
    keep_excursions(time_s, rows, 0, even, &mut kept);
    let each = (half / edges_s.len().max(1)).max(1);
    for (edge, &edge_s) in edges_s.iter().enumerate().take(half) {
        let start = time_s.partition_point(|&t| t <= edge_s);
        let next = edges_s.get(edge + 1);
        let stop = next.map_or(n, |next_s| time_s.partition_point(|t| t < next_s));
        if start + 1 >= stop {
            continue;
        }
        let (low, high) = ((time_s[start] - edge_s).ln(), (time_s[stop - 1] - edge_s).ln());
        let part = |k: usize| (k + 1) as f64 / each as f64;
        let ends = (0..each).map(|k| edge_s + (low + (high - low) * part(k)).exp());
        keep_excursions(time_s, rows, start, ends, &mut kept);
    }
    kept.sort_unstable();
    kept.dedup();
    kept
}

/// Adds, of each stretch that ends at one of `ends`, the frames with the largest excursion up and down.
fn keep_excursions(
    time_s: &[f64],
    rows: &[Vec<f64>],
    mut start: usize,
    ends: impl Iterator<Item = f64>,
    kept: &mut Vec<usize>,
) {
    for end_s in ends {
        let stop = time_s.partition_point(|&t| t <= end_s).max(start);
        let mut lowest: Option<(f64, usize)> = None;
        let mut highest: Option<(f64, usize)> = None;
        for row in rows {
            let known = || {
                row[start..stop]
                    .iter()
                    .zip(start..)
                    .filter(|(v, _)| v.is_finite())
            };
            let count = known().count();
            let mean = known().map(|(v, _)| v).sum::<f64>() / count.max(1) as f64;
            for (value, frame) in known() {
                let off = value - mean;
                if lowest.is_none_or(|(least, _)| off < least) {
                    lowest = Some((off, frame));
                }
                if highest.is_none_or(|(most, _)| off > most) {
                    highest = Some((off, frame));
                }
            }
        }
        kept.extend(lowest.into_iter().chain(highest).map(|(_, frame)| frame));
        start = stop;
    }
}

/// Where a strip lies at one time, seen from its side.
#[derive(Debug, Clone, PartialEq)]
pub struct StripShape {
    /// Frame of the curvatures that it follows from.
    pub frame: usize,
    /// Distance ahead of the clamp and sideways, mm, the clamp first; from measured curvatures.
    pub measured_mm: Vec<(f64, f64)>,
    /// The same from simulated curvatures; empty where nothing was fitted.
    pub fitted_mm: Vec<(f64, f64)>,
}

/// How much more a strip bends near its clamp than near its tip.
#[derive(Debug, Clone, PartialEq)]
pub struct EndsRatio {
    /// When, s.
    pub time_s: f64,
    /// Mean curvature of the places nearest to the clamp over that of those nearest to the tip; only a lower bound
    /// where the bending near the tip cannot be told from none.
    pub ratio: Estimate,
}

/// Everything that pages show along the strip of one run.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct AlongStrip {
    /// Free length, mm, where it is known.
    pub length_mm: Option<f64>,
    /// Time of the step, s.
    pub step_s: f64,
    /// Whether the drive changes again after the step.
    pub changes_again: bool,
    /// Curvatures, where they were measured at several places.
    pub curvature: Option<AlongCurve>,
    /// Voltages, where they were measured along the strip.
    pub voltage: Option<AlongCurve>,
    /// Simulated voltages at even places from the clamp to the tip; none where nothing was fitted.
    pub voltage_profile: Option<AlongCurve>,
    /// Frames of `voltage` at a few times, spread as those of `shapes`.
    pub voltage_frames: Vec<usize>,
    /// Shapes at a few times, spread over the logarithm of the time since the step.
    pub shapes: Vec<StripShape>,
    /// Shapes of a moving picture: more times in the same spread.
    pub film: Vec<StripShape>,
    /// Places whose means are compared near the clamp, and near the tip: the outermost ones, mm.
    pub ends_mm: Option<[(f64, f64); 2]>,
    /// How uneven the bending is: early, and in the end.
    pub unevenness: Vec<EndsRatio>,
}

#[cfg(test)]
mod tests {
    use super::*;

    fn place<'a>(position_mm: f64, time_s: &'a [f64], measured: &'a [f64]) -> PlaceSeries<'a> {
        PlaceSeries {
            position_mm,
            time_s,
            measured,
            fitted: &[],
            noise: 0.1,
        }
    }

    #[test]
    fn places_with_other_times_leave_cells_empty() {
        let curve = AlongCurve::of(
            Quantity::Curvature,
            &[
                place(8.0, &[0.0, 2.0], &[5.0, 6.0]),
                place(2.0, &[0.0, 1.0, 2.0], &[1.0, 2.0, 3.0]),
                place(2.0, &[0.0], &[9.0]),
            ],
            &[0.0],
        )
        .unwrap();
        assert_eq!(curve.position_mm, [2.0, 8.0]);
        assert_eq!(curve.measured_at(0), [1.0, 2.0, 3.0]);
        let second = curve.measured_at(1);
        assert!(second[0] == 5.0 && second[1].is_nan() && second[2] == 6.0);
        assert!(curve.fitted.is_empty() && curve.fitted_at(1).is_empty());
        assert_eq!(AlongCurve::of(Quantity::Curvature, &[], &[0.0]), None);
    }

    #[test]
    fn cells_end_half_way_and_within_the_strip() {
        let curve = |at: &[f64]| {
            let places: Vec<PlaceSeries> = at.iter().map(|&mm| place(mm, &[0.0], &[1.0])).collect();
            AlongCurve::of(Quantity::Curvature, &places, &[0.0]).unwrap()
        };
        let edges = curve(&[1.0, 5.0, 7.0]).cell_edges_mm(Some(7.5));
        assert_eq!(edges, [(0.0, 3.0), (3.0, 6.0), (6.0, 7.5)]);
        assert_eq!(curve(&[4.0]).cell_edges_mm(None), [(3.5, 4.5)]);
    }

    #[test]
    fn a_peak_of_one_place_in_one_frame_survives_thinning() {
        let time_s: Vec<f64> = (0..20_000).map(|k| f64::from(k) * 0.05 - 2.0).collect();
        let mut rows: Vec<Vec<f64>> = (1..20)
            .map(|k| time_s.iter().map(|t| t.max(0.0) / f64::from(k)).collect())
            .collect();
        rows[11][17_345] += 500.0;
        rows[3][60] -= 30.0;
        rows[5][9] = f64::NAN;
        let kept = drawn_frames(&time_s, &rows, &[0.0]);
        assert!(kept.len() <= DRAWN_FRAMES + 2, "{}", kept.len());
        assert!(kept.contains(&17_345) && kept.contains(&60));
        assert_eq!((kept[0], kept[kept.len() - 1]), (0, 19_999));
        assert!(kept.windows(2).all(|pair| pair[0] < pair[1]));
    }

    #[test]
    fn what_follows_a_later_change_of_the_drive_is_kept_too() {
        let time_s: Vec<f64> = (0..10_000).map(|k| f64::from(k) * 0.1).collect();
        let rows = [time_s.iter().map(|t| (t % 500.0).min(3.0)).collect()];
        let soon = |edges_s: &[f64]| {
            let kept = drawn_frames(&time_s, &rows, edges_s);
            assert!(kept.len() <= DRAWN_FRAMES + 2, "{}", kept.len());
            kept.iter()
                .filter(|&&frame| (5001..5030).contains(&frame))
                .count()
        };
        assert!(soon(&[0.0]) <= 2);
        assert!(soon(&[0.0, 500.0]) >= 6);
        let many: Vec<f64> = (0..900).map(f64::from).collect();
        assert!(drawn_frames(&time_s, &rows, &many).len() <= DRAWN_FRAMES + 2);
    }
}
