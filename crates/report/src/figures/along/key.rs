//! A key above a drawing: a line and a word for each series.

use plotters::element::{PathElement, Text};
use plotters::style::Color;
use plotters::style::text_anchor::{HPos, VPos};

use crate::figures::canvas::{Area, Ink, TENTHS};
use crate::figures::panel::{TICK_SIZE, text_style};

/// Height of a row, px.
const ROW: i32 = 16;
/// Length of the line before a word, px.
const LINE: i32 = 16;
/// Estimated width of a character, px.
const CHARACTER: i32 = 7;

/// Places of the entries in a width: left end and top, px; and the height of all rows.
fn places(width: i32, words: &[String]) -> (Vec<(i32, i32)>, i32) {
    let mut at = (4, 2);
    let mut places = Vec::new();
    for word in words {
        let length = LINE + 5 + CHARACTER * word.chars().count() as i32 + 14;
        if at.0 > 4 && at.0 + length > width {
            at = (4, at.1 + ROW);
        }
        places.push(at);
        at.0 += length;
    }
    (places, at.1 + ROW)
}

/// Room that a key of these words takes above a drawing, px.
pub fn height(width: u32, words: &[String]) -> u32 {
    places(width as i32, words).1 as u32
}

/// Draws a key at the top of `area`.
///
/// # Errors
/// The message of the drawing library.
pub fn draw(area: &Area, words: &[String], inks: &[Ink]) -> Result<(), String> {
    let width = area.dim_in_pixel().0 as i32 / TENTHS;
    for ((word, (x, y)), ink) in words.iter().zip(places(width, words).0).zip(inks) {
        let middle = (y + ROW / 2) * TENTHS;
        let line = [(x * TENTHS, middle), ((x + LINE) * TENTHS, middle)];
        area.draw(&PathElement::new(line, ink.color().stroke_width(22)))
            .map_err(|error| error.to_string())?;
        let style = text_style(Ink::Text, TICK_SIZE, HPos::Left, VPos::Center);
        area.draw(&Text::new(word.clone(), ((x + LINE + 5) * TENTHS, middle), style))
            .map_err(|error| error.to_string())?;
    }
    Ok(())
}
