//! A print as an SVG file of its own: sizes in millimetres, colours in the file, text as outlines.

use ieap_domain::number::digits;
use std::fmt::Write as _;

use super::Print;
use super::outlines::{Outline, Paint, Piece, outlines};
use crate::visible::escaped;

/// Writes the print.
///
/// # Errors
/// The font cannot be read; a fault of the program.
pub fn write(print: &Print) -> Result<Vec<u8>, String> {
    let (width_mm, height_mm) = print.size_mm();
    let (width, height) = print.drawing.size;
    let mut out = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{}mm\" \
         height=\"{}mm\" viewBox=\"0 0 {width} {height}\" role=\"img\" stroke-linejoin=\"round\" \
         stroke-linecap=\"round\">\n<title>{}</title>\n<desc>{}</desc>\n",
        digits(width_mm, 2),
        digits(height_mm, 2),
        escaped(&print.title),
        escaped(&print.description())
    );
    let _ = writeln!(out, "<rect width=\"{width}\" height=\"{height}\" fill=\"#fff\"/>");
    for outline in outlines(&print.drawing)? {
        element(&mut out, &outline);
    }
    out += "</svg>\n";
    Ok(out.into_bytes())
}

fn element(out: &mut String, outline: &Outline) {
    if outline.pieces.is_empty() {
        return;
    }
    let (red, green, blue) = outline.rgb;
    let color = format!("#{red:02x}{green:02x}{blue:02x}");
    let paint = match outline.paint {
        Paint::Line(width) | Paint::Dots(width) => {
            format!("fill=\"none\" stroke=\"{color}\" stroke-width=\"{width}\"")
        }
        Paint::Fill => format!("fill=\"{color}\""),
    };
    let opacity = if outline.opacity < 1.0 {
        format!(" opacity=\"{}\"", outline.opacity)
    } else {
        String::new()
    };
    // Writing to a String cannot fail.
    let _ = write!(out, "<path {paint}{opacity} d=\"");
    for piece in &outline.pieces {
        let _ = match piece {
            // A line without length has round ends.
            Piece::Move(x, y) if matches!(outline.paint, Paint::Dots(_)) => {
                write!(out, "M{} {}h0", short(*x), short(*y))
            }
            Piece::Move(x, y) => write!(out, "M{} {}", short(*x), short(*y)),
            Piece::Line(x, y) => write!(out, "L{} {}", short(*x), short(*y)),
            Piece::Curve(p) => write!(
                out,
                "C{} {} {} {} {} {}",
                short(p[0]),
                short(p[1]),
                short(p[2]),
                short(p[3]),
                short(p[4]),
                short(p[5])
            ),
            Piece::Close => write!(out, "Z"),
        };
    }
    out.push_str("\"/>\n");
}

/// A hundredth of a pixel is finer than any printer.
fn short(number: f32) -> f32 {
    (number * 10.0).round() / 10.0
}
