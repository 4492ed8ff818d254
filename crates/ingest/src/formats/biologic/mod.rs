//! BioLogic EC-Lab and BT-Lab: text export (.mpt) and binary file (.mpr). Their logs, settings, states and display
//! settings (.mpl, .mps, .sta, .mgr) are sidecars.

pub mod mpr;
pub mod mpr_columns;
pub mod mpt;
pub mod mpt_header;

pub use mpr::BiologicMpr;
pub use mpt::BiologicMpt;

use super::assemble::RowFlag;
use super::cells::CellTable;
use crate::text::header::{Header, Meaning};
use ieap_domain::Quantity;

/// Value of the column `mode` where the potential is held.
const POTENTIOSTATIC: f64 = 2.0;

/// Marks of the readings whose column `error` is set. In the public files these readings lie at the end of their current
/// range or are the first after a change, but what the bit means is not published: nothing is left out of fits for it.
fn marks(headers: &[Header], cells: &CellTable) -> Vec<RowFlag> {
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
fn judge_control(headers: &mut [Header], cells: &CellTable) {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::{Format, ReadContext};

    #[test]
    fn readings_with_the_error_bit_are_marked_and_kept() {
        let text = "mode\terror\ttime/s\tEwe/V\tI/mA\r\n\
                    2\t0\t0.0E+000\t1.0E+000\t1.0E+000\r\n\
                    2\t1\t1.0E+000\t1.0E+000\t2.5E-001\r\n\
                    2\t1\t2.0E+000\t1.0E+000\t2.5E-001\r\n\
                    2\t0\t3.0E+000\t1.0E+000\t1.0E-001\r\n";
        let reading = BiologicMpt
            .read(text.as_bytes(), &ReadContext::default())
            .unwrap();
        let [mark] = reading.tables[0].flags.as_slice() else {
            panic!("{:?}", reading.tables[0].flags);
        };
        assert_eq!((mark.column.as_str(), mark.flag.as_str()), ("error", "1"));
        assert_eq!((mark.readings, mark.excludes), (2, false));
        let channels = &reading.tables[0].channels;
        assert!(channels.iter().all(|channel| channel.excluded.is_empty()));
    }

    #[test]
    fn the_last_row_is_read_where_it_ends_without_a_line_end() {
        let row = |at: u32, end: &str| format!("2\t{at}.5E-04\t1.25E-04{end}");
        for (between, last, rows) in [
            ("\n", "", 3),
            ("\r\n", "\r", 3),
            ("\t\n", "\t", 3),
            ("\r\n", "\t7", 2),
        ] {
            let rows_of_text: Vec<String> = (1..=2).map(|at| row(at, between)).collect();
            let text = format!(
                "mode\ttime/s\tI/mA{between}{}{}",
                rows_of_text.concat(),
                row(3, last)
            );
            let reading = BiologicMpt
                .read(text.as_bytes(), &ReadContext::default())
                .unwrap();
            let is_told = reading.issues.iter().any(|issue| issue.code == "file-cut");
            assert_eq!((reading.tables[0].rows, is_told), (rows, rows == 2), "{text:?}");
        }
    }
}
