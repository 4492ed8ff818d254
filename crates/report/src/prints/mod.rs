//! Figures for print: named, at an asked width, as SVG, PNG or PDF with text as outlines, so that they look the same
//! on every machine. A figure is one file here and one row in [`FIGURES`].

mod along;
mod bending;
mod currents;
pub mod family;
pub(crate) mod frequency;
mod grid;
pub(crate) mod models;
mod modulus;
mod outlines;
mod parameters;
mod pdf;
mod png;
pub mod predicted;
mod responses;
mod svg;

use crate::figures::canvas::Drawing;
use crate::site::Site;
use ieap_domain::CurveSource;

/// Points (1/72 inch) per pixel of a drawing: tick labels of 11 px are 7.5 pt in print, titles of 12 px 8.2 pt, and
/// the thinnest line, 0.8 px, 0.55 pt.
pub const POINTS_PER_PIXEL: f64 = 7.5 / 11.0;
/// Points per millimetre.
const POINTS_PER_MM: f64 = 72.0 / 25.4;

/// What figures are made from.
pub struct FigureInput<'a> {
    /// Campaign, runs and conditions, as the report has them.
    pub site: &'a Site<'a>,
    /// Measured and fitted curves of the runs.
    pub curves: &'a dyn CurveSource,
    /// The only run that a figure of strips shows; none: all of them.
    pub run: Option<usize>,
}

/// A figure that can be asked for.
pub struct NamedFigure {
    /// Its name, after the thesis.
    pub name: &'static str,
    /// The same figure by what it shows.
    pub alias: &'static str,
    /// What it shows, one sentence.
    pub about: &'static str,
    /// Width for which it is laid out, mm.
    pub width_mm: f64,
    /// Whether it shows strips read at several places, so that one run can be asked for.
    pub of_strips: bool,
    /// Draws it, that many pixels wide; the message says what is missing, or what the drawing library says.
    draw: fn(&FigureInput, u32) -> Result<Drawing, String>,
}

impl NamedFigure {
    /// The figure of that campaign, `width_mm` wide.
    ///
    /// # Errors
    /// What the campaign lacks, or the message of the drawing library.
    pub fn print(&self, input: &FigureInput, width_mm: f64) -> Result<Print, String> {
        Ok(Print {
            title: self.about.to_owned(),
            notice: input.site.input.campaign.notice.clone(),
            drawing: (self.draw)(input, Print::pixels(width_mm))?,
            width_mm,
        })
    }
}

/// Every figure, in the order in which they are listed.
pub const FIGURES: [NamedFigure; 11] = [
    NamedFigure {
        name: "figure4",
        alias: "shapes",
        about: "Shape of the strip at a few times, drawn to scale, measured and simulated",
        width_mm: 85.0,
        of_strips: true,
        draw: along::shapes,
    },
    NamedFigure {
        name: "figure5",
        alias: "curvature-map",
        about: "Curvature over place and time, measured, simulated and their difference",
        width_mm: 170.0,
        of_strips: true,
        draw: along::maps,
    },
    NamedFigure {
        name: "figure20",
        alias: "voltages",
        about: "Voltage along the strip at a few times, measured and simulated",
        width_mm: 85.0,
        of_strips: true,
        draw: along::voltage,
    },
    NamedFigure {
        name: "figure21",
        alias: "places",
        about: "Curvature over time at a few places along the strip, measured and simulated",
        width_mm: 85.0,
        of_strips: true,
        draw: along::places,
    },
    NamedFigure {
        name: "figure22",
        alias: "currents",
        about: "Current in the environments at the lowest and highest voltage, measured and simulated",
        width_mm: 170.0,
        of_strips: false,
        draw: currents::draw,
    },
    NamedFigure {
        name: "figure23",
        alias: "bending",
        about: "Curvature in dry and in humid environments at each voltage, measured and simulated",
        width_mm: 170.0,
        of_strips: false,
        draw: bending::curvature,
    },
    NamedFigure {
        name: "figure23-displacement",
        alias: "displacement",
        about: "Displacement at the free length in dry and in humid environments at each voltage, measured and simulated",
        width_mm: 170.0,
        of_strips: false,
        draw: bending::displacement,
    },
    NamedFigure {
        name: "figure24",
        alias: "modulus",
        about: "Normalised complex modulus under changing humidity",
        width_mm: 85.0,
        of_strips: false,
        draw: modulus::draw,
    },
    NamedFigure {
        name: "figure26",
        alias: "parameters",
        about: "Parameters over environment and voltage, with 95 % intervals",
        width_mm: 170.0,
        of_strips: false,
        draw: parameters::draw,
    },
    NamedFigure {
        name: "frequency",
        alias: "bode",
        about: "Amplitude and phase of current and bending per volt against frequency, measured and by the fit",
        width_mm: 170.0,
        of_strips: false,
        draw: frequency::draw,
    },
    NamedFigure {
        name: "models",
        alias: "models-compared",
        about: "What was measured with the curve of every model compared, and what each leaves",
        width_mm: 170.0,
        of_strips: false,
        draw: models::draw,
    },
];

/// A print of a family of lines that no campaign is needed for.
///
/// # Errors
/// There is no panel, or the message of the drawing library.
pub fn family_print(family: &family::Family, title: &str, width_mm: f64) -> Result<Print, String> {
    Ok(Print {
        title: title.to_owned(),
        notice: None,
        drawing: family.draw(Print::pixels(width_mm))?,
        width_mm,
    })
}

/// The figure of that name or alias.
pub fn figure_named(name: &str) -> Option<&'static NamedFigure> {
    FIGURES
        .iter()
        .find(|figure| figure.name == name || figure.alias == name)
}

/// A drawing with what a file needs beside it.
pub struct Print {
    /// What it shows.
    pub title: String,
    /// The campaign's own statement, such as "simulated, not measured".
    pub notice: Option<String>,
    /// The drawing.
    pub drawing: Drawing,
    /// Its width, mm.
    pub width_mm: f64,
}

impl Print {
    /// Width of a drawing that is printed `width_mm` wide, px.
    pub fn pixels(width_mm: f64) -> u32 {
        (width_mm * POINTS_PER_MM / POINTS_PER_PIXEL).round() as u32
    }

    /// Width and height, mm; the height follows from the drawing.
    pub fn size_mm(&self) -> (f64, f64) {
        let (width, height) = self.drawing.size;
        (
            self.width_mm,
            self.width_mm * f64::from(height) / f64::from(width),
        )
    }

    /// Title and notice.
    pub fn description(&self) -> String {
        match &self.notice {
            Some(notice) => format!("{}. {notice}", self.title),
            None => self.title.clone(),
        }
    }
}

/// A file format of figures.
pub struct FigureFormat {
    /// Name, and ending of its files.
    pub name: &'static str,
    /// Writes the print; the number is the resolution in dots per inch, for pixels.
    pub write: fn(&Print, f64) -> Result<Vec<u8>, String>,
}

/// Every format.
pub const FIGURE_FORMATS: [FigureFormat; 3] = [
    FigureFormat {
        name: "svg",
        write: |print, _| svg::write(print),
    },
    FigureFormat {
        name: "png",
        write: png::write,
    },
    FigureFormat {
        name: "pdf",
        write: |print, _| pdf::write(print),
    },
];

/// The format of that name.
pub fn figure_format_named(name: &str) -> Option<&'static FigureFormat> {
    FIGURE_FORMATS.iter().find(|format| format.name == name)
}
