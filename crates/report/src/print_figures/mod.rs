//! Figures for print: named, at an asked width, as SVG, PNG or PDF with text as outlines, so that they look the same
//! on every machine. A figure is one file here and one row in [`FIGURES`].

mod along;
mod bending;
mod charge;
mod currents;
mod figure;
pub(crate) mod frequency;
pub(crate) mod grid;
mod laws;
pub(crate) mod models;
mod modulus;
mod outlines;
mod parameters;
mod pdf;
mod png;
mod print;
mod responses;
mod svg;

pub use figure::{FigureInput, NamedFigure};
pub use print::{POINTS_PER_PIXEL, Print};

use crate::blocks::chart;
use ieap_show::Chart;

/// Every figure, in the order in which they are listed.
pub const FIGURES: &[NamedFigure] = &[
    NamedFigure {
        name: "figure4",
        alias: "shapes",
        about: "Shape of the strip at a few times, drawn to scale, measured and simulated",
        width_mm: 85.0,
        of_strips: true,
        of_parameters: false,
        draw: along::shapes,
    },
    NamedFigure {
        name: "figure5",
        alias: "curvature-map",
        about: "Curvature over place and time, measured, simulated and their difference",
        width_mm: 170.0,
        of_strips: true,
        of_parameters: false,
        draw: along::maps,
    },
    NamedFigure {
        name: "figure20",
        alias: "voltages",
        about: "Voltage along the strip at a few times, measured and simulated",
        width_mm: 85.0,
        of_strips: true,
        of_parameters: false,
        draw: along::voltage,
    },
    NamedFigure {
        name: "figure21",
        alias: "places",
        about: "Curvature over time at a few places along the strip, measured and simulated",
        width_mm: 85.0,
        of_strips: true,
        of_parameters: false,
        draw: along::places,
    },
    NamedFigure {
        name: "figure22",
        alias: "currents",
        about: "Current in the environments at the lowest and highest voltage, measured and simulated",
        width_mm: 170.0,
        of_strips: false,
        of_parameters: false,
        draw: currents::draw,
    },
    NamedFigure {
        name: "figure23",
        alias: "bending",
        about: "Curvature in dry and in humid environments at each voltage, measured and simulated",
        width_mm: 170.0,
        of_strips: false,
        of_parameters: false,
        draw: bending::curvature,
    },
    NamedFigure {
        name: "figure23-displacement",
        alias: "displacement",
        about: "Displacement at the free length in dry and in humid environments at each voltage, measured and simulated",
        width_mm: 170.0,
        of_strips: false,
        of_parameters: false,
        draw: bending::displacement,
    },
    NamedFigure {
        name: "charge",
        alias: "curvature-charge",
        about: "Curvature against the charge that has passed, at the lowest and highest voltage, measured and simulated",
        width_mm: 170.0,
        of_strips: false,
        of_parameters: false,
        draw: charge::draw,
    },
    NamedFigure {
        name: "figure24",
        alias: "modulus",
        about: "Normalised complex modulus under changing humidity",
        width_mm: 85.0,
        of_strips: false,
        of_parameters: false,
        draw: modulus::draw,
    },
    NamedFigure {
        name: "figure26",
        alias: "parameters",
        about: "Parameters over environment and voltage, with 95 % intervals",
        width_mm: 170.0,
        of_strips: false,
        of_parameters: false,
        draw: parameters::draw,
    },
    NamedFigure {
        name: "laws",
        alias: "dependences",
        about: "Parameters against humidity, voltage or what else they follow, with the law and its 95 % interval",
        width_mm: 85.0,
        of_strips: false,
        of_parameters: true,
        draw: laws::laws,
    },
    NamedFigure {
        name: "monitoring",
        alias: "lives",
        about: "Parameters over the life of each sample, with trend, changes and limits",
        width_mm: 85.0,
        of_strips: false,
        of_parameters: true,
        draw: laws::lives,
    },
    NamedFigure {
        name: "frequency",
        alias: "bode",
        about: "Amplitude and phase of current and bending per volt against frequency, measured and by the fit",
        width_mm: 170.0,
        of_strips: false,
        of_parameters: false,
        draw: frequency::draw,
    },
    NamedFigure {
        name: "models",
        alias: "models-compared",
        about: "What was measured with the curve of every model compared, and what each leaves",
        width_mm: 170.0,
        of_strips: false,
        of_parameters: false,
        draw: models::draw,
    },
];

/// A print of charts, in so many columns, that no campaign is needed for.
///
/// # Errors
/// There is no chart, or the message of the drawing library.
pub fn charts_print(charts: &[Chart], columns: usize, title: &str, width_mm: f64) -> Result<Print, String> {
    Ok(Print {
        title: title.to_owned(),
        notice: None,
        drawing: chart::prints(charts, columns, Print::pixels(width_mm))?,
        width_mm,
    })
}

/// The figure of that name or alias.
pub fn figure_named(name: &str) -> Option<&'static NamedFigure> {
    FIGURES
        .iter()
        .find(|figure| figure.name == name || figure.alias == name)
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
