//! Sheets as people keep them: headings over two names, two columns of files, names of columns in any language.

use ieap_ingest::run_sheet::{is_sheet, pairs_of, read};

use super::{Came, count};

#[test]
fn a_sheet_tags_both_files_of_each_of_its_rows() {
    count("sheets", 85, |dice| {
        let rows = dice.whole(3, 12);
        let ending = dice.pick(&[".txt", ".csv", ".dta"]);
        let file_words = dice.pick(&[
            ["文件名", "电流", "位移"],
            ["Messdaten", "Strom", "Laser"],
            ["データ", "電流", "レーザ"],
            ["Plik", "prąd", "laser"],
            ["Failid", "vool", "laser"],
            ["파일", "전류", "변위"],
            ["Soubor", "proud", "laser"],
        ]);
        let sample = dice.pick(&["样品", "Probe", "試料", "Vzorek", "시료", "Próbka", "Strip"]);
        let (volts, air) = (
            dice.pick(&["电压 (V)", "Spannung (V)", "Napětí (V)", "전압 (V)"]),
            dice.pick(&["气氛", "Umgebung", "Prostředí", "Gaz"]),
        );
        let mark = dice.pick(&[",", ";", "\t"]);
        let is_stacked = dice.chance(0.5);
        let has_title = dice.chance(0.5);
        let mut text = String::new();
        if has_title {
            text += &format!("Series 12{}\n", mark.repeat(4));
        }
        // The order of the columns is anybody's.
        let mut order = [0, 1, 2, 3, 4];
        if !is_stacked {
            dice.shuffle(&mut order);
        }
        let line = |cells: [&str; 5]| order.map(|at| cells[at]).join(mark) + "\n";
        if is_stacked {
            text += &line([sample, file_words[0], "", volts, air]);
            text += &line(["", file_words[1], file_words[2], "", ""]);
        } else {
            let (one, two) = (
                format!("{} {}", file_words[0], file_words[1]),
                format!("{} {}", file_words[0], file_words[2]),
            );
            text += &line([sample, &one, &two, volts, air]);
        }
        let mut expected = Vec::new();
        for k in 0..rows {
            let strip = format!("N{}", 1 + k % 3);
            let (a, b) = (format!("P{}_{k:02}", k % 3), format!("{strip}-{k:02}-laser"));
            let (volts, air) = (dice.pick(&["1", "2", "-2"]), dice.pick(&["air", "vacuum"]));
            text += &line([&strip, &format!("{a}{ending}"), &format!("{b}.csv"), volts, air]);
            expected.push((a, b, strip, volts, air));
        }
        if !is_sheet("list.csv", text.as_bytes()) {
            return (Came::Asked, text);
        }
        let Ok(found) = read(text.as_bytes()) else {
            return (Came::Asked, text);
        };
        let mut wrong = Vec::new();
        let pairs = pairs_of(&found);
        for (a, b, strip, volts, air) in &expected {
            for name in [a, b] {
                let row = found.iter().find(|row| row.file == *name);
                let is = |key: &str, value: &str| row.is_some_and(|row| row.tag(key) == Some(value));
                if !(is("sample", strip) && is("voltage_v", volts) && is("environment", air)) {
                    wrong.push(format!("{name}: {row:?}"));
                }
            }
            let is_pair =
                |pair: &&(String, String)| [&pair.0, &pair.1].contains(&a) && [&pair.0, &pair.1].contains(&b);
            if pairs.iter().filter(is_pair).count() != 1 {
                wrong.push(format!("{a} and {b} are no pair in {pairs:?}"));
            }
        }
        match wrong.first() {
            None => (Came::Right, String::new()),
            Some(first) => (Came::Wrong, format!("{first}\n{text}")),
        }
    });
}

#[test]
fn a_sheet_in_utf_16_without_a_mark_is_read() {
    let text =
        "样品;文件;电压 (V);气氛\r\n样一;a_1.txt;2;air\r\n样二;a_2.txt;1;air\r\n样二;a_3.txt;1;vacuum\r\n";
    for bytes in [
        text.encode_utf16()
            .flat_map(u16::to_le_bytes)
            .collect::<Vec<u8>>(),
        text.encode_utf16().flat_map(u16::to_be_bytes).collect(),
    ] {
        assert!(is_sheet("list.csv", &bytes));
        let rows = read(&bytes).unwrap();
        assert_eq!(
            (rows.len(), rows[2].tag("sample"), rows[2].tag("environment")),
            (3, Some("样二"), Some("vacuum"))
        );
    }
}
