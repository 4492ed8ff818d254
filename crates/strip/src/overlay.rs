//! The traced line drawn over the frame, so that a person can check it.

use tiny_skia::{Color, FillRule, Paint, Path, PathBuilder, Pixmap, Stroke, Transform};

use super::gray::Gray;
use super::traced::Trace;

/// Colours that people who see few colours can tell apart, also in print.
const CENTRE: [u8; 3] = [230, 159, 0];
const EDGES: [u8; 3] = [86, 180, 233];
const JOINTS: [u8; 3] = [213, 94, 0];

/// A PNG of the frame with edges (thin, blue), centre line (orange) and the joints between `vectors` equal vectors
/// (dots).
///
/// # Errors
/// The picture cannot be made, with the library's message.
pub fn overlay(gray: &Gray, trace: &Trace, vectors: usize) -> Result<Vec<u8>, String> {
    let mut pixmap = pixmap_of(gray)?;
    let line: Vec<_> = trace.line_px().collect();
    for side in [-0.5, 0.5] {
        let edge = line
            .iter()
            .map(|((x, y), (nx, ny), width)| (x + side * width * nx, y + side * width * ny));
        stroke(&mut pixmap, edge, EDGES, 1.0);
    }
    stroke(&mut pixmap, line.iter().map(|(place, _, _)| *place), CENTRE, 1.5);
    let dots = (0..=vectors).map(|k| trace.point_px(trace.length_px() * k as f64 / vectors.max(1) as f64));
    for (x, y) in dots {
        if let Some(dot) = PathBuilder::from_circle(x as f32, y as f32, 2.6) {
            pixmap.fill_path(
                &dot,
                &paint(JOINTS),
                FillRule::Winding,
                Transform::identity(),
                None,
            );
        }
    }
    encode(&pixmap)
}

fn pixmap_of(gray: &Gray) -> Result<Pixmap, String> {
    let mut pixmap =
        Pixmap::new(gray.width() as u32, gray.height() as u32).ok_or("no memory for the picture")?;
    let rows = (0..gray.height()).flat_map(|y| gray.row(y));
    for (pixel, value) in pixmap.data_mut().chunks_exact_mut(4).zip(rows) {
        let shade = (value * 255.0).round() as u8;
        pixel.copy_from_slice(&[shade, shade, shade, 255]);
    }
    Ok(pixmap)
}

fn paint([red, green, blue]: [u8; 3]) -> Paint<'static> {
    let mut paint = Paint::default();
    paint.set_color(Color::from_rgba8(red, green, blue, 255));
    paint.anti_alias = true;
    paint
}

fn path(places: impl Iterator<Item = (f64, f64)>) -> Option<Path> {
    let mut builder = PathBuilder::new();
    for (k, (x, y)) in places.enumerate() {
        match k {
            0 => builder.move_to(x as f32, y as f32),
            _ => builder.line_to(x as f32, y as f32),
        }
    }
    builder.finish()
}

fn stroke(pixmap: &mut Pixmap, places: impl Iterator<Item = (f64, f64)>, colour: [u8; 3], width: f32) {
    if let Some(path) = path(places) {
        let stroke = Stroke {
            width,
            ..Stroke::default()
        };
        pixmap.stroke_path(&path, &paint(colour), &stroke, Transform::identity(), None);
    }
}

/// RGB without the fourth channel, packed quickly: there is one picture a frame.
fn encode(pixmap: &Pixmap) -> Result<Vec<u8>, String> {
    let rgb: Vec<u8> = pixmap
        .data()
        .chunks_exact(4)
        .flat_map(|pixel| [pixel[0], pixel[1], pixel[2]])
        .collect();
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, pixmap.width(), pixmap.height());
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::Fast);
    let written = encoder
        .write_header()
        .and_then(|mut writer| writer.write_image_data(&rgb));
    written.map_err(|error| error.to_string())?;
    Ok(file)
}
