//! Zones in names of columns and in lines above.

use super::run::read_text;
use super::{Came, count};

#[test]
fn a_zone_is_read_or_said_not_to_be_understood() {
    count("zones", 60, |dice| {
        let hours = dice.whole(-9, 12);
        let sign = if hours < 0 { '-' } else { '+' };
        let size = hours.abs();
        let (zone, is_known) = match dice.whole(0, 8) {
            0 => (format!("UTC{sign}{size}"), true),
            1 => (format!("UTC{sign}{size:02}:00"), true),
            2 => (format!("GMT {sign}{size:02}00"), true),
            3 => (format!("UTC {sign}{size} h"), true),
            4 => (format!("GMT{sign}{size:02}:00"), true),
            5 => ("Central".to_owned(), false),
            6 => ("IST".to_owned(), false),
            7 => ("W. Europe Standard".to_owned(), false),
            _ => (format!("utc({sign}{size:02}:00)"), true),
        };
        let word = dice.pick(&[
            "time zone",
            "Timezone",
            "Zeitzone",
            "时区",
            "タイムゾーン",
            "Fuseau horaire",
            "Strefa czasowa",
        ]);
        let (head, name) = match dice.whole(0, 2) {
            0 => (format!("Logger;TH-2\n{word}: {zone}\n"), "Time".to_owned()),
            1 => (format!("Logger;TH-2\n{word};{zone}\n"), "Date Time".to_owned()),
            _ if is_known => (String::new(), format!("Time ({zone})")),
            _ => (format!("# {word} = {zone}\n"), "Timestamp".to_owned()),
        };
        let mut text = format!("{head}{name};T (°C);RH (%)\n");
        for k in 0..40 {
            text += &format!("2026-03-19 14:{k:02}:00;21.{};45.{}\n", k % 10, k % 7);
        }
        let came = match read_text("log.csv", &text) {
            Err(_) => Came::Asked,
            Ok(reading) => {
                let expected = format!("{sign}{size:02}:00");
                let said = reading
                    .issues
                    .iter()
                    .any(|issue| issue.code == "zone-not-understood");
                match reading.started_at.unwrap().offset {
                    Some(found)
                        if is_known && (found == expected || size == 0 && found.ends_with("00:00")) =>
                    {
                        Came::Right
                    }
                    None if said => Came::Asked,
                    _ => Came::Wrong,
                }
            }
        };
        (came, text[..120.min(text.len())].to_owned())
    });
}
