//! What plotters draws on: a list of shapes, counted in tenths of a pixel, which pages show as SVG and prints as
//! SVG, PNG or PDF.

use std::convert::Infallible;

use plotters::drawing::IntoDrawingArea;
use plotters::prelude::{DrawingArea, RGBColor};
use plotters_backend::text_anchor::{HPos, VPos};
use plotters_backend::{
    BackendColor, BackendCoord, BackendStyle, BackendTextStyle, DrawingBackend, DrawingErrorKind,
    FontTransform,
};

use super::cells::Cells;
use super::group::Group;

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
    /// The first of an ordered series, dark to light.
    First,
    /// The second of an ordered series, dark to light.
    Second,
    /// The third of an ordered series, dark to light.
    Third,
    /// The fourth of an ordered series, dark to light.
    Fourth,
    /// The fifth of an ordered series, dark to light.
    Fifth,
    /// The sixth of an ordered series, dark to light.
    Sixth,
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
    /// Inks of series that have an order, as times and places: lightness rises by equal steps (0.30 to 0.68 in the Oklab
    /// space), so that the order is seen with any colour vision and in grey, while the hue goes from blue over red to
    /// orange.
    pub const ORDERED: [Ink; 6] = [
        Ink::First,
        Ink::Second,
        Ink::Third,
        Ink::Fourth,
        Ink::Fifth,
        Ink::Sixth,
    ];
    const ALL: [Ink; 15] = [
        Ink::Text,
        Ink::Muted,
        Ink::Grid,
        Ink::Blue,
        Ink::Vermillion,
        Ink::Green,
        Ink::Purple,
        Ink::Orange,
        Ink::Sky,
        Ink::First,
        Ink::Second,
        Ink::Third,
        Ink::Fourth,
        Ink::Fifth,
        Ink::Sixth,
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
            Ink::First => (0x1f, 0x19, 0x76),
            Ink::Second => (0x55, 0x22, 0x7f),
            Ink::Third => (0x8b, 0x28, 0x68),
            Ink::Fourth => (0xb1, 0x3e, 0x46),
            Ink::Fifth => (0xc8, 0x5e, 0x27),
            Ink::Sixth => (0xd0, 0x86, 0x0b),
        }
    }

    /// Class in the style sheet, which strokes and fills follow.
    pub(super) fn class(color: BackendColor) -> &'static str {
        match Ink::ALL.into_iter().find(|ink| ink.rgb() == color.rgb) {
            Some(Ink::Muted) => "k-muted",
            Some(Ink::Grid) => "k-grid",
            Some(Ink::Blue) => "k-1",
            Some(Ink::Vermillion) => "k-2",
            Some(Ink::Green) => "k-3",
            Some(Ink::Purple) => "k-4",
            Some(Ink::Orange) => "k-5",
            Some(Ink::Sky) => "k-6",
            Some(Ink::First) => "k-o1",
            Some(Ink::Second) => "k-o2",
            Some(Ink::Third) => "k-o3",
            Some(Ink::Fourth) => "k-o4",
            Some(Ink::Fifth) => "k-o5",
            Some(Ink::Sixth) => "k-o6",
            Some(Ink::Text) | None => "k-text",
        }
    }
}

/// The drawing area that figures draw on.
pub type Area<'a> = DrawingArea<Canvas<'a>, plotters::coord::Shift>;

/// A finished drawing.
#[derive(Clone)]
pub struct Drawing {
    /// Width and height, tenths of a pixel.
    pub size: (u32, u32),
    /// Shapes from back to front.
    pub shapes: Vec<Shape>,
}

/// One shape; positions and widths in tenths of a pixel.
#[derive(Clone)]
pub enum Shape {
    /// An open line.
    Stroke {
        /// Corners.
        points: Vec<BackendCoord>,
        /// Width.
        width: u32,
        /// Colour with opacity.
        color: BackendColor,
    },
    /// A filled polygon.
    Fill {
        /// Corners.
        points: Vec<BackendCoord>,
        /// Colour with opacity.
        color: BackendColor,
    },
    /// A filled circle.
    Dot {
        /// Centre.
        at: BackendCoord,
        /// Radius.
        radius: u32,
        /// Colour with opacity.
        color: BackendColor,
    },
    /// A circle's line.
    Ring {
        /// Centre.
        at: BackendCoord,
        /// Radius.
        radius: u32,
        /// Width.
        width: u32,
        /// Colour with opacity.
        color: BackendColor,
    },
    /// Cells of a map.
    Cells(Cells),
    /// One line of text.
    Text(Label),
    /// The shapes up to its [`Shape::Close`], or of a panel up to the next panel, belong together. Nothing is seen of it.
    Open(Group),
    /// Ends the innermost group that is no panel.
    Close,
}

/// One line of text.
#[derive(Clone)]
pub struct Label {
    /// Text as it came, nothing escaped.
    pub text: String,
    /// Position of the anchor on the base line, before turning.
    pub at: BackendCoord,
    /// Size, tenths of a pixel.
    pub size: f64,
    /// Which end of the text the anchor is.
    pub anchor: HPos,
    /// Whether it runs upward.
    pub upward: bool,
    /// Colour with opacity.
    pub color: BackendColor,
}

/// What `draw` draws on a canvas of `width` x `height` pixels.
///
/// # Errors
/// The message of the drawing library; a fault of the program.
pub fn drawing<F>((width, height): (u32, u32), draw: F) -> Result<Drawing, String>
where
    F: FnOnce(&Area) -> Result<(), String>,
{
    let size = (width * TENTHS as u32, height * TENTHS as u32);
    let mut shapes = Vec::new();
    {
        let area = Canvas {
            shapes: &mut shapes,
            size,
        }
        .into_drawing_area();
        draw(&area)?;
        area.present().map_err(|error| error.to_string())?;
    }
    Ok(Drawing { size, shapes })
}

/// The SVG of what `draw` draws on a canvas of `width` x `height` pixels, for a page.
///
/// # Errors
/// The message of the drawing library; a fault of the program.
pub fn svg<F>(size: (u32, u32), title: &str, desc: &str, draw: F) -> Result<String, String>
where
    F: FnOnce(&Area) -> Result<(), String>,
{
    Ok(super::svg::inline(&drawing(size, draw)?, title, desc))
}

/// The backend.
pub struct Canvas<'a> {
    pub(super) shapes: &'a mut Vec<Shape>,
    size: (u32, u32),
}

type Drawn = Result<(), DrawingErrorKind<Infallible>>;

impl DrawingBackend for Canvas<'_> {
    type ErrorType = Infallible;

    fn get_size(&self) -> (u32, u32) {
        self.size
    }

    fn ensure_prepared(&mut self) -> Drawn {
        Ok(())
    }

    fn present(&mut self) -> Drawn {
        Ok(())
    }

    fn draw_pixel(&mut self, at: BackendCoord, color: BackendColor) -> Drawn {
        self.shapes.push(Shape::Dot { at, radius: 1, color });
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
        self.shapes.push(Shape::Stroke {
            points: path.into_iter().collect(),
            width: style.stroke_width(),
            color: style.color(),
        });
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
        self.shapes.push(Shape::Fill {
            points: vert.into_iter().collect(),
            color: style.color(),
        });
        Ok(())
    }

    fn draw_circle<S: BackendStyle>(
        &mut self,
        at: BackendCoord,
        radius: u32,
        style: &S,
        fill: bool,
    ) -> Drawn {
        let (color, width) = (style.color(), style.stroke_width());
        self.shapes.push(match fill {
            true => Shape::Dot { at, radius, color },
            false => Shape::Ring {
                at,
                radius,
                width,
                color,
            },
        });
        Ok(())
    }

    fn draw_text<S: BackendTextStyle>(&mut self, text: &str, style: &S, (x, y): BackendCoord) -> Drawn {
        let size = style.size();
        // Heights of capitals and figures over the font size, near enough for every system font.
        let below = match style.anchor().v_pos {
            VPos::Top => 0.74,
            VPos::Center => 0.36,
            VPos::Bottom => -0.05,
        };
        let drop = (below * size).round() as i32;
        let upward = matches!(style.transform(), FontTransform::Rotate270);
        self.shapes.push(Shape::Text(Label {
            text: text.to_owned(),
            at: if upward { (x + drop, y) } else { (x, y + drop) },
            size,
            anchor: style.anchor().h_pos,
            upward,
            color: style.color(),
        }));
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use plotters::prelude::{EmptyElement, Text};

    #[test]
    fn text_of_files_is_text_in_figures() {
        let drawn = svg((10, 10), "<script>", "\"\u{1b}", |area| {
            let label = Text::new("</text><script>alert(1)</script>", (0, 0), ("sans", 120));
            let element = EmptyElement::at((5, 5)) + label;
            area.draw(&element).map_err(|error| error.to_string())
        })
        .unwrap();
        assert!(!drawn.contains("<script"), "{drawn}");
        assert!(
            drawn.contains("aria-label=\"&lt;script&gt;. &quot;␛\""),
            "{drawn}"
        );
    }
}
