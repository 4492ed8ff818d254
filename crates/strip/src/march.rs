//! A rough centre line: step by step along the strip from the clamp to the tip, whichever way it turns.

use super::gray::Gray;
use super::ground::{Ground, median};
use super::refusal::Untraceable;
use super::silhouette::Root;

/// Centres from which the next one is foretold.
const REMEMBERED: usize = 12;
/// Widths from which the thickness is learnt.
const LEARNT_FROM: usize = 60;
/// Steps at most, however the strip winds.
const MOST_STEPS: usize = 20_000;

/// Middles of the strip, from the clamp to where it ends, and its thickness.
#[derive(Debug, Clone)]
pub struct Rough {
    /// Middles, a step apart, in pixels.
    pub centres: Vec<(f64, f64)>,
    /// Median thickness, pixels.
    pub width: f64,
}

/// How wide the strip is seen across a place, from `low` to `high` along the normal.
#[derive(Debug, Clone, Copy)]
struct Across {
    low: f64,
    high: f64,
}

/// Follows the strip from its root.
///
/// # Errors
/// It leaves the picture, is no strip, or the clamp is in view.
pub fn follow(gray: &Gray, ground: &Ground, root: &Root) -> Result<Rough, Untraceable> {
    let mut walk = Walk::new(gray, ground, root);
    while walk.widths.len() < MOST_STEPS && walk.step() {}
    walk.finish(root)
}

struct Walk<'a> {
    gray: &'a Gray,
    ground: &'a Ground,
    inward: (f64, f64),
    centres: Vec<(f64, f64)>,
    /// Whether the strip was seen at each centre.
    seen: Vec<bool>,
    widths: Vec<f64>,
    width: f64,
    stride: f64,
    /// Steps since the strip was seen last.
    unseen: usize,
}

impl<'a> Walk<'a> {
    fn new(gray: &'a Gray, ground: &'a Ground, root: &Root) -> Walk<'a> {
        let width = root.width.max(1.0);
        Walk {
            gray,
            ground,
            inward: root.side.inward(),
            centres: vec![root.at],
            seen: vec![true],
            widths: Vec::new(),
            width,
            stride: (width / 3.0).clamp(1.5, 5.0),
            unseen: 0,
        }
    }

    /// One step; false where the strip has ended.
    fn step(&mut self) -> bool {
        let (at, along) = self.foretold();
        if !self.gray.holds(at) {
            return false;
        }
        let normal = (-along.1, along.0);
        let found = self.across(at, normal).and_then(|across| self.middle(across));
        match found {
            Some((offset, width)) => {
                self.centres
                    .push((at.0 + offset * normal.0, at.1 + offset * normal.1));
                self.seen.push(true);
                if let Some(width) = width {
                    // Near the clamp the side cuts the strip at an angle: the thickness is learnt soon.
                    self.widths.push(width);
                    if self.widths.len() < 8 {
                        self.width += 0.5 * (width - self.width)
                    } else {
                        let from = self.widths.len().saturating_sub(LEARNT_FROM);
                        self.width = median(&mut self.widths[from..].to_vec());
                    }
                }
                self.unseen = 0;
            }
            None => {
                self.centres.push(at);
                self.seen.push(false);
                self.unseen += 1;
            }
        }
        // A gap as a reflection leaves it is bridged; beyond, the strip has ended.
        (self.unseen as f64) * self.stride <= (2.5 * self.width).max(10.0)
    }

    /// Next place and direction, from a parabola through the last centres.
    fn foretold(&self) -> ((f64, f64), (f64, f64)) {
        let recent = &self.centres[self.centres.len().saturating_sub(REMEMBERED)..];
        let last = recent[recent.len() - 1];
        if recent.len() < 4 {
            let at = (
                last.0 + self.stride * self.inward.0,
                last.1 + self.stride * self.inward.1,
            );
            return (at, self.inward);
        }
        // A parabola only where there are enough centres to tell it from noise.
        let bent = recent.len() >= REMEMBERED && self.unseen == 0;
        let (x, dx) = ahead(recent.iter().map(|centre| centre.0), bent);
        let (y, dy) = ahead(recent.iter().map(|centre| centre.1), bent);
        let length = dx.hypot(dy).max(1e-9);
        let along = (dx / length, dy / length);
        // The foretold place lies one stride on, whatever the spacing of the centres was.
        let from = (x - dx, y - dy);
        (
            (from.0 + self.stride * along.0, from.1 + self.stride * along.1),
            along,
        )
    }

    /// The stretch of the normal that belongs to the strip and lies nearest to `at`.
    fn across(&self, at: (f64, f64), normal: (f64, f64)) -> Option<Across> {
        const SPACING: f64 = 0.5;
        let reach = (1.25 * self.width).max(self.width + 4.0);
        let count = (reach / SPACING).ceil() as i64;
        let above = |k: i64| {
            let n = k as f64 * SPACING;
            let level = self
                .ground
                .level_at(self.gray, at.0 + n * normal.0, at.1 + n * normal.1);
            level - self.ground.threshold
        };
        let nearest = (0..=count)
            .flat_map(|k| [k, -k])
            .take_while(|k| k.abs() as f64 * SPACING <= 0.5 * self.width + 1.0)
            .find(|&k| above(k) > 0.0)?;
        let end = |direction: i64| {
            let mut k = nearest;
            let mut level = above(k);
            while k.abs() <= count {
                let next = above(k + direction);
                if next <= 0.0 {
                    return (k as f64 + direction as f64 * level / (level - next)) * SPACING;
                }
                (k, level) = (k + direction, next);
            }
            k as f64 * SPACING
        };
        Some(Across {
            low: end(-1),
            high: end(1),
        })
    }

    /// Middle of the strip along the normal and, where both edges are seen, its thickness.
    fn middle(&self, Across { low, high }: Across) -> Option<(f64, Option<f64>)> {
        let (found, half) = (high - low, 0.5 * self.width);
        if self.widths.len() < 4 {
            return Some((0.5 * (low + high), Some(found)));
        }
        let even = (0.5 * (low + high)).abs() <= 0.12 * self.width + 0.75;
        let (thin, thick) = if even { (0.3, 2.0) } else { (0.85, 1.2) };
        let slack = if even { 0.0 } else { 1.0 };
        if (thin * self.width - slack..=thick * self.width + slack).contains(&found) {
            return Some((0.5 * (low + high), Some(found)));
        }
        // Something adds to the strip or takes from it at one edge: the other one, where it is expected, counts.
        let (off_low, off_high) = ((low + half).abs(), (high - half).abs());
        let near = 0.2 * self.width + 1.0;
        match (
            off_low.min(off_high) <= near && found > 0.3 * self.width,
            off_low <= off_high,
        ) {
            (false, _) => None,
            (true, true) => Some((low + half, None)),
            (true, false) => Some((high - half, None)),
        }
    }

    fn finish(mut self, root: &Root) -> Result<Rough, Untraceable> {
        let ended = self.end();
        self.centres.truncate(ended + 1);
        let width = median(&mut self.widths.clone());
        let length = ended as f64 * self.stride;
        if length < (4.0 * width).max(20.0) {
            return Err(Untraceable::NoStrip { length, width });
        }
        let early = median(&mut self.widths[..self.widths.len().min(3)].to_vec());
        if early > 2.2 * width.max(3.0) {
            return Err(Untraceable::ClampInView {
                side: root.side.key(),
                at_side: early,
                further: width,
            });
        }
        let (x, y) = self.centres[ended];
        let margin = 0.5 * width + 2.0;
        let distances = [x, self.gray.width() as f64 - x, y, self.gray.height() as f64 - y];
        let leaves = distances.iter().enumerate().any(|(side, distance)| {
            *distance < margin && (side != root.side.index() || length > 8.0 * width)
        });
        if leaves && self.touches_margin((x, y)) {
            return Err(Untraceable::LeavesPicture { x, y });
        }
        Ok(Rough {
            centres: self.centres,
            width,
        })
    }

    /// Index of the last centre of the strip. What follows on a gap and is shorter than the gap is no strip that goes on
    /// behind a reflection, but dust that happens to lie ahead of the tip.
    fn end(&self) -> usize {
        let mut ended = self.seen.iter().rposition(|seen| *seen).unwrap_or(0);
        loop {
            let Some(gap_end) = self.seen[..ended].iter().rposition(|seen| !seen) else {
                return ended;
            };
            let gap_start = self.seen[..gap_end].iter().rposition(|seen| *seen).unwrap_or(0);
            let (after, gap) = ((ended - gap_end) as f64, (gap_end - gap_start) as f64);
            if after > gap && after * self.stride > 1.5 * self.width {
                return ended;
            }
            ended = gap_start;
        }
    }

    /// Whether the outermost pixels next to a place belong to the strip.
    fn touches_margin(&self, (x, y): (f64, f64)) -> bool {
        let (width, height) = (self.gray.width() as f64, self.gray.height() as f64);
        let nearest = [
            (x, (0.5, y)),
            (width - x, (width - 0.5, y)),
            (y, (x, 0.5)),
            (height - y, (x, height - 0.5)),
        ];
        let closest = nearest
            .iter()
            .min_by(|a, b| a.0.total_cmp(&b.0))
            .map_or((x, y), |n| n.1);
        self.ground.level_at(self.gray, closest.0, closest.1) > self.ground.threshold
    }
}

/// Value and slope one step after a series, from the parabola (or straight line) that fits it best.
fn ahead(series: impl ExactSizeIterator<Item = f64>, bent: bool) -> (f64, f64) {
    let n = series.len() as f64;
    let middle = (n - 1.0) / 2.0;
    let (mut s0, mut s1, mut s2, mut u2, mut u4) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for (k, value) in series.enumerate() {
        let u = k as f64 - middle;
        s0 += value;
        s1 += u * value;
        s2 += u * u * value;
        u2 += u * u;
        u4 += u.powi(4);
    }
    let slope = s1 / u2;
    let curve = if bent {
        (s2 - u2 / n * s0) / (u4 - u2 * u2 / n)
    } else {
        0.0
    };
    let mean = s0 / n - curve * u2 / n;
    let u = n - middle;
    (mean + u * (slope + u * curve), slope + 2.0 * curve * u)
}
