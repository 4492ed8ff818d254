//! A print as a PDF of one page: paths only, so that no reader and no printer needs a font.

use std::collections::BTreeMap;
use std::io::Write;

use flate2::Compression;
use flate2::write::ZlibEncoder;
use pdf_writer::types::{LineCapStyle, LineJoinStyle};
use pdf_writer::{Content, Filter, Finish, Name, Pdf, Rect, Ref, TextStr};

use super::outlines::{Outline, Paint, Piece, outlines};
use super::print::{POINTS_PER_MM, Print};

/// Writes the print.
///
/// # Errors
/// The font cannot be read; a fault of the program.
pub fn write(print: &Print) -> Result<Vec<u8>, String> {
    let (width_mm, height_mm) = print.size_mm();
    let (width, height) = (
        (width_mm * POINTS_PER_MM) as f32,
        (height_mm * POINTS_PER_MM) as f32,
    );
    let scale = width / print.drawing.size.0 as f32;
    let mut content = Content::new();
    // Drawings count down from the top, pages up from the bottom.
    content.transform([scale, 0.0, 0.0, -scale, 0.0, height]);
    content
        .set_line_cap(LineCapStyle::RoundCap)
        .set_line_join(LineJoinStyle::RoundJoin);
    let outlines = outlines(&print.drawing)?;
    let opacities = opacities(&outlines);
    for outline in &outlines {
        paint(&mut content, outline, &opacities);
    }
    let [catalog, pages, page, stream, info] = [1, 2, 3, 4, 5].map(Ref::new);
    let mut pdf = Pdf::new();
    pdf.catalog(catalog).pages(pages);
    pdf.pages(pages).kids([page]).count(1);
    let mut leaf = pdf.page(page);
    leaf.media_box(Rect::new(0.0, 0.0, width, height))
        .parent(pages)
        .contents(stream);
    let mut resources = leaf.resources();
    let mut states = resources.ext_g_states();
    for (percent, name) in &opacities {
        let alpha = f32::from(*percent) / 100.0;
        states
            .insert(Name(name.as_bytes()))
            .start::<pdf_writer::writers::ExtGraphicsState>()
            .non_stroking_alpha(alpha)
            .stroking_alpha(alpha);
    }
    states.finish();
    resources.finish();
    leaf.finish();
    let bytes = compressed(&content.finish()).map_err(|error| error.to_string())?;
    pdf.stream(stream, &bytes).filter(Filter::FlateDecode);
    pdf.document_info(info)
        .title(TextStr(&print.title))
        .subject(TextStr(&print.description()))
        .creator(TextStr(concat!("ieap ", env!("CARGO_PKG_VERSION"))));
    Ok(pdf.finish())
}

/// Opacities that occur, in percent, with the names of their states.
fn opacities(outlines: &[Outline]) -> BTreeMap<u8, String> {
    let percents = outlines.iter().map(percent);
    percents.map(|percent| (percent, format!("A{percent}"))).collect()
}

fn percent(outline: &Outline) -> u8 {
    (100.0 * outline.opacity.clamp(0.0, 1.0)).round() as u8
}

fn paint(content: &mut Content, outline: &Outline, opacities: &BTreeMap<u8, String>) {
    if outline.pieces.is_empty() {
        return;
    }
    if let Some(name) = opacities.get(&percent(outline)) {
        content.set_parameters(Name(name.as_bytes()));
    }
    let part = |part: u8| f32::from(part) / 255.0;
    let (red, green, blue) = (part(outline.rgb.0), part(outline.rgb.1), part(outline.rgb.2));
    match outline.paint {
        Paint::Line(width) | Paint::Dots(width) => {
            content.set_line_width(width).set_stroke_rgb(red, green, blue)
        }
        Paint::Fill => content.set_fill_rgb(red, green, blue),
    };
    for piece in &outline.pieces {
        match *piece {
            // A line without length has round ends.
            Piece::Move(x, y) if matches!(outline.paint, Paint::Dots(_)) => {
                content.move_to(short(x), short(y)).line_to(short(x), short(y))
            }
            Piece::Move(x, y) => content.move_to(short(x), short(y)),
            Piece::Line(x, y) => content.line_to(short(x), short(y)),
            Piece::Curve(points) => {
                let [ax, ay, bx, by, x, y] = points.map(short);
                content.cubic_to(ax, ay, bx, by, x, y)
            }
            Piece::Close => content.close_path(),
        };
    }
    match outline.paint {
        Paint::Line(_) | Paint::Dots(_) => content.stroke(),
        Paint::Fill => content.fill_nonzero(),
    };
}

/// A hundredth of a pixel is finer than any printer.
fn short(number: f32) -> f32 {
    (number * 10.0).round() / 10.0
}

/// The bytes as a PDF stores them compressed.
fn compressed(bytes: &[u8]) -> std::io::Result<Vec<u8>> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(bytes)?;
    encoder.finish()
}
