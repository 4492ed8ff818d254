//! Tests of run sheets: what is read, what is refused, and where.

use proptest::prelude::*;

use super::*;
use crate::formats::sheet_writer::{Xml, merged_workbook, sheet};

const SHEET: &str = "planned,file,sample,environment,voltage_v,drive,why,operator\n\
    P01,P01-S1-air-1200mV,S1,air,1.20,\"hold 1.20 V for 600 s, then 0.00 V for 600 s\",tells a from b,\n\
    P02,P02-S1-air-2500mV,S1,air,2.5,hold 2.50 V for 600 s,\"said \"\"so\"\"\",MK\n";

#[test]
fn a_row_tags_the_file_of_its_name() {
    let rows = read(SHEET.as_bytes()).unwrap();
    assert_eq!(rows.len(), 2);
    assert_eq!(rows[0].tag("voltage_v"), Some("1.2"));
    assert_eq!(rows[0].tag("planned"), Some("P01"));
    assert_eq!(rows[0].tag("operator"), None);
    assert_eq!(rows[1].tag("operator"), Some("MK"));
    assert_eq!(rows[1].said("why"), "said \"so\"");
    assert!(rows.iter().all(|row| row.tag("drive").is_none()));
    let sheets = RunSheets {
        sheets: vec![RunSheet {
            path: "runs/a.run-sheet.csv".to_owned(),
            rows,
        }],
        ..RunSheets::default()
    };
    let tags = sheets.tags_of("P02-S1-air-2500mV");
    assert!(tags.iter().all(|tag| tag.source == TagSource::RunSheet));
    assert_eq!(tags[0].detail, "runs/a.run-sheet.csv, P02");
    assert!(sheets.tags_of("P02").is_empty());
}

#[test]
fn what_a_spreadsheet_saves_is_read() {
    let text = "\u{feff}Planned;File;voltage_v;drive\r\nP01;a;1,25;hold\r\n;;;\r\n";
    let rows = read(text.as_bytes()).unwrap();
    assert_eq!(rows.len(), 1);
    assert_eq!(rows[0].tag("voltage_v"), Some("1.25"));
    let wide: Vec<u8> = "planned\tfile\nP01\ta\n"
        .encode_utf16()
        .flat_map(u16::to_le_bytes)
        .collect();
    assert_eq!(
        read(&[&[0xff, 0xfe], wide.as_slice()].concat()).unwrap()[0].file,
        "a"
    );
}

#[test]
fn a_fault_has_its_place_and_its_mend() {
    for (text, place, found) in [
        ("file,drive\na,hold\n", "line 1", "planned and file"),
        ("planned,file\nP01,\n", "line 2, column file", "empty"),
        ("planned,file\nP01,a\nP02,a\n", "line 3", "on line 2 already"),
        ("planned,file\nP01,a\nP01,b\n", "line 3", "the planned id"),
        (
            "planned,file\nP01,runs/a\n",
            "line 2, column file",
            "no name of a file",
        ),
        (
            "planned,file,voltage_v\nP01,a,two\n",
            "line 2, column voltage_v",
            "no number",
        ),
        (
            "planned,file,voltage_v\nP01,a,1,2\n",
            "line 2",
            "beyond the 3 columns",
        ),
        ("planned,file,file\nP01,a,b\n", "line 1", "stands twice"),
        ("planned,file,why\nP01,a,\"cut o", "", "never closed"),
    ] {
        let issue = read(text.as_bytes()).unwrap_err();
        assert_eq!(
            (issue.code.as_str(), issue.place.as_str()),
            (IS_DAMAGED, place),
            "{text}"
        );
        assert!(
            issue.message.contains(found) && !issue.mend.is_empty(),
            "{issue:?}"
        );
    }
}

#[test]
fn sheets_are_told_by_name_or_columns() {
    assert!(is_sheet("run-sheet.csv", b""));
    assert!(is_sheet("2026-11.RUN-SHEET.csv", b"\0"));
    assert!(is_sheet("next.csv", SHEET.as_bytes()));
    assert!(!is_sheet("next.dta", SHEET.as_bytes()));
    assert!(!is_sheet("a.csv", b"time_s,current_a\n0,1\n"));
}

proptest! {
    #[test]
    fn any_bytes_are_a_sheet_or_are_refused(bytes in proptest::collection::vec(any::<u8>(), 0..300)) {
        if let Err(issue) = read(&bytes) {
            prop_assert_eq!(issue.code, IS_DAMAGED);
        }
    }

    #[test]
    fn damage_to_a_sheet_never_gives_a_number_that_is_none(at in 0..SHEET.len(), byte in any::<u8>()) {
        let mut bytes = SHEET.as_bytes().to_vec();
        bytes[at] = byte;
        if let Ok(rows) = read(&bytes) {
            for row in rows {
                prop_assert!(!row.planned.is_empty() && !row.file.is_empty());
                if let Some(volts) = row.tag("voltage_v") {
                    prop_assert!(volts.parse::<f64>().unwrap().is_finite());
                }
            }
        }
    }
}

#[test]
fn a_workbook_of_a_laboratory_with_titles_and_merged_cells_is_a_run_sheet() {
    use Xml::{None as Gap, Number, Text};
    let rows = sheet(&[
        &[Text("Campagne mars 2026"), Gap, Gap, Gap, Gap, Gap],
        &[
            Text("N°"),
            Text("Échantillon"),
            Text("Atmosphère"),
            Text("HR (%)"),
            Text("Tension (mV)"),
            Text("Fichier"),
        ],
        &[
            Number(1.0),
            Text("PtNaf-1"),
            Text("vide"),
            Number(0.0),
            Number(2000.0),
            Text("m0001.txt"),
        ],
        &[Number(2.0), Gap, Gap, Gap, Text("-2000"), Text("m0002.txt")],
        &[
            Number(3.0),
            Gap,
            Text("air"),
            Number(35.5),
            Text("+1000"),
            Text("pot/m0003.txt"),
        ],
        &[Text("pause"), Gap, Gap, Gap, Gap, Gap],
    ]);
    let bytes = merged_workbook(&[rows], "A1:F1 B3:B5 C3:C4 D3:D4");
    assert!(is_sheet("Feuille de route.xlsx", &bytes));
    let found = laboratory::rewritten(&bytes).unwrap();
    assert_eq!((found.unused, found.nameless), (vec!["N°".to_owned()], 1));
    let rows = read(&bytes).unwrap();
    let keys = ["sample", "environment", "relative_humidity_percent", "voltage_v"];
    let shown = rows.iter().map(|row| {
        let tags = keys.map(|key| row.tag(key).unwrap_or("-"));
        format!("{} {}", row.file, tags.join(" "))
    });
    assert_eq!(
        shown.collect::<Vec<_>>(),
        [
            "m0001 PtNaf-1 vide 0 2",
            "m0002 PtNaf-1 vide 0 -2",
            "m0003 PtNaf-1 air 35.5 1",
        ]
    );
}

#[test]
fn sizes_of_strips_stand_in_a_tab_of_their_own() {
    use Xml::{None as Gap, Number, Text};
    let runs = sheet(&[
        &[Text("样品"), Text("数据文件"), Gap, Text("电压 (V)")],
        &[Gap, Text("电流"), Text("位移"), Gap],
        &[Text("N1"), Text("a.txt"), Text("N1-01.csv"), Number(2.0)],
        &[Text("N2"), Text("b.txt"), Text("N2-01.csv"), Number(1.0)],
    ]);
    let sizes = sheet(&[
        &[Text("样品尺寸表"), Gap, Gap, Gap],
        &[
            Text("样品"),
            Text("自由长度 (cm)"),
            Text("宽度 (mm)"),
            Text("厚度 (µm)"),
        ],
        &[Text("N1"), Number(1.25), Number(2.0), Number(180.0)],
        &[Text("N2"), Text("1.3 cm"), Gap, Gap],
    ]);
    let bytes = merged_workbook(&[runs, sizes], "B1:C1");
    assert!(is_sheet("实验记录.xlsx", &bytes));
    let found = sizes_of(&bytes);
    let shown: Vec<String> = found
        .iter()
        .map(|size| format!("{} {:?}", size.sample, size.sizes_mm))
        .collect();
    assert_eq!(
        shown,
        [
            r#"N1 [("length_mm", 12.5), ("width_mm", 2.0), ("thickness_mm", 0.18)]"#,
            r#"N2 [("length_mm", 13.0)]"#
        ]
    );
    // Of two lengths nobody says which is the free one.
    let text = "sample;length (mm);free length (mm);width (mm)\nS1;12;10;2\n";
    assert_eq!(sizes_of(text.as_bytes())[0].sizes_mm, [("width_mm", 2.0)]);
}

#[test]
fn a_text_of_a_laboratory_is_one_and_a_table_of_readings_is_none() {
    let text = "Datei;Probe;Umgebung;%rF;U [V]\r\na_2.5V;S1;Luft;35,5;2,5\r\n";
    assert!(is_sheet("Messplan.csv", text.as_bytes()));
    let rows = read(text.as_bytes()).unwrap();
    assert_eq!(
        (rows[0].file.as_str(), rows[0].tag("voltage_v")),
        ("a_2.5V", Some("2.5"))
    );
    assert_eq!(rows[0].tag("relative_humidity_percent"), Some("35.5"));
    assert!(!is_sheet("a.csv", b"Zeit;Probe;U [V]\n0;1;2\n"));
    // A plan of which little was measured yet is one all the same; a logger's event is no file, however often it stands there.
    let to_come = "1;S2;Luft;\n2;S3;Luft;\n3;S4;Luft;\n4;S5;Luft;\n";
    for (file, is_one) in [("lauf-7", true), ("ende", false)] {
        let plan = format!("Nr;Probe;Umgebung;Datei\n0;S1;Luft;{file}\n{to_come}");
        assert_eq!(is_sheet("Messplan.csv", plan.as_bytes()), is_one, "{file}");
    }
    for event in ["Logged", "LD0029.CSV", "LD{k}.CSV"] {
        let end = |k: usize| {
            if k % 4 == 3 {
                event.replace("{k}", &k.to_string())
            } else {
                String::new()
            }
        };
        let rows: String = (0..16).map(|k| format!("{k};{};{}\n", 35 + k, end(k))).collect();
        let log = format!("Nr;rF (%);Datei\n{rows}");
        assert!(!is_sheet("log.csv", log.as_bytes()), "{event}");
    }
    let log = "Plot Title: a\n#,\"Date Time, GMT+02:00\",\"RH, %\",End Of File\n1,05/17/26 10:00:00 AM,41.5,Logged\n";
    assert!(!is_sheet("log.csv", log.as_bytes()));
}
