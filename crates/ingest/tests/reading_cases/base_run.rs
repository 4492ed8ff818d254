//! The run that all files of runs are written from: 2 V from the step on, a current that decays twice, a tip that bends.

/// A row of the run.
#[derive(Debug, Clone, Copy)]
pub struct Row {
    /// Time since the step, s.
    pub t: f64,
    /// Voltage, V.
    pub volts: f64,
    /// Current, mA.
    pub ma: f64,
    /// Displacement of the tip, mm.
    pub tip_mm: f64,
}

impl Row {
    /// What is there at `t` seconds after the step.
    fn at(t: f64) -> Row {
        if t < 0.0 {
            return Row {
                t,
                volts: 0.0,
                ma: 0.0,
                tip_mm: 0.0,
            };
        }
        Row {
            t,
            volts: 2.0,
            ma: 8.0 * (-t / 1.5).exp() + 1.2 * (-t / 12.0).exp() + 0.2,
            tip_mm: 1.2 * (1.0 - (-t / 4.0).exp()),
        }
    }

    /// The current, A.
    pub fn amperes(&self) -> f64 {
        self.ma * 1e-3
    }
}

/// So many rows, the first at `from_s` after the step.
pub fn rows(count: usize, from_s: f64, every_s: f64) -> Vec<Row> {
    (0..count).map(|k| Row::at(from_s + k as f64 * every_s)).collect()
}

/// 85 rows of 0.5 s, the step 2 s after the first.
pub fn base() -> Vec<Row> {
    rows(85, -2.0, 0.5)
}

/// 501 rows of 0.25 s, the step 5 s after the first, with noise of 1 uA and 1 um.
pub fn noisy() -> Vec<Row> {
    rows(501, -5.0, 0.25)
        .into_iter()
        .enumerate()
        .map(noised)
        .collect()
}

fn noised((k, row): (usize, Row)) -> Row {
    // The digits of multiples of an irrational number have no pattern that a reader could see.
    let noise = |factor: f64| 2.0 * (k as f64 * factor).sin() * (k as f64 * 7.7 * factor).cos();
    Row {
        ma: row.ma + 1e-3 * noise(std::f64::consts::E * 1e3),
        tip_mm: row.tip_mm + 1e-3 * noise(std::f64::consts::PI * 1e3),
        ..row
    }
}

/// Names and a line for each row.
pub fn table(names: &str, rows: &[Row], line: impl Fn(&Row) -> String) -> String {
    let lines: Vec<String> = rows.iter().map(line).collect();
    format!("{names}\n{}\n", lines.join("\n"))
}

/// `9.400000e-03`, as most programs write it.
pub fn power(number: f64) -> String {
    let text = format!("{number:.6e}");
    let (digits, exponent) = text.split_once('e').unwrap();
    let exponent: i32 = exponent.parse().unwrap();
    format!(
        "{digits}e{}{:02}",
        if exponent < 0 { '-' } else { '+' },
        exponent.abs()
    )
}

/// Six digits without zeros behind them: `0.00708328`.
pub fn short(number: f64) -> String {
    let rounded: f64 = format!("{number:.5e}").parse().unwrap();
    rounded.to_string()
}

#[test]
fn the_formula_is_that_of_the_cases() {
    let base = base();
    let (step, next, last) = (base[4], base[5], base[84]);
    assert_eq!((base.len(), step.t, step.volts, last.t), (85, 0.0, 2.0, 40.0));
    let written = [step, next, last].map(|row| (power(row.amperes()), short(row.amperes())));
    let expected = [
        ("9.400000e-03", "0.0094"),
        ("7.083278e-03", "0.00708328"),
        ("2.428088e-04", "0.000242809"),
    ];
    assert_eq!(
        written,
        expected.map(|(power, short)| (power.to_owned(), short.to_owned()))
    );
}
