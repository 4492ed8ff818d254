//! Edges of the strip along the normals of its centre line, to a fraction of a pixel.
//!
//! An edge lies where the light that is missing (or added) beyond the strip's middle would end if it ended sharply:
//! levels are summed along the normal and divided by the strip's own level. The sum is the same wherever an edge falls
//! within a pixel and however blurred it is, which a crossing of half the level is not.

use super::curve::Curve;
use super::gray::Gray;
use super::ground::{Ground, median};
use super::steady::running_median;
use super::thickness;
use ieap_numerics::sums::mean;

/// Distance between readings along a normal, pixels.
pub const SPACING: f64 = 0.5;
/// How far beyond its expected edge the strip is looked at, pixels: blur must have ended there.
pub const MARGIN: f64 = 5.0;
/// How far inside its expected edge a settled strip is looked at, pixels.
const INWARD: f64 = 5.0;
/// Readings to either side that give the level of a settled strip at most.
const CORE: usize = 3;
/// Readings at either end of a normal that give the ground there.
pub const OUTER: usize = 5;
/// Stretch, as a share of the length, over which thickness and levels are taken for steady.
const STEADY: f64 = 0.08;
/// The middle's level may differ by this share before something lies before the strip, or it is not there.
pub const COVERED: f64 = 0.3;

/// What is measured at places along the strip, a pixel or so apart.
#[derive(Debug, Clone, Default)]
pub struct Edges {
    /// Offset of the strip's middle from the curve, by the edge to either side; none where that edge is not seen.
    pub middle: [Vec<Option<f64>>; 2],
    /// Thickness, pixels.
    pub width: Vec<f64>,
    /// Level of the strip's middle.
    pub inside: Vec<f64>,
    /// Whether the thickness seen at a place is not the strip's: at least one edge is something else's.
    pub doubtful: Vec<bool>,
    /// Thickness just before the tip, pixels.
    pub width_at_tip: f64,
}

/// Measures the edges at every place of the curve; `width` is the thickness expected.
///
/// Once the curve lies on the strip (`settled`), only what is near an edge is looked at: light that is uneven across a
/// thick strip, or something at its other edge, does not matter then.
pub fn measure(gray: &Gray, ground: &Ground, curve: &Curve, width: &[f64], settled: bool) -> Edges {
    let n = curve.places();
    let window = ((STEADY * n as f64) as usize).max(12);
    let profiles: Vec<Profile> = (0..n)
        .map(|k| Profile::at(gray, ground, curve, k, width[k], settled))
        .collect();
    let steady =
        |of: &dyn Fn(&Profile) -> f64| running_median(&profiles.iter().map(of).collect::<Vec<_>>(), window);
    let inside = steady(&|profile| profile.centre());
    let mut distances = [0, 1].map(|side: usize| {
        let level = steady(&|profile| profile.inside(side));
        let outside = steady(&|profile| profile.outside(side));
        let seen = |k: usize| {
            let contrast = level[k] - outside[k];
            let excess = profiles[k].sum(side) - profiles[k].summed() * outside[k];
            let like_strip = (profiles[k].inside(side) - level[k]).abs() < COVERED * inside[k].abs();
            (like_strip && contrast > 0.25 * inside[k].abs())
                .then(|| profiles[k].skipped() + excess * SPACING / contrast)
        };
        (0..n).map(seen).collect::<Vec<Option<f64>>>()
    });
    for (k, profile) in profiles.iter().enumerate() {
        let covered = (profile.centre() - inside[k]).abs() >= COVERED * inside[k].abs();
        if (covered && !settled) || !in_view(gray, curve, k, profile.reach()) {
            distances.iter_mut().for_each(|side| side[k] = None);
        }
    }
    let [low, high] = distances;
    let both: Vec<f64> = low
        .iter()
        .zip(&high)
        .map(|(low, high)| low.zip(*high).map_or(f64::NAN, |(low, high)| low + high))
        .collect();
    let doubtful = thickness::doubtful(&both);
    let sure: Vec<f64> = both
        .iter()
        .zip(&doubtful)
        .map(|(width, doubtful)| if *doubtful { f64::NAN } else { *width })
        .collect();
    let thickness = steady_thickness(&sure, width, window);
    let near_tip = (2.0 * width[n - 1]) as usize + 8;
    let mut last: Vec<f64> = sure[n.saturating_sub(near_tip)..]
        .iter()
        .copied()
        .filter(|width| width.is_finite())
        .collect();
    let width_at_tip = if last.is_empty() {
        thickness[n - 1]
    } else {
        median(&mut last)
    };
    let middle = |distance: &[Option<f64>], sign: f64| {
        distance
            .iter()
            .zip(&thickness)
            .map(|(distance, width)| distance.map(|d| sign * (d - 0.5 * width)))
            .collect()
    };
    Edges {
        middle: [middle(&low, -1.0), middle(&high, 1.0)],
        width: thickness,
        inside,
        doubtful,
        width_at_tip,
    }
}

/// Levels along a normal, from one side of the strip to the other.
struct Profile {
    levels: Vec<f64>,
    /// Readings to either side of the middle.
    half: usize,
    /// Readings from the middle on that are not summed.
    skipped: usize,
    /// Readings to either side of where the strip's own level is taken.
    core: usize,
}

impl Profile {
    fn at(gray: &Gray, ground: &Ground, curve: &Curve, k: usize, width: f64, settled: bool) -> Profile {
        let half = ((0.5 * width.max(1.0) + MARGIN) / SPACING).ceil() as usize;
        let ((x, y), (nx, ny)) = (curve.point(k), curve.normal(k));
        let level = |i: usize| {
            let offset = (i as f64 - half as f64) * SPACING;
            ground.level_at(gray, x + offset * nx, y + offset * ny)
        };
        let skipped = if settled {
            (((0.5 * width - INWARD) / SPACING).max(0.0)) as usize
        } else {
            0
        };
        let core = ((0.15 * width / SPACING) as usize).max(1).min(half);
        Profile {
            levels: (0..=2 * half).map(level).collect(),
            half,
            skipped,
            core: if skipped > 0 { core.min(CORE) } else { core },
        }
    }

    /// Reading a number of steps from the middle toward a side.
    fn toward(&self, side: usize, i: usize) -> f64 {
        self.levels[if side == 0 { self.half - i } else { self.half + i }]
    }

    /// Level of the middle.
    fn centre(&self) -> f64 {
        mean(&self.levels[self.half - self.core..=self.half + self.core])
    }

    /// The strip's own level, where the sum toward an edge begins.
    fn inside(&self, side: usize) -> f64 {
        let middle = match side {
            0 => self.half - self.skipped,
            _ => self.half + self.skipped,
        };
        mean(&self.levels[middle - self.core..=middle + self.core])
    }

    /// The ground's level beyond an edge.
    fn outside(&self, side: usize) -> f64 {
        match side {
            0 => mean(&self.levels[..OUTER]),
            _ => mean(&self.levels[self.levels.len() - OUTER..]),
        }
    }

    /// Sum of the levels toward an edge. Half of the first reading belongs to it.
    fn sum(&self, side: usize) -> f64 {
        let beyond: f64 = (self.skipped + 1..=self.half).map(|i| self.toward(side, i)).sum();
        beyond + 0.5 * self.toward(side, self.skipped)
    }

    /// Readings in that sum.
    fn summed(&self) -> f64 {
        (self.half - self.skipped) as f64 + 0.5
    }

    /// Distance from the middle to where the sum begins, pixels.
    fn skipped(&self) -> f64 {
        self.skipped as f64 * SPACING
    }

    /// Distance from the middle to the last reading, pixels.
    fn reach(&self) -> f64 {
        self.half as f64 * SPACING
    }
}

/// Whether the normal at a place lies in the picture.
fn in_view(gray: &Gray, curve: &Curve, k: usize, reach: f64) -> bool {
    let ((x, y), (nx, ny)) = (curve.point(k), curve.normal(k));
    [-reach, reach]
        .iter()
        .all(|n| gray.holds((x + n * nx, y + n * ny)))
}

/// Running median of the thickness where both edges are seen; elsewhere what was expected.
fn steady_thickness(both: &[f64], expected: &[f64], window: usize) -> Vec<f64> {
    if both.iter().all(|width| width.is_nan()) {
        return expected.to_vec();
    }
    running_median(both, 2 * window)
}
