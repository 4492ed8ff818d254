//! A figure that can be asked for, and what it is made from.

use super::print::Print;
use crate::figures::canvas::Drawing;
use crate::site::Site;
use ieap_domain::CurveSource;

/// What figures are made from.
pub struct FigureInput<'a> {
    /// Campaign, runs and conditions, as the report has them.
    pub site: &'a Site<'a>,
    /// Measured and fitted curves of the runs.
    pub curves: &'a dyn CurveSource,
    /// The only run that a figure of strips shows; none: all of them.
    pub run: Option<usize>,
    /// The only parameter that a figure of laws or lives shows: `lambda`; none: all of them.
    pub parameter: Option<&'a str>,
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
    /// Whether it shows parameters against what they follow, so that one of them can be asked for.
    pub of_parameters: bool,
    /// Draws it, that many pixels wide; the message says what is missing, or what the drawing library says.
    pub(super) draw: fn(&FigureInput, u32) -> Result<Drawing, String>,
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
