//! Small multiples: a legend, then panels in rows, each with a letter and a title, then notes.

use plotters::element::{PathElement, Text};
use plotters::style::Color;
use plotters::style::text_anchor::{HPos, VPos};

use crate::figures::canvas::{Area, Drawing, Ink, TENTHS, drawing};
use crate::figures::panel::{TICK_SIZE, TITLE_SIZE, text_style};

/// Height of a row of the legend, px.
const LEGEND_ROW: i32 = 18;
/// Room above a panel for its title, px.
const TITLE_ROOM: i32 = 18;
/// Width of the line before an entry of the legend, and of a character in it, px.
const SAMPLE_LINE: i32 = 18;
const CHARACTER: i32 = 7;
/// Height of a line of the notes, px, and the average width of a character in it.
const NOTE_LINE: i32 = 15;
const NOTE_CHARACTER: f64 = 5.6;
/// Narrowest panel that can be read, px.
const NARROWEST: u32 = 165;

/// One panel.
pub struct Panel<'a> {
    /// Title.
    pub title: String,
    /// Draws it on the area below the title.
    #[allow(clippy::type_complexity)]
    pub draw: Box<dyn Fn(&Area) -> Result<(), String> + 'a>,
}

/// Draws panels in rows of `columns`, fewer where they would be too narrow.
///
/// # Errors
/// There is no panel, or the message of the drawing library.
pub fn grid(
    width: u32,
    columns: usize,
    panel_height: u32,
    legend: &[(String, Ink)],
    panels: &[Panel],
    notes: &[String],
) -> Result<Drawing, String> {
    if panels.is_empty() {
        return Err("no run has what this figure shows".to_owned());
    }
    let columns = columns
        .min((width / NARROWEST).max(1) as usize)
        .min(panels.len())
        .max(1);
    let rows = panels.len().div_ceil(columns);
    let places = legend_places(width as i32, legend);
    let legend_height = places.last().map_or(0, |&(_, y)| y + LEGEND_ROW);
    let row_height = panel_height as i32 + TITLE_ROOM;
    let lines: Vec<String> = notes.iter().flat_map(|note| wrapped(note, width)).collect();
    let plots_height = legend_height + rows as i32 * row_height;
    let size = (width, (plots_height + lines.len() as i32 * NOTE_LINE) as u32);
    drawing(size, |area| {
        let (plots, foot) = area.split_vertically(plots_height * TENTHS);
        draw_notes(&foot, &lines)?;
        let (top, below) = plots.split_vertically(legend_height * TENTHS);
        for ((name, ink), place) in legend.iter().zip(&places) {
            draw_entry(&top, name, *ink, *place)?;
        }
        let cells = below.split_evenly((rows, columns));
        for (at, (panel, cell)) in panels.iter().zip(&cells).enumerate() {
            let (title, plot) = cell.split_vertically(TITLE_ROOM * TENTHS);
            let letter = match panels.len() {
                1 => String::new(),
                _ => format!("{}  ", char::from(b'A' + (at % 26) as u8)),
            };
            let style = text_style(Ink::Text, TITLE_SIZE, HPos::Left, VPos::Center);
            let text = Text::new(
                format!("{letter}{}", panel.title),
                (4 * TENTHS, TITLE_ROOM * TENTHS / 2),
                style,
            );
            title.draw(&text).map_err(|error| error.to_string())?;
            (panel.draw)(&plot)?;
        }
        Ok(())
    })
}

/// A note in lines that fit into `width` px.
fn wrapped(note: &str, width: u32) -> Vec<String> {
    let most = (f64::from(width) / NOTE_CHARACTER) as usize;
    let mut lines: Vec<String> = Vec::new();
    for word in note.split(' ') {
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + word.chars().count() <= most => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

/// Draws a legend at the top of `area`, and gives what lies below it.
///
/// # Errors
/// The message of the drawing library.
pub fn draw_entries<'a>(area: &Area<'a>, legend: &[(String, Ink)]) -> Result<Area<'a>, String> {
    let (width, _) = area.dim_in_pixel();
    let places = legend_places(width as i32 / TENTHS, legend);
    let height = places.last().map_or(0, |&(_, y)| y + LEGEND_ROW);
    let (top, below) = area.split_vertically(height * TENTHS);
    for ((name, ink), place) in legend.iter().zip(&places) {
        draw_entry(&top, name, *ink, *place)?;
    }
    Ok(below)
}

fn draw_notes(area: &Area, lines: &[String]) -> Result<(), String> {
    for (at, line) in lines.iter().enumerate() {
        let middle = (at as i32 * NOTE_LINE + NOTE_LINE / 2) * TENTHS;
        let style = text_style(Ink::Text, TICK_SIZE, HPos::Left, VPos::Center);
        let text = Text::new(line.clone(), (4 * TENTHS, middle), style);
        area.draw(&text).map_err(|error| error.to_string())?;
    }
    Ok(())
}

/// Left end and top of every entry of the legend, px.
fn legend_places(width: i32, legend: &[(String, Ink)]) -> Vec<(i32, i32)> {
    let mut at = (4, 0);
    let mut places = Vec::new();
    for (name, _) in legend {
        let length = SAMPLE_LINE + 8 + CHARACTER * name.chars().count() as i32 + 8;
        if at.0 > 4 && at.0 + length > width {
            at = (4, at.1 + LEGEND_ROW);
        }
        places.push(at);
        at.0 += length;
    }
    places
}

fn draw_entry(area: &Area, name: &str, ink: Ink, (x, y): (i32, i32)) -> Result<(), String> {
    let middle = (y + LEGEND_ROW / 2) * TENTHS;
    let line = [(x * TENTHS, middle), ((x + SAMPLE_LINE) * TENTHS, middle)];
    let line = PathElement::new(line, ink.color().stroke_width(20));
    area.draw(&line).map_err(|error| error.to_string())?;
    let text = text_style(Ink::Text, TICK_SIZE, HPos::Left, VPos::Center);
    let text = Text::new(name.to_owned(), ((x + SAMPLE_LINE + 6) * TENTHS, middle), text);
    area.draw(&text).map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn notes_are_broken_between_words() {
        let lines = wrapped("Set aside, in no result: a.csv (its current is 1000 times)", 165);
        assert!(
            lines.len() > 1 && lines.iter().all(|line| line.chars().count() <= 29),
            "{lines:?}"
        );
        assert_eq!(
            lines.join(" "),
            "Set aside, in no result: a.csv (its current is 1000 times)"
        );
    }
}
