//! Dates of which day, month and year may stand in several orders.

use jiff::ToSpan;
use jiff::civil::DateTime;

use super::run::read_text;
use super::{Came, count};

#[test]
fn the_order_of_dates_is_the_one_in_which_rows_are_regular_or_it_is_asked() {
    count("orders of dates", 40, |dice| {
        let start: DateTime = format!(
            "20{}-{:02}-{:02}T{:02}:{:02}:00",
            dice.whole(16, 31),
            dice.whole(1, 12),
            dice.whole(1, 28),
            dice.whole(0, 23),
            dice.whole(0, 59)
        )
        .parse()
        .unwrap();
        let mark = dice.pick(&[".", "/", "-"]);
        let form = match dice.whole(0, 4) {
            0 => format!("%d{mark}%m{mark}%Y"),
            1 => format!("%m{mark}%d{mark}%Y"),
            2 => format!("%d{mark}%m{mark}%y"),
            3 => format!("%m{mark}%d{mark}%y"),
            _ => format!("%y{mark}%m{mark}%d"),
        };
        let every_min = dice.pick(&[5, 10, 15, 30, 60]);
        let rows = dice.whole(30, 200);
        let mut text = "Time;T (°C);RH (%)\n".to_owned();
        for k in 0..rows {
            let at = start.checked_add((k * every_min).minutes()).unwrap();
            text += &format!(
                "{};21.{};45.{}\n",
                at.strftime(&format!("{form} %H:%M:%S")),
                k % 10,
                k % 7
            );
        }
        let is_convention = mark == "." && form.starts_with("%d");
        let came = match read_text("log.csv", &text) {
            Err(_) => Came::Asked,
            Ok(reading) => {
                let found = reading.started_at.unwrap().local.unwrap();
                match found.parse::<DateTime>().unwrap() == start {
                    true => Came::Right,
                    // Where the rows leave it open, dates with dots are read day first, which is said.
                    false if mark == "." && !is_convention && is_open(start, rows * every_min) => Came::Asked,
                    false => Came::Wrong,
                }
            }
        };
        (came, text[..200].to_owned())
    });
}

/// Whether all rows are of one day.
fn is_open(start: DateTime, minutes: i64) -> bool {
    start.checked_add(minutes.minutes()).unwrap().date() == start.date()
}

/// Counts of a clock, by their zero before 1970, s.
const ZEROS_S: [i64; 4] = [0, 2_082_844_800, 2_209_161_600, 2_208_988_800];

#[test]
fn a_count_of_seconds_is_from_the_zero_that_the_date_above_shows_or_gives_no_start() {
    count("epochs", 60, |dice| {
        let start: DateTime = format!("20{}-03-{:02}T14:00:00", dice.whole(18, 27), dice.whole(13, 28))
            .parse()
            .unwrap();
        let zero_s = dice.pick(&ZEROS_S);
        let since_1970 = start
            .to_zoned(jiff::tz::TimeZone::UTC)
            .unwrap()
            .timestamp()
            .as_second();
        let head = match dice.whole(0, 2) {
            0 => start.strftime("Opened,%-m/%-d/%Y,2:00 pm\n").to_string(),
            1 => start.strftime("记录时间 %Y/%m/%d 14:00:00\n").to_string(),
            _ => String::new(),
        };
        let mut text = format!("{head}Time Stamp (s),Voltage (V),Current (mA)\n");
        for row in super::run::rows(dice) {
            text += &format!(
                "{:.2},{:.3},{:.5}\n",
                (since_1970 + zero_s) as f64 + row[0],
                row[1],
                row[2]
            );
        }
        let came = match read_text("run.csv", &text) {
            Err(_) => Came::Asked,
            Ok(reading) => match reading.started_at.and_then(|start| start.local) {
                None => Came::Asked,
                Some(local) if local.parse::<DateTime>().unwrap() == start => Came::Right,
                // Without a date a count of our time is read as the usual one.
                Some(_) if head.is_empty() && ZEROS_S[2..].contains(&zero_s) => Came::Asked,
                Some(_) => Came::Wrong,
            },
        };
        (came, text.chars().take(200).collect())
    });
}
