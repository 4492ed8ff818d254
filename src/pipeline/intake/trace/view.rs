//! What is said of the view of a camera and of frames that were refused.

use schemars::JsonSchema;
use serde::Serialize;

/// A frame that was not traced.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct RefusedFrame {
    /// Its name.
    pub frame: String,
    /// Why.
    pub reason: String,
}

/// What holds for all frames.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ViewSummary {
    /// Side of the clamp in the first frame.
    pub clamp: &'static str,
    /// Dark or bright.
    pub strip: &'static str,
    /// Scale.
    pub px_per_mm: f64,
    /// Where the scale comes from.
    pub scale_from: String,
    /// Free length of the initial shape, mm.
    pub length_mm: f64,
    /// Thickness of the strip in the first frame, mm.
    pub thickness_mm: f64,
    /// Which turn is positive.
    pub positive: &'static str,
    /// What bending is counted from.
    pub initial: String,
    /// Positions of the curvatures, mm from the clamp.
    pub positions_mm: Vec<f64>,
    /// Median of the edges' noise over the frames, pixels.
    pub edge_noise_px: f64,
}
