//! A strip as a filled shape: every pixel is looked at in 5 x 5 places, each of which lies on the strip or beside it.

use super::optics::Light;

/// Places in a pixel to each side.
const FINE: usize = 5;
/// Distance between places of the line, pixels.
const STEP: f64 = 0.25;

/// A strip and what lies about it.
pub struct Painted {
    /// Root, on the side of the clamp; angle there, rad, from x toward y (downward).
    pub root: (f64, f64),
    pub angle_rad: f64,
    pub length_px: f64,
    pub thickness_px: f64,
    /// Thickness at the tip over that at the root.
    pub taper: f64,
    /// Radius of the corners of the tip over half the thickness: 0 square, 1 round.
    pub round: f64,
    /// Brightness of the strip and of the ground, and whether the strip is dark.
    pub dark: bool,
    pub contrast: f64,
    /// A shine along one edge: from and to (shares of the length), how far in (share of the thickness), how strong.
    pub shine: Option<Shine>,
    pub specks: Vec<((f64, f64), f64)>,
    /// Fall of the light to the corners, its tilt along x and y.
    pub vignette: f64,
    pub tilt: (f64, f64),
    /// A mirror image this far off, and its strength.
    pub mirror: Option<((f64, f64), f64)>,
}

/// Light that an edge throws back: what it covers looks like the ground, or nearly.
#[derive(Debug, Clone, Copy)]
pub struct Shine {
    pub from: f64,
    pub to: f64,
    pub depth: f64,
    pub strength: f64,
    pub low_edge: bool,
}

/// A place of the line and the tangent's angle there.
pub type Place = ((f64, f64), f64);

impl Painted {
    /// The line: it starts before the root, in the clamp, where it is straight.
    pub fn line(&self, per_px: &dyn Fn(f64) -> f64) -> (Vec<Place>, usize) {
        let before = (self.thickness_px / STEP) as usize + 40;
        let (sin, cos) = self.angle_rad.sin_cos();
        let mut line: Vec<Place> = (0..before)
            .map(|k| {
                let s = (k as f64 - before as f64) * STEP;
                ((self.root.0 + s * cos, self.root.1 + s * sin), self.angle_rad)
            })
            .collect();
        let (mut at, mut angle) = (self.root, self.angle_rad);
        let count = (self.length_px / STEP).round() as usize;
        let step = self.length_px / count as f64;
        line.push((at, angle));
        for k in 0..count {
            let turn = -per_px((k as f64 + 0.5) * step) * step;
            let middle = angle + 0.5 * turn;
            at = (at.0 + step * middle.cos(), at.1 + step * middle.sin());
            angle += turn;
            line.push((at, angle));
        }
        (line, before)
    }

    /// The light of the whole view, 0 to 1.
    pub fn light(&self, width: usize, height: usize, line: &[Place], before: usize) -> Light {
        let mut strip = self.cover(width, height, line, before, (0.0, 0.0), true);
        if let Some((shift, strength)) = self.mirror {
            for (cover, mirrored) in strip
                .iter_mut()
                .zip(self.cover(width, height, line, before, shift, false))
            {
                *cover = cover.max(strength as f32 * mirrored);
            }
        }
        for &((x, y), radius) in &self.specks {
            self.speck(&mut strip, width, height, (x, y), radius);
        }
        let mut values = Vec::with_capacity(strip.len());
        for y in 0..height {
            for x in 0..width {
                let (u, v) = (
                    2.0 * x as f64 / width as f64 - 1.0,
                    2.0 * y as f64 / height as f64 - 1.0,
                );
                // The fourth power of the cosine, as a lens has it: no parabola.
                let fall = (1.0 + self.vignette * (u * u + v * v)).powi(-2);
                let lit = fall * (1.0 + self.tilt.0 * u + self.tilt.1 * v);
                let cover = f64::from(strip[y * width + x]);
                let value = if self.dark {
                    0.75 * lit * (1.0 - self.contrast * cover)
                } else {
                    0.75 * lit * (1.0 - self.contrast * (1.0 - cover))
                };
                values.push(value as f32);
            }
        }
        Light {
            width,
            height,
            values,
        }
    }

    fn half(&self, s: f64) -> f64 {
        0.5 * self.thickness_px * (1.0 + (self.taper - 1.0) * (s / self.length_px).clamp(0.0, 1.0))
    }

    /// How much of the strip's level a place has, by its arc length and its distance from the line.
    fn level(&self, s: f64, n: f64, shone: bool) -> f32 {
        let half = self.half(s);
        if s > self.length_px || n.abs() > half {
            return 0.0;
        }
        let radius = self.round * self.half(self.length_px);
        let (beyond, out) = (s - (self.length_px - radius), n.abs() - (half - radius));
        if beyond > 0.0 && out > 0.0 && beyond.hypot(out) > radius {
            return 0.0;
        }
        let Some(shine) = self.shine.filter(|_| shone) else {
            return 1.0;
        };
        let inward = if shine.low_edge { n + half } else { half - n };
        let share = s / self.length_px;
        let shines = (shine.from..shine.to).contains(&share) && inward < shine.depth * 2.0 * half;
        if shines { 1.0 - shine.strength as f32 } else { 1.0 }
    }

    fn cover(
        &self,
        width: usize,
        height: usize,
        line: &[Place],
        before: usize,
        shift: (f64, f64),
        shone: bool,
    ) -> Vec<f32> {
        let mut nearest: Vec<(f32, u32)> = vec![(f32::INFINITY, 0); width * height];
        let reach = (0.5 * self.thickness_px * self.taper.max(1.0) + 2.0).ceil() as i64;
        for (k, ((x, y), _)) in line.iter().enumerate().step_by(2) {
            let (x, y) = (x + shift.0, y + shift.1);
            for j in (y as i64 - reach).max(0)..=(y as i64 + reach).min(height as i64 - 1) {
                for i in (x as i64 - reach).max(0)..=(x as i64 + reach).min(width as i64 - 1) {
                    let d = (i as f64 + 0.5 - x).hypot(j as f64 + 0.5 - y) as f32;
                    let slot = &mut nearest[j as usize * width + i as usize];
                    if d < slot.0 {
                        *slot = (d, k as u32);
                    }
                }
            }
        }
        let share = |(index, &(d, k)): (usize, &(f32, u32))| {
            if d.is_infinite() {
                return 0.0;
            }
            let ((px, py), angle) = line[k as usize];
            let (sin, cos) = angle.sin_cos();
            let from = (index % width, index / width);
            let mut sum = 0.0;
            for j in 0..FINE {
                for i in 0..FINE {
                    let x = from.0 as f64 + (i as f64 + 0.5) / FINE as f64 - px - shift.0;
                    let y = from.1 as f64 + (j as f64 + 0.5) / FINE as f64 - py - shift.1;
                    let s = (k as f64 - before as f64) * STEP + cos * x + sin * y;
                    sum += self.level(s, -sin * x + cos * y, shone);
                }
            }
            sum / (FINE * FINE) as f32
        };
        nearest.iter().enumerate().map(share).collect()
    }

    fn speck(&self, cover: &mut [f32], width: usize, height: usize, (x, y): (f64, f64), radius: f64) {
        let range = |at: f64, most: usize| {
            ((at - radius - 1.0).max(0.0) as usize)..((at + radius + 2.0).max(0.0) as usize).min(most)
        };
        for j in range(y, height) {
            for i in range(x, width) {
                let d = (i as f64 + 0.5 - x).hypot(j as f64 + 0.5 - y);
                let share = (radius - d + 0.5).clamp(0.0, 1.0) as f32;
                let cover = &mut cover[j * width + i];
                *cover = cover.max(share);
            }
        }
    }
}
