//! Drawings as SVG in a page.
//!
//! Plotters' own SVG backend rounds to whole pixels and writes one element per dot. This writer counts in tenths of a
//! pixel, joins dots, strokes and texts of one kind that follow each other, writes relative coordinates, and names inks
//! by a class, so that the style sheet can show them in dark mode and in print. Dots are the corners of a path that is
//! not stroked, with a marker at each: the page holds the markers and their classes (see [`dot_markers`]).

use ieap_domain::number::{digits, to_digits};
use std::fmt::Write as _;

use plotters_backend::text_anchor::HPos;
use plotters_backend::{BackendColor, BackendCoord};
use serde::Serialize;

use super::axis::Scale;
use super::ink::Ink;
use super::shape::{Drawing, Group, Label, Shape, Span, TENTHS};
use crate::visible::escaped;

/// Start of the id of a marker; the ink's class and the form follow.
const MARKER: &str = "dot-";

/// Width of most figures, px: the style sheet limits figures to it.
const USUAL_WIDTH: u32 = super::shape::PAGE_WIDTH;
/// Width of lines and size of labels, tenths of a pixel, where no attribute states another: as in the style sheet.
const USUAL_LINE: u32 = 10;
const USUAL_TEXT: f64 = 110.0;
/// Size of the titles of axes, tenths of a pixel: as in the style sheet.
const TITLE_TEXT: f64 = 120.0;

/// The drawing as an element of a page.
pub fn inline(drawing: &Drawing, title: &str, desc: &str) -> String {
    let mut body = Body {
        out: String::new(),
        waiting: None,
        in_panel: false,
        across: level_span(&drawing.shapes),
        form: 0,
        aside: false,
        dot_unit: 1,
        group: None,
    };
    drawing.shapes.iter().for_each(|shape| body.add(shape));
    body.flush();
    if body.in_panel {
        body.out.push_str("</g>");
    }
    let (width, height) = drawing.size;
    let pixels = width / TENTHS as u32;
    let widest = match pixels {
        USUAL_WIDTH => String::new(),
        _ => format!(" style=\"max-width:{pixels}px\""),
    };
    let said = if desc.is_empty() { "" } else { ". " };
    format!(
        "<svg viewBox=\"0 0 {width} {height}\" role=\"img\" aria-label=\"{}{said}{}\" class=\"figure\"{widest}>{}</svg>",
        escaped(title),
        escaped(desc),
        body.out,
    )
}

/// Outlines of dots about their middle, for a stroke width of 1: round, square, pointing up, diamond, pointing down.
pub const FORMS: [&str; 5] = [
    "M0-.5a.5.5 0 1 0 .01 0z",
    "M-.45-.45h.9v.9h-.9z",
    "M0-.6l.58 1.04h-1.16z",
    "M0-.66l.66.66-.66.66-.66-.66z",
    "M0 .6l.58-1.04h-1.16z",
];

/// What stands for the form of an open dot in the name of its marker, and its outline: a ring, whose inner circle goes
/// round the other way.
const OPEN: &str = "o";
const RING: &str = "M0-.6a.6.6 0 1 0 .01 0zM0-.36a.36.36 0 1 1-.01 0z";

/// A marker that a page must hold so that dots are seen.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub struct DotMarker {
    /// Id; paths name it as a class.
    pub id: String,
    /// Class of the ink.
    pub ink: String,
    /// Outline.
    pub outline: &'static str,
}

/// The markers of these figures.
pub fn dot_markers<'a>(figures: impl Iterator<Item = &'a String>) -> Vec<DotMarker> {
    let start = format!("\"dots {MARKER}");
    let named = figures.flat_map(|svg| {
        svg.split(&start)
            .skip(1)
            .filter_map(|rest| rest.split('"').next())
    });
    let marker = |name: &str| {
        let (ink, form) = name.rsplit_once('-')?;
        Some(DotMarker {
            id: format!("{MARKER}{name}"),
            ink: ink.to_owned(),
            outline: match form {
                OPEN => RING,
                form => FORMS.get(form.parse::<usize>().ok()?)?,
            },
        })
    };
    let mut markers: Vec<DotMarker> = named.filter_map(marker).collect();
    markers.sort_unstable();
    markers.dedup();
    markers
}

/// What waits for others of its kind.
enum Waiting {
    /// Corners with dots.
    Dots {
        color: BackendColor,
        radius: u32,
        points: Vec<BackendCoord>,
    },
    /// Path data, and where they end.
    Strokes {
        color: BackendColor,
        width: u32,
        data: String,
        end: BackendCoord,
    },
    /// Path data of polygons.
    Fills { color: BackendColor, data: String },
    /// Labels; never empty.
    Texts(Vec<Label>),
}

/// Elements written so far.
struct Body {
    out: String,
    waiting: Option<Waiting>,
    in_panel: bool,
    /// What the first horizontal axis of the figure shows: panels that state nothing else show the same.
    across: Option<Span>,
    form: usize,
    /// Whether no result is made from the series that is open.
    aside: bool,
    /// Canvas units per unit of the dots' path data.
    dot_unit: i32,
    /// Where the elements of the group that is open begin, and its attributes.
    group: Option<(usize, String)>,
}

impl Body {
    fn add(&mut self, shape: &Shape) {
        match shape {
            Shape::Dot { at, radius, color } => self.add_dot(*at, *radius, *color),
            Shape::Stroke { points, width, color } => self.add_stroke(points, *width, *color),
            Shape::Fill { points, color } => self.add_fill(points, *color),
            Shape::Ring {
                at: (x, y),
                radius,
                width,
                color,
            } => {
                self.flush();
                let _ = write!(
                    self.out,
                    "<circle class=\"s {}\" stroke-width=\"{width}\" cx=\"{x}\" cy=\"{y}\" r=\"{radius}\"/>",
                    Ink::class(*color),
                );
            }
            Shape::Cells(cells) => {
                self.flush();
                let [left, top, right, bottom] = cells.frame();
                let _ = write!(
                    self.out,
                    "<image x=\"{left}\" y=\"{top}\" width=\"{}\" height=\"{}\" preserveAspectRatio=\"none\" href=\"{}\"/>",
                    right - left,
                    bottom - top,
                    cells.data_uri(),
                );
            }
            Shape::Text(label) => self.add_text(label),
            Shape::Open(group) => self.open(group),
            Shape::Close => {
                self.flush();
                (self.form, self.dot_unit, self.aside) = (0, 1, false);
                self.close();
            }
        }
    }

    /// Ends the innermost group; a series of a single element is that element.
    fn close(&mut self) {
        let Some((start, attributes)) = self.group.take() else {
            return;
        };
        let is_series = attributes.starts_with(" data-s");
        if is_series && self.out[start..].starts_with("<path") && self.out[start..].matches('<').count() == 1
        {
            return self.out.insert_str(start + "<path".len(), &attributes);
        }
        self.out.insert_str(start, &format!("<g{attributes}>"));
        self.out.push_str("</g>");
    }

    fn open(&mut self, group: &Group) {
        self.flush();
        // Writing to a String cannot fail.
        let _ = match group {
            Group::Panel { frame, x, .. } => {
                let [left, top, right, bottom] = frame;
                let ends = if self.in_panel { "</g>" } else { "" };
                self.in_panel = true;
                let across = if self.across == Some(*x) {
                    String::new()
                } else {
                    format!(" data-x=\"{}\"", span(x))
                };
                write!(
                    self.out,
                    "{ends}<g data-f=\"{left} {top} {right} {bottom}\"{across}>"
                )
            }
            Group::Axes { level, span: shown } => {
                let which = if *level { "x" } else { "y" };
                let attributes = format!(" class=\"axes\" data-{which}=\"{}\"", span(shown));
                self.group = Some((self.out.len(), attributes));
                Ok(())
            }
            Group::Series {
                name,
                runs,
                form,
                to_the_pixel,
                aside,
            } => {
                self.aside = *aside;
                self.form = form % FORMS.len();
                self.dot_unit = if *to_the_pixel { TENTHS } else { 1 };
                let runs = if runs.is_empty() {
                    String::new()
                } else {
                    format!(" data-r=\"{}\"", run_list(runs))
                };
                let aside = if *aside { " data-aside=\"1\"" } else { "" };
                let attributes = format!(" data-s=\"{}\"{runs}{aside}", escaped(name));
                self.group = Some((self.out.len(), attributes));
                Ok(())
            }
        };
    }

    fn flush(&mut self) {
        match self.waiting.take() {
            None => {}
            Some(Waiting::Dots {
                color,
                radius,
                points,
            }) => {
                let class = Ink::class(color);
                // A path of one corner has no marker without a stretch.
                let alone = if points.len() == 1 { "h0" } else { "" };
                let unit = self.dot_unit;
                let in_units = |at: i32| (f64::from(at) / f64::from(unit)).round() as i32;
                let points: Vec<BackendCoord> =
                    points.iter().map(|&(x, y)| (in_units(x), in_units(y))).collect();
                let transform = match unit {
                    1 => String::new(),
                    unit => format!(" transform=\"scale({unit})\""),
                };
                let form = if self.aside {
                    OPEN.to_owned()
                } else {
                    self.form.to_string()
                };
                let _ = write!(
                    self.out,
                    "<path class=\"dots {MARKER}{class}-{}\" stroke-width=\"{}\"{}{transform} d=\"{}{alone}\"/>",
                    form,
                    f64::from(2 * radius) / f64::from(unit),
                    opacity(color.alpha),
                    corners(&points, false)
                );
            }
            Some(Waiting::Strokes {
                color, width, data, ..
            }) => {
                let _ = write!(
                    self.out,
                    "<path class=\"s {}\"{}{} d=\"{data}\"/>",
                    Ink::class(color),
                    line_width(width),
                    opacity(color.alpha),
                );
            }
            Some(Waiting::Fills { color, data }) => {
                let _ = write!(
                    self.out,
                    "<path class=\"f {}\"{} d=\"{data}\"/>",
                    Ink::class(color),
                    opacity(color.alpha),
                );
            }
            Some(Waiting::Texts(labels)) => self.write_texts(&labels),
        }
    }

    fn add_stroke(&mut self, points: &[BackendCoord], width: u32, color: BackendColor) {
        let Some(&last) = points.last() else {
            return;
        };
        let more = path_data(points);
        match &mut self.waiting {
            Some(Waiting::Strokes {
                color: c,
                width: w,
                data,
                end,
            }) if same(*c, color) && *w == width && c.alpha == 1.0 => {
                data.push_str(&moved(&more, points[0], *end));
                *end = last;
            }
            _ => {
                self.flush();
                self.waiting = Some(Waiting::Strokes {
                    color,
                    width,
                    data: more,
                    end: last,
                });
            }
        }
    }

    fn add_fill(&mut self, points: &[BackendCoord], color: BackendColor) {
        let more = format!("{}z", path_data(points));
        match &mut self.waiting {
            Some(Waiting::Fills { color: c, data }) if same(*c, color) && c.alpha == 1.0 => {
                data.push_str(&more)
            }
            _ => {
                self.flush();
                self.waiting = Some(Waiting::Fills { color, data: more });
            }
        }
    }

    fn add_dot(&mut self, at: BackendCoord, radius: u32, color: BackendColor) {
        match &mut self.waiting {
            Some(Waiting::Dots {
                color: c,
                radius: r,
                points,
            }) if same(*c, color) && *r == radius => points.push(at),
            _ => {
                self.flush();
                self.waiting = Some(Waiting::Dots {
                    color,
                    radius,
                    points: vec![at],
                });
            }
        }
    }

    fn add_text(&mut self, label: &Label) {
        let alike = |first: &Label| {
            (first.size, first.upward, anchor(first)) == (label.size, label.upward, anchor(label))
                && same(first.color, label.color)
        };
        match &mut self.waiting {
            Some(Waiting::Texts(labels)) if alike(&labels[0]) => labels.push(label.clone()),
            _ => {
                self.flush();
                self.waiting = Some(Waiting::Texts(vec![label.clone()]));
            }
        }
    }

    fn write_texts(&mut self, labels: &[Label]) {
        let first = &labels[0];
        let look = look(first);
        let (look_of_each, opened) = match (labels.len(), look.is_empty()) {
            (_, true) => (String::new(), false),
            (1, false) => (format!(" {look}"), false),
            (_, false) => (String::new(), true),
        };
        if opened {
            let _ = write!(self.out, "<g {look}>");
        }
        for Label {
            text,
            at: (x, y),
            upward,
            ..
        } in labels
        {
            let text = escaped(text);
            // What runs upward is turned by its class.
            let (x, y) = if *upward { (-y, *x) } else { (*x, *y) };
            let _ = write!(self.out, "<text{look_of_each} x=\"{x}\" y=\"{y}\">{text}</text>");
        }
        if opened {
            self.out.push_str("</g>");
        }
    }
}

/// The range of the first horizontal axis among `shapes`.
fn level_span(shapes: &[Shape]) -> Option<Span> {
    shapes.iter().find_map(|shape| match shape {
        Shape::Open(Group::Axes { level: true, span }) => Some(*span),
        _ => None,
    })
}

fn same(one: BackendColor, other: BackendColor) -> bool {
    (one.rgb, one.alpha) == (other.rgb, other.alpha)
}

/// Class and size of a label. Titles of axes, which every figure has, have a class of their own.
fn look(label: &Label) -> String {
    let ink = Ink::class(label.color);
    let upward = if label.upward { " up" } else { "" };
    match (label.size, ink, label.anchor) {
        (TITLE_TEXT, "k-text", HPos::Center) => format!("class=\"axis{upward}\""),
        // Labels of the vertical axis: as the style sheet has it without a class.
        (USUAL_TEXT, "k-muted", HPos::Right) if !label.upward => String::new(),
        (USUAL_TEXT, "k-muted", HPos::Center) if !label.upward => "class=\"mid\"".to_owned(),
        (USUAL_TEXT, ..) => format!("class=\"{ink}{}{upward}\"", anchor(label)),
        (size, ..) => format!("class=\"{ink}{}{upward}\" font-size=\"{size}\"", anchor(label)),
    }
}

/// Class of the anchor, after another class.
fn anchor(label: &Label) -> &'static str {
    match label.anchor {
        HPos::Left => " start",
        HPos::Center => " mid",
        HPos::Right => "",
    }
}

/// `0 -0.07 3.669`: scale (0 linear, 1 logarithm, 2 calendar, 3 names, 4 about a step) and ends; about a step also the
/// unit and the positions per second before it.
fn span(span: &Span) -> String {
    let (scale, more) = match span.scale {
        Scale::Linear => (0, String::new()),
        Scale::Log => (1, String::new()),
        Scale::Calendar => (2, String::new()),
        Scale::Names => (3, String::new()),
        Scale::AboutStep { unit_s, before } => (4, format!(" {} {}", shortest(unit_s), shortest(before))),
    };
    format!("{scale} {} {}{more}", shortest(span.low), shortest(span.high))
}

/// As many digits as a position on a screen has, and for a moment those of its seconds.
fn shortest(number: f64) -> String {
    if number.abs() >= 1e7 {
        digits(number, 0)
    } else {
        to_digits(number, 7).to_string()
    }
}

/// `3-7 9`: numbers that follow each other are written by their ends.
fn run_list(runs: &[usize]) -> String {
    let stretches: Vec<String> = runs
        .chunk_by(|a, b| a + 1 == *b)
        .map(|stretch| match stretch {
            [only] => only.to_string(),
            _ => format!("{}-{}", stretch[0], stretch[stretch.len() - 1]),
        })
        .collect();
    stretches.join(" ")
}

/// Path data with relative coordinates; points that fall on the one before are left out.
pub(super) fn path_data(points: &[BackendCoord]) -> String {
    let mut distinct = points.to_vec();
    distinct.dedup();
    corners(&distinct, true)
}

/// Path data that start at `start`, written from `end` of the stretch before where that is shorter.
fn moved(data: &str, start: BackendCoord, end: BackendCoord) -> String {
    let absolute = format!("M{} {}", start.0, start.1);
    let (dx, dy) = (start.0 - end.0, start.1 - end.1);
    let relative = if dy < 0 {
        format!("m{dx}{dy}")
    } else {
        format!("m{dx} {dy}")
    };
    match data.strip_prefix(&absolute) {
        Some(rest) if relative.len() < absolute.len() => format!("{relative}{rest}"),
        _ => data.to_owned(),
    }
}

/// Path data through all these corners; a stretch along an axis alone is written by its length.
fn corners(points: &[BackendCoord], with_axes: bool) -> String {
    let Some(&(x, y)) = points.first() else {
        return String::new();
    };
    let mut data = format!("M{x} {y}");
    if let (&[(x0, y0), (x1, y1)], true) = (points, with_axes)
        && (x0 == x1 || y0 == y1)
    {
        let _ = if y0 == y1 {
            write!(data, "h{}", x1 - x0)
        } else {
            write!(data, "v{}", y1 - y0)
        };
        return data;
    }
    for (k, pair) in points.windows(2).enumerate() {
        let (dx, dy) = (pair[1].0 - pair[0].0, pair[1].1 - pair[0].1);
        let before = match (k == 0, dx < 0) {
            (true, _) => "l",
            (false, true) => "",
            (false, false) => " ",
        };
        let between = if dy < 0 { "" } else { " " };
        let _ = write!(data, "{before}{dx}{between}{dy}");
    }
    data
}

fn line_width(width: u32) -> String {
    match width {
        USUAL_LINE => String::new(),
        _ => format!(" stroke-width=\"{width}\""),
    }
}

fn opacity(alpha: f64) -> String {
    if alpha < 1.0 {
        format!(" opacity=\"{alpha}\"")
    } else {
        String::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figures::canvas::drawing;
    use plotters::prelude::{Circle, PathElement};
    use plotters::style::Color;

    #[test]
    fn dots_and_strokes_join_and_lines_are_relative() {
        let drawn = drawing((10, 10), |area| {
            for x in [10, 20, 30] {
                area.draw(&Circle::new((x, 50), 8, Ink::Blue.color().filled()))
                    .map_err(|error| error.to_string())?;
            }
            for points in [vec![(0, 5), (7, 2), (7, 2), (9, 9)], vec![(3, 4), (8, 4)]] {
                area.draw(&PathElement::new(points, Ink::Text.color()))
                    .map_err(|error| error.to_string())?;
            }
            Ok(())
        });
        let drawn = inline(&drawn.unwrap(), "t", "d");
        assert_eq!(drawn.matches("<path").count(), 2, "{drawn}");
        assert!(
            drawn.contains("class=\"dots dot-k-1-0\" stroke-width=\"16\" d=\"M10 50l10 0 10 0\""),
            "{drawn}"
        );
        assert!(drawn.contains("d=\"M0 5l7-3 2 7M3 4h5\""), "{drawn}");
        let markers = dot_markers([drawn].iter());
        assert_eq!(markers.len(), 1);
        assert_eq!(
            (markers[0].id.as_str(), markers[0].ink.as_str()),
            ("dot-k-1-0", "k-1")
        );
    }

    #[test]
    fn runs_in_a_row_are_written_by_their_ends() {
        assert_eq!(run_list(&[3, 4, 5, 9, 12, 13]), "3-5 9 12-13");
    }

    #[test]
    fn ends_of_axes_carry_the_digits_of_a_screen() {
        assert_eq!(shortest(-0.069_333_333_333), "-0.06933333");
        assert_eq!(shortest(1_763_000_123.4), "1763000123");
    }
}
