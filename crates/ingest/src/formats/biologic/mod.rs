//! BioLogic EC-Lab and BT-Lab: text export (.mpt) and binary file (.mpr). Their logs, settings, states and display
//! settings (.mpl, .mps, .sta, .mgr) are sidecars.

mod mode_and_error;
pub mod mpr;
pub mod mpr_columns;
pub mod mpt;
pub mod mpt_header;

pub use mpr::BiologicMpr;
pub use mpt::BiologicMpt;

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
