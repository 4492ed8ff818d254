//! Logs with numbers that stand for no reading.

use ieap_domain::Quantity;

use super::run::{channel, read_text};
use super::{Came, count};

#[test]
fn numbers_that_stand_for_no_reading_enter_no_mean() {
    count("codes", 85, |dice| {
        let rows = dice.whole(40, 300);
        let digits = dice.pick(&[1usize, 2, 3]);
        let (mid, swing, hour) = (
            dice.number(16.0, 28.0),
            dice.number(0.2, 3.0),
            dice.number(20.0, 200.0),
        );
        let code = dice.pick(&[
            998.0, -127.0, 0.0, 85.0, 999.0, -99.0, -40.0, 850.0, 150.0, -50.0, 327.67,
        ]);
        let is_in_both = dice.chance(0.3);
        let count_of = dice.whole(2, (rows / 8).max(3)) as usize;
        let mut at: Vec<i64> = (1..rows - 1).collect();
        dice.shuffle(&mut at);
        let mut off: Vec<i64> = at[..count_of].to_vec();
        // A sensor that is off is so for a while.
        if dice.chance(0.5) {
            let long = dice.whole(2, 6);
            let from = off[0];
            off.extend((from..from + long).filter(|k| *k < rows - 1));
        }
        let mut text = "Time,T (°C),RH (%)\n".to_owned();
        let (mut sum, mut kept) = (0.0, 0usize);
        for k in 0..rows {
            let noise = dice.number(-0.1, 0.1);
            let t = mid + swing * (k as f64 / hour).sin() + noise;
            let rh = 45.0 + 5.0 * (k as f64 / hour).cos() - 2.0 * noise;
            let t_shown = format!("{t:.digits$}");
            let (t_cell, rh_cell) = if off.contains(&k) {
                (
                    format!("{code:.digits$}"),
                    if is_in_both {
                        format!("{code:.1}")
                    } else {
                        format!("{rh:.1}")
                    },
                )
            } else {
                (sum, kept) = (sum + t_shown.parse::<f64>().unwrap(), kept + 1);
                (t_shown, format!("{rh:.1}"))
            };
            text += &format!(
                "2026-03-{:02} {:02}:{:02}:00,{t_cell},{rh_cell}\n",
                1 + k / 288,
                k / 12 % 24,
                k % 12 * 5
            );
        }
        let came = match read_text("log.csv", &text) {
            Err(_) => Came::Asked,
            Ok(reading) => match channel(&reading, Quantity::Temperature) {
                None => Came::Asked,
                Some(found) => {
                    let mean = found.values.iter().sum::<f64>() / found.values.len() as f64;
                    let is_right = found.values.len() == kept && (mean - sum / kept as f64).abs() < 0.01;
                    if is_right { Came::Right } else { Came::Wrong }
                }
            },
        };
        (
            came,
            format!("code {code}, {} of {rows}\n{}", off.len(), &text[..600]),
        )
    });
}

#[test]
fn readings_of_steps_rests_and_chambers_are_no_codes() {
    count("no codes", 100, |dice| {
        let (low, high) = (dice.whole(15, 30) as f64, dice.whole(40, 80) as f64);
        let noise = dice.pick(&[0.0, 0.05, 0.2]);
        let (mut text, mut rows) = ("Time,T (°C),RH (%)\n".to_owned(), 0);
        let way = dice.whole(0, 2);
        for k in 0..240 {
            let t = match way {
                // A chamber that is stepped, over a ramp.
                0 => match k % 120 {
                    0..50 => low,
                    50..60 => low + (high - low) * f64::from(k % 120 - 50) / 10.0,
                    60..110 => high,
                    _ => high - (high - low) * f64::from(k % 120 - 110) / 10.0,
                },
                // A door that was opened once.
                1 => low + if (100..106).contains(&k) { 4.0 } else { 0.0 },
                _ => low + 3.0 * (f64::from(k) / 30.0).sin(),
            };
            let t = t + dice.number(-noise, noise);
            rows += 1;
            text += &format!("2026-03-01 {:02}:{:02}:00,{t:.1},45.0\n", k / 12 % 24, k % 12 * 5);
        }
        let reading = read_text("log.csv", &text).unwrap();
        let found = channel(&reading, Quantity::Temperature).map_or(0, |found| found.values.len());
        (
            if found == rows { Came::Right } else { Came::Wrong },
            format!("way {way}, {found} of {rows}"),
        )
    });
}
