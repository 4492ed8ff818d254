//! What a camera does to light: blur, motion, gamma, noise, eight bits, JPEG.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

/// Light, row by row.
#[derive(Debug, Clone)]
pub struct Light {
    pub width: usize,
    pub height: usize,
    pub values: Vec<f32>,
}

/// A camera.
#[derive(Debug, Clone)]
pub struct Camera {
    /// Standard deviation of the blur, pixels.
    pub blur_px: f64,
    /// Way that everything moves while the shutter is open, pixels, and its direction, rad.
    pub motion_px: f64,
    pub motion_rad: f64,
    /// Exponent between light and value: 1 or 1/2.2.
    pub gamma: f64,
    /// Standard deviation of a value's noise, of 255.
    pub noise: f64,
    /// Quality of JPEG; none: kept as it is.
    pub jpeg: Option<u8>,
}

impl Camera {
    /// Values 0 to 255 of the light that falls on it.
    pub fn picture(&self, light: &Light, random: &mut ChaCha8Rng) -> Vec<u8> {
        let mut light = light.clone();
        blur(&mut light, self.blur_px);
        if self.motion_px > 0.0 {
            light = self.moved(&light);
        }
        let value = |light: &f32| {
            let value = 255.0 * f64::from(*light).clamp(0.0, 1.0).powf(self.gamma);
            (value + self.noise * normal(random)).round().clamp(0.0, 255.0) as u8
        };
        let mut values: Vec<u8> = light.values.iter().map(value).collect();
        if let Some(quality) = self.jpeg {
            compress(&mut values, light.width, light.height, quality);
        }
        values
    }

    fn moved(&self, light: &Light) -> Light {
        const PARTS: usize = 8;
        let mut moved = light.clone();
        let (sin, cos) = self.motion_rad.sin_cos();
        for y in 0..light.height {
            for x in 0..light.width {
                let sum: f32 = (0..PARTS)
                    .map(|part| {
                        let way = self.motion_px * ((part as f64 + 0.5) / PARTS as f64 - 0.5);
                        light.at(x as f64 + way * cos, y as f64 + way * sin)
                    })
                    .sum();
                moved.values[y * light.width + x] = sum / PARTS as f32;
            }
        }
        moved
    }
}

impl Light {
    /// Light between the middles of pixels, which have whole numbers here.
    fn at(&self, x: f64, y: f64) -> f32 {
        let (x, y) = (
            x.clamp(0.0, (self.width - 1) as f64),
            y.clamp(0.0, (self.height - 1) as f64),
        );
        let (i, j) = (
            (x as usize).min(self.width - 2),
            (y as usize).min(self.height - 2),
        );
        let (a, b) = ((x - i as f64) as f32, (y - j as f64) as f32);
        let value = |i: usize, j: usize| self.values[j * self.width + i];
        (value(i, j) * (1.0 - a) + value(i + 1, j) * a) * (1.0 - b)
            + (value(i, j + 1) * (1.0 - a) + value(i + 1, j + 1) * a) * b
    }
}

fn blur(light: &mut Light, sigma: f64) {
    let reach = (4.0 * sigma).ceil() as i64;
    let mut kernel: Vec<f32> = (-reach..=reach)
        .map(|k| (-0.5 * (k as f64 / sigma).powi(2)).exp() as f32)
        .collect();
    let sum: f32 = kernel.iter().sum();
    kernel.iter_mut().for_each(|k| *k /= sum);
    let (width, height) = (light.width, light.height);
    for (count, stride, lines, line_stride) in [(width, 1, height, width), (height, width, width, 1)] {
        let source = light.values.clone();
        for line in 0..lines {
            for k in 0..count {
                let at = |offset: i64| {
                    let place = (k as i64 + offset).clamp(0, count as i64 - 1) as usize;
                    source[line * line_stride + place * stride]
                };
                light.values[line * line_stride + k * stride] =
                    (-reach..=reach).zip(&kernel).map(|(o, w)| w * at(o)).sum();
            }
        }
    }
}

/// A number of normal distribution (Box and Muller).
pub fn normal(random: &mut ChaCha8Rng) -> f64 {
    let (a, b): (f64, f64) = (random.random_range(1e-300..1.0), random.random_range(0.0..1.0));
    (-2.0 * a.ln()).sqrt() * (std::f64::consts::TAU * b).cos()
}

/// The luminance table of the JPEG standard (annex K).
const TABLE: [u8; 64] = [
    16, 11, 10, 16, 24, 40, 51, 61, 12, 12, 14, 19, 26, 58, 60, 55, 14, 13, 16, 24, 40, 57, 69, 56, 14, 17,
    22, 29, 51, 87, 80, 62, 18, 22, 37, 56, 68, 109, 103, 77, 24, 35, 55, 64, 81, 104, 113, 92, 49, 64, 78,
    87, 103, 121, 120, 101, 72, 92, 95, 98, 112, 100, 103, 99,
];

/// What JPEG leaves of a picture: blocks of 8 x 8 whose cosine terms are rounded to multiples of the scaled table.
fn compress(values: &mut [u8], width: usize, height: usize, quality: u8) {
    let quality = f64::from(quality);
    let scale = if quality < 50.0 {
        50.0 / quality
    } else {
        2.0 - quality / 50.0
    };
    let steps: Vec<f32> = TABLE
        .iter()
        .map(|step| ((f64::from(*step) * scale).round().clamp(1.0, 255.0)) as f32)
        .collect();
    let wave = |u: usize, x: usize| {
        let size = if u == 0 { 0.125f64.sqrt() } else { 0.5 };
        (size * (std::f64::consts::PI * (2.0 * x as f64 + 1.0) * u as f64 / 16.0).cos()) as f32
    };
    let waves: Vec<f32> = (0..64).map(|k| wave(k / 8, k % 8)).collect();
    // Blocks that would reach beyond the picture are left as they are.
    for top in (0..height - height % 8).step_by(8) {
        for left in (0..width - width % 8).step_by(8) {
            let block: Vec<f32> = (0..64)
                .map(|k| f32::from(values[(top + k / 8) * width + left + k % 8]) - 128.0)
                .collect();
            let mut terms = turned(&turned(&block, &waves, false), &waves, false);
            for (term, step) in terms.iter_mut().zip(&steps) {
                *term = (*term / step).round() * step;
            }
            let back = turned(&turned(&terms, &waves, true), &waves, true);
            for (k, value) in back.iter().enumerate() {
                values[(top + k / 8) * width + left + k % 8] =
                    (value + 128.0).round().clamp(0.0, 255.0) as u8;
            }
        }
    }
}

/// Cosine transform of each row of a block (or back), transposed: twice is the transform of the block.
fn turned(block: &[f32], waves: &[f32], back: bool) -> Vec<f32> {
    let mut turned = vec![0.0; 64];
    for row in 0..8 {
        for u in 0..8 {
            turned[u * 8 + row] = (0..8)
                .map(|x| block[row * 8 + x] * if back { waves[x * 8 + u] } else { waves[u * 8 + x] })
                .sum();
        }
    }
    turned
}
