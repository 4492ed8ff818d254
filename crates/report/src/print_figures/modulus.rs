//! The thesis's figure 24: normalised complex modulus of the modulus logs under changing humidity.

use super::FigureInput;
use crate::blocks::chart;
use crate::figures::canvas::Drawing;
use ieap_analysis::dma::charts::normalised;

/// Draws it.
pub fn draw(input: &FigureInput, width: u32) -> Result<Drawing, String> {
    let chart = normalised(&input.site.input.modulus_logs)
        .ok_or("no modulus log with a humidity step is there: put them into dma/ and run `ieap run`")?;
    chart::print(&chart, width)
}
