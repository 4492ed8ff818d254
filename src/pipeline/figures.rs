//! The verb `figure`: a named figure of the campaign for print.

use super::report::input;
use super::{Context, PipelineError};
use crate::report::Site;
use crate::report::prints::{FIGURE_FORMATS, FIGURES, FigureInput, figure_format_named, figure_named};

/// Narrowest and widest figure, mm: a column's quarter, and a poster.
const WIDTHS_MM: std::ops::RangeInclusive<f64> = 20.0..=1000.0;
/// Coarsest and finest resolution, dots per inch.
const RESOLUTIONS: std::ops::RangeInclusive<f64> = 30.0..=2400.0;

/// What is asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct MakeFigure {
    /// Name or alias.
    pub name: String,
    /// `svg`, `png` or `pdf`.
    pub format: String,
    /// Width, mm; none: that for which the figure is laid out.
    pub width_mm: Option<f64>,
    /// Resolution of pixels, dots per inch.
    pub dots_per_inch: f64,
}

/// Name, alias, width in mm and description of every figure.
pub fn listed() -> impl Iterator<Item = (&'static str, &'static str, f64, &'static str)> {
    FIGURES
        .iter()
        .map(|figure| (figure.name, figure.alias, figure.width_mm, figure.about))
}

/// Names of the formats.
pub fn formats() -> Vec<&'static str> {
    FIGURE_FORMATS.iter().map(|format| format.name).collect()
}

impl MakeFigure {
    /// The bytes of the file.
    ///
    /// # Errors
    /// There is no such figure or format, the campaign lacks what it shows, or the database cannot be read.
    pub fn run(&self, context: &Context) -> Result<Vec<u8>, PipelineError> {
        let bad = |what: &'static str, found: String, needed: String| PipelineError::BadArgument {
            what,
            found,
            needed,
        };
        let names = || {
            FIGURES
                .iter()
                .map(|figure| figure.name)
                .collect::<Vec<_>>()
                .join(", ")
        };
        let figure = figure_named(&self.name).ok_or_else(|| {
            bad(
                "figure",
                format!("{:?}", self.name),
                format!("one of {}", names()),
            )
        })?;
        let format = figure_format_named(&self.format).ok_or_else(|| {
            bad(
                "--format",
                format!("{:?}", self.format),
                format!("one of {}", formats().join(", ")),
            )
        })?;
        let width_mm = self.width_mm.unwrap_or(figure.width_mm);
        within("--width-mm", width_mm, &WIDTHS_MM)?;
        within("--dpi", self.dots_per_inch, &RESOLUTIONS)?;
        let (changes, changed_at) = context.store.changes()?;
        let input = input(context, changes, &changed_at)?;
        let site = Site::new(&input);
        let drawn = figure.print(
            &FigureInput {
                site: &site,
                curves: &context.store,
            },
            width_mm,
        );
        let written = drawn.and_then(|print| (format.write)(&print, self.dots_per_inch));
        written.map_err(|reason| PipelineError::Figure {
            figure: figure.name,
            reason,
        })
    }
}

fn within(
    what: &'static str,
    found: f64,
    range: &std::ops::RangeInclusive<f64>,
) -> Result<(), PipelineError> {
    match range.contains(&found) {
        true => Ok(()),
        false => Err(PipelineError::BadArgument {
            what,
            found: found.to_string(),
            needed: format!("{} to {}", range.start(), range.end()),
        }),
    }
}
