//! Columns that a caller holds in memory, read as those of a plain run table: the same names, units and judgements.

use ieap_domain::Issue;

use crate::Reading;
use crate::formats::assemble::{Raw, assemble};
use crate::formats::cells::{CellColumn, CellTable};
use crate::text::header::Header;

/// Stands for a format's id with readings that came from no file.
pub const FORMAT: &str = "arrays";

/// A column of a caller.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// Its name, with a unit.
    pub name: String,
    /// Its cells; NaN is an empty one.
    pub numbers: Vec<f64>,
    /// Whether they are durations, s: whatever unit the name says.
    pub are_durations: bool,
}

impl Column {
    /// A column of numbers in the unit that its name says.
    pub fn new(name: String, numbers: Vec<f64>) -> Column {
        Column {
            name,
            numbers,
            are_durations: false,
        }
    }
}

/// Reads columns with the names that a plain run table may have (`time_s`, `I/mA`, `curvature_per_cm`). A cell that is NaN is
/// empty, as a slower instrument leaves it. Time zero is the voltage step, as in a plain run table.
///
/// # Errors
/// No row, no usable time column, time out of order, or columns of different lengths; places are indices and names.
pub fn read(columns: Vec<Column>) -> Result<Reading, Issue> {
    let names: Vec<String> = columns.iter().map(|column| column.name.clone()).collect();
    let rows = columns.first().map_or(0, |first| first.numbers.len());
    if let Some(other) = columns.iter().find(|column| column.numbers.len() != rows) {
        let message = format!(
            "it has {} values, and {} has {rows}",
            other.numbers.len(),
            names[0]
        );
        return Err(Issue::error("column-unusable", message)
            .at(format!("column {}", other.name))
            .mend("give all columns the same length; NaN or None is an empty cell"));
    }
    let header = |column: &Column| {
        if column.are_durations {
            Header::of_durations(&column.name)
        } else {
            Header::parse(&column.name)
        }
    };
    let headers = columns.iter().map(header).collect();
    let cells = CellTable {
        columns: columns.into_iter().map(|own| column(own.numbers)).collect(),
        line_of_row: (1..=rows as u32).collect(),
        ..CellTable::default()
    };
    let raw = Raw {
        time_zero_is_step: true,
        must_be_run: true,
        ..Raw::of_instrument(String::new(), headers, cells)
    };
    let mut issues = Vec::new();
    let table = assemble(raw, &mut issues).map_err(|error| in_words_of_arrays(error.issue(), &names))?;
    Ok(Reading {
        is_step_response: true,
        status_evidence: format!("{rows} rows were given"),
        tables: vec![table],
        issues: issues
            .into_iter()
            .map(|issue| in_words_of_arrays(issue, &names))
            .collect(),
        ..Reading::of(FORMAT, 1)
    })
}

/// What is said of lines and headers of a file, said of arrays.
fn in_words_of_arrays(issue: Issue, names: &[String]) -> Issue {
    let mend = match issue.code.as_str() {
        "header-only" => "give a value or more in every column, with a time beside it",
        "column-unusable" | "column-refused" => "write the unit into the name, as in current_a or I/mA",
        "no-header" => "name the times with their unit: time_s, or t/ms",
        "no-response" => "name the response with its unit: current_a, curvature_per_cm, tip_displacement_mm",
        "time-order" => {
            "give the readings in the order in which they were taken, each later than the one before"
        }
        // Files can also be described by a profile.
        _ => issue.mend.split("; `ieap profile").next().unwrap_or_default(),
    };
    let mend = mend.to_owned();
    let message = match issue.code.as_str() {
        "header-only" => "there is no row with a time and a number".to_owned(),
        "no-header" => format!("none of the columns {} is a time", names.join(", ")),
        _ => of_indices(&issue.message),
    };
    Issue {
        place: place(&issue.place, names),
        message,
        mend,
        ..issue
    }
}

/// `line 3, column 2` as the name of the column and the index of the row.
fn place(of_file: &str, names: &[String]) -> String {
    let mut parts: Vec<String> = Vec::new();
    for part in of_file.split(", ") {
        let number = |word: &str| part.strip_prefix(word)?.parse::<usize>().ok();
        match (number("line "), number("column ")) {
            (Some(0), _) => {}
            (Some(line), _) => parts.push(format!("index {}", line - 1)),
            (_, Some(column)) if (1..=names.len()).contains(&column) => {
                parts.insert(0, format!("column {}", names[column - 1]));
            }
            _ => parts.push(part.to_owned()),
        }
    }
    parts.join(", ")
}

/// A message that speaks of lines, in indices.
fn of_indices(message: &str) -> String {
    let mut parts = message.split("line ");
    let mut said = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let digits = part.find(|c: char| !c.is_ascii_digit()).unwrap_or(part.len());
        // Of a baseline nothing is meant.
        let is_word = !said.ends_with(char::is_alphanumeric);
        match part[..digits].parse::<usize>() {
            Ok(line) if line > 0 && is_word => said += &format!("index {}{}", line - 1, &part[digits..]),
            _ => said += &format!("line {part}"),
        }
    }
    said
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

    fn columns(pairs: &[(&str, &[f64])]) -> Vec<Column> {
        let own = |(name, numbers): &(&str, &[f64])| Column::new((*name).to_owned(), numbers.to_vec());
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
    fn durations_are_seconds_whatever_their_name_says() {
        for name in ["time", "t/ms", "Test Time [min]", "time_s"] {
            let mut given = columns(&[(name, &[0.0, 0.5, 1.0]), ("current_a", &[1.0, 2.0, 3.0])]);
            given[0].are_durations = true;
            let table = &read(given).unwrap().tables[0];
            assert_eq!(table.channels[0].time_s.to_vec(), [0.0, 0.5, 1.0], "{name}");
        }
    }

    #[test]
    fn lines_become_indices_and_baselines_stay() {
        assert_eq!(
            of_indices("first at line 3, baseline 5 V"),
            "first at index 2, baseline 5 V"
        );
        let names = ["time_s".to_owned(), "current_a".to_owned()];
        assert_eq!(place("line 3, column 2", &names), "column current_a, index 2");
        assert_eq!(place("line 0, column 1", &names), "column time_s");
    }

    #[test]
    fn what_cannot_be_a_table_is_refused_with_place_and_mend() {
        let uneven = read(columns(&[("time_s", &[0.0, 1.0]), ("current_a", &[1.0])])).unwrap_err();
        assert_eq!(uneven.place, "column current_a");
        assert!(uneven.message.contains("1 values"), "{}", uneven.message);
        let timeless = read(columns(&[("current_a", &[1.0])])).unwrap_err();
        assert_eq!(timeless.message, "none of the columns current_a is a time");
        let unitless = read(columns(&[("time", &[0.0, 1.0]), ("current_a", &[1.0, 2.0])])).unwrap_err();
        assert_eq!(unitless.place, "column time");
        let backwards: Vec<f64> = [0.0, 1.0, 2.0, 1.5, 1.2, 1.0].to_vec();
        let disordered = read(columns(&[("time_s", &backwards), ("current_a", &backwards)])).unwrap_err();
        assert_eq!((&*disordered.code, &*disordered.place), ("time-order", "index 3"));
        for issue in [uneven, timeless, unitless, disordered] {
            let whole = format!("{} {}", issue.message, issue.mend);
            let of_files = ["line", "header", "file", "instrument", "profile", "export"];
            assert!(of_files.iter().all(|word| !whole.contains(word)), "{whole}");
        }
        let infinite = columns(&[("time_s", &[0.0, 1.0]), ("current_a", &[1.0, f64::INFINITY])]);
        let reading = read(infinite).unwrap();
        assert_eq!(reading.tables[0].channels[0].len(), 1);
        assert!(!reading.issues.is_empty(), "an infinite current is pointed out");
    }
}
