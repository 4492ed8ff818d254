//! A laboratory with a potentiostat and a laser, each with a clock and names of its own, whose files state their start behind a
//! word of any language.

use ieap_domain::pairs::PairRules;
use ieap_ingest::pairs::{Half, half_of, pair, window_s};
use jiff::ToSpan;
use jiff::civil::DateTime;

use super::dice::Dice;
use super::run::{read_text, rows};
use super::{Came, count_of};

/// A word of any script.
fn word(dice: &mut Dice) -> String {
    let (first, last) = dice.pick(&[('a', 'z'), ('а', 'я'), ('一', '鿀'), ('가', '힣'), ('ぁ', 'ん')]);
    let letters = dice.whole(2, 7);
    (0..letters)
        .filter_map(|_| char::from_u32(dice.whole(i64::from(first as u32), i64::from(last as u32)) as u32))
        .collect()
}

/// The head of a file: lines of words, among them the one with the start.
struct Head {
    title: String,
    label: String,
    between: &'static str,
    form: &'static str,
    calibrated: Option<String>,
}

impl Head {
    fn of(dice: &mut Dice) -> Head {
        Head {
            title: word(dice),
            label: format!("{}{}", word(dice), word(dice)),
            between: dice.pick(&[": ", " ", "\t", ":", " = "]),
            form: dice.pick(&[
                "%Y/%m/%d %H:%M:%S",
                "%Y-%m-%d %H:%M:%S",
                "%Y年%m月%d日 %H:%M:%S",
                "%d.%m.%Y %H:%M:%S",
            ]),
            calibrated: dice
                .chance(0.3)
                .then(|| format!("{} 2023/05/17 09:00:00\n", word(dice))),
        }
    }

    fn text(&self, at: DateTime) -> String {
        let calibrated = self.calibrated.as_deref().unwrap_or("");
        format!(
            "{}\n{calibrated}{}{}{}\n\n",
            self.title,
            self.label,
            self.between,
            at.strftime(self.form)
        )
    }
}

#[test]
fn halves_of_runs_are_joined_by_their_starts_behind_any_word() {
    count_of(12, "laboratories", 85, |dice| {
        let (pot, laser) = (Head::of(dice), Head::of(dice));
        let off_s = dice.whole(-600, 600);
        let runs = dice.whole(12, 40);
        let mut at: DateTime = "2026-06-13T09:12:40".parse().unwrap();
        let mut halves = Vec::new();
        let mut texts = String::new();
        for k in 0..runs {
            let rows = rows(dice);
            at = at.checked_add(dice.whole(200, 1500).seconds()).unwrap();
            let begins = at.checked_add((off_s + dice.whole(-3, 3)).seconds()).unwrap();
            let line = |row: &[f64; 4]| format!("{:.2}\t{:.3}\t{:.5}\n", row[0], row[1], row[2]);
            let current = pot.text(at)
                + "Time (s)\tVoltage (V)\tCurrent (mA)\n"
                + &rows.iter().map(line).collect::<String>();
            let line = |row: &[f64; 4]| format!("{:.2},{:.5}\n", row[0], row[3]);
            let bending = laser.text(begins)
                + "Time (s),Displacement (mm)\n"
                + &rows.iter().map(line).collect::<String>();
            for (path, text) in [
                (format!("runs/pot/P{}_{k:03}.txt", k % 3), current),
                // Counted by themselves, and in another order of the strips.
                (format!("runs/laser/P{}-{:02}.csv", (k + 1) % 3, k / 3), bending),
            ] {
                let Ok(reading) = read_text(&path, &text) else {
                    return (Came::Asked, text[..text.len().min(200)].to_owned());
                };
                let table = &reading.tables[0];
                let times = table.time_first_last_s.unwrap();
                halves.push(Half {
                    kind: half_of(table.channels.iter().map(|c| c.quantity)).unwrap(),
                    window_s: reading
                        .started_at
                        .as_ref()
                        .and_then(|start| window_s(start, times, 0.0)),
                    path,
                });
                if k == 0 {
                    texts += &text.chars().take(150).collect::<String>();
                }
            }
        }
        let expected: Vec<(&str, &str)> = halves
            .chunks(2)
            .map(|two| (two[0].path.as_str(), two[1].path.as_str()))
            .collect();
        let found = pair(&halves, &PairRules::default(), "runs", &[]);
        let wrong = found
            .pairs
            .iter()
            .filter(|pair| !expected.contains(&(pair.electrical.as_str(), pair.bending.as_str())))
            .count();
        let came = match (wrong, found.pairs.len() == expected.len()) {
            (0, true) => Came::Right,
            (0, false) => Came::Asked,
            _ => Came::Wrong,
        };
        (
            came,
            format!(
                "{off_s} s off, {} of {runs} joined, {wrong} wrong\n{texts}",
                found.pairs.len()
            ),
        )
    });
}
