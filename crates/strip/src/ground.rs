//! The lit ground behind the strip, and what stands out from it.

use super::Tone;
use super::gray::Gray;
use super::refusal::Untraceable;
use ieap_numerics::robust::{sd_about_median, upper_median};
use ieap_numerics::symmetric::Symmetric;

/// Tiles along the longer side of the picture.
const TILES: usize = 28;
/// Pixels looked at along each side of a tile.
const LOOKED_AT: usize = 8;
/// Pixels looked at for tone, noise and contrast, about.
const SAMPLED: usize = 60_000;
/// Terms of the ground: a parabola in both directions.
const TERMS: usize = 6;
/// How many times brighter things must outweigh darker ones, or the reverse.
const CLEARLY: f64 = 4.0;
/// A strip stands out by at least this many standard deviations of the ground.
const STANDS_OUT: f64 = 8.0;
/// Contrast below which nothing is looked for, share of the full scale: two steps of eight bits.
const LEAST_CONTRAST: f64 = 0.01;

/// Brightness of the ground as a parabola over the picture, which follows uneven light, and the way in which the strip
/// differs from it.
#[derive(Debug, Clone)]
pub struct Ground {
    terms: [f64; TERMS],
    scale: (f64, f64),
    tone: Tone,
    /// Level above which a pixel belongs to something, half the strip's.
    pub threshold: f64,
    /// Standard deviation of a pixel of the ground, as a level.
    pub noise: f64,
}

impl Ground {
    /// Finds ground, tone and contrast.
    ///
    /// # Errors
    /// Nothing stands out, or as much to one side as to the other.
    pub fn of(gray: &Gray, told: Option<Tone>) -> Result<Ground, Untraceable> {
        let scale = (2.0 / gray.width() as f64, 2.0 / gray.height() as f64);
        let terms = surface(&tiles(gray), scale);
        let mut ground = Ground {
            terms,
            scale,
            tone: Tone::Bright,
            threshold: 0.0,
            noise: 0.0,
        };
        let stride = (gray.width() * gray.height() / SAMPLED).max(1).isqrt();
        let differences = ground.differences(gray, stride);
        let noise = sd_about_median(&differences).max(0.2 / 255.0);
        ground.tone = match told {
            Some(tone) => tone,
            None => tone(&differences, noise)?,
        };
        if ground.tone == Tone::Dark {
            // As a share of the light, which is the same wherever a strip shades it.
            let middle = ground.brightness(gray.width() as f64 / 2.0, gray.height() as f64 / 2.0);
            ground.noise = noise / middle.max(1e-3);
        } else {
            ground.noise = noise;
        }
        let levels = ground.levels(gray, stride);
        ground.threshold = split(&levels, STANDS_OUT * 0.5 * ground.noise).unwrap_or(0.0);
        let contrast = 2.0 * ground.threshold;
        if contrast < STANDS_OUT * ground.noise || contrast < LEAST_CONTRAST {
            return Err(Untraceable::Empty {
                contrast,
                noise: ground.noise,
            });
        }
        Ok(ground)
    }

    /// The tone told or found.
    pub fn tone(&self) -> Tone {
        self.tone
    }

    fn brightness(&self, x: f64, y: f64) -> f64 {
        let (u, v) = (x * self.scale.0 - 1.0, y * self.scale.1 - 1.0);
        let t = &self.terms;
        t[0] + u * (t[1] + u * t[3] + v * t[4]) + v * (t[2] + v * t[5])
    }

    /// How far a brightness at a place stands out: 0 on the ground; for a dark strip the share of the light that it
    /// takes, for a bright one the light that it adds.
    #[inline]
    pub fn level(&self, brightness: f64, x: f64, y: f64) -> f64 {
        let ground = self.brightness(x, y);
        match self.tone {
            Tone::Dark => 1.0 - brightness / ground.max(1e-3),
            Tone::Bright => brightness - ground,
        }
    }

    /// Level at a place of the picture.
    #[inline]
    pub fn level_at(&self, gray: &Gray, x: f64, y: f64) -> f64 {
        self.level(f64::from(gray.at(x, y)), x, y)
    }

    /// For each pixel of a row, whether it stands out by more than the threshold.
    pub fn mark_row(&self, gray: &Gray, y: usize, marks: &mut Vec<bool>) {
        let v = (y as f64 + 0.5) * self.scale.1 - 1.0;
        let t = &self.terms;
        let (c0, c1, c2) = (t[0] + v * (t[2] + v * t[5]), t[1] + v * t[4], t[3]);
        let (gain, shift) = match self.tone {
            Tone::Dark => (1.0 - self.threshold, 0.0),
            Tone::Bright => (1.0, self.threshold),
        };
        let line = [c0 * gain + shift, c1 * gain, c2 * gain].map(|c| c as f32);
        let (step, first) = (self.scale.0 as f32, 0.5 * self.scale.0 as f32 - 1.0);
        let limit = |x: usize| {
            let u = first + step * x as f32;
            line[0] + u * (line[1] + u * line[2])
        };
        marks.clear();
        let pixels = gray.row(y).iter().enumerate();
        match self.tone {
            Tone::Dark => marks.extend(pixels.map(|(x, &value)| value < limit(x))),
            Tone::Bright => marks.extend(pixels.map(|(x, &value)| value > limit(x))),
        }
    }

    fn differences(&self, gray: &Gray, stride: usize) -> Vec<f64> {
        self.sampled(gray, stride, |value, x, y| value - self.brightness(x, y))
    }

    fn levels(&self, gray: &Gray, stride: usize) -> Vec<f64> {
        self.sampled(gray, stride, |value, x, y| self.level(value, x, y))
    }

    fn sampled(&self, gray: &Gray, stride: usize, of: impl Fn(f64, f64, f64) -> f64) -> Vec<f64> {
        let mut found = Vec::with_capacity(gray.width() * gray.height() / (stride * stride) + gray.width());
        for y in (0..gray.height()).step_by(stride) {
            let row = gray.row(y);
            // Rows begin at different columns, so that nothing regular is missed.
            let columns = ((y / stride) % stride..gray.width()).step_by(stride);
            found.extend(columns.map(|x| of(f64::from(row[x]), x as f64 + 0.5, y as f64 + 0.5)));
        }
        found
    }
}

/// Middle and median brightness of tiles over the picture.
fn tiles(gray: &Gray) -> Vec<(f64, f64, f64)> {
    let side = (gray.width().max(gray.height()) / TILES).max(LOOKED_AT);
    let (columns, rows) = ((gray.width() / side).max(1), (gray.height() / side).max(1));
    let mut found = Vec::with_capacity(columns * rows);
    let mut values = Vec::with_capacity(LOOKED_AT * LOOKED_AT);
    for row in 0..rows {
        for column in 0..columns {
            values.clear();
            for j in 0..LOOKED_AT {
                let y = (row * side + j * side / LOOKED_AT).min(gray.height() - 1);
                let line = gray.row(y);
                values.extend(
                    (0..LOOKED_AT).map(|i| line[(column * side + i * side / LOOKED_AT).min(line.len() - 1)]),
                );
            }
            let middle = values.len() / 2;
            let (_, median, _) = values.select_nth_unstable_by(middle, f32::total_cmp);
            let at = |k: usize| (k as f64 + 0.5) * side as f64;
            found.push((at(column), at(row), f64::from(*median)));
        }
    }
    found
}

/// Parabola through the tiles; those that something covers are left out by and by (Tukey's biweight).
fn surface(tiles: &[(f64, f64, f64)], scale: (f64, f64)) -> [f64; TERMS] {
    let columns = |&(x, y, _): &(f64, f64, f64)| {
        let (u, v) = (x * scale.0 - 1.0, y * scale.1 - 1.0);
        [1.0, u, v, u * u, u * v, v * v]
    };
    let mut medians: Vec<f64> = tiles.iter().map(|tile| tile.2).collect();
    let mut terms = [0.0; TERMS];
    terms[0] = median(&mut medians);
    for _ in 0..12 {
        let left = |tile: &(f64, f64, f64)| {
            let fitted: f64 = columns(tile).iter().zip(&terms).map(|(c, t)| c * t).sum();
            tile.2 - fitted
        };
        let residuals: Vec<f64> = tiles.iter().map(left).collect();
        let scale = sd_about_median(&residuals).max(1.0 / 255.0);
        let mut normal = Symmetric::zero(TERMS);
        let mut right = [0.0; TERMS];
        for (tile, residual) in tiles.iter().zip(&residuals) {
            let weight = biweight(residual / (5.0 * scale));
            let columns = columns(tile);
            for row in 0..TERMS {
                right[row] += weight * columns[row] * tile.2;
                for column in 0..TERMS {
                    normal.add(row, column, weight * columns[row] * columns[column]);
                }
            }
        }
        let solved = normal.solve(&right, 1e-9);
        let moved = solved.iter().zip(&terms).any(|(a, b)| (a - b).abs() > 1e-5);
        terms.copy_from_slice(&solved);
        if !moved {
            break;
        }
    }
    terms
}

/// Tukey's biweight: 1 in the middle, 0 at 1 and beyond.
pub fn biweight(share: f64) -> f64 {
    (1.0 - (share * share).min(1.0)).powi(2)
}

/// The middle value; zero of none.
pub fn median(values: &mut [f64]) -> f64 {
    upper_median(values).unwrap_or(0.0)
}

/// Whether what stands out is darker or brighter than the ground.
fn tone(differences: &[f64], noise: f64) -> Result<Tone, Untraceable> {
    let (mut bright, mut dark) = (0.0, 0.0);
    let largest = differences.iter().fold(0.0f64, |most, d| most.max(d.abs()));
    for difference in differences {
        let beyond = (difference.abs() - 5.0 * noise).max(0.0).powi(2);
        if *difference > 0.0 {
            bright += beyond
        } else {
            dark += beyond
        }
    }
    // The tails of the noise are no strip.
    if largest < STANDS_OUT * noise {
        return Err(Untraceable::Empty {
            contrast: largest,
            noise,
        });
    }
    match bright / (bright + dark) {
        share if share > CLEARLY / (1.0 + CLEARLY) => Ok(Tone::Bright),
        share if share < 1.0 / (1.0 + CLEARLY) => Ok(Tone::Dark),
        _ => Err(Untraceable::Tone),
    }
}

/// The level half-way between the strip and what lies beside it (Otsu's split): between the levels above `least`, with
/// as much ground added, so that a strip that is a hundredth of the picture counts as much as the rest.
fn split(levels: &[f64], least: f64) -> Option<f64> {
    const BINS: usize = 256;
    let above: Vec<f64> = levels.iter().copied().filter(|level| *level > least).collect();
    let highest = above.iter().fold(0.0f64, |most, level| most.max(*level));
    if above.len() < 8 {
        return None;
    }
    let mut bins = [0.0f64; BINS];
    bins[0] = above.len() as f64;
    for level in &above {
        bins[((level / highest * BINS as f64) as usize).min(BINS - 1)] += 1.0;
    }
    let total: f64 = bins.iter().sum();
    let middle = |bin: usize| if bin == 0 { 0.0 } else { bin as f64 + 0.5 };
    let moment: f64 = bins.iter().enumerate().map(|(bin, n)| middle(bin) * n).sum();
    let (mut below, mut below_moment) = (0.0, 0.0);
    let mut best = (0.0, 0.0);
    for (bin, n) in bins.iter().enumerate().take(BINS - 1) {
        below += n;
        below_moment += middle(bin) * n;
        let rest = total - below;
        if rest <= 0.0 {
            break;
        }
        let (low, high) = (below_moment / below, (moment - below_moment) / rest);
        let between = below * rest * (high - low).powi(2);
        if between > best.0 {
            best = (between, 0.5 * (low + high));
        }
    }
    Some(best.1 / BINS as f64 * highest)
}
