//! Profiles from their text, what they read, and what goes before what.

use std::path::Path;

use super::{Profile, Reader, StatedColumn, choose, from_text, load, propose, read};
use crate::Reading;
use crate::formats::{ReadContext, ReadError};
use ieap_domain::Quantity;

const LASER: &str = r#"
[profile]
version = 3
title = "laser"

[recognise]
name = "*.csv"

[layout]
separator = "semicolon"
decimal = "comma"
header_contains = "Epoch"

[time]
base = "epoch"
column = "Epoch (ms)"
unit = "ms"

[[column]]
column = "Distance1"
quantity = "tip_displacement"
unit = "mm"
"#;

const LOG: &[u8] =
    b"Sensor;1\r\nEpoch (ms);Distance1;Sum\r\n1728937444032;12,5;1\r\n1728937444532;12,75;2\r\n1728937445032;13;3\r\n";

fn profile(text: &str) -> Profile {
    from_text(Path::new("laser.toml"), text).unwrap()
}

fn read_with(text: &str, name: &str, bytes: &[u8]) -> Reading {
    let profiles = [profile(text)];
    read(&profiles, name, bytes, &ReadContext::default()).unwrap().0
}

fn refusal(text: &str) -> String {
    from_text(Path::new("laser.toml"), text).unwrap_err().to_string()
}

#[test]
fn a_file_is_read_as_its_profile_says() {
    let reading = read_with(LASER, "a.csv", LOG);
    assert_eq!((reading.format, reading.tables[0].rows), ("profile", 3));
    let tip = &reading.tables[0].channels[0];
    assert_eq!(
        (tip.quantity, tip.raw_name.as_str(), tip.raw_unit.as_str()),
        (Quantity::TipDisplacement, "Distance1", "mm")
    );
    assert_eq!(
        (&tip.time_s[..], &tip.values[..]),
        (&[0.0, 0.5, 1.0][..], &[12.5, 12.75, 13.0][..])
    );
    assert_eq!(reading.tables[0].channels[1].quantity, Quantity::Other);
    let start = reading.started_at.unwrap();
    assert_eq!(start.local.as_deref(), Some("2024-10-14T20:24:04.032"));
    assert_eq!(
        (start.offset.as_deref(), start.raw.as_str()),
        (Some("+00:00"), "1728937444032")
    );
}

#[test]
fn a_profile_goes_before_generic_readers_and_after_vendors_unless_it_says_so() {
    let plain = b"time_s;current_a;x\n0;1;2\n1;2;3\n";
    let text = "[profile]\nversion = 1\n[layout]\nseparator = \"semicolon\"\ndecimal = \"point\"\nheader_line = 1\n\
                [time]\nbase = \"elapsed\"\ncolumn = \"time_s\"\nunit = \"min\"\n\
                [[column]]\ncolumn = \"x\"\nquantity = \"current\"\nunit = \"mA\"\n";
    let reading = read_with(text, "a.csv", plain);
    assert_eq!(reading.format, "profile");
    assert_eq!(reading.tables[0].time_first_last_s, Some((0.0, 60.0)));
    let nova = b"Time (s);WE(1).Current (A);x\n0;1;2\n1;2;3\n";
    let text = text.replace("time_s", "Time (s)");
    assert_eq!(read_with(&text, "a.csv", nova).format, "autolab-nova");
    let over = format!("{text}\n[recognise]\nover_vendor = true\n");
    assert_eq!(read_with(&over, "a.csv", nova).format, "profile");
}

#[test]
fn two_profiles_that_fit_are_named() {
    let profiles = [
        profile(LASER),
        Profile {
            id: "other".to_owned(),
            ..profile(LASER)
        },
    ];
    let error = choose(&profiles, "a.csv", LOG).err().unwrap();
    assert!(
        matches!(&error, ReadError::AmbiguousFormat { candidates } if candidates == "profile laser, profile other"),
        "{error}"
    );
    let other_name = choose(&profiles, "a.txt", LOG);
    assert!(!matches!(other_name.map(|c| c.reader), Ok(Reader::Profile(_))));
}

#[test]
fn what_cannot_be_is_refused_with_place_and_need() {
    for (from, to, parts) in [
        (
            "unit = \"ms\"",
            "unit = \"V\"",
            ["[time] unit", "does not measure Time"],
        ),
        (
            "base = \"epoch\"",
            "base = \"epok\"",
            ["line 15, [time] base", "elapsed"],
        ),
        (
            "decimal = \"comma\"",
            "decimal = \",\"",
            ["line 11, [layout] decimal", "\"point\" or \"comma\""],
        ),
        ("decimal", "decimals", ["line 11", "unknown field `decimals`"]),
        (
            "quantity = \"tip_displacement\"",
            "quantity = \"tip\"",
            ["quantity", "tip_displacement, "],
        ),
        (
            "column = \"Distance1\"",
            "column = \"Epoch (ms)\"",
            ["named twice", "one meaning"],
        ),
        (
            "version = 3",
            "version = 0",
            ["[profile] version", "a whole number from 1"],
        ),
        (
            "header_contains = \"Epoch\"",
            "header_line = 0",
            ["given by name", "its number"],
        ),
        (
            "unit = \"ms\"",
            "unit = \"ms\"\nzone = \"UTC\"",
            ["[time] zone", "for that base only"],
        ),
        (
            "[layout]",
            "[layout]\nkind = \"sheet\"",
            ["separator", "workbook"],
        ),
    ] {
        let text = LASER.replacen(from, to, 1);
        let message = refusal(&text);
        assert!(
            parts.iter().all(|part| message.contains(part)) && message.starts_with("laser.toml, "),
            "{to}: {message}"
        );
    }
}

#[test]
fn dates_in_two_columns_pass_a_change_of_the_clocks() {
    let text = "[profile]\nversion = 1\n[layout]\nseparator = \"tab\"\ndecimal = \"comma\"\nheader_line = 1\n\
                [time]\nbase = \"clock\"\ncolumn = \"Zeit\"\ndate_column = \"Datum\"\norder = \"day-first\"\n\
                zone = \"Europe/Tallinn\"\n[[column]]\ncolumn = \"Strom\"\nquantity = \"current\"\nunit = \"mA\"\n";
    let log = b"Datum\tZeit\tStrom\n31.03.2024\t02:59:59\t1,5\n31.03.2024\t04:00:00\t1,6\n";
    let reading = read_with(text, "a.txt", log);
    assert_eq!(reading.tables[0].time_first_last_s, Some((0.0, 1.0)));
    assert_eq!(reading.started_at.unwrap().offset.as_deref(), Some("+02:00"));
    assert_eq!(reading.tables[0].channels[0].values[0], 1.5e-3);
}

#[test]
fn times_of_day_pass_midnight_and_intervals_count() {
    let text = "[profile]\nversion = 1\n[recognise]\nname = \"*.log\"\n[layout]\nseparator = \"comma\"\n\
                decimal = \"point\"\nheader_line = 0\n[time]\nbase = \"time-of-day\"\ncolumn = 1\n\
                [[column]]\ncolumn = 2\nquantity = \"current\"\nunit = \"A\"\nfactor = 2.0\n";
    let reading = read_with(text, "a.log", b"23:59:59,1\n00:00:01,2\n");
    assert_eq!(reading.tables[0].time_first_last_s, Some((0.0, 2.0)));
    assert_eq!(&reading.tables[0].channels[0].values[..], [2.0, 4.0]);
    assert_eq!(reading.issues[0].code, "midnight-passed");
    let text = text.replace(
        "base = \"time-of-day\"\ncolumn = 1",
        "base = \"interval\"\ninterval_s = 0.5",
    );
    let reading = read_with(&text, "a.log", b"0,1\n0,2\n0,3\n");
    assert_eq!(reading.tables[0].time_first_last_s, Some((0.0, 1.0)));
}

#[test]
fn a_start_may_stand_above_the_table() {
    let text = LASER.replace("base = \"epoch\"", "base = \"elapsed\"").replace(
        "[[column]]",
        "[start]\nline_begins = \"Trigger\"\norder = \"year-first\"\nkind = \"end\"\n[[column]]",
    );
    let log = String::from_utf8(LOG.to_vec())
        .unwrap()
        .replace("Sensor;1", "Trigger;2026-05-13 10:20:30");
    let start = read_with(&text, "a.csv", log.as_bytes()).started_at.unwrap();
    assert_eq!(start.local.as_deref(), Some("2026-05-13T10:20:30"));
    assert_eq!(start.kind, crate::Timestamp::End);
}

#[test]
fn a_cut_at_any_byte_never_changes_a_number() {
    let profiles = [profile(LASER)];
    let whole = read_with(LASER, "a.csv", LOG);
    let mut read_so_far = 0;
    for end in 0..LOG.len() {
        if let Ok((cut, Some(_))) = read(&profiles, "a.csv", &LOG[..end], &ReadContext::default()) {
            read_so_far += 1;
            for (cut, whole) in cut.tables[0].channels.iter().zip(&whole.tables[0].channels) {
                assert!(whole.values.starts_with(&cut.values) && whole.time_s.starts_with(&cut.time_s));
            }
        }
    }
    assert!(read_so_far > 20, "{read_so_far}");
}

#[test]
fn proposals_read_the_file_they_were_made_from() {
    let with_names = b"made by hand\nTime (s);I/mA;kappa (1/m)\n0;1,5;0\n0,5;1,25;1\n1;1;2\n";
    for (name, bytes) in [("a.csv", LOG), ("b.csv", with_names.as_slice())] {
        let proposal = propose(name, bytes, &[]).unwrap();
        println!("{}\n{:?}", proposal.text, proposal.open);
        if name == "b.csv" {
            assert!(proposal.open.is_empty(), "{:?}", proposal.open);
            let reading = read_with(&proposal.text, name, bytes);
            assert_eq!(reading.tables[0].channels[1].values[2], 0.02);
            assert_eq!(reading.tables[0].time_first_last_s, Some((0.0, 1.0)));
        } else {
            assert!(proposal.text.contains("base = \"epoch\"") && proposal.open.len() == 1);
        }
    }
    let unitless = b"test_time,amps\n1.5,2\n2.5,3\n3.5,3\n";
    let proposal = propose("c.csv", unitless, &[]).unwrap();
    assert!(proposal.open[0].contains("[time] unit"), "{:?}", proposal.open);
    assert!(from_text(Path::new("c.toml"), &proposal.text).is_err());
}

#[test]
fn a_row_of_units_is_no_row_of_names() {
    let mut text = "Project:\tstrip\r\n\r\nInterval data:\tPoint No.\tRun duration\tStorage Modulus\r\n\t\t\t\r\n\t\t[min]\t[Pa]\r\n".to_owned();
    (0..4).for_each(|k| text.push_str(&format!("\t{}\t{}\t{}\r\n", k + 1, 0.5 * f64::from(k), 2e6)));
    let utf16: Vec<u8> = std::iter::once(0xfeff)
        .chain(text.encode_utf16())
        .flat_map(u16::to_le_bytes)
        .collect();
    let proposal = propose("sweep.csv", &utf16, &[]).unwrap();
    assert!(
        proposal
            .text
            .contains("header_contains = \"Interval data:\\tPoint No.\\tRun duration\\tStorage Modulus\"\nlines_after_header = 2"),
        "{}",
        proposal.text
    );
    assert!(
        proposal
            .text
            .contains("\"Storage Modulus\"\nquantity = \"storage_modulus\"\nunit = \"Pa\""),
        "{}",
        proposal.text
    );
}

#[test]
fn columns_headed_by_units_say_what_they_hold() {
    let text = "made by hand\ns,V,\u{b5}A\n0,0.5,1.5\n1,0.5,1.25\n2,0.5,1\n".as_bytes();
    let proposal = propose("cv.csv", text, &[]).unwrap();
    assert!(proposal.open.is_empty(), "{:?}\n{}", proposal.open, proposal.text);
    let reading = read_with(&proposal.text, "cv.csv", text);
    let found: Vec<(Quantity, f64)> = reading.tables[0]
        .channels
        .iter()
        .map(|c| (c.quantity, c.values[0]))
        .collect();
    assert_eq!(found, [(Quantity::Voltage, 0.5), (Quantity::Current, 1.5e-6)]);
    assert_eq!(reading.tables[0].time_first_last_s, Some((0.0, 2.0)));
}

#[test]
fn a_profile_of_a_modulus_log_is_complete() {
    let log = b"made by hand\nTime (min);T (\xb0C);E' (MPa);E\" (MPa)\n0;25;70;7\n1;25,5;68;6,5\n2;26;66;6\n";
    let proposal = propose("dma.csv", log, &[]).unwrap();
    assert!(proposal.open.is_empty(), "{:?}", proposal.open);
    let reading = read_with(&proposal.text, "dma.csv", log);
    assert!(
        reading.tables[0]
            .channels
            .iter()
            .any(|c| c.quantity == Quantity::LossModulus && c.values[1] == 6.5)
    );
}

#[test]
fn profiles_of_a_folder_are_loaded_by_id() {
    let folder = tempfile::tempdir().unwrap();
    assert!(load(folder.path()).is_empty());
    let profiles = folder.path().join("profiles");
    std::fs::create_dir(&profiles).unwrap();
    std::fs::write(profiles.join("b.toml"), LASER).unwrap();
    std::fs::write(profiles.join("a.toml"), LASER).unwrap();
    std::fs::write(profiles.join("c.toml.draft"), "nothing").unwrap();
    let found = load(folder.path()).strict().unwrap();
    assert_eq!(
        found.iter().map(|p| p.id.as_str()).collect::<Vec<_>>(),
        ["a", "b"]
    );
    assert_eq!(found[0].digest, found[1].digest);
    std::fs::write(profiles.join("Big.toml"), LASER).unwrap();
    let found = load(folder.path());
    assert_eq!((found.len(), found.refused.len()), (2, 1));
    assert_eq!(found.refused[0].path, "profiles/Big.toml");
    assert!(found.strict().unwrap_err().to_string().contains("lower case"));
}

#[test]
fn the_phase_of_a_modulus_is_none_of_an_impedance() {
    let log = "Time (s);f (Hz);Phase (\u{b0});E' (MPa);tan delta\n0;1;10,5;60;0,185\n1;1;10,75;61;0,19\n2;1;11;62;0,2\n";
    let proposal = propose("dma.csv", log.as_bytes(), &[]).unwrap();
    assert!(!proposal.text.contains("impedance"), "{}", proposal.text);
    let reading = crate::formats::read("dma.csv", log.as_bytes(), &ReadContext::default()).unwrap();
    let phase = reading.tables[0]
        .channels
        .iter()
        .find(|c| c.raw_name.starts_with("Phase"));
    assert_eq!(phase.map(|channel| channel.quantity), Some(Quantity::Other));
    let spectrum = "f (Hz);|Z| (Ohm);Phase (\u{b0})\n1;10,5;-20\n2;10;-25\n3;9,5;-30\n";
    let proposal = propose("eis.csv", spectrum.as_bytes(), &[]).unwrap();
    assert!(proposal.text.contains("impedance_phase"), "{}", proposal.text);
}

#[test]
fn a_column_is_what_a_person_says_of_it() {
    let bytes = b"time_s,voltage_v,d [mm],Weg\n0,0,0,0\n1,2,0.1,100\n2,2,0.2,200\n";
    let stated = |column: &str, unit: Option<&str>| StatedColumn {
        column: column.to_owned(),
        quantity: Quantity::TipDisplacement,
        unit: unit.map(str::to_owned),
    };
    for (said, expected_mm) in [(stated("d [mm]", None), 0.2), (stated("Weg", Some("um")), 0.2)] {
        let proposal = propose("a.csv", bytes, std::slice::from_ref(&said)).unwrap();
        assert!(proposal.open.is_empty(), "{:?}", proposal.open);
        let profile = from_text(Path::new("laser.toml"), &proposal.text).unwrap();
        let reading = profile.read(bytes, &ReadContext::default()).unwrap();
        let channels = &reading.tables[0].channels;
        let found = channels.iter().find(|c| c.quantity == Quantity::TipDisplacement);
        let last = found.and_then(|channel| channel.values.last().copied());
        assert!((last.unwrap() - expected_mm).abs() < 1e-12, "{said:?}");
    }
    let wrong = propose("a.csv", bytes, &[stated("Laser", None)]).unwrap();
    assert!(wrong.open[0].contains("no column Laser"), "{:?}", wrong.open);
}

#[test]
fn a_start_in_the_head_is_proposed_where_its_date_has_one_order() {
    let file = |date: &str| {
        format!(
            "Messung 7\r\nStart: {date}\r\nt [s];U [V];I [mA];Spitze [mm]\r\n0,0;2,0;1,5;0,1\r\n0,5;2,0;1,4;0,2\r\n1,0;2,0;1,3;0,3\r\n"
        )
    };
    let stated = [StatedColumn {
        column: "Spitze [mm]".to_owned(),
        quantity: Quantity::TipDisplacement,
        unit: None,
    }];
    let proposal = propose("m.csv", file("02.06.2026 03:00:00").as_bytes(), &stated).unwrap();
    assert!(
        proposal
            .text
            .contains("[start]\nline_begins = \"Start:\"\norder = \"day-first\""),
        "{}",
        proposal.text
    );
    let reading = read_with(&proposal.text, "m.csv", file("02.06.2026 03:00:00").as_bytes());
    assert_eq!(
        reading.started_at.as_ref().unwrap().local.as_deref(),
        Some("2026-06-02T03:00:00")
    );
    let slashes = propose("m.csv", file("02/06/2026 03:00:00").as_bytes(), &stated).unwrap();
    assert!(
        slashes.text.contains("# [start]") && slashes.open == proposal.open,
        "{}",
        slashes.text
    );
}

#[test]
fn a_column_that_is_read_less_often_than_the_others_is_one_of_the_table() {
    let rows: String = (0..60)
        .map(|k| {
            let camera = if k % 3 == 0 {
                format!("{}", 0.1 + 0.01 * f64::from(k))
            } else {
                String::new()
            };
            format!(
                "{};2.0;{};{camera};\n",
                0.5 * f64::from(k),
                1.5 - 0.01 * f64::from(k)
            )
            .replace('.', ",")
        })
        .collect();
    let text = format!("Messung 7;;;;\nZeit [s];U [V];I [mA];Weg [mm];\n{rows}");
    let stated = [StatedColumn {
        column: "Weg [mm]".to_owned(),
        quantity: Quantity::TipDisplacement,
        unit: None,
    }];
    let proposal = propose("m.csv", text.as_bytes(), &stated).unwrap();
    assert_eq!(proposal.open, Vec::<String>::new(), "{}", proposal.text);
    let reading = read_with(&proposal.text, "m.csv", text.as_bytes());
    let lengths: Vec<usize> = reading.tables[0]
        .channels
        .iter()
        .map(|channel| channel.len())
        .collect();
    assert_eq!(lengths, [60, 60, 20], "{}", proposal.text);
}

/// A profile of dates under `Zeit` and a current under `Strom`, with what else is stated.
fn of_dates(layout: &str, time: &str) -> String {
    format!(
        "[profile]\nversion = 1\n[layout]\n{layout}\n[time]\nbase = \"clock\"\ncolumn = \"Zeit\"\n{time}\n\
         [[column]]\ncolumn = \"Strom\"\nquantity = \"current\"\nunit = \"mA\"\n"
    )
}

#[test]
fn the_order_that_is_stated_counts_against_all_that_the_rows_show() {
    // Day first, the rows would follow each other by a day.
    let log = b"Zeit;Strom\n01/02/2026 10:00:00;1\n02/02/2026 10:00:00;2\n03/02/2026 10:00:00;3\n";
    let layout = "separator = \"semicolon\"\ndecimal = \"point\"\nheader_line = 1";
    let read = |order: &str| {
        let reading = read_with(&of_dates(layout, &format!("order = \"{order}\"")), "a.txt", log);
        reading.tables[0]
            .time_first_last_s
            .map(|(_, last)| last / 86_400.0)
    };
    assert_eq!((read("day-first"), read("month-first")), (Some(2.0), Some(59.0)));
    let none = of_dates(layout, "order = \"year-first\"");
    let refused = profile(&none).read(log, &ReadContext::default()).unwrap_err();
    assert!(
        refused
            .to_string()
            .contains("3 of 3 rows hold no date and time, year first"),
        "{refused}"
    );
}

#[test]
fn a_row_in_anothers_place_costs_no_more_than_itself() {
    let layout = "separator = \"semicolon\"\ndecimal = \"point\"\nheader_line = 1";
    let dates = of_dates(layout, "order = \"day-first\"");
    let counted = dates.replace("\"clock\"", "\"elapsed\"");
    let counted = counted.replace("order = \"day-first\"", "unit = \"s\"");
    let mut seconds: Vec<u32> = (0..60).collect();
    seconds.swap(20, 21);
    seconds.swap(40, 41);
    let table = |time: &dyn Fn(&u32) -> String| {
        let rows = seconds.iter().map(|second| format!("{};1\n", time(second)));
        format!("Zeit;Strom\n{}", rows.collect::<String>())
    };
    let (moments, numbers) = (
        table(&|second| format!("05.02.2026 10:00:{second:02}")),
        table(&u32::to_string),
    );
    for (text, log) in [(dates, moments), (counted, numbers)] {
        let reading = read_with(&text, "a.csv", log.as_bytes());
        assert_eq!(reading.tables[0].channels[0].len(), 58);
        let codes: Vec<&str> = reading.issues.iter().map(|issue| issue.code.as_str()).collect();
        assert!(codes.contains(&"time-not-increasing"), "{codes:?}");
    }
}

#[test]
fn a_sheet_is_read_as_its_profile_says() {
    use crate::formats::sheet_writer::Xml::{Date, Number, Text};
    use crate::formats::sheet_writer::{sheet, workbook};
    let notes = sheet(&[&[Text("notes of the day")]]);
    let readings = sheet(&[
        &[Text("Messung 7")],
        &[Text("Zeit"), Text("Strom"), Text("Bemerkung"), Text("Weg")],
        &[Text("-"), Text("mA"), Text("-"), Text("V")],
        &[Date(46082.5), Text("1,5"), Text("erste"), Number(0.5)],
        &[
            Date(46082.5 + 1.0 / 86_400.0),
            Text("2,5"),
            Text("#2"),
            Number(1.0),
        ],
    ]);
    let bytes = workbook(&[notes, readings]);
    let layout = "kind = \"sheet\"\nheader_line = 2\nlines_after_header = 1";
    let text = of_dates(layout, "order = \"day-first\"\nzone = \"+02:00\"")
        + "[[column]]\ncolumn = 4\nquantity = \"tip_displacement\"\nunit = \"mm\"\nfactor = 3.0\n";
    let reading = read_with(&text, "a.xlsx", &bytes);
    let table = &reading.tables[0];
    assert_eq!(table.time_first_last_s, Some((0.0, 1.0)));
    let values = |at: usize| table.channels[at].values.to_vec();
    assert_eq!((values(0), values(1)), (vec![1.5e-3, 2.5e-3], vec![1.5, 3.0]));
    let start = reading.started_at.unwrap();
    assert_eq!(
        (start.local.as_deref(), start.offset.as_deref()),
        (Some("2026-03-01T12:00:00"), Some("+02:00"))
    );
    let other = text.replace("\"Strom\"", "\"Spannung\"");
    assert!(profile(&other).fits("a.xlsx", &bytes).is_err());
}

#[test]
fn what_a_profile_leaves_open_is_found_or_answered_as_in_any_table() {
    let text = LASER.replace("base = \"epoch\"", "base = \"elapsed\"");
    let log = b"Messung vom;13.05.2026 10:20:30\r\nEpoch (ms);Distance1\r\n1.000;1,5\r\n2.000;2,5\r\n3.000.000;3\r\n";
    let answered = format!("{text}[answers]\nstart = \"none\"\nthousands = \"point\"\n");
    let reading = read_with(&answered, "a.csv", log);
    assert_eq!(reading.tables[0].time_first_last_s, Some((1.0, 3000.0)));
    assert_eq!(reading.started_at, None);
    let only_end = answered.replace("\"none\"", "\"end\"");
    let end = read_with(&only_end, "a.csv", log).started_at.unwrap();
    assert_eq!(
        (end.local.as_deref(), end.kind),
        (Some("2026-05-13T10:20:30"), crate::Timestamp::End)
    );
    // Where the names stand again, a logger was started anew.
    let twice = b"Epoch (ms);Distance1\n0;1,5\n500;2,5\nEpoch (ms);Distance1\n0;3\n500;4\n";
    assert_eq!(read_with(&text, "a.csv", twice).tables.len(), 2);
}
