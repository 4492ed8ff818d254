//! Views of strips, drawn at random: shape, thickness, light, camera.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::optics::Camera;
use super::paint::{Painted, Shine};

pub const WIDTH: usize = 1280;
pub const HEIGHT: usize = 1024;

/// How the curvature falls along the strip.
#[derive(Debug, Clone, Copy)]
pub enum Course {
    Even,
    /// A cosine hyperbolicus with this length of decay, over the strip's: a strip whose electrodes resist.
    Falls(f64),
    /// Error function with this depth: early after a step.
    Early(f64),
    /// A bend in the middle, of this width: a strip with a weak place.
    Hump(f64),
}

/// A view.
pub struct View {
    pub seed: u64,
    /// Largest curvature times the length.
    pub bend: f64,
    pub course: Course,
    pub painted: Painted,
    pub camera: Camera,
    pub side: usize,
}

impl View {
    /// Curvature at an arc length, 1/pixel, counter-clockwise as seen.
    pub fn curvature(&self, s: f64) -> f64 {
        let u = (s / self.painted.length_px).clamp(0.0, 1.0);
        let share = match self.course {
            Course::Even => 1.0,
            Course::Falls(decay) => ((1.0 - u) / decay).cosh() / (1.0 / decay).cosh(),
            Course::Early(depth) => statrs::function::erf::erfc(u / (2.0 * depth)),
            Course::Hump(width) => 0.4 + 0.6 * (-0.5 * ((u - 0.5) / width).powi(2)).exp(),
        };
        self.bend / self.painted.length_px * share
    }

    /// A view of that seed: views are drawn until the strip lies in the picture.
    pub fn random(seed: u64, clean: bool) -> View {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        loop {
            let view = View::drawn(seed, clean, &mut random);
            if view.fits() {
                return view;
            }
        }
    }

    fn drawn(seed: u64, clean: bool, random: &mut ChaCha8Rng) -> View {
        let mut between = |low: f64, high: f64| low + (high - low) * random.random_range(0.0..1.0);
        let length_px = between(200.0, 1100.0);
        let thickness_px = between(3f64.ln(), 40f64.min(length_px / 12.0).ln()).exp();
        let side = between(0.0, 4.0) as usize;
        let (w, h) = (WIDTH as f64, HEIGHT as f64);
        let at = between(0.1, 0.9);
        let (root, straight) = match side {
            0 => ((0.0, at * h), 0.0),
            1 => ((w, at * h), std::f64::consts::PI),
            2 => ((at * w, 0.0), std::f64::consts::FRAC_PI_2),
            _ => ((at * w, h), -std::f64::consts::FRAC_PI_2),
        };
        let course = match between(0.0, 5.0) as usize {
            0 | 1 => Course::Even,
            2 => Course::Falls(between(0.2, 2.0)),
            3 => Course::Early(between(0.15, 0.6)),
            _ => Course::Hump(between(0.12, 0.4)),
        };
        let mut chance = |share: f64| between(0.0, 1.0) < share;
        let (shines, mirrored, dusty) = (chance(0.3), chance(0.15), chance(0.4));
        let (moving, bent_light, compressed, tapers, gamma) =
            (chance(0.4), chance(0.5), chance(0.5), chance(0.3), chance(0.5));
        let dark = chance(0.6);
        let from = between(0.0, 0.9);
        let shine = Shine {
            from,
            to: from + between(0.03, 0.3),
            depth: between(0.1, 0.5),
            strength: between(0.3, 1.0),
            low_edge: between(0.0, 1.0) < 0.5,
        };
        let mirror = (
            (
                between(-2.0, 2.0) * thickness_px,
                (2.5 * thickness_px + 20.0) * if between(0.0, 1.0) < 0.5 { 1.0 } else { -1.0 },
            ),
            between(0.1, 0.35),
        );
        let specks = (0..between(5.0, 60.0) as usize)
            .map(|_| ((between(0.0, w), between(0.0, h)), between(0.7, 5.0)))
            .collect();
        View {
            seed,
            bend: between(-2.5, 2.5),
            course,
            painted: Painted {
                root,
                angle_rad: straight + between(-0.15, 0.15),
                length_px,
                thickness_px,
                taper: if tapers { between(0.7, 1.0) } else { 1.0 },
                round: [0.0, 0.0, 0.4, 1.0][between(0.0, 4.0) as usize],
                dark,
                contrast: between(0.5, 0.97),
                shine: (shines && !clean).then_some(shine),
                specks: if dusty && !clean { specks } else { Vec::new() },
                vignette: if bent_light { between(0.0, 0.25) } else { 0.0 },
                tilt: (between(-0.15, 0.15), between(-0.15, 0.15)),
                mirror: (mirrored && !clean).then_some(mirror),
            },
            camera: Camera {
                blur_px: between(0.5, 1.8),
                motion_px: if moving { between(0.0, 2.5) } else { 0.0 },
                motion_rad: between(0.0, std::f64::consts::PI),
                gamma: if gamma { 1.0 / 2.2 } else { 1.0 },
                noise: between(0.5, 3.5),
                jpeg: compressed.then(|| between(85.0, 95.9) as u8),
            },
            side,
        }
    }

    /// Whether the strip stays away from all sides but the clamp's, and from itself.
    fn fits(&self) -> bool {
        let (line, before) = self.painted.line(&|s| self.curvature(s));
        let margin = self.painted.thickness_px + 12.0;
        let (w, h) = (WIDTH as f64, HEIGHT as f64);
        line[before..].iter().all(|&((x, y), _)| {
            let distances = [x, w - x, y, h - y];
            let s = (x - self.painted.root.0).hypot(y - self.painted.root.1);
            distances
                .iter()
                .enumerate()
                .all(|(side, d)| *d > margin || (side == self.side && s < 3.0 * margin))
        })
    }
}
