//! Draws strips of known shape as a camera would see them, so that what is traced can be held against the truth.

use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Where the strip is held.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Held {
    Left,
    Right,
    Top,
    Bottom,
}

/// A view of a strip.
#[derive(Debug, Clone)]
pub struct Scene {
    pub width: usize,
    pub height: usize,
    pub held: Held,
    /// Place of the root along the held side, as a share of it.
    pub root: f64,
    /// Angle by which the strip leaves the clamp off the straight direction, rad, counter-clockwise as seen.
    pub tilt_rad: f64,
    /// Thickness, pixels.
    pub thickness: f64,
    /// Whether the strip is darker than the ground.
    pub dark: bool,
    /// Standard deviation of the blur, pixels.
    pub blur: f64,
    /// Standard deviation of a pixel's noise, of 255.
    pub noise: f64,
    /// Fall of the light from the middle to a corner, as a share.
    pub uneven: f64,
    /// Number of specks of dust.
    pub dust: usize,
    /// Whether the strip has bright spots and a faint mirror image.
    pub reflection: bool,
    pub seed: u64,
}

impl Default for Scene {
    fn default() -> Scene {
        Scene {
            width: 1280,
            height: 1024,
            held: Held::Left,
            root: 0.5,
            tilt_rad: 0.0,
            thickness: 9.0,
            dark: true,
            blur: 1.0,
            noise: 2.0,
            uneven: 0.3,
            dust: 0,
            reflection: false,
            seed: 1,
        }
    }
}

/// A drawn frame: brightness 0 to 255, and the truth.
pub struct Frame {
    pub width: usize,
    pub height: usize,
    pub pixels: Vec<u8>,
    /// The tip, pixels.
    pub tip: (f64, f64),
}

/// Distance between places of the drawn line, pixels.
const STEP: f64 = 0.5;

impl Scene {
    /// Draws a strip of `length` pixels whose curvature (1/pixel, counter-clockwise as seen) at each arc length
    /// (pixels) is `curvature`.
    pub fn draw(&self, length: f64, curvature: impl Fn(f64) -> f64) -> Frame {
        let line = self.line(length, curvature);
        let mut cover = self.cover(&line);
        let mut random = ChaCha8Rng::seed_from_u64(self.seed);
        if self.reflection {
            self.mirror(&line, &mut cover);
            self.spots(&line, &mut cover);
        }
        for _ in 0..self.dust {
            self.speck(&mut random, &mut cover);
        }
        blur(&mut cover, self.width, self.height, self.blur);
        let mut pixels = Vec::with_capacity(cover.len());
        for y in 0..self.height {
            for x in 0..self.width {
                let (u, v) = (
                    2.0 * x as f64 / self.width as f64 - 1.0,
                    2.0 * y as f64 / self.height as f64 - 1.0,
                );
                let light = 1.0 - self.uneven * (0.35 * (u * u + v * v) + 0.15 * (u - v));
                let c = f64::from(cover[y * self.width + x]);
                let value = if self.dark {
                    215.0 * light * (1.0 - 0.86 * c)
                } else {
                    12.0 * light + 190.0 * light * c
                };
                pixels.push(
                    (value + self.noise * normal(random.next_u64()))
                        .round()
                        .clamp(0.0, 255.0) as u8,
                );
            }
        }
        Frame {
            width: self.width,
            height: self.height,
            pixels,
            tip: line[line.len() - 1].0,
        }
    }

    /// Places and tangent angles (downward y) a step apart.
    fn line(&self, length: f64, curvature: impl Fn(f64) -> f64) -> Vec<((f64, f64), f64)> {
        let (w, h) = (self.width as f64, self.height as f64);
        let (mut at, straight) = match self.held {
            Held::Left => ((0.0, self.root * h), 0.0),
            Held::Right => ((w, self.root * h), std::f64::consts::PI),
            Held::Top => ((self.root * w, 0.0), std::f64::consts::FRAC_PI_2),
            Held::Bottom => ((self.root * w, h), -std::f64::consts::FRAC_PI_2),
        };
        let mut angle = straight - self.tilt_rad;
        let count = (length / STEP).round() as usize;
        let step = length / count as f64;
        let mut line = vec![(at, angle)];
        for k in 0..count {
            let turn = -curvature((k as f64 + 0.5) * step) * step;
            let middle = angle + 0.5 * turn;
            // The chord of an arc.
            let chord = if turn.abs() > 1e-9 {
                step * (0.5 * turn).sin() / (0.5 * turn)
            } else {
                step
            };
            at = (at.0 + chord * middle.cos(), at.1 + chord * middle.sin());
            angle += turn;
            line.push((at, angle));
        }
        line
    }

    /// Share of each pixel that the strip covers.
    fn cover(&self, line: &[((f64, f64), f64)]) -> Vec<f32> {
        let mut nearest: Vec<(f32, u32)> = vec![(f32::INFINITY, 0); self.width * self.height];
        let reach = (0.5 * self.thickness + 2.0).ceil() as i64;
        for (k, ((x, y), _)) in line.iter().enumerate() {
            for j in (*y as i64 - reach).max(0)..=(*y as i64 + reach).min(self.height as i64 - 1) {
                for i in (*x as i64 - reach).max(0)..=(*x as i64 + reach).min(self.width as i64 - 1) {
                    let d = (i as f64 + 0.5 - x).hypot(j as f64 + 0.5 - y) as f32;
                    let slot = &mut nearest[j as usize * self.width + i as usize];
                    if d < slot.0 {
                        *slot = (d, k as u32);
                    }
                }
            }
        }
        let last = line.len() - 1;
        let half = 0.5 * self.thickness;
        let share = |(index, &(d, k)): (usize, &(f32, u32))| {
            if d.is_infinite() {
                return 0.0;
            }
            let (x, y) = (
                (index % self.width) as f64 + 0.5,
                (index / self.width) as f64 + 0.5,
            );
            let ((px, py), angle) = line[k as usize];
            let (sin, cos) = angle.sin_cos();
            let across = -sin * (x - px) + cos * (y - py);
            let mut share = below(half - across, sin, cos) - below(-half - across, sin, cos);
            if k as usize + 8 > last {
                let ((px, py), angle) = line[last];
                let (sin, cos) = angle.sin_cos();
                share *= below(-(cos * (x - px) + sin * (y - py)), cos, sin);
            }
            share as f32
        };
        nearest.iter().enumerate().map(share).collect()
    }

    /// A faint mirror image of the strip some way off.
    fn mirror(&self, line: &[((f64, f64), f64)], cover: &mut [f32]) {
        let shift = 3.5 * self.thickness + 20.0;
        let moved: Vec<((f64, f64), f64)> = line
            .iter()
            .map(|&((x, y), angle)| match self.held {
                Held::Left | Held::Right => ((x, y + shift), angle),
                Held::Top | Held::Bottom => ((x + shift, y), angle),
            })
            .collect();
        for (cover, mirrored) in cover.iter_mut().zip(self.cover(&moved)) {
            *cover = cover.max(0.3 * mirrored);
        }
    }

    /// Two spots on the strip that shine: one at an edge, one over its whole thickness.
    fn spots(&self, line: &[((f64, f64), f64)], cover: &mut [f32]) {
        for (place, off, radius) in [(0.37, 0.5, 0.6), (0.71, 0.0, 0.9)] {
            let ((x, y), angle) = line[(place * line.len() as f64) as usize];
            let (sin, cos) = angle.sin_cos();
            let middle = (x - sin * off * self.thickness, y + cos * off * self.thickness);
            self.disc(cover, middle, radius * self.thickness, |cover, share| {
                *cover *= 1.0 - 0.85 * share
            });
        }
    }

    /// A speck as dark (or bright) as the strip, somewhere.
    fn speck(&self, random: &mut impl Rng, cover: &mut [f32]) {
        let middle = (
            random.random_range(0.0..self.width as f64),
            random.random_range(0.0..self.height as f64),
        );
        let radius = random.random_range(1.0..6.0);
        self.disc(cover, middle, radius, |cover, share| *cover = cover.max(share));
    }

    fn disc(&self, cover: &mut [f32], (x, y): (f64, f64), radius: f64, change: impl Fn(&mut f32, f32)) {
        let range = |at: f64, most: usize| {
            ((at - radius - 1.0).max(0.0) as usize)..((at + radius + 2.0).max(0.0) as usize).min(most)
        };
        for j in range(y, self.height) {
            for i in range(x, self.width) {
                let d = (i as f64 + 0.5 - x).hypot(j as f64 + 0.5 - y);
                let share = (radius - d + 0.5).clamp(0.0, 1.0) as f32;
                change(&mut cover[j * self.width + i], share);
            }
        }
    }
}

/// A number of about normal distribution, mean 0 and standard deviation 1, from random bits: four evenly spread ones
/// added, which is quick.
fn normal(bits: u64) -> f64 {
    let sum: u64 = (0..4).map(|part| bits >> (16 * part) & 0xffff).sum();
    (sum as f64 / 65_536.0 - 2.0) * 3f64.sqrt()
}

/// Share of a unit square about the origin on which a line's normal coordinate is below `distance`; the normal has
/// the components `a` and `b`.
fn below(distance: f64, a: f64, b: f64) -> f64 {
    let (wide, narrow) = (a.abs().max(b.abs()), a.abs().min(b.abs()));
    // The projection of the square is a trapezoid: flat in the middle, falling over the narrow side.
    let (flat, foot) = (0.5 * (wide - narrow), 0.5 * (wide + narrow));
    let part = |x: f64| match x {
        x if x >= foot => 0.5,
        x if x > flat => 0.5 - (foot - x).powi(2) / (2.0 * wide * narrow),
        x => x / wide,
    };
    0.5 + distance.signum() * part(distance.abs())
}

/// Gaussian blur by two passes.
fn blur(values: &mut [f32], width: usize, height: usize, sigma: f64) {
    if sigma <= 0.0 {
        return;
    }
    let reach = (3.5 * sigma).ceil() as i64;
    let mut kernel: Vec<f32> = (-reach..=reach)
        .map(|k| (-0.5 * (k as f64 / sigma).powi(2)).exp() as f32)
        .collect();
    let sum: f32 = kernel.iter().sum();
    kernel.iter_mut().for_each(|k| *k /= sum);
    for (count, stride, lines, line_stride) in [(width, 1, height, width), (height, width, width, 1)] {
        let source = values.to_vec();
        for line in 0..lines {
            for k in 0..count {
                let at = |offset: i64| {
                    let place = (k as i64 + offset).clamp(0, count as i64 - 1) as usize;
                    source[line * line_stride + place * stride]
                };
                values[line * line_stride + k * stride] =
                    (-reach..=reach).zip(&kernel).map(|(o, w)| w * at(o)).sum();
            }
        }
    }
}
