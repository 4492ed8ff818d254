//! Drives, wanted courses and humidities as tables of two columns: `time_s,voltage_v`, `time_s,tip_displacement_mm` and
//! `time_s,relative_humidity_percent`.

use std::fmt::Write;
use std::path::Path;

use crate::domain::Drive;
use crate::pipeline::{PipelineError, failed};
use crate::system::fs;

/// A drive: every row holds its voltage until the next. Before the first row the strip rests, discharged.
///
/// # Errors
/// The file cannot be read, or is not such a table.
pub fn read_drive(path: &Path) -> Result<Drive, PipelineError> {
    let rows = read(path, "voltage_v")?.into_iter();
    let levels = rows.map(|(start_s, volts)| (start_s, Some(volts)));
    Ok(Drive::of_levels(0.0, levels))
}

/// A wanted course of the tip: times, s, and displacements, mm; between rows it goes straight.
///
/// # Errors
/// The file cannot be read, or is not such a table.
pub fn read_course(path: &Path) -> Result<Vec<(f64, f64)>, PipelineError> {
    read(path, "tip_displacement_mm")
}

/// A humidity that changes: from each time, s, on it is so many percent.
///
/// # Errors
/// The file cannot be read, is not such a table, or holds what is no humidity.
pub fn read_humidity(path: &Path) -> Result<Vec<(f64, f64)>, PipelineError> {
    let rows = read(path, "relative_humidity_percent")?;
    match rows.iter().find(|(_, percent)| !(0.0..=100.0).contains(percent)) {
        Some((time_s, percent)) => Err(PipelineError::DriveFile {
            path: path.to_owned(),
            place: format!("time {time_s} s"),
            found: format!("{percent} %"),
            needed: "relative humidities between 0 and 100 %",
        }),
        None => Ok(rows),
    }
}

/// The drive as such a table.
pub fn write_drive(drive: &Drive) -> String {
    let mut text = "time_s,voltage_v\n".to_owned();
    for (start_s, volts) in drive.levels() {
        if let Some(volts) = volts {
            // Writing to a string does not fail.
            let _ = writeln!(text, "{start_s},{volts}");
        }
    }
    text
}

fn read(path: &Path, column: &'static str) -> Result<Vec<(f64, f64)>, PipelineError> {
    let text = fs::read_text(path).map_err(failed(path, "reading"))?;
    parse(&text, column).map_err(|(line, found, needed)| PipelineError::DriveFile {
        path: path.to_owned(),
        place: format!("line {line}"),
        found,
        needed,
    })
}

type Refused = (usize, String, &'static str);

fn parse(text: &str, column: &'static str) -> Result<Vec<(f64, f64)>, Refused> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut lines = text
        .lines()
        .enumerate()
        .map(|(at, line)| (at + 1, line.trim()))
        .filter(|(_, line)| !line.is_empty() && !line.starts_with('#'));
    let needed = match column {
        "voltage_v" => "a header with the columns time_s and voltage_v",
        "relative_humidity_percent" => "a header with the columns time_s and relative_humidity_percent",
        _ => "a header with the columns time_s and tip_displacement_mm",
    };
    let (first, header) = lines.next().ok_or((1, "no line".to_owned(), needed))?;
    let names: Vec<&str> = fields(header).collect();
    let place = |name: &str| names.iter().position(|found| *found == name);
    let (time, value) = place("time_s")
        .zip(place(column))
        .ok_or((first, format!("{header:?}"), needed))?;
    let mut rows: Vec<(f64, f64)> = Vec::new();
    for (at, line) in lines {
        let cells: Vec<&str> = fields(line).collect();
        let number = |place: usize| cells.get(place).and_then(|cell| cell.parse().ok());
        let finite = number(time)
            .zip(number(value))
            .filter(|(t, v): &(f64, f64)| t.is_finite() && v.is_finite());
        let row = finite.ok_or((
            at,
            format!("{line:?}"),
            "numbers with a decimal point in both columns",
        ))?;
        if rows.last().is_some_and(|before| before.0 >= row.0) {
            return Err((at, format!("time {} s", row.0), "times that increase"));
        }
        rows.push(row);
    }
    if rows.is_empty() {
        Err((first, "no row of numbers".to_owned(), "at least one row"))
    } else {
        Ok(rows)
    }
}

fn fields(line: &str) -> impl Iterator<Item = &str> {
    line.split([',', ';', '\t'])
        .map(|field| field.trim().trim_matches('"'))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_drive_that_is_written_is_read_back() {
        let text = "# of today\nvoltage_v;time_s\n1.5;0\n-0.25;12.5\n";
        let rows = parse(text, "voltage_v").unwrap();
        assert_eq!(rows, [(0.0, 1.5), (12.5, -0.25)]);
        let drive = Drive::of_levels(0.0, rows.iter().map(|row| (row.0, Some(row.1))));
        assert_eq!(parse(&write_drive(&drive), "voltage_v").unwrap(), rows);
    }

    #[test]
    fn other_tables_are_refused_with_their_line() {
        for (text, line) in [
            ("", 1),
            ("time_s,current_a\n0,1", 1),
            ("time_s,voltage_v\n", 1),
            ("time_s,voltage_v\n0,1\n0,2", 3),
            ("time_s,voltage_v\n0,one", 2),
            ("time_s,voltage_v\n0", 2),
            ("time_s,voltage_v\n0,inf", 2),
        ] {
            assert_eq!(parse(text, "voltage_v").unwrap_err().0, line, "{text:?}");
        }
    }
}
