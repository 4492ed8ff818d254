//! From a picture to the centre line of the strip.

use super::View;
use super::curve::Curve;
use super::edges::{self, Edges};
use super::first_curve::first_curve;
use super::gray::Gray;
use super::ground::Ground;
use super::march::{self, Rough};
use super::refusal::Untraceable;
use super::silhouette::{Root, Silhouette};
use super::smooth::{Equations, Solution};
use super::tip;
use super::traced::Trace;

/// Fewest pixels to a side of a picture.
const LEAST_SIDE: usize = 32;
/// Rounds of measuring the edges and moving the curve at most.
const MOST_ROUNDS: usize = 9;
/// By how much the curve may be off the strip in the first rounds, pixels.
const DOUBTS_PX: [f64; 3] = [0.6, 0.25, 0.1];
/// A step moves the line by at most this many thicknesses, and pixels in addition.
const LONGEST_STEP: (f64, f64) = (1.0, 4.0);
/// The curve stands still where its tip moves by less than this, pixels.
const STANDS_STILL: f64 = 0.02;
/// Longest stretch that may be hidden, as a share of the length.
const LONGEST_HIDDEN: f64 = 0.12;
/// Longest stretch on which the strip is seen but not where exactly, as a share of the length.
const LONGEST_DOUBTFUL: f64 = 0.25;
/// Scatter of an edge that is allowed, as a share of the thickness.
const MOST_SCATTER: f64 = 0.2;
/// Share of the strip's pixels that another thing may have.
const SHARE_ELSEWHERE: f64 = 0.25;
/// Share of the strip's pixels that may lie off the line though they are connected with it: fibres, dust.
const SHARE_OFF: f64 = 0.1;
/// The tip may move by this much in the last round, pixels.
const TIP_SETTLED: f64 = 1.0;

/// Traces the strip in a picture.
///
/// # Errors
/// [`Untraceable`] with the reason, wherever the line would have to be guessed.
pub fn trace(gray: &Gray, view: &View) -> Result<Trace, Untraceable> {
    let Some(crop) = view.crop else {
        return trace_whole(gray, view, (0.0, 0.0));
    };
    let part = gray.part(&crop).ok_or(Untraceable::Crop {
        left: crop.left,
        top: crop.top,
        width: crop.width,
        height: crop.height,
        picture_width: gray.width(),
        picture_height: gray.height(),
    })?;
    let corner = (crop.left as f64, crop.top as f64);
    trace_whole(&part, view, corner).map_err(|refusal| refusal.moved(corner))
}

fn trace_whole(gray: &Gray, view: &View, corner: (f64, f64)) -> Result<Trace, Untraceable> {
    if gray.width().min(gray.height()) < LEAST_SIDE {
        return Err(Untraceable::TooSmall {
            width: gray.width(),
            height: gray.height(),
            needed: LEAST_SIDE,
        });
    }
    let ground = Ground::of(gray, view.tone)?;
    let silhouette = Silhouette::of(gray, &ground);
    let root = silhouette.root(view.clamp)?;
    let rough = march::follow(gray, &ground, &root)?;
    let fitted = Fitting::new(gray, &ground, &root, &rough).run()?;
    fitted.check_seen()?;
    check_rest(&silhouette, &root, &fitted)?;
    Ok(Trace {
        covariance: fitted.solution.covariance,
        width: fitted.edges.width,
        corner,
        clamp: root.side,
        tone: ground.tone(),
        edge_noise_px: fitted.equations.noise,
        bandwidth_px: fitted.solution.bandwidth,
        tip_error_px: fitted.tip_error,
        seen: fitted.equations.weight.iter().filter(|w| **w > 0.2).count() as f64
            / fitted.curve.places() as f64,
        curve: fitted.curve,
    })
}

/// The search for the line.
struct Fitting<'a> {
    gray: &'a Gray,
    ground: &'a Ground,
    curve: Curve,
    width: Vec<f64>,
    /// Place to which the strip was followed, and how far the tip may lie from there.
    followed: ((f64, f64), f64),
}

/// What it found.
struct Fitted {
    curve: Curve,
    edges: Edges,
    equations: Equations,
    solution: Solution,
    tip_error: f64,
}

impl<'a> Fitting<'a> {
    fn new(gray: &'a Gray, ground: &'a Ground, root: &Root, rough: &Rough) -> Fitting<'a> {
        let curve = first_curve(root, rough);
        let width = vec![rough.width; curve.places()];
        Fitting {
            gray,
            ground,
            followed: (rough.centres[rough.centres.len() - 1], 2.0 * rough.width + 6.0),
            curve,
            width,
        }
    }

    fn run(mut self) -> Result<Fitted, Untraceable> {
        let mut round = 0;
        loop {
            let edges = edges::measure(self.gray, self.ground, &self.curve, &self.width, round >= 2);
            let tip = self.tip(&edges);
            let equations = Equations::new(&self.curve, &edges, DOUBTS_PX.get(round).copied().unwrap_or(0.0));
            let solution = equations.solve(&self.curve);
            let next = self.moved(&solution, tip.0);
            let last = self.curve.places() - 1;
            let (old, new) = (self.curve.point(last), next.point(next.places() - 1));
            let still = (old.0 - new.0).hypot(old.1 - new.1) < STANDS_STILL;
            round += 1;
            if (still && round > DOUBTS_PX.len()) || round == MOST_ROUNDS {
                let (x, y) = new;
                if tip.0.abs() > TIP_SETTLED.max(tip.1) {
                    return Err(Untraceable::NoTip { x, y });
                }
                return Ok(Fitted {
                    curve: next,
                    edges,
                    equations,
                    solution,
                    tip_error: tip.1,
                });
            }
            self.width = stretched(&edges.width, next.places());
            self.curve = next;
        }
    }

    /// How far beyond the curve the strip ends, with its standard error: by its end where that is sharp, else by where
    /// it could be followed to.
    fn tip(&self, edges: &Edges) -> (f64, f64) {
        let (place, reach) = self.followed;
        let followed = self.curve.nearest(place);
        tip::tip(self.gray, self.ground, &self.curve, edges)
            .filter(|(moved, _)| (self.curve.length + moved - followed).abs() < reach)
            .unwrap_or((followed - self.curve.length, 0.5 * edges.width_at_tip.max(2.0)))
    }

    /// The curve after a step, `longer` by what the tip says. A step that would throw the line off the strip, as one does
    /// that rests on few readings, is cut short.
    fn moved(&self, solution: &Solution, longer: f64) -> Curve {
        let longest = LONGEST_STEP.0 * self.width[0] + LONGEST_STEP.1;
        let last = self.curve.places() - 1;
        let mut share = 1.0;
        loop {
            let next = self.moved_by(solution, share, longer);
            let far = (0..=8).any(|k| {
                let (x, y) = self.curve.point(k * last / 8);
                let (to_x, to_y) = next.point(k * (next.places() - 1) / 8);
                (to_x - x).hypot(to_y - y) > longest + longer.abs()
            });
            if !far || share == 0.0 {
                return next;
            }
            share = if share > 0.05 { 0.5 * share } else { 0.0 };
        }
    }

    fn moved_by(&self, solution: &Solution, share: f64, longer: f64) -> Curve {
        let shift = share * solution.change[0];
        let line = self.curve.clamp_line;
        let start = (
            self.curve.start.0 + shift * line.0,
            self.curve.start.1 + shift * line.1,
        );
        let mut curvature = self.curve.curvature.clone();
        let changes = &solution.change[2..];
        curvature
            .coefficients
            .iter_mut()
            .zip(changes)
            .for_each(|(c, change)| *c += share * change);
        let angle_rad = self.curve.angle_rad + share * solution.change[1];
        let length = (self.curve.length + longer).max(8.0);
        Curve::new(start, line, angle_rad, curvature, length)
    }
}

/// A series on another number of places.
fn stretched(values: &[f64], places: usize) -> Vec<f64> {
    let last = values.len() - 1;
    (0..places)
        .map(|k| values[(k * last / (places - 1).max(1)).min(last)])
        .collect()
}

impl Fitted {
    /// Refuses a line that was not seen for too long a stretch, or whose edges scatter too much.
    fn check_seen(&self) -> Result<(), Untraceable> {
        let weight = &self.equations.weight;
        let length = self.curve.length;
        let width = self.edges.width[self.edges.width.len() / 2];
        let hidden = |k: usize| weight[k] <= 0.2;
        // Where its thickness is not its own the strip is there, but not where exactly.
        let in_doubt = |k: usize| self.edges.doubtful.get(k).is_some_and(|doubtful| *doubtful);
        let gaps = [
            (
                longest(weight.len(), |k| hidden(k) && !in_doubt(k)),
                LONGEST_HIDDEN,
            ),
            (longest(weight.len(), hidden), LONGEST_DOUBTFUL),
        ];
        for ((from, count), share) in gaps {
            let gap = count as f64 * self.curve.step();
            if gap > (share * length).max(1.5 * width + 6.0) {
                let (x, y) = self.curve.point((from + count / 2).min(self.curve.places() - 1));
                return Err(Untraceable::Hidden { gap, length, x, y });
            }
        }
        let allowed = (MOST_SCATTER * width).max(1.0);
        if self.equations.noise > allowed {
            return Err(Untraceable::Scatter {
                scatter: self.equations.noise,
                allowed,
            });
        }
        Ok(())
    }
}

/// Start and length of the longest stretch of places that are so.
fn longest(places: usize, so: impl Fn(usize) -> bool) -> (usize, usize) {
    let (mut best, mut start) = ((0, 0), 0);
    for k in 0..=places {
        if k == places || !so(k) {
            if k - start > best.1 {
                best = (start, k - start);
            }
            start = k + 1;
        }
    }
    best
}

/// Refuses where something as large as the strip lies beside the line.
fn check_rest(silhouette: &Silhouette, root: &Root, fitted: &Fitted) -> Result<(), Untraceable> {
    let curve = &fitted.curve;
    // Distance to the line by a grid of buckets that hold its places.
    const BUCKET: f64 = 16.0;
    let widest = fitted.edges.width.iter().copied().fold(1.0, f64::max);
    let reach = 0.5 * widest + 5.0;
    let bucket = |v: f64| (v / BUCKET).floor() as i64;
    let mut buckets: std::collections::HashMap<(i64, i64), Vec<usize>> = std::collections::HashMap::new();
    for (k, &(x, y)) in curve.points().iter().enumerate().step_by(3) {
        buckets.entry((bucket(x), bucket(y))).or_default().push(k);
    }
    let around = (reach / BUCKET).ceil() as i64;
    let on_line = |x: f64, y: f64| {
        (-around..=around).any(|i| {
            (-around..=around).any(|j| {
                buckets
                    .get(&(bucket(x) + i, bucket(y) + j))
                    .is_some_and(|places| {
                        places.iter().any(|&k| {
                            let (px, py) = curve.point(k);
                            (px - x).hypot(py - y) < reach
                        })
                    })
            })
        })
    };
    let mut off = vec![(0.0, 0.0, 0.0); silhouette.things.len()];
    let mut on = 0.0;
    // Every other row and column: shares need no more.
    for stretch in silhouette.stretches.iter().filter(|s| s.y % 2 == 0) {
        let y = stretch.y as f64 + 0.5;
        let mut x = stretch.from;
        while x < stretch.to {
            if on_line(x as f64 + 0.5, y) {
                on += 1.0;
            } else {
                let thing = &mut off[stretch.thing()];
                *thing = (thing.0 + 1.0, thing.1 + x as f64, thing.2 + y);
            }
            x += 2;
        }
    }
    for (k, (pixels, x, y)) in off.iter().enumerate() {
        let share = if k == root.thing {
            SHARE_OFF
        } else {
            SHARE_ELSEWHERE
        };
        if *pixels <= share * on {
            continue;
        }
        let (x, y) = (x / pixels, y / pixels);
        if k == root.thing {
            return Err(Untraceable::Branches {
                percent: 100.0 * pixels / (pixels + on),
                x,
                y,
            });
        }
        return Err(silhouette.two(root.thing, k));
    }
    Ok(())
}
