//! Drawings as paths: lines, areas, and text as the outlines of its letters (DejaVu Sans, carried by the program).

use plotters_backend::BackendColor;
use plotters_backend::text_anchor::HPos;
use skrifa::instance::{LocationRef, Size};
use skrifa::outline::{DrawSettings, OutlinePen};
use skrifa::{FontRef, GlyphId, MetadataProvider};

use crate::figures::canvas::{Drawing, Label, Shape};
use crate::figures::cells::Cells;

/// A piece of a path; positions in tenths of a pixel, down from the top.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Piece {
    /// Go there without a line.
    Move(f32, f32),
    /// A straight line.
    Line(f32, f32),
    /// A cubic curve over two control points.
    Curve([f32; 6]),
    /// Back to where the outline began.
    Close,
}

/// A path with what is done to it.
#[derive(Debug, Clone, PartialEq)]
pub struct Outline {
    /// Pieces in order.
    pub pieces: Vec<Piece>,
    /// What is done to it.
    pub paint: Paint,
    /// Red, green, blue.
    pub rgb: (u8, u8, u8),
    /// From 0 to 1.
    pub opacity: f32,
}

/// What is done to a path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Paint {
    /// Its inside is filled.
    Fill,
    /// A line of that width follows it.
    Line(f32),
    /// A dot of that diameter stands at each of its points.
    Dots(f32),
}

/// Distance of the control points of a quarter of a circle from its ends, in radii.
const QUARTER: f32 = 0.552_284_8;

/// Every shape of a drawing as a path, from back to front.
///
/// # Errors
/// The font cannot be read; a fault of the program.
pub fn outlines(drawing: &Drawing) -> Result<Vec<Outline>, String> {
    let font = FontRef::new(dejavu::sans::regular()).map_err(|error| error.to_string())?;
    let mut found: Vec<Outline> = Vec::new();
    for shape in &drawing.shapes {
        if let Shape::Cells(cells) = shape {
            found.extend(painted_cells(cells));
            continue;
        }
        let Some(outline) = outline(shape, &font) else {
            continue;
        };
        match found.last_mut() {
            // Dots of one kind are one path: files stay small.
            Some(last) if is_dots(&outline) && alike(last, &outline) => last.pieces.extend(outline.pieces),
            _ => found.push(outline),
        }
    }
    Ok(found)
}

fn is_dots(outline: &Outline) -> bool {
    matches!(outline.paint, Paint::Dots(_))
}

fn alike(a: &Outline, b: &Outline) -> bool {
    (a.paint, a.rgb, a.opacity) == (b.paint, b.rgb, b.opacity)
}

fn outline(shape: &Shape, font: &FontRef) -> Option<Outline> {
    Some(match shape {
        Shape::Stroke { points, width, color } => {
            painted(*color, Paint::Line(*width as f32), polygon(points, false))
        }
        Shape::Fill { points, color } => painted(*color, Paint::Fill, polygon(points, true)),
        Shape::Dot { at, radius, color } => {
            let there = vec![Piece::Move(at.0 as f32, at.1 as f32)];
            painted(*color, Paint::Dots(2.0 * *radius as f32), there)
        }
        Shape::Ring {
            at,
            radius,
            width,
            color,
        } => painted(*color, Paint::Line(*width as f32), circle(*at, *radius)),
        Shape::Text(label) => painted(label.color, Paint::Fill, letters(label, font)),
        Shape::Open(_) | Shape::Close | Shape::Cells(_) => return None,
    })
}

/// Cells of a map, those of one colour as one path: files stay small.
fn painted_cells(cells: &Cells) -> Vec<Outline> {
    let mut patches = cells.patches();
    patches.sort_by_key(|(rgb, _)| *rgb);
    let of_color = patches.chunk_by(|a, b| a.0 == b.0);
    of_color
        .map(|patches| Outline {
            pieces: patches
                .iter()
                .flat_map(|(_, [left, top, right, bottom])| {
                    let corners = [(*left, *top), (*right, *top), (*right, *bottom), (*left, *bottom)];
                    polygon(&corners, true)
                })
                .collect(),
            paint: Paint::Fill,
            rgb: patches[0].0,
            opacity: 1.0,
        })
        .collect()
}

fn painted(color: BackendColor, paint: Paint, pieces: Vec<Piece>) -> Outline {
    Outline {
        pieces,
        paint,
        rgb: color.rgb,
        opacity: color.alpha as f32,
    }
}

fn polygon(points: &[(i32, i32)], closed: bool) -> Vec<Piece> {
    let mut pieces: Vec<Piece> = Vec::with_capacity(points.len() + 1);
    for &(x, y) in points {
        let (x, y) = (x as f32, y as f32);
        pieces.push(if pieces.is_empty() {
            Piece::Move(x, y)
        } else {
            Piece::Line(x, y)
        });
    }
    if closed {
        pieces.push(Piece::Close);
    }
    pieces
}

fn circle((x, y): (i32, i32), radius: u32) -> Vec<Piece> {
    let (x, y, r) = (x as f32, y as f32, radius as f32);
    let k = QUARTER * r;
    vec![
        Piece::Move(x + r, y),
        Piece::Curve([x + r, y + k, x + k, y + r, x, y + r]),
        Piece::Curve([x - k, y + r, x - r, y + k, x - r, y]),
        Piece::Curve([x - r, y - k, x - k, y - r, x, y - r]),
        Piece::Curve([x + k, y - r, x + r, y - k, x + r, y]),
        Piece::Close,
    ]
}

/// The letters of a label. A character that the font lacks shows as the font's empty box.
fn letters(label: &Label, font: &FontRef) -> Vec<Piece> {
    // As it was drawn: not scaled, and of no variation.
    let (whole, plain) = (Size::unscaled(), LocationRef::default());
    let (metrics, glyph_metrics) = (font.metrics(whole, plain), font.glyph_metrics(whole, plain));
    let scale = label.size as f32 / f32::from(metrics.units_per_em);
    let text = crate::visible::one_line(&label.text);
    let (charmap, outlines) = (font.charmap(), font.outline_glyphs());
    let glyphs: Vec<GlyphId> = text
        .chars()
        .map(|c| charmap.map(c).unwrap_or(GlyphId::NOTDEF))
        .collect();
    let advance = |glyph: &GlyphId| scale * glyph_metrics.advance_width(*glyph).unwrap_or(0.0);
    let length: f32 = glyphs.iter().map(advance).sum();
    let mut pen = Pen {
        pieces: Vec::new(),
        origin: (label.at.0 as f32, label.at.1 as f32),
        scale,
        upward: label.upward,
        along: match label.anchor {
            HPos::Left => 0.0,
            HPos::Center => -0.5 * length,
            HPos::Right => -length,
        },
        last: (0.0, 0.0),
    };
    for glyph in &glyphs {
        // A glyph that has no outline, as a blank, leaves its room empty.
        let drawn = outlines.get(*glyph);
        let _ = drawn.map(|drawn| drawn.draw(DrawSettings::unhinted(whole, plain), &mut pen));
        pen.along += advance(glyph);
    }
    pen.pieces
}

/// Puts the outline of a glyph, which counts upward from its own origin in units of the font, where the label is.
struct Pen {
    pieces: Vec<Piece>,
    /// Tenths of a pixel in a unit of the font.
    scale: f32,
    origin: (f32, f32),
    upward: bool,
    along: f32,
    last: (f32, f32),
}

impl Pen {
    fn placed(&self, x: f32, y: f32) -> (f32, f32) {
        let (along, up) = (self.along + self.scale * x, self.scale * y);
        if self.upward {
            (self.origin.0 - up, self.origin.1 - along)
        } else {
            (self.origin.0 + along, self.origin.1 - up)
        }
    }
}

impl OutlinePen for Pen {
    fn move_to(&mut self, x: f32, y: f32) {
        self.last = (x, y);
        let (x, y) = self.placed(x, y);
        self.pieces.push(Piece::Move(x, y));
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.last = (x, y);
        let (x, y) = self.placed(x, y);
        self.pieces.push(Piece::Line(x, y));
    }

    fn quad_to(&mut self, cx: f32, cy: f32, x: f32, y: f32) {
        // The cubic curve that is the same.
        let (x0, y0) = self.last;
        let toward = |from: f32, control: f32| from + 2.0 / 3.0 * (control - from);
        self.curve_to(toward(x0, cx), toward(y0, cy), toward(x, cx), toward(y, cy), x, y);
    }

    fn curve_to(&mut self, ax: f32, ay: f32, bx: f32, by: f32, x: f32, y: f32) {
        self.last = (x, y);
        let (a, b, end) = (self.placed(ax, ay), self.placed(bx, by), self.placed(x, y));
        self.pieces.push(Piece::Curve([a.0, a.1, b.0, b.1, end.0, end.1]));
    }

    fn close(&mut self) {
        self.pieces.push(Piece::Close);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figures::canvas::Ink;

    fn label(text: &str, anchor: HPos, upward: bool) -> Label {
        let (red, green, blue) = (0, 0, 0);
        Label {
            text: text.to_owned(),
            at: (1000, 1000),
            size: 110.0,
            anchor,
            upward,
            color: BackendColor {
                alpha: 1.0,
                rgb: (red, green, blue),
            },
        }
    }

    fn extent(label: Label) -> [f32; 4] {
        let drawing = Drawing {
            size: (2000, 2000),
            shapes: vec![Shape::Text(label)],
        };
        let outlines = outlines(&drawing).unwrap();
        let mut extent = [f32::MAX, f32::MAX, f32::MIN, f32::MIN];
        for piece in &outlines[0].pieces {
            if let Piece::Move(x, y) | Piece::Line(x, y) = *piece {
                extent = [
                    extent[0].min(x),
                    extent[1].min(y),
                    extent[2].max(x),
                    extent[3].max(y),
                ];
            }
        }
        extent
    }

    #[test]
    fn text_stands_where_its_anchor_says() {
        let [left, top, right, bottom] = extent(label("HHH", HPos::Left, false));
        assert!(left > 999.0 && right > 1150.0 && top < 930.0 && bottom <= 1001.0);
        let [left, _, right, _] = extent(label("HHH", HPos::Right, false));
        assert!(right < 1001.0 && left < 850.0);
        let [left, top, right, _] = extent(label("HHH", HPos::Left, true));
        assert!(right <= 1001.0 && left < 930.0 && top < 850.0);
    }

    #[test]
    fn the_font_has_every_character_of_axes_and_symbols() {
        let font = FontRef::new(dejavu::sans::regular()).unwrap();
        for character in "0123456789·⁻⁰¹²³⁴⁵⁶⁷⁸⁹₁₂ₛₑ∥αλμκτΩ±−–°′″|*%(),.…ÕõÄäÖöÜüŠšŽžЖ".chars()
        {
            assert!(font.charmap().map(character).is_some(), "{character}");
        }
        assert_eq!(Ink::Text.color().0, 0x1d);
    }
}
