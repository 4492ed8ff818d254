//! Writes small workbooks cell by cell, for tests.

use std::fmt::Write as _;
use std::io::{Cursor, Write as _};

use Xml::{Date, Duration, Formula, None as Gap, Number, Percent, Text};
use zip::ZipWriter;
use zip::write::SimpleFileOptions;

/// One cell as it stands in the sheet's XML.
#[derive(Clone, Copy)]
pub enum Xml<'a> {
    /// A text.
    Text(&'a str),
    /// A number.
    Number(f64),
    /// A date, days since 1899-12-30.
    Date(f64),
    /// A duration shown as `[hh]:mm:ss`, days.
    Duration(f64),
    /// A number shown as `0.0%`.
    Percent(f64),
    /// A formula that no program has computed.
    Formula(&'a str),
    /// No cell.
    None,
}

/// The XML of the rows of a sheet.
pub fn sheet(rows: &[&[Xml<'_>]]) -> String {
    let mut xml = String::new();
    for (row, cells) in rows.iter().enumerate() {
        let number = row + 1;
        let _ = write!(xml, r#"<row r="{number}">"#);
        for (column, cell) in cells.iter().enumerate() {
            let place = format!("{}{number}", (b'A' + column as u8) as char);
            let _ = match cell {
                Text(text) => write!(xml, r#"<c r="{place}" t="inlineStr"><is><t>{text}</t></is></c>"#),
                Number(number) => write!(xml, r#"<c r="{place}"><v>{number}</v></c>"#),
                Date(days) => write!(xml, r#"<c r="{place}" s="1"><v>{days}</v></c>"#),
                Duration(days) => write!(xml, r#"<c r="{place}" s="2"><v>{days}</v></c>"#),
                Percent(number) => write!(xml, r#"<c r="{place}" s="3"><v>{number}</v></c>"#),
                Formula(text) => write!(xml, r#"<c r="{place}"><f>{text}</f><v/></c>"#),
                Gap => Ok(()),
            };
        }
        xml.push_str("</row>");
    }
    xml
}

/// A workbook with one sheet for each of `sheets`, the XML of their rows.
pub fn workbook(sheets: &[String]) -> Vec<u8> {
    merged_workbook(sheets, "")
}

/// The same with merged cells in every sheet: their ranges with blanks between them, `A1:F1 B3:B5`.
pub fn merged_workbook(sheets: &[String], merged: &str) -> Vec<u8> {
    const MAIN: &str = "http://schemas.openxmlformats.org/spreadsheetml/2006/main";
    const RELATIONS: &str = "http://schemas.openxmlformats.org/officeDocument/2006/relationships";
    const PACKAGE: &str = "http://schemas.openxmlformats.org/package/2006/relationships";
    let mut names = String::new();
    let mut parts = String::new();
    for k in 1..=sheets.len() {
        let _ = write!(names, r#"<sheet name="Run {k}" sheetId="{k}" r:id="rId{k}"/>"#);
        let _ = write!(
            parts,
            r#"<Relationship Id="rId{k}" Type="{RELATIONS}/worksheet" Target="worksheets/sheet{k}.xml"/>"#
        );
    }
    let styles = format!(
        r#"<styleSheet xmlns="{MAIN}"><numFmts count="3"><numFmt numFmtId="164" formatCode="[hh]:mm:ss"/><numFmt numFmtId="165" formatCode="0.0%"/><numFmt numFmtId="166" formatCode="0.0&quot; %&quot;"/></numFmts><cellXfs><xf numFmtId="0"/><xf numFmtId="14"/><xf numFmtId="164"/><xf numFmtId="165"/><xf numFmtId="166"/></cellXfs></styleSheet>"#
    );
    let mut members = vec![
        ("[Content_Types].xml".to_owned(), "<Types/>".to_owned()),
        (
            "_rels/.rels".to_owned(),
            format!(
                r#"<Relationships xmlns="{PACKAGE}"><Relationship Id="rId1" Type="{RELATIONS}/officeDocument" Target="xl/workbook.xml"/></Relationships>"#
            ),
        ),
        (
            "xl/workbook.xml".to_owned(),
            format!(r#"<workbook xmlns="{MAIN}" xmlns:r="{RELATIONS}"><sheets>{names}</sheets></workbook>"#),
        ),
        (
            "xl/_rels/workbook.xml.rels".to_owned(),
            format!(r#"<Relationships xmlns="{PACKAGE}">{parts}</Relationships>"#),
        ),
        ("xl/styles.xml".to_owned(), styles),
    ];
    let ranges: Vec<&str> = merged.split_whitespace().collect();
    let cells: String = ranges
        .iter()
        .map(|range| format!(r#"<mergeCell ref="{range}"/>"#))
        .collect();
    let merges = if ranges.is_empty() {
        String::new()
    } else {
        format!(r#"<mergeCells count="{}">{cells}</mergeCells>"#, ranges.len())
    };
    for (index, rows) in sheets.iter().enumerate() {
        members.push((
            format!("xl/worksheets/sheet{}.xml", index + 1),
            format!(r#"<worksheet xmlns="{MAIN}"><sheetData>{rows}</sheetData>{merges}</worksheet>"#),
        ));
    }
    let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, content) in members {
        writer.start_file(name, SimpleFileOptions::default()).unwrap();
        writer.write_all(content.as_bytes()).unwrap();
    }
    writer.finish().unwrap().into_inner()
}
