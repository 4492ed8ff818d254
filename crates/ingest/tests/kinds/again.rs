//! Names that stand again, words in place of readings, units in cells.

use ieap_domain::Quantity;

use super::run::{channel, read_text, rows};
use super::{Came, count};

#[test]
fn names_that_stand_again_lose_no_row() {
    count("names again", 85, |dice| {
        let rows = dice.whole(40, 120);
        let every = dice.whole(7, 25);
        let pause = if dice.chance(0.5) { dice.whole(1, 600) } else { 0 };
        let names = "Time,T (°C),RH (%)\n";
        let mut text = names.to_owned();
        let mut minutes = 0;
        for k in 0..rows {
            if k > 0 && k % every == 0 {
                text += names;
                minutes += pause;
            }
            minutes += 5;
            let (day, hour) = (19 + minutes / 1440, minutes / 60 % 24);
            text += &format!(
                "2026-03-{day} {hour:02}:{:02}:00,21.{},45.{}\n",
                minutes % 60,
                k % 10,
                k % 7
            );
        }
        let came = match read_text("log.csv", &text) {
            Err(_) => Came::Asked,
            Ok(reading) => match channel(&reading, Quantity::Temperature) {
                Some(found) if found.values.len() == rows as usize => Came::Right,
                _ => Came::Wrong,
            },
        };
        (came, text.chars().take(300).collect())
    });
}

#[test]
fn names_of_a_run_that_stand_again_while_its_clock_goes_on_begin_no_other_run() {
    count("names of a run again", 85, |dice| {
        let rows = rows(dice);
        let every = dice.whole(10, 40) as usize;
        let names = "Date;Voltage;Current\n;V;mA\n";
        let mut text = names.to_owned();
        for (k, row) in rows.iter().enumerate() {
            if k > 0 && k % every == 0 {
                text += names;
            }
            text += &format!(
                "2026-03-19 14:{:02}:{:09.6};{:.3};{:.5}\n",
                row[0] as i64 / 60,
                row[0] % 60.0,
                row[1],
                row[2]
            );
        }
        let came = match read_text("run.csv", &text) {
            Err(_) => Came::Asked,
            Ok(reading) if reading.tables.len() == 1 && reading.tables[0].rows == rows.len() => Came::Right,
            Ok(_) => Came::Wrong,
        };
        (came, text.chars().take(300).collect())
    });
}

#[test]
fn words_in_place_of_readings_take_no_column_out() {
    count("words", 85, |dice| {
        let rows = dice.whole(40, 200);
        let word = dice.pick(&[
            "No Data",
            "N/A",
            "unavailable",
            "Sensor off",
            "keine Daten",
            "нет данных",
            "无数据",
            "fuera de rango",
        ]);
        let share = dice.number(0.02, 0.4);
        let mut kept = 0;
        let mut text = "Time;T (°C);RH (%)\n".to_owned();
        for k in 0..rows {
            let is_off = k > 0 && dice.chance(share);
            kept += usize::from(!is_off);
            let t = if is_off {
                word.to_owned()
            } else {
                format!("21.{}", k % 10)
            };
            text += &format!("2026-03-19 {:02}:{:02}:00;{t};45.{}\n", k / 12, k % 12 * 5, k % 7);
        }
        let came = match read_text("log.csv", &text) {
            Err(_) => Came::Asked,
            Ok(reading) => match channel(&reading, Quantity::Temperature) {
                Some(found) if found.values.len() == kept => Came::Right,
                Some(_) => Came::Wrong,
                None => Came::Asked,
            },
        };
        (came, text.chars().take(300).collect())
    });
}

#[test]
fn units_in_cells_are_those_of_the_column() {
    count("units in cells", 85, |dice| {
        let rows = dice.whole(10, 100);
        let blank = dice.pick(&["", " "]);
        let mark = dice.pick(&[",", ";", "\t"]);
        let decimal = if mark == "," { "." } else { dice.pick(&[".", ","]) };
        let (t_unit, rh_unit) = (dice.pick(&["°C", "℃", "K"]), dice.pick(&["%", "%RH", "% r.F."]));
        let mut text = ["Time", "Temperature", "Humidity"].join(mark) + "\n";
        let zero = if t_unit == "K" { 273.15 } else { 0.0 };
        for k in 0..rows {
            let t = format!("{:.2}", 21.0 + zero + 0.01 * k as f64).replace('.', decimal);
            let rh = format!("{:.1}", 45.0 + 0.1 * k as f64).replace('.', decimal);
            text += &format!(
                "2026-03-19 {:02}:{:02}:00{mark}{t}{blank}{t_unit}{mark}{rh}{blank}{rh_unit}\n",
                k / 12,
                k % 12 * 5
            );
        }
        let came = match read_text("log.csv", &text) {
            Err(_) => Came::Asked,
            Ok(reading) => {
                let last =
                    |quantity| channel(&reading, quantity).and_then(|found| found.values.last().copied());
                let k = (rows - 1) as f64;
                let is = |found: Option<f64>, expected: f64| {
                    found.is_some_and(|found| (found - expected).abs() < 1e-6)
                };
                if is(last(Quantity::Temperature), 21.0 + 0.01 * k)
                    && is(last(Quantity::RelativeHumidity), 45.0 + 0.1 * k)
                {
                    Came::Right
                } else {
                    Came::Wrong
                }
            }
        };
        (came, text.chars().take(200).collect())
    });
}
