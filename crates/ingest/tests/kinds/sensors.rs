//! Logs of several sensors by turns, told apart by a number under any name, and columns of numbers that tell nothing apart.

use ieap_domain::Quantity;

use super::pairs::word;
use super::run::read_text;
use super::{Came, count};

#[test]
fn sensors_that_a_number_tells_apart_are_not_mixed() {
    count("sensors", 85, |dice| {
        let sensors = dice.whole(2, 4);
        let (first, rows) = (dice.whole(0, 9), dice.whole(15, 40));
        let name = dice.pick(&["Kanal", "Room", "Ort", "No", "ID", ""]);
        let name = if name.is_empty() {
            word(dice)
        } else {
            name.to_owned()
        };
        let base: Vec<f64> = (0..sensors)
            .map(|k| 35.0 + 12.0 * k as f64 + dice.number(0.0, 4.0))
            .collect();
        let is_first = dice.chance(0.5);
        let mut text = if is_first {
            format!("Time,{name},T (°C),RH (%)\n")
        } else {
            format!("Time,T (°C),RH (%),{name}\n")
        };
        for row in 0..rows {
            for sensor in 0..sensors {
                let minute = row * sensors + sensor;
                let rh = base[sensor as usize] + 0.1 * row as f64 + dice.number(-0.1, 0.1);
                let (t, id) = (21.0 + sensor as f64 + 0.01 * row as f64, first + sensor);
                let cells = if is_first {
                    format!("{id},{t:.2},{rh:.1}")
                } else {
                    format!("{t:.2},{rh:.1},{id}")
                };
                text += &format!(
                    "2026-03-19 {:02}:{:02}:00,{cells}\n",
                    8 + minute / 60,
                    minute % 60
                );
            }
        }
        let came = match read_text("log.csv", &text) {
            Err(_) => Came::Asked,
            Ok(reading) => {
                let of_each =
                    (reading.tables.iter()).all(|table| table.rows == rows as usize && has_no_leap(table));
                if of_each && reading.tables.len() == sensors as usize {
                    Came::Right
                } else {
                    Came::Wrong
                }
            }
        };
        (came, text.chars().take(200).collect())
    });
}

fn has_no_leap(table: &ieap_ingest::RunTable) -> bool {
    let humidity = table
        .channels
        .iter()
        .find(|c| c.quantity == Quantity::RelativeHumidity);
    humidity.is_some_and(|c| c.values.windows(2).all(|pair| (pair[1] - pair[0]).abs() < 2.0))
}

#[test]
fn numbers_that_tell_nothing_apart_leave_one_series() {
    count("no sensors", 100, |dice| {
        let way = dice.whole(0, 3);
        let name = word(dice);
        let mut text = format!("Time,T (°C),RH (%),{name}\n");
        for k in 0..120 {
            let rh = 45.0 + 5.0 * (f64::from(k) / 20.0).sin() + dice.number(-0.2, 0.2);
            let t = 21.0 + (f64::from(k) / 30.0).sin() + dice.number(-0.05, 0.05);
            let number = match way {
                // A state by turns, a battery, a set point in stretches, a counter that begins anew.
                0 => k % 2,
                1 => 100 - k / 20,
                2 => 20 + 10 * (k / 40),
                _ => k % 10,
            };
            text += &format!(
                "2026-03-19 {:02}:{:02}:00,{t:.2},{rh:.1},{number}\n",
                8 + k / 60,
                k % 60
            );
        }
        let reading = read_text("log.csv", &text).unwrap();
        let is_one = reading.tables.len() == 1 && reading.tables[0].rows == 120;
        (
            if is_one { Came::Right } else { Came::Wrong },
            format!(
                "way {way}, {} tables\n{}",
                reading.tables.len(),
                text.chars().take(200).collect::<String>()
            ),
        )
    });
}
