//! Small whole files of the formats that cannot be typed by hand: workbooks of both kinds, and Parquet.

use std::io::{Cursor, Write};

/// A sheet: its name, and rows of cells. What parses as a number is one, an empty text is no cell.
pub type Sheet<'a> = (&'a str, &'a [&'a [&'a str]]);

/// One sample for each of these formats: format id, file name, bytes.
pub fn made() -> Vec<(&'static str, &'static str, Vec<u8>)> {
    vec![
        ("spreadsheet", "run.xlsx", xlsx(&[RUN])),
        ("spreadsheet", "run.xls", xls(&[RUN])),
        ("eplexor-xls", "sweep.xls", xls(&[SETTINGS, READINGS])),
        ("spreadsheet", "log.xlsx", xlsx(&[LOG])),
        ("spreadsheet", "log.xls", xls(&[LOG])),
        ("parquet", "run.parquet", parquet()),
        ("parquet", "encodings.parquet", parquet_encodings()),
    ]
}

/// A run.
pub const RUN: Sheet<'_> = (
    "Run 1",
    &[
        &["Time (s)", "Voltage (V)", "Current (mA)", "note"],
        &["-0.5", "0", "0.0125", ""],
        &["0", "2.5", "12.75", "step"],
        &["0.5", "2.5", "-3.25", ""],
        &["1", "2.5", "1.125", ""],
    ],
);
const SETTINGS: Sheet<'_> = (
    "Data header",
    &[&["Measurement type:", "Time Sweep"], &["Limits:", "100", "50"]],
);
const READINGS: Sheet<'_> = (
    "Exported Data",
    &[
        &["Nr", "Time", "f", "T", "E'", "E''", "|E*|", "tan delta"],
        &["", "s", "Hz", "\u{b0}C", "MPa", "MPa", "MPa", ""],
        &["1", "0.5", "1", "23.25", "60.5", "11.25", "61.537", "0.18595"],
        &["2", "30.5", "1", "23.5", "50.25", "9.125", "51.072", "0.18159"],
        &["3", "60.5", "1", "23.75", "48.75", "8.875", "49.551", "0.18205"],
    ],
);
const LOG: Sheet<'_> = (
    "Logger",
    &[
        &["Serial number", "ABC-123"],
        &["Date Time", "Temperature (\u{b0}C)", "Humidity (%RH)"],
        &["2026-03-01 12:00:00", "21.25", "40.125"],
        &["2026-03-01 12:10:00", "21.375", "41.5"],
        &["2026-03-01 12:20:00", "21.5", "42.75"],
    ],
);

/// Rows of cells as the XML that an .xlsx holds.
pub fn sheet_xml(rows: &[&[&str]]) -> String {
    let mut xml = String::from(
        r#"<worksheet xmlns="http://schemas.openxmlformats.org/spreadsheetml/2006/main"><sheetData>"#,
    );
    for (row, cells) in rows.iter().enumerate() {
        xml += &format!("<row r=\"{}\">", row + 1);
        for (column, text) in cells.iter().enumerate().filter(|(_, text)| !text.is_empty()) {
            let place = format!("{}{}", char::from(b'A' + column as u8), row + 1);
            xml += &match text.parse::<f64>() {
                Ok(_) => format!(r#"<c r="{place}"><v>{text}</v></c>"#),
                Err(_) => format!(r#"<c r="{place}" t="inlineStr"><is><t>{text}</t></is></c>"#),
            };
        }
        xml += "</row>\n";
    }
    xml + "</sheetData></worksheet>"
}

/// A workbook with these sheets.
pub fn xlsx(sheets: &[Sheet<'_>]) -> Vec<u8> {
    let parts: Vec<(&str, Vec<u8>)> = sheets
        .iter()
        .map(|(name, rows)| (*name, sheet_xml(rows).into_bytes()))
        .collect();
    workbook(&parts)
}

/// A workbook whose sheets are these XML documents.
pub fn workbook(sheets: &[(&str, Vec<u8>)]) -> Vec<u8> {
    const MAIN: &str = "http://schemas.openxmlformats.org/spreadsheetml/2006/main";
    const RELATIONS: &str = "http://schemas.openxmlformats.org/officeDocument/2006/relationships";
    const PACKAGE: &str = "http://schemas.openxmlformats.org/package/2006";
    let (mut names, mut relations) = (String::new(), String::new());
    for (k, (name, _)) in (1..).zip(sheets) {
        names += &format!(r#"<sheet name="{name}" sheetId="{k}" r:id="r{k}"/>"#);
        relations += &format!(
            r#"<Relationship Id="r{k}" Type="{RELATIONS}/worksheet" Target="worksheets/sheet{k}.xml"/>"#
        );
    }
    let related = |inside: &str| {
        format!(r#"<Relationships xmlns="{PACKAGE}/relationships">{inside}</Relationships>"#).into_bytes()
    };
    let book =
        format!(r#"<Relationship Id="r1" Type="{RELATIONS}/officeDocument" Target="xl/workbook.xml"/>"#);
    let mut parts = vec![
        (
            "[Content_Types].xml".to_owned(),
            format!(r#"<Types xmlns="{PACKAGE}/content-types"/>"#).into_bytes(),
        ),
        ("_rels/.rels".to_owned(), related(&book)),
        (
            "xl/workbook.xml".to_owned(),
            format!(r#"<workbook xmlns="{MAIN}" xmlns:r="{RELATIONS}"><sheets>{names}</sheets></workbook>"#)
                .into_bytes(),
        ),
        ("xl/_rels/workbook.xml.rels".to_owned(), related(&relations)),
    ];
    for (k, (_, sheet)) in (1..).zip(sheets) {
        parts.push((format!("xl/worksheets/sheet{k}.xml"), sheet.clone()));
    }
    let mut archive = zip::ZipWriter::new(Cursor::new(Vec::new()));
    let options = zip::write::SimpleFileOptions::default().compression_method(zip::CompressionMethod::Stored);
    for (name, part) in parts {
        archive
            .start_file(name, options)
            .expect("a part of a workbook begins");
        archive.write_all(&part).expect("a part of a workbook is written");
    }
    archive.finish().expect("a workbook ends").into_inner()
}

/// The same as an .xls: BIFF8 records in a compound file, after Microsoft's [MS-XLS] and [MS-CFB].
pub fn xls(sheets: &[Sheet<'_>]) -> Vec<u8> {
    compound("Workbook", &biff(sheets))
}

fn record(kind: u16, data: &[u8]) -> Vec<u8> {
    [&kind.to_le_bytes()[..], &(data.len() as u16).to_le_bytes(), data].concat()
}

/// One byte a character.
fn latin(text: &str) -> Vec<u8> {
    text.chars().map(|c| c as u8).collect()
}

fn biff(sheets: &[Sheet<'_>]) -> Vec<u8> {
    let begin = |kind: u16| {
        let words = [0x0600, kind, 0x0DBB, 0x07CC, 0, 0, 6, 0];
        record(0x0809, &words.map(u16::to_le_bytes).concat())
    };
    let end = record(0x000A, &[]);
    let body = |rows: &[&[&str]]| {
        let mut body = begin(0x0010);
        for (row, cells) in (0u16..).zip(rows) {
            for (column, text) in (0u16..).zip(*cells).filter(|(_, text)| !text.is_empty()) {
                let place = [row, column, 0].map(u16::to_le_bytes).concat();
                body.extend(match text.parse::<f64>() {
                    Ok(number) => record(0x0203, &[&place[..], &number.to_le_bytes()].concat()),
                    Err(_) => {
                        let text = latin(text);
                        let length = (text.len() as u16).to_le_bytes();
                        record(0x0204, &[&place[..], &length, &[0], &text].concat())
                    }
                });
            }
        }
        body.extend(&end);
        body
    };
    let bodies: Vec<Vec<u8>> = sheets.iter().map(|(_, rows)| body(rows)).collect();
    let entry = |name: &str, at: u32| {
        let name = latin(name);
        record(
            0x0085,
            &[&at.to_le_bytes()[..], &[0, 0, name.len() as u8, 0], &name].concat(),
        )
    };
    let names: usize = sheets.iter().map(|(name, _)| entry(name, 0).len()).sum();
    let mut book = begin(0x0005);
    let mut at = book.len() + names + end.len();
    for ((name, _), body) in sheets.iter().zip(&bodies) {
        book.extend(entry(name, at as u32));
        at += body.len();
    }
    book.extend(&end);
    book.extend(bodies.concat());
    book
}

/// A compound file of one stream: a header, the table of sectors, the folder, the stream's sectors.
fn compound(name: &str, stream: &[u8]) -> Vec<u8> {
    const SECTOR: usize = 512;
    const END: u32 = 0xFFFF_FFFE;
    const FREE: u32 = 0xFFFF_FFFF;
    // Streams of less than 4096 bytes would have to lie elsewhere.
    let sectors = stream.len().max(4096).div_ceil(SECTOR);
    let mut file = vec![0xD0, 0xCF, 0x11, 0xE0, 0xA1, 0xB1, 0x1A, 0xE1];
    file.extend([0; 16]);
    file.extend([0x3E, 3, 0xFFFE, 9, 6].map(u16::to_le_bytes).concat());
    file.extend([0; 6]);
    file.extend(
        [0, 1, 1, 0, 4096, END, 0, END, 0, 0]
            .map(u32::to_le_bytes)
            .concat(),
    );
    file.extend([FREE; 108].map(u32::to_le_bytes).concat());
    let mut table = vec![0xFFFF_FFFD, END];
    table.extend((0..sectors as u32).map(|k| if k + 1 == sectors as u32 { END } else { k + 3 }));
    table.resize(SECTOR / 4, FREE);
    file.extend(table.iter().flat_map(|entry| entry.to_le_bytes()));
    file.extend(folder_entry("Root Entry", 5, 1, END, 0));
    file.extend(folder_entry(name, 2, FREE, 2, (sectors * SECTOR) as u64));
    file.extend([folder_entry("", 0, FREE, 0, 0), folder_entry("", 0, FREE, 0, 0)].concat());
    file.extend(stream);
    file.resize((3 + sectors) * SECTOR, 0);
    file
}

fn folder_entry(name: &str, kind: u8, child: u32, start: u32, size: u64) -> Vec<u8> {
    let mut entry: Vec<u8> = name.encode_utf16().flat_map(u16::to_le_bytes).collect();
    let length = if name.is_empty() {
        0
    } else {
        entry.len() as u16 + 2
    };
    entry.resize(64, 0);
    entry.extend(length.to_le_bytes());
    entry.extend([kind, 1]);
    entry.extend([u32::MAX, u32::MAX, child].map(u32::to_le_bytes).concat());
    entry.extend([0; 36]);
    entry.extend(start.to_le_bytes());
    entry.extend(size.to_le_bytes());
    entry
}

/// A run as Parquet.
pub fn parquet() -> Vec<u8> {
    use polars::prelude::{Column, DataFrame, NamedFrom, Series};
    let columns: Vec<Column> = vec![
        Series::new("Time [s]".into(), [0.0, 0.5, 1.0]).into(),
        Series::new("Current [mA]".into(), [Some(1.5), None, Some(0.5)]).into(),
        Series::new("cycle".into(), [1i64, 1, 2]).into(),
        Series::new("note".into(), ["a", "b", "c"]).into(),
    ];
    let mut bytes = Vec::new();
    let mut frame = DataFrame::new(3, columns).expect("a table");
    polars_io::parquet::write::ParquetWriter::new(&mut bytes)
        .finish(&mut frame)
        .expect("a Parquet file is written");
    bytes
}

/// A run as Parquet without compression, each column in an encoding of its own: damage reaches the decoders.
fn parquet_encodings() -> Vec<u8> {
    use parquet::basic::Encoding;
    use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, Int64Type};
    use parquet::file::properties::{WriterProperties, WriterVersion};
    use parquet::file::writer::SerializedFileWriter;
    use parquet::schema::parser::parse_message_type;

    let schema = "message run { required double time_s; optional double current_a; optional int64 cycle; \
                  optional binary status (STRING); optional binary note (STRING); }";
    let schema = parse_message_type(schema).expect("a schema");
    let encoded = [
        ("time_s", Encoding::BYTE_STREAM_SPLIT),
        ("cycle", Encoding::DELTA_BINARY_PACKED),
        ("status", Encoding::DELTA_BYTE_ARRAY),
    ];
    let properties = encoded.iter().fold(
        WriterProperties::builder().set_writer_version(WriterVersion::PARQUET_2_0),
        |properties, (name, encoding)| {
            let properties = properties.set_column_dictionary_enabled((*name).into(), false);
            properties.set_column_encoding((*name).into(), *encoding)
        },
    );
    let mut bytes = Vec::new();
    let mut file = SerializedFileWriter::new(&mut bytes, schema.into(), properties.build().into())
        .expect("a Parquet file is begun");
    let levels: Vec<i16> = (0..40).map(|row| i16::from(row % 9 != 4)).collect();
    let filled: Vec<usize> = (0..40).filter(|row| row % 9 != 4).collect();
    let texts = |text: &dyn Fn(usize) -> String| -> Vec<ByteArray> {
        filled.iter().map(|&row| text(row).as_str().into()).collect()
    };
    let mut group = file.next_row_group().expect("a row group");
    let mut number = 0;
    while let Some(mut column) = group.next_column().expect("a column") {
        let written = match number {
            0 => {
                let times: Vec<f64> = (0..40).map(|row| f64::from(row) * 0.5).collect();
                column.typed::<DoubleType>().write_batch(&times, None, None)
            }
            1 => {
                let currents: Vec<f64> = filled.iter().map(|&row| (row / 5) as f64 * 1e-3).collect();
                column
                    .typed::<DoubleType>()
                    .write_batch(&currents, Some(&levels), None)
            }
            2 => {
                let cycles: Vec<i64> = filled.iter().map(|&row| row as i64 * 3 - 7).collect();
                column
                    .typed::<Int64Type>()
                    .write_batch(&cycles, Some(&levels), None)
            }
            3 => {
                let statuses = texts(&|row| format!("range {}", row % 3));
                column
                    .typed::<ByteArrayType>()
                    .write_batch(&statuses, Some(&levels), None)
            }
            _ => {
                let notes = texts(&|row| ["a", "b"][row % 2].to_owned());
                column
                    .typed::<ByteArrayType>()
                    .write_batch(&notes, Some(&levels), None)
            }
        };
        written.expect("values are written");
        column.close().expect("a column is ended");
        number += 1;
    }
    group.close().expect("a row group is ended");
    file.close().expect("a file is ended");
    bytes
}
