//! Files that are made to cost more than they are: containers that lead back into themselves, and small files that unpack to
//! much or declare much.

use std::io::{Cursor, Write};

use flate2::Compression;
use flate2::write::{GzEncoder, ZlibEncoder};
use zip::write::SimpleFileOptions;

use crate::samples;

/// Files of little that lead back into themselves, or declare much: name and bytes of each.
pub fn small() -> Vec<(String, Vec<u8>)> {
    let mut all = compound_files();
    all.extend(packed(declaring_workbooks()));
    all.push(("wide.png".to_owned(), png(40_000, 2)));
    all
}

/// Small files that unpack to much.
pub fn large() -> Vec<(String, Vec<u8>)> {
    let mut all = packed(large_workbooks());
    let inner = zipped(&[("xl/a.xml", vec![b' '; 100 << 20])]);
    all.push(("nested.xlsx".to_owned(), zipped(&[("xl/inner.zip", inner)])));
    all.extend(packed_texts());
    all.extend(matlab_files());
    all.push(("flat.png".to_owned(), png(6900, 6900)));
    all.push(("equal.parquet".to_owned(), equal_parquet(1 << 20, 40)));
    all
}

/// Small whole pictures, to be made worse.
pub fn pictures() -> Vec<(String, Vec<u8>)> {
    vec![("frame.png".to_owned(), png(24, 16))]
}

/// An .xls with each number that leads on leading to each sector, the folder's links among entries, and both of a larger one.
fn compound_files() -> Vec<(String, Vec<u8>)> {
    let small = samples::xls(&[samples::RUN]);
    let mut long = small.clone();
    long.resize(95 << 10, 0);
    let sectors = (small.len() / 512) as u32;
    let mut found = Vec::new();
    let mut with = |name: String, whole: &[u8], changes: &[(usize, u32)]| {
        let mut file = whole.to_vec();
        for (at, word) in changes {
            file[*at..*at + 4].copy_from_slice(&word.to_le_bytes());
        }
        found.push((name, file));
    };
    // Starts of the folder, of the small table and of the list of tables, with a length where one is declared.
    for (name, at, length) in [("folder", 48, 44), ("small", 60, 64), ("list", 68, 72)] {
        for to in [0, 1, 2, sectors, 0x7FFF_FFFF] {
            with(
                format!("start.{name}.{to}.xls"),
                &small,
                &[(at, to), (length, 1 << 20)],
            );
        }
    }
    // The chains of the folder and of the stream, and of the file of 95 kB.
    for at in 0..4usize {
        for to in 0..4 {
            with(format!("chain.{at}.{to}.xls"), &small, &[(512 + 4 * at, to)]);
            with(format!("chain.{at}.{to}.long.xls"), &long, &[(512 + 4 * at, to)]);
        }
    }
    // The table names itself over and over.
    let over: Vec<(usize, u32)> = (76..512).step_by(4).map(|at| (at, 0)).collect();
    with("tables.xls".to_owned(), &small, &over);
    // The tree of the folder.
    for at in [68, 72, 76] {
        with(
            format!("tree.{at}.xls"),
            &small,
            &[(1024 + at, 0), (1024 + 128 + at, 1)],
        );
    }
    // As a protected .xlsx is: the folder that loops was followed on the look for a password.
    let mut protected = samples::xls(&[samples::RUN]);
    protected[512 + 4..512 + 8].copy_from_slice(&1u32.to_le_bytes());
    found.push(("protected.xlsx".to_owned(), protected));
    found
}

const MAIN: &str = "http://schemas.openxmlformats.org/spreadsheetml/2006/main";
const RELATIONS: &str = "http://schemas.openxmlformats.org/officeDocument/2006/relationships";
const PACKAGE: &str = "http://schemas.openxmlformats.org/package/2006/relationships";

/// What of a workbook is other than in a plain one.
#[derive(Default)]
struct Book {
    /// Inside the list of sheets; one sheet where it is empty.
    sheets: String,
    /// The sheet; a small run where it is empty.
    sheet: String,
    styles: String,
    shared: String,
    /// A part that nobody reads.
    other: Vec<u8>,
}

impl Book {
    fn packed(&self) -> Vec<u8> {
        let or = |text: &String, other: &str| {
            if text.is_empty() {
                other.to_owned()
            } else {
                text.clone()
            }
        };
        let sheets = or(&self.sheets, r#"<sheet name="a" sheetId="1" r:id="r1"/>"#);
        let book =
            format!(r#"<workbook xmlns="{MAIN}" xmlns:r="{RELATIONS}"><sheets>{sheets}</sheets></workbook>"#);
        let relation = |kind: &str, target: &str| {
            format!(
                r#"<Relationships xmlns="{PACKAGE}"><Relationship Id="r1" Type="{RELATIONS}/{kind}" Target="{target}"/></Relationships>"#
            )
        };
        let parts = [
            ("[Content_Types].xml", b"<Types/>".to_vec()),
            (
                "_rels/.rels",
                relation("officeDocument", "xl/workbook.xml").into_bytes(),
            ),
            ("xl/workbook.xml", book.into_bytes()),
            (
                "xl/_rels/workbook.xml.rels",
                relation("worksheet", "worksheets/sheet1.xml").into_bytes(),
            ),
            (
                "xl/worksheets/sheet1.xml",
                or(&self.sheet, &samples::sheet_xml(samples::RUN.1)).into_bytes(),
            ),
            (
                "xl/styles.xml",
                or(&self.styles, "<styleSheet></styleSheet>").into_bytes(),
            ),
            (
                "xl/sharedStrings.xml",
                or(&self.shared, "<sst></sst>").into_bytes(),
            ),
            ("xl/media/image1.bin", self.other.clone()),
        ];
        zipped(&parts)
    }
}

fn zipped(parts: &[(&str, Vec<u8>)]) -> Vec<u8> {
    let mut archive = zip::ZipWriter::new(Cursor::new(Vec::new()));
    let options = SimpleFileOptions::default().compression_method(zip::CompressionMethod::Deflated);
    for (name, part) in parts {
        archive.start_file(*name, options).unwrap();
        archive.write_all(part).unwrap();
    }
    archive.finish().unwrap().into_inner()
}

fn sheet_of(inside: &str) -> String {
    format!(r#"<worksheet xmlns="{MAIN}"><sheetData>{inside}</sheetData></worksheet>"#)
}

fn packed(books: Vec<(&str, Book)>) -> Vec<(String, Vec<u8>)> {
    let of = |(name, book): (&str, Book)| (format!("{name}.xlsx"), book.packed());
    books.into_iter().map(of).collect()
}

/// That many sheets, which are one part.
fn sheets(count: usize) -> String {
    let named = |k: usize| format!(r#"<sheet name="s{k}" sheetId="{k}" r:id="r1"/>"#);
    (1..=count).map(named).collect()
}

/// A workbook with this sheet.
fn sheet(inside: &str) -> Book {
    Book {
        sheet: sheet_of(inside),
        ..Book::default()
    }
}

fn declaring_workbooks() -> Vec<(&'static str, Book)> {
    let cell = |row: u32, column: &str, inside: &str| {
        format!(r#"<row r="{row}"><c r="{column}{row}">{inside}</c></row>"#)
    };
    let (value, formula) = ("<v>1</v>", "<f>B1</f>");
    let far = |inside: &str| sheet(&(cell(1_048_576, "XFD", inside) + &cell(1, "A", inside)));
    let shared = r#"<f t="shared" si="4000000000" ref="A1:A2">B1</f><v>1</v>"#;
    vec![
        (
            "many_sheets",
            Book {
                sheets: sheets(100_000),
                ..Book::default()
            },
        ),
        ("far_cells", far(value)),
        ("far_formulas", far(formula)),
        ("shared_formula", sheet(&cell(1, "A", shared))),
        (
            "declared_texts",
            Book {
                shared: r#"<sst uniqueCount="1000000000000"></sst>"#.to_owned(),
                ..Book::default()
            },
        ),
    ]
}

fn large_workbooks() -> Vec<(&'static str, Book)> {
    let cells = |inside: &str, rows: usize| format!("<row>{}</row>", inside.repeat(50)).repeat(rows);
    let turned = r#"<row r="1"><c r="A1"><v>1</v></c></row><row r="2"><c r="A2"><v>1</v></c></row>"#;
    let list = |texts: String| format!("<sst>{texts}</sst>");
    let styles = |inside: String| format!("<styleSheet>{inside}</styleSheet>");
    let text = "x".repeat(30_000);
    let font = format!(
        r#"<fonts><font><name val="{}"/></font></fonts>"#,
        "x".repeat(1 << 20)
    );
    let formats = |format: &str, count: usize| format!("<cellXfs>{}</cellXfs>", format.repeat(count));
    let plain = Book::default;
    vec![
        (
            "one_part_for_all",
            Book {
                sheets: sheets(1000),
                ..sheet(&"<row/>".repeat(1 << 20))
            },
        ),
        (
            "cells_for_all",
            Book {
                sheets: sheets(1000),
                ..sheet(&cells("<c><v>1</v></c>", 1000))
            },
        ),
        ("many_cells", sheet(&cells("<c><v>1</v></c>", 80_000))),
        ("rows_out_of_order", sheet(&turned.repeat(600_000))),
        ("deep", sheet(&"<a>".repeat(20_000_000))),
        (
            "many_texts",
            Book {
                shared: list("<si/>".repeat(12_000_000)),
                ..plain()
            },
        ),
        (
            "long_text",
            Book {
                shared: list(format!("<si><t>{}</t></si>", "x".repeat(60 << 20))),
                ..plain()
            },
        ),
        (
            "one_text_for_all",
            Book {
                shared: list(format!("<si><t>{text}</t></si>")),
                ..sheet(&cells(r#"<c t="s"><v>0</v></c>"#, 10_000))
            },
        ),
        (
            "formats",
            Book {
                styles: styles(formats("<xf/>", 12_000_000)),
                ..plain()
            },
        ),
        (
            "copied_font",
            Book {
                styles: styles(font + &formats(r#"<xf fontId="0"/>"#, 60_000)),
                ..plain()
            },
        ),
        (
            "bomb",
            Book {
                other: vec![0; 200 << 20],
                ..plain()
            },
        ),
    ]
}

fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut writer = GzEncoder::new(Vec::new(), Compression::fast());
    writer.write_all(bytes).unwrap();
    writer.finish().unwrap()
}

fn packed_texts() -> Vec<(String, Vec<u8>)> {
    let table = |rows: usize| {
        let rows: String = (0..rows).map(|k| format!("{k},2,0.5,0.25\n")).collect();
        format!("time_s,voltage_v,current_a,curvature_per_cm\n{rows}").into_bytes()
    };
    let blank = gzip(&vec![b' '; 200 << 20]);
    vec![
        ("blank.csv.gz".to_owned(), blank.clone()),
        ("within.csv.gz".to_owned(), gzip(&table(2_700_000))),
        ("lines.csv.gz".to_owned(), gzip(&vec![b'\n'; 60 << 20])),
        (
            "commas.csv.gz".to_owned(),
            gzip(&[b"time_s,current_a\n".to_vec(), vec![b','; 60 << 20]].concat()),
        ),
        ("twice.csv.gz.gz".to_owned(), gzip(&blank)),
        (
            "workbook.xlsx.gz".to_owned(),
            gzip(
                &Book {
                    other: vec![0; 200 << 20],
                    ..Book::default()
                }
                .packed(),
            ),
        ),
    ]
}

/// An element of a .mat file.
fn element(kind: u32, data: &[u8]) -> Vec<u8> {
    let mut element = [kind.to_le_bytes(), (data.len() as u32).to_le_bytes()].concat();
    element.extend_from_slice(data);
    element.resize(element.len().next_multiple_of(8), 0);
    element
}

/// An array of that class and size, named `x`, around its data.
fn array(class: u32, dimensions: [u32; 2], data: &[u8]) -> Vec<u8> {
    let parts = [
        element(6, &[class.to_le_bytes(), [0; 4]].concat()),
        element(5, &dimensions.map(u32::to_le_bytes).concat()),
        element(1, b"x"),
        data.to_vec(),
    ];
    element(14, &parts.concat())
}

fn matlab_files() -> Vec<(String, Vec<u8>)> {
    let head = || {
        let mut head = b"MATLAB 5.0 MAT-file".to_vec();
        head.resize(124, b' ');
        head.extend([0, 1, b'I', b'M']);
        head
    };
    let packed = |content: &[u8]| {
        let mut writer = ZlibEncoder::new(Vec::new(), Compression::fast());
        writer.write_all(content).unwrap();
        let packed = writer.finish().unwrap();
        [15u32.to_le_bytes(), (packed.len() as u32).to_le_bytes()]
            .concat()
            .into_iter()
            .chain(packed)
            .collect::<Vec<u8>>()
    };
    let (large, count) = (60 << 20, 60u32 << 20);
    let numbers = packed(&array(6, [count, 1], &element(2, &vec![1; large])));
    let texts = packed(&array(4, [count, 1], &element(16, &vec![b'a'; large])));
    let widths = element(5, &1u32.to_le_bytes());
    let fields = packed(&array(
        2,
        [1, 1],
        &[widths, element(1, &vec![b'a'; large])].concat(),
    ));
    let bomb = packed(&vec![0; 200 << 20]);
    let nameless = packed(&element(
        14,
        &[
            element(6, &[0; 8]),
            element(5, &[0; 8]),
            element(1, b""),
            element(2, &vec![0; large]),
        ]
        .concat(),
    ));
    [
        ("numbers.mat", numbers),
        ("texts.mat", texts),
        ("fields.mat", fields),
        ("bomb.mat", bomb),
        ("over_and_over.mat", nameless.repeat(20)),
    ]
    .into_iter()
    .map(|(name, body)| (name.to_owned(), [head(), body].concat()))
    .collect()
}

fn png(width: u32, height: u32) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    let mut writer = encoder.write_header().unwrap();
    writer
        .write_image_data(&vec![0; (width * height * 4) as usize])
        .unwrap();
    writer.finish().unwrap();
    bytes
}

/// Columns of equal numbers, which pack to nothing.
fn equal_parquet(rows: usize, columns: usize) -> Vec<u8> {
    use polars::prelude::{Column, DataFrame, NamedFrom, Series};
    let columns: Vec<Column> = (0..columns)
        .map(|k| Series::new(format!("current_{k}_a").into(), vec![1.0; rows]).into())
        .collect();
    let mut bytes = Vec::new();
    let mut frame = DataFrame::new(rows, columns).unwrap();
    polars_io::parquet::write::ParquetWriter::new(&mut bytes)
        .finish(&mut frame)
        .unwrap();
    bytes
}
