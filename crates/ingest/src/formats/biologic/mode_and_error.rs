//! The columns `mode` and `error`, which both kinds of file have, and techniques that hold the voltage.

use crate::formats::assemble::RowFlag;
use crate::formats::cells::CellTable;
use crate::text::header::{Header, Meaning};
use ieap_domain::Quantity;

/// Value of the column `mode` where the potential is held.
pub(super) const POTENTIOSTATIC: f64 = 2.0;

/// Marks of the readings whose column `error` is set. In the public files these readings lie at the end of their current
/// range or are the first after a change, but what the bit means is not published: nothing is left out of fits for it.
pub(super) fn marks(headers: &[Header], cells: &CellTable) -> Vec<RowFlag> {
    let Some(index) = headers.iter().position(|header| header.raw_name == "error") else {
        return Vec::new();
    };
    let numbers = cells.columns[index].numbers.iter().enumerate();
    let set = numbers.filter(|(_, number)| !number.is_nan() && **number != 0.0);
    set.map(|(row, number)| RowFlag {
        row: row as u32,
        column: "error".to_owned(),
        flag: number.to_string(),
        excludes: false,
    })
    .collect()
}

/// Takes the control for what it is where `mode` says that it does not control throughout: at rest it is 0 and no voltage
/// is applied, so that it is no drive.
pub(super) fn judge_control(headers: &mut [Header], cells: &CellTable) {
    let Some(mode) = headers.iter().position(|header| header.raw_name == "mode") else {
        return;
    };
    let modes = &cells.columns[mode].numbers;
    let is_control = |header: &&mut Header| header.meaning.quantity() == Some(Quantity::ControlVoltage);
    if modes.iter().any(|mode| *mode != POTENTIOSTATIC) {
        headers
            .iter_mut()
            .filter(is_control)
            .for_each(|header| header.meaning = Meaning::Other);
    }
}

/// Whether a technique, by its name, answers a voltage that is held: chronoamperometry and constant voltage.
pub(super) fn holds_the_voltage(technique: &str) -> bool {
    technique.starts_with("Chronoamperometry") || technique == "Constant Voltage"
}
