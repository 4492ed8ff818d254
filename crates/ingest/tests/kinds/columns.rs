//! Two columns of one quantity in any order: one that goes with the voltage, and one of something else.

use ieap_domain::Quantity;

use super::run::{channel, close, read_text, rows};
use super::{Came, count};

/// Words before a name that make it another thing's, and the share that this has of the true readings.
const OTHERS: [&str; 8] = [
    "Background",
    "Leakage",
    "Stage",
    "Reference",
    "Guard",
    "Counter",
    "Heater",
    "Auxiliary",
];

#[test]
fn of_two_columns_of_one_quantity_the_one_that_goes_with_the_voltage_is_taken() {
    count("two columns", 85, |dice| {
        let rows = rows(dice);
        let is_current = dice.chance(0.5);
        let (name, unit) = if is_current {
            ("Current", "mA")
        } else {
            ("Displacement", "mm")
        };
        let at = if is_current { 2 } else { 3 };
        let most = rows.iter().map(|row| row[at]).fold(0.0, f64::max);
        let other = dice.pick(&OTHERS);
        let way = dice.whole(0, 3);
        let share = dice.decade(0.005, 0.2);
        let level = dice.number(-0.5, 0.5);
        let false_of = |k: usize, row: &[f64; 4]| match way {
            0 => share * row[at] + 0.01 * most,
            1 => level * most,
            2 => level * most + share * most * k as f64 / 50.0,
            _ => share * most * ((k * 7919) % 97) as f64 / 97.0,
        };
        // What qualifies a name does so for a quantity that nothing else measures, too.
        let (own, false_name) = match dice.whole(0, 2) {
            0 => (name.to_owned(), format!("{other} {}", name.to_lowercase())),
            1 if way > 0 => (
                format!("Cell {}", name.to_lowercase()),
                format!("{other} {}", name.to_lowercase()),
            ),
            _ => (name.to_owned(), format!("{name} {}", other.to_lowercase())),
        };
        let is_first = dice.chance(0.5);
        let third = if is_current {
            ("Displacement (mm)", 3)
        } else {
            ("Current (mA)", 2)
        };
        let mut text = if is_first {
            format!(
                "Time (s),Voltage (V),{own} ({unit}),{false_name} ({unit}),{}\n",
                third.0
            )
        } else {
            format!(
                "Time (s),Voltage (V),{false_name} ({unit}),{own} ({unit}),{}\n",
                third.0
            )
        };
        for (k, row) in rows.iter().enumerate() {
            let (a, b) = if is_first {
                (row[at], false_of(k, row))
            } else {
                (false_of(k, row), row[at])
            };
            text += &format!("{:.2},{:.3},{a:.5},{b:.5},{:.5}\n", row[0], row[1], row[third.1]);
        }
        let quantity = if is_current {
            Quantity::Current
        } else {
            Quantity::TipDisplacement
        };
        let per = if is_current { 1e-3 } else { 1.0 };
        let came = match read_text("a.csv", &text) {
            Err(_) => Came::Asked,
            Ok(reading) => match channel(&reading, quantity) {
                Some(found) => {
                    let largest = found.values.iter().copied().fold(0.0, f64::max);
                    if (largest - per * most).abs() < 1e-3 * per * most + 1e-5 {
                        Came::Right
                    } else {
                        Came::Wrong
                    }
                }
                None => Came::Asked,
            },
        };
        (came, format!("way {way}: {}", &text[..text.len().min(900)]))
    });
}

#[test]
fn the_temperature_of_a_run_is_that_of_the_plain_name_or_asked() {
    count("two temperatures", 60, |dice| {
        let rows = rows(dice);
        let (own, false_c) = (dice.number(18.0, 26.0), dice.number(30.0, 90.0));
        let is_plain = dice.chance(0.7);
        let names = if is_plain {
            [
                "Temperature (°C)".to_owned(),
                format!("{} temperature (°C)", dice.pick(&OTHERS)),
            ]
        } else {
            ["Temperature 1 (°C)".to_owned(), "Temperature 2 (°C)".to_owned()]
        };
        let is_first = dice.chance(0.5);
        let (a, b) = if is_first { (0, 1) } else { (1, 0) };
        let mut text = format!("Time (s),Voltage (V),Current (mA),{},{}\n", names[a], names[b]);
        for row in &rows {
            let of = |which: usize| if which == 0 { own } else { false_c };
            text += &format!(
                "{:.2},{:.3},{:.5},{:.1},{:.1}\n",
                row[0],
                row[1],
                row[2],
                of(a),
                of(b)
            );
        }
        let reading = read_text("a.csv", &text).unwrap();
        let came = match channel(&reading, Quantity::Temperature) {
            Some(found) if close((found.values[0] * 10.0).round(), (own * 10.0).round()) => Came::Right,
            Some(_) => Came::Wrong,
            None => Came::Asked,
        };
        (came, text[..400].to_owned())
    });
}
