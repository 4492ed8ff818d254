//! What plotters draws on: a list of shapes, counted in tenths of a pixel, which pages show as SVG and prints as
//! SVG, PNG or PDF.

use std::convert::Infallible;

use plotters::drawing::IntoDrawingArea;
use plotters::prelude::{Cartesian2d, ChartContext, DrawingArea};
use plotters_backend::text_anchor::VPos;
use plotters_backend::{
    BackendColor, BackendCoord, BackendStyle, BackendTextStyle, DrawingBackend, DrawingErrorKind,
    FontTransform,
};

use super::positions::Positions;

pub use super::ink::Ink;
pub use super::shape::{Drawing, Label, PAGE_WIDTH, Shape, TENTHS};

/// The drawing area that figures draw on.
pub type Area<'a> = DrawingArea<Canvas<'a>, plotters::coord::Shift>;

/// Chart with linear coordinates; positions on log axes are logarithms.
pub type Chart<'a, 'b> = ChartContext<'a, Canvas<'b>, Cartesian2d<Positions, Positions>>;

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
        if fill {
            self.fill_polygon(corners, style)
        } else {
            self.draw_path(corners.into_iter().chain([(left, top)]), style)
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
        self.shapes.push(if fill {
            Shape::Dot { at, radius, color }
        } else {
            Shape::Ring {
                at,
                radius,
                width,
                color,
            }
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
