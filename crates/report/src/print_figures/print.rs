//! A drawing on its way into a file, and its size on paper.

use crate::figures::canvas::Drawing;

/// Points (1/72 inch) per pixel of a drawing: tick labels of 11 px are 7.5 pt in print, titles of 12 px 8.2 pt, and
/// the thinnest line, 0.8 px, 0.55 pt.
pub const POINTS_PER_PIXEL: f64 = 7.5 / 11.0;
/// Points per millimetre.
pub(super) const POINTS_PER_MM: f64 = 72.0 / 25.4;

/// A drawing with what a file needs beside it.
pub struct Print {
    /// What it shows.
    pub title: String,
    /// The campaign's own statement, such as "simulated, not measured".
    pub notice: Option<String>,
    /// The drawing.
    pub drawing: Drawing,
    /// Its width, mm.
    pub width_mm: f64,
}

impl Print {
    /// Width of a drawing that is printed `width_mm` wide, px.
    pub fn pixels(width_mm: f64) -> u32 {
        (width_mm * POINTS_PER_MM / POINTS_PER_PIXEL).round() as u32
    }

    /// Width and height, mm; the height follows from the drawing.
    pub fn size_mm(&self) -> (f64, f64) {
        let (width, height) = self.drawing.size;
        (
            self.width_mm,
            self.width_mm * f64::from(height) / f64::from(width),
        )
    }

    /// Title and notice.
    pub fn description(&self) -> String {
        match &self.notice {
            Some(notice) => format!("{}. {notice}", self.title),
            None => self.title.clone(),
        }
    }
}
