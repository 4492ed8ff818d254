//! A picture in shades of grey.

/// A rectangle of pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Crop {
    /// First column.
    pub left: usize,
    /// First row.
    pub top: usize,
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
}

/// Brightness of each pixel, 0 (black) to 1 (white), row by row from the top.
///
/// Places are continuous: pixel (0, 0) covers 0 to 1 in both directions, x to the right and y downward.
#[derive(Debug, Clone, PartialEq)]
pub struct Gray {
    width: usize,
    height: usize,
    values: Vec<f32>,
}

impl Gray {
    /// A picture of `values`, row by row; none where their number is not `width` times `height`, or zero.
    pub fn new(width: usize, height: usize, values: Vec<f32>) -> Option<Gray> {
        let fits = width > 0 && width.checked_mul(height) == Some(values.len()) && height > 0;
        fits.then_some(Gray {
            width,
            height,
            values,
        })
    }

    /// Columns.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> usize {
        self.height
    }

    /// Pixels of a row.
    pub fn row(&self, y: usize) -> &[f32] {
        &self.values[y * self.width..(y + 1) * self.width]
    }

    /// The part inside a rectangle; none where it reaches beyond the picture or is empty.
    pub fn part(&self, crop: &Crop) -> Option<Gray> {
        let (right, bottom) = (
            crop.left.checked_add(crop.width)?,
            crop.top.checked_add(crop.height)?,
        );
        if right > self.width || bottom > self.height {
            return None;
        }
        let rows = (crop.top..bottom).flat_map(|y| self.row(y)[crop.left..right].iter().copied());
        Gray::new(crop.width, crop.height, rows.collect())
    }

    /// Whether a place lies in the picture.
    pub fn holds(&self, (x, y): (f64, f64)) -> bool {
        x >= 0.0 && y >= 0.0 && x <= self.width as f64 && y <= self.height as f64
    }

    /// Brightness at a place, linear between the middles of pixels; beyond the picture, that of its margin.
    #[inline]
    pub fn at(&self, x: f64, y: f64) -> f32 {
        let fx = (x as f32 - 0.5).clamp(0.0, (self.width - 1) as f32);
        let fy = (y as f32 - 0.5).clamp(0.0, (self.height - 1) as f32);
        let (left, top) = (fx as usize, fy as usize);
        let (right, bottom) = ((left + 1).min(self.width - 1), (top + 1).min(self.height - 1));
        let (a, b) = (fx - left as f32, fy - top as f32);
        let (upper, lower) = (top * self.width, bottom * self.width);
        let value = |row: usize| self.values[row + left] * (1.0 - a) + self.values[row + right] * a;
        value(upper) * (1.0 - b) + value(lower) * b
    }
}
