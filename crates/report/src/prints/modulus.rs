//! The thesis's figure 24: normalised complex modulus of the modulus logs under changing humidity.

use super::FigureInput;
use crate::figures::canvas::Drawing;
use crate::figures::modulus::{NormalisedLog, normalised_drawing};
use crate::pages::dma::{MOST_DRAWN, drawable};

/// Draws it.
pub fn draw(input: &FigureInput, width: u32) -> Result<Drawing, String> {
    let logs = input.site.input.modulus_logs.iter();
    let drawn: Vec<NormalisedLog> = logs
        .filter_map(|log| drawable(log, log.analysis.as_ref()?))
        .take(MOST_DRAWN)
        .collect();
    if drawn.is_empty() {
        Err("no modulus log with a humidity step is there: put them into dma/ and run `ieap run`".to_owned())
    } else {
        normalised_drawing(width, &drawn)
    }
}
