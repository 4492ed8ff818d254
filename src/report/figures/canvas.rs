//! What plotters draws on: a compact SVG writer.
//!
//! Plotters' own SVG backend rounds to whole pixels and writes one element per dot. This one counts in tenths
//! of a pixel, joins dots into one path, writes relative coordinates, and names inks by a class, so that the
//! style sheet can show them in dark mode and in print.

use std::convert::Infallible;
use std::fmt::Write as _;

use plotters::drawing::IntoDrawingArea;
use plotters::prelude::{DrawingArea, RGBColor};
use plotters_backend::text_anchor::{HPos, VPos};
use plotters_backend::{
    BackendColor, BackendCoord, BackendStyle, BackendTextStyle, DrawingBackend, DrawingErrorKind,
    FontTransform,
};

use crate::report::visible::escaped;

/// Canvas units per pixel.
pub const TENTHS: i32 = 10;

/// The inks of all figures. Series colours are those of Okabe and Ito (2008), told apart with any colour vision.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ink {
    /// Text, axes and marks.
    Text,
    /// Secondary text and tick labels.
    Muted,
    /// Grid lines.
    Grid,
    /// A fitted curve or the first series.
    Blue,
    /// The second series.
    Vermillion,
    /// The third series.
    Green,
    /// The fourth series.
    Purple,
    /// The fifth series.
    Orange,
    /// The sixth series.
    Sky,
}

impl Ink {
    /// Colours of series, in the order in which they are given out.
    pub const SERIES: [Ink; 6] = [
        Ink::Blue,
        Ink::Vermillion,
        Ink::Green,
        Ink::Purple,
        Ink::Orange,
        Ink::Sky,
    ];
    const ALL: [Ink; 9] = [
        Ink::Text,
        Ink::Muted,
        Ink::Grid,
        Ink::Blue,
        Ink::Vermillion,
        Ink::Green,
        Ink::Purple,
        Ink::Orange,
        Ink::Sky,
    ];

    /// Colour for plotters; also what is seen where no style sheet is.
    pub fn color(self) -> RGBColor {
        let (red, green, blue) = self.rgb();
        RGBColor(red, green, blue)
    }

    fn rgb(self) -> (u8, u8, u8) {
        match self {
            Ink::Text => (0x1d, 0x23, 0x29),
            Ink::Muted => (0x5c, 0x66, 0x70),
            Ink::Grid => (0xe3, 0xe6, 0xe8),
            Ink::Blue => (0x00, 0x72, 0xb2),
            Ink::Vermillion => (0xd5, 0x5e, 0x00),
            Ink::Green => (0x00, 0x9e, 0x73),
            Ink::Purple => (0xcc, 0x79, 0xa7),
            Ink::Orange => (0xe6, 0x9f, 0x00),
            Ink::Sky => (0x56, 0xb4, 0xe9),
        }
    }

    /// Class in the style sheet; `f-` sets `--ink`, which strokes and fills follow.
    fn class(color: BackendColor) -> &'static str {
        match Ink::ALL.into_iter().find(|ink| ink.rgb() == color.rgb) {
            Some(Ink::Muted) => "k-muted",
            Some(Ink::Grid) => "k-grid",
            Some(Ink::Blue) => "k-1",
            Some(Ink::Vermillion) => "k-2",
            Some(Ink::Green) => "k-3",
            Some(Ink::Purple) => "k-4",
            Some(Ink::Orange) => "k-5",
            Some(Ink::Sky) => "k-6",
            Some(Ink::Text) | None => "k-text",
        }
    }
}

/// The drawing area that figures draw on.
pub type Area<'a> = DrawingArea<Canvas<'a>, plotters::coord::Shift>;

/// The SVG of what `draw` draws on a canvas of `width` x `height` pixels.
///
/// `id` must be unique on the page: the title and description are tied to it for screen readers.
///
/// # Errors
/// The message of the drawing library; a fault of the program.
pub fn svg<F>(
    id: &str,
    (width, height): (u32, u32),
    title: &str,
    desc: &str,
    draw: F,
) -> Result<String, String>
where
    F: FnOnce(&Area) -> Result<(), String>,
{
    let mut body = String::new();
    let size = (width * TENTHS as u32, height * TENTHS as u32);
    {
        let area = Canvas::new(&mut body, size).into_drawing_area();
        draw(&area)?;
        area.present().map_err(|error| error.to_string())?;
    }
    Ok(format!(
        "<svg viewBox=\"0 0 {} {}\" role=\"img\" aria-labelledby=\"{id}-t {id}-d\" class=\"figure\" \
         style=\"max-width:{width}px\"><title id=\"{id}-t\">{}</title><desc id=\"{id}-d\">{}</desc>{body}</svg>",
        size.0,
        size.1,
        escaped(title),
        escaped(desc),
    ))
}

/// Dots that wait for others of their kind.
struct Dots {
    class: &'static str,
    radius: u32,
    opacity: f64,
    path: String,
    last: BackendCoord,
}

/// The backend.
pub struct Canvas<'a> {
    out: &'a mut String,
    size: (u32, u32),
    dots: Option<Dots>,
}

type Drawn = Result<(), DrawingErrorKind<Infallible>>;

impl<'a> Canvas<'a> {
    fn new(out: &'a mut String, size: (u32, u32)) -> Canvas<'a> {
        Canvas {
            out,
            size,
            dots: None,
        }
    }

    fn element(&mut self, element: std::fmt::Arguments) {
        self.flush_dots();
        // Writing to a String cannot fail.
        let _ = self.out.write_fmt(element);
    }

    fn flush_dots(&mut self) {
        if let Some(dots) = self.dots.take() {
            let _ = write!(
                self.out,
                "<path class=\"s {} dots\" stroke-width=\"{}\"{} d=\"{}\"/>",
                dots.class,
                2 * dots.radius,
                opacity(dots.opacity),
                dots.path
            );
        }
    }

    fn add_dot(&mut self, (x, y): BackendCoord, radius: u32, color: BackendColor) {
        let class = Ink::class(color);
        let same_kind = |dots: &Dots| (dots.class, dots.radius, dots.opacity) == (class, radius, color.alpha);
        if !self.dots.as_ref().is_some_and(same_kind) {
            self.flush_dots();
        }
        let dots = self.dots.get_or_insert_with(|| Dots {
            class,
            radius,
            opacity: color.alpha,
            path: String::new(),
            last: (0, 0),
        });
        let _ = match dots.path.is_empty() {
            true => write!(dots.path, "M{x} {y}h0"),
            false => write!(dots.path, "m{} {}h0", x - dots.last.0, y - dots.last.1),
        };
        dots.last = (x, y);
    }
}

/// Path data with relative coordinates; points that fall on the one before are left out.
fn path_data(points: impl IntoIterator<Item = BackendCoord>) -> String {
    let mut data = String::new();
    let mut last: Option<BackendCoord> = None;
    for (x, y) in points {
        let _ = match last {
            None => write!(data, "M{x} {y}l"),
            Some(previous) if previous == (x, y) => continue,
            Some((x0, y0)) if data.ends_with('l') => write!(data, "{} {}", x - x0, y - y0),
            Some((x0, y0)) => write!(data, " {} {}", x - x0, y - y0),
        };
        last = Some((x, y));
    }
    data.replace(" -", "-")
}

fn opacity(alpha: f64) -> String {
    match alpha < 1.0 {
        true => format!(" opacity=\"{alpha}\""),
        false => String::new(),
    }
}

impl DrawingBackend for Canvas<'_> {
    type ErrorType = Infallible;

    fn get_size(&self) -> (u32, u32) {
        self.size
    }

    fn ensure_prepared(&mut self) -> Drawn {
        Ok(())
    }

    fn present(&mut self) -> Drawn {
        self.flush_dots();
        Ok(())
    }

    fn draw_pixel(&mut self, point: BackendCoord, color: BackendColor) -> Drawn {
        self.add_dot(point, 1, color);
        Ok(())
    }

    fn draw_line<S: BackendStyle>(&mut self, from: BackendCoord, to: BackendCoord, style: &S) -> Drawn {
        self.draw_path([from, to], style)
    }

    fn draw_path<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        path: I,
        style: &S,
    ) -> Drawn {
        let data = path_data(path);
        let color = style.color();
        self.element(format_args!(
            "<path class=\"s {}\" stroke-width=\"{}\"{} d=\"{data}\"/>",
            Ink::class(color),
            style.stroke_width(),
            opacity(color.alpha),
        ));
        Ok(())
    }

    fn draw_rect<S: BackendStyle>(
        &mut self,
        (left, top): BackendCoord,
        (right, bottom): BackendCoord,
        style: &S,
        fill: bool,
    ) -> Drawn {
        let corners = [(left, top), (right, top), (right, bottom), (left, bottom)];
        match fill {
            true => self.fill_polygon(corners, style),
            false => self.draw_path(corners.into_iter().chain([(left, top)]), style),
        }
    }

    fn fill_polygon<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        vert: I,
        style: &S,
    ) -> Drawn {
        let data = path_data(vert);
        let color = style.color();
        self.element(format_args!(
            "<path class=\"f {}\"{} d=\"{data}z\"/>",
            Ink::class(color),
            opacity(color.alpha),
        ));
        Ok(())
    }

    fn draw_circle<S: BackendStyle>(
        &mut self,
        center: BackendCoord,
        radius: u32,
        style: &S,
        fill: bool,
    ) -> Drawn {
        if fill {
            self.add_dot(center, radius, style.color());
            return Ok(());
        }
        let (x, y) = center;
        self.element(format_args!(
            "<circle class=\"s {}\" stroke-width=\"{}\" cx=\"{x}\" cy=\"{y}\" r=\"{radius}\"/>",
            Ink::class(style.color()),
            style.stroke_width(),
        ));
        Ok(())
    }

    fn draw_text<S: BackendTextStyle>(&mut self, text: &str, style: &S, (x, y): BackendCoord) -> Drawn {
        let size = style.size();
        let anchor = match style.anchor().h_pos {
            HPos::Left => "",
            HPos::Center => " text-anchor=\"middle\"",
            HPos::Right => " text-anchor=\"end\"",
        };
        // Heights of capitals and figures over the font size, near enough for every system font.
        let below = match style.anchor().v_pos {
            VPos::Top => 0.74,
            VPos::Center => 0.36,
            VPos::Bottom => -0.05,
        };
        let drop = (below * size).round() as i32;
        let class = Ink::class(style.color());
        let text = escaped(text);
        match style.transform() {
            FontTransform::Rotate270 => self.element(format_args!(
                "<text class=\"f {class}\" font-size=\"{size}\"{anchor} transform=\"translate({} {y})rotate(-90)\">\
                 {text}</text>",
                x + drop,
            )),
            _ => self.element(format_args!(
                "<text class=\"f {class}\" font-size=\"{size}\"{anchor} x=\"{x}\" y=\"{}\">{text}</text>",
                y + drop,
            )),
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use plotters::prelude::{Circle, EmptyElement, PathElement, Text};
    use plotters::style::Color;

    #[test]
    fn dots_join_into_one_path_and_lines_are_relative() {
        let drawn = svg("f", (10, 10), "t", "d", |area| {
            for x in [10, 20, 30] {
                area.draw(&Circle::new((x, 50), 8, Ink::Blue.color().filled()))
                    .map_err(|error| error.to_string())?;
            }
            area.draw(&PathElement::new(
                [(0, 5), (7, 2), (7, 2), (9, 9)],
                Ink::Text.color(),
            ))
            .map_err(|error| error.to_string())
        })
        .unwrap();
        assert_eq!(drawn.matches("<path").count(), 2, "{drawn}");
        assert!(drawn.contains("d=\"M10 50h0m10 0h0m10 0h0\""), "{drawn}");
        assert!(drawn.contains("d=\"M0 5l7-3 2 7\""), "{drawn}");
    }

    #[test]
    fn text_of_files_is_text_in_figures() {
        let drawn = svg("f", (10, 10), "<script>", "\"\u{1b}", |area| {
            let label = Text::new("</text><script>alert(1)</script>", (0, 0), ("sans", 120));
            let element = EmptyElement::at((5, 5)) + label;
            area.draw(&element).map_err(|error| error.to_string())
        })
        .unwrap();
        assert!(!drawn.contains("<script"), "{drawn}");
        assert!(drawn.contains("<desc id=\"f-d\">&quot;␛</desc>"));
    }
}
