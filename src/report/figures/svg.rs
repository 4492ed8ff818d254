//! Drawings as SVG in a page.
//!
//! Plotters' own SVG backend rounds to whole pixels and writes one element per dot. This writer counts in tenths of a
//! pixel, joins dots into one path, writes relative coordinates, and names inks by a class, so that the style sheet
//! can show them in dark mode and in print.

use std::fmt::Write as _;

use plotters_backend::text_anchor::HPos;
use plotters_backend::{BackendColor, BackendCoord};

use super::canvas::{Drawing, Ink, Label, Shape, TENTHS};
use crate::report::visible::escaped;

/// The drawing as an element of a page; `id` must be unique on it.
pub fn inline(id: &str, drawing: &Drawing, title: &str, desc: &str) -> String {
    let mut body = Body::default();
    drawing.shapes.iter().for_each(|shape| body.add(shape));
    body.flush_dots();
    let (width, height) = drawing.size;
    format!(
        "<svg viewBox=\"0 0 {width} {height}\" role=\"img\" aria-labelledby=\"{id}-t {id}-d\" class=\"figure\" \
         style=\"max-width:{}px\"><title id=\"{id}-t\">{}</title><desc id=\"{id}-d\">{}</desc>{}</svg>",
        width / TENTHS as u32,
        escaped(title),
        escaped(desc),
        body.out,
    )
}

/// Dots that wait for others of their kind.
struct Dots {
    class: &'static str,
    radius: u32,
    opacity: f64,
    path: String,
    last: BackendCoord,
}

/// Elements written so far.
#[derive(Default)]
struct Body {
    out: String,
    dots: Option<Dots>,
}

impl Body {
    fn add(&mut self, shape: &Shape) {
        match shape {
            Shape::Dot { at, radius, color } => self.add_dot(*at, *radius, *color),
            Shape::Stroke { points, width, color } => self.element(format_args!(
                "<path class=\"s {}\" stroke-width=\"{width}\"{} d=\"{}\"/>",
                Ink::class(*color),
                opacity(color.alpha),
                path_data(points)
            )),
            Shape::Fill { points, color } => self.element(format_args!(
                "<path class=\"f {}\"{} d=\"{}z\"/>",
                Ink::class(*color),
                opacity(color.alpha),
                path_data(points)
            )),
            Shape::Ring {
                at: (x, y),
                radius,
                width,
                color,
            } => self.element(format_args!(
                "<circle class=\"s {}\" stroke-width=\"{width}\" cx=\"{x}\" cy=\"{y}\" r=\"{radius}\"/>",
                Ink::class(*color),
            )),
            Shape::Text(label) => self.add_text(label),
        }
    }

    fn element(&mut self, element: std::fmt::Arguments) {
        self.flush_dots();
        // Writing to a String cannot fail.
        let _ = self.out.write_fmt(element);
    }

    fn add_text(&mut self, label: &Label) {
        let Label { at: (x, y), size, .. } = label;
        let anchor = match label.anchor {
            HPos::Left => "",
            HPos::Center => " text-anchor=\"middle\"",
            HPos::Right => " text-anchor=\"end\"",
        };
        let class = Ink::class(label.color);
        let text = escaped(&label.text);
        match label.upward {
            true => self.element(format_args!(
                "<text class=\"f {class}\" font-size=\"{size}\"{anchor} transform=\"translate({x} {y})rotate(-90)\">\
                 {text}</text>",
            )),
            false => self.element(format_args!(
                "<text class=\"f {class}\" font-size=\"{size}\"{anchor} x=\"{x}\" y=\"{y}\">{text}</text>",
            )),
        }
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
fn path_data(points: &[BackendCoord]) -> String {
    let mut data = String::new();
    let mut last: Option<BackendCoord> = None;
    for &(x, y) in points {
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
