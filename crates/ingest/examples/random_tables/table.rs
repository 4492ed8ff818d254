//! The columns of a written table, each cell with what a reader may make of it.

use ieap_domain::Quantity;

use crate::dialect::{Dialect, Numbers};
use crate::dice::Dice;
use crate::names;
use crate::number::{local, written};
use crate::truth::{Column, Meaning, Truth};
use crate::units::{self, Unit};

/// What a reader may make of a cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Expect {
    /// This reading.
    Reading(f64),
    /// This reading or none.
    Optional(f64),
    /// No reading.
    Gap,
}

/// A column as it is written.
#[derive(Debug, Clone)]
pub struct Written {
    /// Name without the unit.
    pub name: String,
    /// Unit as text; empty where there is none.
    pub unit: String,
    /// Unit at the end of `name_unit`; empty where there is none.
    pub snake: String,
    /// Cells in the order of time.
    pub cells: Vec<String>,
    /// What they mean; empty where they mean nothing to a reader.
    pub expect: Vec<Expect>,
    /// What it measures, and by which sensor.
    pub quantity: Option<(Quantity, usize)>,
    /// It holds date, time or both.
    pub is_time: bool,
}

/// A column of time with its cells.
pub fn time_column(name: String, cells: Vec<String>) -> Written {
    Written {
        name,
        unit: String::new(),
        snake: String::new(),
        cells,
        expect: Vec::new(),
        quantity: None,
        is_time: true,
    }
}

/// Gives a column its unit as the dialect writes it.
pub fn describe(dice: &mut Dice, column: &mut Written, dialect: &Dialect, unit: &Unit) {
    let is_russian = dialect.language == 7 && dialect.encoding != crate::dialect::Encoding::Windows1252;
    let is_cyrillic = is_russian && dice.chance(0.6);
    column.unit = if is_cyrillic {
        unit.cyrillic
    } else {
        dice.pick(unit.texts)
    }
    .to_owned();
    column.snake = unit.snake.to_owned();
}

/// Writes a column of readings or words.
pub fn data(dice: &mut Dice, truth: &Truth, dialect: &Dialect, of: &Column) -> Written {
    let mut column = time_column(data_name(dice, truth, dialect, of), Vec::new());
    column.is_time = false;
    let unit = match of.meaning {
        Meaning::Humidity if dialect.fraction => units::FRACTION,
        _ => fitting_unit(dice, of, dialect),
    };
    describe(dice, &mut column, dialect, &unit);
    if of.meaning == Meaning::Remark {
        let words = ["", "", "", "ok", "start", "door open", "lamp off"];
        let word = |dice: &mut Dice| {
            dice.pick(if dialect.delimiter == ' ' {
                &words[3..]
            } else {
                &words
            })
        };
        column.cells = truth.time_us.iter().map(|_| word(dice).to_owned()).collect();
        return column;
    }
    let numbers: Vec<f64> = of
        .values
        .iter()
        .map(|value| value / unit.scale + unit.zero)
        .collect();
    let largest = numbers.iter().map(|n| n.abs()).fold(0.0, f64::max).max(1e-30);
    let fine = dice.whole(4, 6) as usize;
    let decimals = match of.meaning {
        Meaning::Constant => 0,
        Meaning::Humidity | Meaning::Temperature | Meaning::DewPoint | Meaning::Pressure
            if !dialect.fraction =>
        {
            dice.whole(1, 2) as usize
        }
        _ => (fine as f64 - 1.0 - largest.log10().floor()).clamp(0.0, 12.0) as usize,
    };
    let quantity = of.meaning.quantity();
    column.quantity = quantity.map(|quantity| (quantity, of.sensor));
    for number in numbers {
        let (text, said) = written(number, decimals, fine, dialect);
        column.cells.push(text);
        column
            .expect
            .push(Expect::Reading((said - unit.zero) * unit.scale));
    }
    column
}

fn data_name(dice: &mut Dice, truth: &Truth, dialect: &Dialect, of: &Column) -> String {
    let name = dice.pick(names::of(of.meaning)[dialect.language]);
    let sensor = truth.sensors[of.sensor];
    let is_of_sensor = !matches!(of.meaning, Meaning::Constant | Meaning::Remark);
    if truth.sensor_of_row.is_some() || sensor.is_empty() || !is_of_sensor {
        return name.to_owned();
    }
    // One writer names all his columns alike: the row count decides, so that no chance does for each column.
    match truth.time_us.len() % 3 {
        0 => format!("{sensor} {name}"),
        1 => format!("{name} {sensor}"),
        _ => format!("{sensor}_{name}"),
    }
}

/// A unit in which the numbers have a size that is written.
fn fitting_unit(dice: &mut Dice, of: &Column, dialect: &Dialect) -> Unit {
    let largest = of.values.iter().map(|value| value.abs()).fold(0.0, f64::max);
    let known = units::units(of.meaning);
    let fits =
        |unit: &Unit| (1e-4..1e6).contains(&(largest / unit.scale)) || of.meaning == Meaning::Temperature;
    let has_exponent = matches!(dialect.numbers, Numbers::Scientific | Numbers::Fortran);
    let fitting: Vec<(u32, Unit)> = known
        .iter()
        .copied()
        .filter(|(_, unit)| has_exponent || fits(unit))
        .collect();
    dice.weighted(if fitting.is_empty() { known } else { &fitting })
}

/// Puts cells without a measurement into columns of readings, the last row left alone.
pub fn sentinels(dice: &mut Dice, truth: &Truth, dialect: &Dialect, columns: &mut [Written]) {
    let mut words = vec![
        local("9.9E+37", dialect),
        local("-9.9E+37", dialect),
        local("1E+38", dialect),
        "NaN".into(),
        "---".into(),
        "n/a".into(),
    ];
    if truth.is_log {
        words.push(local("-999.9", dialect));
    } else {
        words.extend(["OVLD".to_owned(), "OL".to_owned()]);
    }
    if dialect.delimiter != ' ' {
        words.push(String::new());
    }
    let measured: Vec<usize> = (0..columns.len())
        .filter(|&c| columns[c].quantity.is_some())
        .collect();
    for _ in 0..dialect.sentinels {
        let (column, row) = (
            dice.pick(&measured),
            dice.whole(0, truth.time_us.len() as i64 - 2) as usize,
        );
        let word = dice.whole(0, words.len() as i64 - 1) as usize;
        columns[column].cells[row] = words[word].clone();
        columns[column].expect[row] = Expect::Gap;
    }
}
