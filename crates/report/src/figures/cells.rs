//! Cells of a map: a small picture in a page, patches in a print.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;

use super::colors::Rgb;
use super::shape::TENTHS;

/// How far a patch reaches under its neighbours, tenths of a pixel: edges that meet would show as hair lines.
const OVERLAP: i32 = 6;

/// Rectangles in rows and columns, each of one colour or left out.
#[derive(Debug, Clone, PartialEq)]
pub struct Cells {
    /// Edges of the columns from left to right, tenths of a pixel; one more than columns.
    pub columns: Vec<i32>,
    /// Edges of the rows from top to bottom; one more than rows.
    pub rows: Vec<i32>,
    /// Colours, row after row from the top; none: nothing is drawn there.
    pub colors: Vec<Option<Rgb>>,
}

impl Cells {
    /// Left, top, right and bottom of all cells.
    pub fn frame(&self) -> [i32; 4] {
        let ends = |edges: &[i32]| match edges {
            [first, .., last] => (*first, *last),
            _ => (0, 0),
        };
        let ((left, right), (top, bottom)) = (ends(&self.columns), ends(&self.rows));
        [left, top, right, bottom]
    }

    fn color(&self, row: usize, column: usize) -> Option<Rgb> {
        let across = self.columns.len() - 1;
        self.colors.get(row * across + column).copied().flatten()
    }

    /// The cells as rectangles (left, top, right, bottom), neighbours of one colour in a row made one.
    pub fn patches(&self) -> Vec<(Rgb, [i32; 4])> {
        let mut patches = Vec::new();
        let [_, _, right_end, bottom_end] = self.frame();
        for (row, ends) in self.rows.windows(2).enumerate() {
            let bottom = (ends[1] + OVERLAP).min(bottom_end);
            let mut column = 0;
            while column + 1 < self.columns.len() {
                let color = self.color(row, column);
                let first = column;
                while column + 1 < self.columns.len() && self.color(row, column) == color {
                    column += 1;
                }
                let Some(color) = color else { continue };
                // Nothing is drawn over what is left out.
                let goes_on = column + 1 < self.columns.len() && self.color(row, column).is_some();
                let right = self.columns[column] + if goes_on { OVERLAP } else { 0 };
                let below =
                    (first..column).all(|k| row + 2 < self.rows.len() && self.color(row + 1, k).is_some());
                let bottom = if below { bottom } else { ends[1] };
                patches.push((
                    color,
                    [self.columns[first], ends[0], right.min(right_end), bottom],
                ));
            }
        }
        patches
    }

    /// The cells as a PNG, a pixel of the picture for each pixel of the page, in an address that holds it whole.
    pub fn data_uri(&self) -> String {
        // Encoding into memory cannot fail; a picture without extent has nothing to show.
        let bytes = self.png().unwrap_or_default();
        format!("data:image/png;base64,{}", STANDARD.encode(bytes))
    }

    fn png(&self) -> Result<Vec<u8>, png::EncodingError> {
        let [left, top, right, bottom] = self.frame();
        let (columns, rows) = (
            self.sampled(&self.columns, left, right),
            self.sampled(&self.rows, top, bottom),
        );
        let mut palette: Vec<Rgb> = self.colors.iter().copied().flatten().collect();
        palette.sort_unstable();
        palette.dedup();
        let index = |color: Option<Rgb>| match color {
            Some(color) => palette.partition_point(|other| *other < color) as u8 + 1,
            None => 0,
        };
        let pixels: Vec<u8> = rows
            .iter()
            .flat_map(|&row| columns.iter().map(move |&column| (row, column)))
            .map(|(row, column)| index(self.color(row, column)))
            .collect();
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, columns.len() as u32, rows.len() as u32);
        encoder.set_color(png::ColorType::Indexed);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_compression(png::Compression::High);
        let transparent = (0, 0, 0);
        let colors = std::iter::once(transparent).chain(palette.iter().copied());
        encoder.set_palette(colors.flat_map(|(r, g, b)| [r, g, b]).collect::<Vec<u8>>());
        encoder.set_trns(vec![0u8]);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(&pixels)?;
        writer.finish()?;
        Ok(bytes)
    }

    /// The cell under the middle of each pixel between two ends.
    fn sampled(&self, edges: &[i32], from: i32, to: i32) -> Vec<usize> {
        // Even cells are a pixel each: the page stretches them.
        let size = |k: usize| edges[k + 1] - edges[k];
        let cells = edges.len().saturating_sub(1);
        if (1..cells).all(|k| (size(k) - size(0)).abs() <= 1) {
            return (0..cells).collect();
        }
        let pixels = ((to - from) / TENTHS).max(1);
        (0..pixels)
            .map(|pixel| {
                let middle = from + pixel * TENTHS + TENTHS / 2;
                edges.partition_point(|edge| *edge <= middle).clamp(1, cells) - 1
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RED: Rgb = (200, 0, 0);
    const BLUE: Rgb = (0, 0, 200);

    fn cells() -> Cells {
        Cells {
            columns: vec![100, 150, 300, 400],
            rows: vec![0, 80, 200],
            colors: vec![Some(RED), Some(RED), None, Some(BLUE), Some(RED), Some(BLUE)],
        }
    }

    #[test]
    fn neighbours_of_one_colour_are_one_patch_and_holes_stay() {
        assert_eq!(
            cells().patches(),
            [
                (RED, [100, 0, 300, 86]),
                (BLUE, [100, 80, 156, 200]),
                (RED, [150, 80, 306, 200]),
                (BLUE, [300, 80, 400, 200]),
            ]
        );
    }

    #[test]
    fn the_picture_has_the_cells_where_they_lie() {
        let bytes = cells().png().unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(&bytes))
            .read_info()
            .unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut pixels).unwrap();
        assert_eq!((info.width, info.height), (30, 20));
        let at = |x: usize, y: usize| pixels[y * 30 + x];
        assert_eq!([at(0, 0), at(19, 7), at(20, 7), at(29, 19)], [2, 2, 0, 1]);
        assert_eq!([at(4, 8), at(5, 8)], [1, 2]);
    }
}
