//! A print as pixels, with its resolution in the file, so that it has its size in millimetres wherever it is placed.

use tiny_skia::{Color, FillRule, LineCap, LineJoin, PathBuilder, Pixmap, Stroke, Transform};

use super::Print;
use super::outlines::{Outline, Paint, Piece, outlines};

/// Bytes before the first chunk that may be followed by others: signature and header.
const HEADER_BYTES: usize = 33;
const METRES_PER_INCH: f64 = 0.0254;
/// Pixels at most to a side: a wrong resolution must not take all memory.
const LARGEST: f64 = 20_000.0;

/// Writes the print with `dots_per_inch`.
///
/// # Errors
/// The picture would be larger than a picture can be, or the font cannot be read.
pub fn write(print: &Print, dots_per_inch: f64) -> Result<Vec<u8>, String> {
    let (width_mm, height_mm) = print.size_mm();
    let pixels = |mm: f64| (mm / 25.4 * dots_per_inch).round();
    let (width, height) = (pixels(width_mm), pixels(height_mm));
    if !(1.0..=LARGEST).contains(&width) || !(1.0..=LARGEST).contains(&height) {
        return Err(format!(
            "found {width} x {height} pixels, needed 1 to {LARGEST} to a side: change --dpi or --width-mm"
        ));
    }
    let mut pixmap = Pixmap::new(width as u32, height as u32).ok_or("no memory for the picture")?;
    pixmap.fill(Color::WHITE);
    let scale = (width / f64::from(print.drawing.size.0)) as f32;
    for outline in outlines(&print.drawing)? {
        paint(&mut pixmap, &outline, Transform::from_scale(scale, scale));
    }
    let bytes = pixmap.encode_png().map_err(|error| error.to_string())?;
    Ok(with_resolution(bytes, dots_per_inch))
}

fn paint(pixmap: &mut Pixmap, outline: &Outline, transform: Transform) {
    let mut builder = PathBuilder::new();
    for piece in &outline.pieces {
        match *piece {
            Piece::Move(x, y) => match outline.paint {
                Paint::Dots(diameter) => builder.push_circle(x, y, 0.5 * diameter),
                _ => builder.move_to(x, y),
            },
            Piece::Line(x, y) => builder.line_to(x, y),
            Piece::Curve([ax, ay, bx, by, x, y]) => builder.cubic_to(ax, ay, bx, by, x, y),
            Piece::Close => builder.close(),
        }
    }
    // A path without extent has nothing to show.
    let Some(path) = builder.finish() else { return };
    let mut paint = tiny_skia::Paint::default();
    let (red, green, blue) = outline.rgb;
    paint.set_color_rgba8(red, green, blue, (255.0 * outline.opacity).round() as u8);
    paint.anti_alias = true;
    match outline.paint {
        Paint::Fill | Paint::Dots(_) => pixmap.fill_path(&path, &paint, FillRule::Winding, transform, None),
        Paint::Line(width) => {
            let stroke = Stroke {
                width,
                line_cap: LineCap::Round,
                line_join: LineJoin::Round,
                ..Stroke::default()
            };
            pixmap.stroke_path(&path, &paint, &stroke, transform, None);
        }
    }
}

/// Adds the chunk that says how many pixels there are to a metre.
fn with_resolution(mut bytes: Vec<u8>, dots_per_inch: f64) -> Vec<u8> {
    let per_metre = (dots_per_inch / METRES_PER_INCH).round() as u32;
    let mut chunk = b"pHYs".to_vec();
    chunk.extend(per_metre.to_be_bytes());
    chunk.extend(per_metre.to_be_bytes());
    chunk.push(1);
    let check = crc32fast::hash(&chunk);
    let mut whole = 9u32.to_be_bytes().to_vec();
    whole.extend(chunk);
    whole.extend(check.to_be_bytes());
    if bytes.len() >= HEADER_BYTES {
        bytes.splice(HEADER_BYTES..HEADER_BYTES, whole);
    }
    bytes
}
