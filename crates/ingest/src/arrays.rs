//! Columns that a caller holds in memory, read as those of a plain run table: the same names, units and judgements.

use ieap_domain::RunStatus;

use crate::Reading;
use crate::formats::assemble::{Raw, assemble};
use crate::formats::cells::{CellColumn, CellTable};
use crate::formats::error::ReadError;
use crate::text::header::Header;

/// Stands for a format's id with readings that came from no file.
pub const FORMAT: &str = "arrays";

/// Reads columns with the names that a plain run table may have (`time_s`, `I/mA`, `curvature_per_cm`). A cell that is NaN is
/// empty, as a slower instrument leaves it. Time zero is the voltage step, as in a plain run table.
///
/// # Errors
/// No row, no usable time column, time out of order, or columns of different lengths.
pub fn read(columns: Vec<(String, Vec<f64>)>) -> Result<Reading, ReadError> {
    let rows = columns.first().map_or(0, |(_, numbers)| numbers.len());
    for (index, (name, numbers)) in columns.iter().enumerate() {
        if numbers.len() != rows {
            return Err(ReadError::Column {
                line: 0,
                index: index + 1,
                column: crate::formats::error::quoted(name),
                reason: format!("it has {} values, and the first column has {rows}", numbers.len()),
            });
        }
    }
    let headers = columns.iter().map(|(name, _)| Header::parse(name)).collect();
    let cells = CellTable {
        columns: columns.into_iter().map(|(_, numbers)| column(numbers)).collect(),
        line_of_row: (1..=rows as u32).collect(),
        ..CellTable::default()
    };
    let raw = Raw {
        time_zero_is_step: true,
        must_be_run: true,
        ..Raw::of_instrument(String::new(), headers, cells)
    };
    let mut issues = Vec::new();
    let table = assemble(raw, &mut issues)?;
    Ok(Reading {
        format: FORMAT,
        reader_version: 1,
        technique: None,
        is_step_response: true,
        encoding: None,
        status: RunStatus::Complete,
        status_evidence: format!("{rows} rows were given"),
        started_at: None,
        header_tags: Vec::new(),
        tables: vec![table],
        original_metadata: Vec::new(),
        issues,
    })
}

/// NaN is an empty cell; an infinite number is one that was given and cannot be used.
fn column(mut numbers: Vec<f64>) -> CellColumn {
    let mut column = CellColumn::default();
    for (row, number) in numbers.iter_mut().enumerate() {
        column.filled += usize::from(!number.is_nan());
        if number.is_infinite() {
            column.not_finite.add(row + 1, || number.to_string());
            *number = f64::NAN;
        }
    }
    column.numbers = numbers;
    column
}

#[cfg(test)]
mod tests {
    use super::*;
    use ieap_domain::Quantity;

    fn columns(pairs: &[(&str, &[f64])]) -> Vec<(String, Vec<f64>)> {
        let own = |(name, numbers): &(&str, &[f64])| ((*name).to_owned(), numbers.to_vec());
        pairs.iter().map(own).collect()
    }

    #[test]
    fn units_are_converted_and_empty_cells_left_out_as_in_a_file() {
        let given = columns(&[
            ("time_s", &[0.0, 1.0, 2.0]),
            ("I/mA", &[5.0, 6.0, 7.0]),
            ("curvature_per_cm", &[0.1, f64::NAN, 0.3]),
        ]);
        let table = &read(given).unwrap().tables[0];
        let text: &[u8] = b"time_s,I/mA,curvature_per_cm\n0,5,0.1\n1,6,\n2,7,0.3\n";
        let context = crate::formats::ReadContext::default();
        let (of_file, _) = crate::profiles::read(&[], "a.csv", text, &context).unwrap();
        assert_eq!(table.channels, of_file.tables[0].channels);
        assert_eq!(table.channels[0].quantity, Quantity::Current);
        assert_eq!(table.channels[1].len(), 2);
        assert!(table.time_zero_is_step);
    }

    #[test]
    fn what_cannot_be_a_table_is_refused_with_place_and_mend() {
        let uneven = read(columns(&[("time_s", &[0.0, 1.0]), ("current_a", &[1.0])]));
        let issue = uneven.unwrap_err().issue();
        assert_eq!(issue.place, "column 2");
        assert!(issue.message.contains("1 values"), "{}", issue.message);
        assert!(read(columns(&[("current_a", &[1.0])])).is_err());
        let infinite = columns(&[("time_s", &[0.0, 1.0]), ("current_a", &[1.0, f64::INFINITY])]);
        let reading = read(infinite).unwrap();
        assert_eq!(reading.tables[0].channels[0].len(), 1);
        assert!(!reading.issues.is_empty(), "an infinite current is pointed out");
    }
}
