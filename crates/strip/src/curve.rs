//! A plane curve that starts on the line of the clamp and whose curvature is a spline.

use super::spline::{COEFFICIENTS, Spline};

/// Parameters of a curve: where on the line of the clamp it starts, its angle there, the coefficients of its curvature.
pub const PARAMETERS: usize = 2 + COEFFICIENTS;

/// A curve with its places about a pixel apart.
#[derive(Debug, Clone)]
pub struct Curve {
    /// Place on the line of the clamp, pixels.
    pub start: (f64, f64),
    /// Direction of the line of the clamp.
    pub clamp_line: (f64, f64),
    /// Tangent angle at the start, rad, from the x axis toward the y axis (downward).
    pub angle_rad: f64,
    /// Curvature, 1/pixel.
    pub curvature: Spline,
    /// Arc length of its end, pixels.
    pub length: f64,
    step: f64,
    points: Vec<(f64, f64)>,
    angles: Vec<f64>,
}

impl Curve {
    /// The curve with those parameters, up to an arc length.
    pub fn new(
        start: (f64, f64),
        clamp_line: (f64, f64),
        angle_rad: f64,
        curvature: Spline,
        length: f64,
    ) -> Curve {
        let count = (length.round() as usize).clamp(32, 3000);
        let step = length / count as f64;
        let (mut angles, mut points) = (Vec::with_capacity(count + 1), Vec::with_capacity(count + 1));
        let (mut angle, mut at) = (angle_rad, start);
        angles.push(angle);
        points.push(at);
        let mut before = curvature.at(0.0);
        for k in 1..=count {
            // Two midpoint rules nested: the error is far below a thousandth of a pixel for any strip.
            let s = k as f64 * step;
            let (middle, after) = (curvature.at(s - 0.5 * step), curvature.at(s));
            let half_way = angle + step * (5.0 * before + 8.0 * middle - after) / 24.0;
            let next = angle + step * (before + 4.0 * middle + after) / 6.0;
            let part = |f: fn(f64) -> f64| step * (f(angle) + 4.0 * f(half_way) + f(next)) / 6.0;
            at = (at.0 + part(f64::cos), at.1 + part(f64::sin));
            angle = next;
            angles.push(angle);
            points.push(at);
            before = after;
        }
        Curve {
            start,
            clamp_line,
            angle_rad,
            curvature,
            length,
            step,
            points,
            angles,
        }
    }

    /// Number of places, both ends included.
    pub fn places(&self) -> usize {
        self.points.len()
    }

    /// Distance between places along the curve, pixels.
    pub fn step(&self) -> f64 {
        self.step
    }

    /// Arc length of a place, pixels.
    pub fn arc_length(&self, k: usize) -> f64 {
        k as f64 * self.step
    }

    /// A place.
    pub fn point(&self, k: usize) -> (f64, f64) {
        self.points[k]
    }

    /// All places.
    pub fn points(&self) -> &[(f64, f64)] {
        &self.points
    }

    /// Normal at a place: the tangent turned from the x axis toward the y axis.
    pub fn normal(&self, k: usize) -> (f64, f64) {
        let (sin, cos) = self.angles[k].sin_cos();
        (-sin, cos)
    }

    /// Place at an arc length between the places, or beyond the end along the last tangent.
    pub fn point_at(&self, s: f64) -> (f64, f64) {
        let last = self.points.len() - 1;
        let k = ((s / self.step).max(0.0) as usize).min(last);
        let (sin, cos) = self.angles[k].sin_cos();
        let rest = s - self.arc_length(k);
        // Beyond the end it goes on straight.
        let bend = if k == last {
            0.0
        } else {
            0.5 * rest * rest * self.curvature.at(self.arc_length(k))
        };
        let (x, y) = self.points[k];
        (x + rest * cos - bend * sin, y + rest * sin + bend * cos)
    }

    /// Arc length of the curve, or of its straight continuation, nearest to a place.
    pub fn nearest(&self, (x, y): (f64, f64)) -> f64 {
        let distance = |k: &usize| (self.points[*k].0 - x).powi(2) + (self.points[*k].1 - y).powi(2);
        let k = (0..self.points.len())
            .min_by(|a, b| distance(a).total_cmp(&distance(b)))
            .unwrap_or(0);
        let (sin, cos) = self.angles[k].sin_cos();
        self.arc_length(k) + (x - self.points[k].0) * cos + (y - self.points[k].1) * sin
    }

    /// Calls `visit` with each place and, for each parameter, how far it moves the place along x and y.
    pub fn derivatives(&self, mut visit: impl FnMut(usize, &[(f64, f64); PARAMETERS])) {
        let mut moved = [(0.0, 0.0); PARAMETERS];
        moved[0] = self.clamp_line;
        // Turn of the tangent by each coefficient, up to the place before.
        let mut turned = [0.0; COEFFICIENTS];
        let mut before = self.curvature.weights(0.0);
        visit(0, &moved);
        for k in 1..self.points.len() {
            let s = self.arc_length(k);
            let middle = self.curvature.weights(s - 0.5 * self.step);
            let after = self.curvature.weights(s);
            // Simpson's rule for the angle, and for the place with the angle half-way.
            let (mut half_way, mut now) = (turned, turned);
            for ((first, weights), to_half, to_end) in
                [(before, 5.0, 4.0), (middle, 8.0, 16.0), (after, -1.0, 4.0)]
            {
                for (j, weight) in weights.iter().enumerate() {
                    half_way[first + j] += to_half / 24.0 * self.step * weight;
                    now[first + j] += to_end / 24.0 * self.step * weight;
                }
            }
            let (a0, a1) = (self.angles[k - 1], self.angles[k]);
            let part = self.step / 6.0;
            let parts = [(a0, part), (0.5 * (a0 + a1), 4.0 * part), (a1, part)];
            let [first, second, third] = parts.map(|(angle, part)| (-part * angle.sin(), part * angle.cos()));
            moved[1].0 += first.0 + second.0 + third.0;
            moved[1].1 += first.1 + second.1 + third.1;
            for (j, place) in moved[2..]
                .iter_mut()
                .enumerate()
                .take((after.0 + 4).min(COEFFICIENTS))
            {
                place.0 += turned[j] * first.0 + half_way[j] * second.0 + now[j] * third.0;
                place.1 += turned[j] * first.1 + half_way[j] * second.1 + now[j] * third.1;
            }
            turned = now;
            before = after;
            visit(k, &moved);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn circle() -> Curve {
        let mut spline = Spline::straight(300.0);
        spline.coefficients.fill(0.01);
        Curve::new((10.0, 20.0), (0.0, 1.0), 0.3, spline, 300.0)
    }

    #[test]
    fn a_constant_curvature_gives_a_circle() {
        let curve = circle();
        let centre = (10.0 - 100.0 * 0.3f64.sin(), 20.0 + 100.0 * 0.3f64.cos());
        for &(x, y) in curve.points() {
            assert!(((x - centre.0).hypot(y - centre.1) - 100.0).abs() < 1e-5);
        }
        assert!((curve.angles[curve.places() - 1] - 3.3).abs() < 1e-9);
    }

    #[test]
    fn derivatives_are_those_of_the_places() {
        let curve = circle();
        let small = 1e-6;
        let mut at_end = [(0.0, 0.0); PARAMETERS];
        let last = curve.places() - 1;
        curve.derivatives(|k, moved| {
            if k == last {
                at_end = *moved;
            }
        });
        for (k, found) in at_end.iter().enumerate() {
            let mut spline = curve.curvature.clone();
            let (mut start, mut angle) = (curve.start, curve.angle_rad);
            match k {
                0 => start.1 += small,
                1 => angle += small,
                _ => spline.coefficients[k - 2] += small,
            }
            let other = Curve::new(start, curve.clamp_line, angle, spline, 300.0);
            let (a, b) = (curve.point(last), other.point(last));
            let by_difference = ((b.0 - a.0) / small, (b.1 - a.1) / small);
            let size = 1.0 + by_difference.0.hypot(by_difference.1);
            let off = (found.0 - by_difference.0).hypot(found.1 - by_difference.1);
            assert!(off < 2e-3 * size, "{k}: {found:?} {by_difference:?}");
        }
    }
}
