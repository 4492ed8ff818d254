//! Amplitude and phase of current and bending per volt against frequency.

use super::FigureInput;
use crate::blocks::chart;
use crate::figures::canvas::Drawing;
use ieap_analysis::frequency::view;

/// Draws it.
pub fn draw(input: &FigureInput, width: u32) -> Result<Drawing, String> {
    let charts = view::charts(&input.site.input.frequency);
    if charts.is_empty() {
        return Err("no run has a sine or a chirp for its voltage".to_owned());
    }
    chart::prints(&charts, charts.len(), width)
}
