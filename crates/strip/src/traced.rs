//! What a picture says of the strip: its centre line with its uncertainty.

use super::curve::{Curve, PARAMETERS};
use super::{Side, Tone};
use ieap_numerics::symmetric::Symmetric;

/// A strip as a frame shows it.
///
/// Places are pixels of the whole picture, from its top left corner, y downward; angles and curvatures are positive
/// where the strip turns counter-clockwise as a person sees it.
#[derive(Debug, Clone)]
pub struct Trace {
    /// Centre line, in pixels of the crop.
    pub(super) curve: Curve,
    /// Covariance of start, angle and coefficients of the centre line.
    pub(super) covariance: Symmetric,
    /// Thickness along the strip, pixels.
    pub(super) width: Vec<f64>,
    /// Where the crop starts.
    pub(super) corner: (f64, f64),
    /// The side of the clamp.
    pub clamp: Side,
    /// Dark or bright.
    pub tone: Tone,
    /// Standard deviation of one reading of one edge about the smooth line, pixels.
    pub edge_noise_px: f64,
    /// Length of strip over which the curvature is smoothed, pixels: what one free parameter of it stands for.
    pub bandwidth_px: f64,
    /// Standard error of the length by the tip, pixels.
    pub tip_error_px: f64,
    /// Share of the length on which an edge was seen and used.
    pub seen: f64,
}

impl Trace {
    /// Length of the strip along its centre line, pixels.
    pub fn length_px(&self) -> f64 {
        self.curve.length
    }

    /// Median thickness, pixels.
    pub fn width_px(&self) -> f64 {
        super::ground::median(&mut self.width.clone())
    }

    /// Place at an arc length.
    pub fn point_px(&self, s: f64) -> (f64, f64) {
        let (x, y) = self.curve.point_at(s);
        (x + self.corner.0, y + self.corner.1)
    }

    /// The tip.
    pub fn tip_px(&self) -> (f64, f64) {
        self.point_px(self.length_px())
    }

    /// Places along the line with the strip's thickness there.
    pub fn line_px(&self) -> impl Iterator<Item = ((f64, f64), (f64, f64), f64)> + '_ {
        (0..self.curve.places()).map(|k| {
            let (x, y) = self.curve.point(k);
            let place = (x + self.corner.0, y + self.corner.1);
            let width = self.width[(k * (self.width.len() - 1)) / (self.curve.places() - 1).max(1)];
            (place, self.curve.normal(k), width)
        })
    }

    /// Tangent angle where the strip leaves the clamp, rad counter-clockwise from the x axis.
    pub fn clamp_angle_rad(&self) -> f64 {
        -self.curve.angle_rad
    }

    /// Curvature at an arc length, and its standard error, 1/pixel.
    pub fn curvature_per_px(&self, s: f64) -> (f64, f64) {
        let (first, weights) = self.curve.curvature.weights(s);
        let mut row = [0.0; PARAMETERS];
        row[2 + first..2 + first + 4].copy_from_slice(&weights);
        (-self.curve.curvature.at(s), self.covariance.error_along(&row))
    }

    /// Mean curvature over the length, and its standard error, 1/pixel.
    pub fn mean_curvature_per_px(&self) -> (f64, f64) {
        let mut row = [0.0; PARAMETERS];
        const PARTS: usize = 400;
        for k in 0..PARTS {
            let s = self.length_px() * (k as f64 + 0.5) / PARTS as f64;
            let (first, weights) = self.curve.curvature.weights(s);
            for (j, w) in weights.iter().enumerate() {
                row[2 + first + j] += w / PARTS as f64;
            }
        }
        let mean: f64 = row[2..]
            .iter()
            .zip(&self.curve.curvature.coefficients)
            .map(|(w, c)| w * c)
            .sum();
        (-mean, self.covariance.error_along(&row))
    }

    /// Standard error of the tip's place across the strip, pixels.
    pub fn tip_across_error_px(&self) -> f64 {
        let last = self.curve.places() - 1;
        let (nx, ny) = self.curve.normal(last);
        let mut error = 0.0;
        self.curve.derivatives(|k, moved| {
            if k == last {
                let row: [f64; PARAMETERS] = std::array::from_fn(|p| moved[p].0 * nx + moved[p].1 * ny);
                error = self.covariance.error_along(&row);
            }
        });
        error
    }
}
