//! How a table is written: every choice that loggers and instruments make differently.

use crate::clock::Clock;
use crate::dice::Dice;
use crate::odd::{Odd, Order};
use crate::truth::Truth;
use crate::wall::Wall;

/// How numbers are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Numbers {
    /// So many decimals.
    Fixed,
    /// So many digits.
    Significant,
    /// `1.2E-03`.
    Scientific,
    /// `1.2D-03`.
    Fortran,
}

/// Where units stand.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum UnitPlace {
    /// In the name, as `Time (s)`, `Time [s]`, `Time/s`, `time_s`, `Time, s` or `Time s`.
    Name(char),
    /// In a row of their own, in these brackets.
    Row(&'static str),
    /// In lines above the table.
    Preamble,
    /// Nowhere.
    Missing,
}

/// How bytes stand for characters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Encoding {
    /// UTF-8.
    Utf8,
    /// UTF-8 behind a byte order mark.
    Utf8Bom,
    /// UTF-16, little end first.
    Utf16Le,
    /// UTF-16, big end first.
    Utf16Be,
    /// Windows-1252.
    Windows1252,
    /// That of a language which is not Latin.
    Other(&'static encoding_rs::Encoding),
}

/// All choices.
#[derive(Debug, Clone)]
pub struct Dialect {
    /// Between fields; a blank stands for several.
    pub delimiter: char,
    /// A blank behind each delimiter.
    pub padded: bool,
    /// Decimal mark.
    pub decimal: char,
    /// Mark of thousands.
    pub thousands: Option<char>,
    /// Form of numbers.
    pub numbers: Numbers,
    /// Minus sign.
    pub minus: char,
    /// A plus before positive numbers.
    pub plus: bool,
    /// Quotes around every cell.
    pub quoted: bool,
    /// Columns of time.
    pub clock: Clock,
    /// Where units stand.
    pub units: UnitPlace,
    /// Humidity without a unit, 0 to 1.
    pub fraction: bool,
    /// Index into `LANGUAGES`.
    pub language: usize,
    /// The latest row comes first.
    pub newest_first: bool,
    /// Rows are numbered.
    pub index: bool,
    /// Columns stand in any order.
    pub shuffled: bool,
    /// Lines before the table.
    pub preamble: usize,
    /// Among them the date of the start, in this form.
    pub preamble_date: Option<Wall>,
    /// Among them a date that has nothing to do with the start.
    pub other_date: bool,
    /// `sep=;` in the first line.
    pub sep_line: bool,
    /// Names stand behind `# `, and so do the lines before.
    pub commented: bool,
    /// Names are spread over two rows.
    pub two_rows: bool,
    /// Bytes.
    pub encoding: Encoding,
    /// End of lines.
    pub line_end: &'static str,
    /// A delimiter at the end of each line.
    pub trailing: bool,
    /// Blank lines before the names, and behind every so many rows.
    pub blank_lines: (usize, usize),
    /// The last line is cut.
    pub cut: bool,
    /// Zero bytes at the end.
    pub nul_tail: usize,
    /// No end of line behind the last line.
    pub open_end: bool,
    /// Cells that hold no measurement.
    pub sentinels: usize,
    /// What some writers do besides.
    pub odd: Odd,
}

/// Draws a dialect that a sane writer could have for such a table.
pub fn random(dice: &mut Dice, truth: &Truth) -> Dialect {
    let delimiter = dice.weighted(&[(9, ','), (6, ';'), (5, '\t'), (2, ' '), (1, '|')]);
    let mut dialect = Dialect {
        delimiter,
        padded: matches!(delimiter, ',' | '|') && dice.chance(0.1),
        decimal: '.',
        thousands: None,
        numbers: dice.weighted(&[
            (6, Numbers::Fixed),
            (3, Numbers::Significant),
            (3, Numbers::Scientific),
            (1, Numbers::Fortran),
        ]),
        minus: if dice.chance(0.06) { '\u{2212}' } else { '-' },
        plus: dice.chance(0.05),
        quoted: delimiter != ' ' && dice.chance(0.1),
        clock: Clock::random(dice, truth),
        units: units(dice),
        fraction: dice.chance(0.08),
        language: if dice.chance(0.4) {
            0
        } else {
            dice.whole(0, 9) as usize
        },
        newest_first: false,
        index: dice.chance(0.12),
        shuffled: dice.chance(0.25),
        preamble: if dice.chance(0.55) {
            0
        } else {
            dice.whole(1, 30) as usize
        },
        preamble_date: None,
        other_date: dice.chance(0.15),
        sep_line: !matches!(delimiter, ' ' | '|') && dice.chance(0.05),
        commented: dice.chance(0.08),
        two_rows: delimiter != ' ' && dice.chance(0.06),
        encoding: dice.weighted(&[
            (12, Encoding::Utf8),
            (3, Encoding::Utf8Bom),
            (1, Encoding::Utf16Le),
            (1, Encoding::Utf16Be),
            (4, Encoding::Windows1252),
        ]),
        line_end: dice.weighted(&[(10, "\n"), (8, "\r\n"), (1, "\r")]),
        trailing: delimiter != ' ' && dice.chance(0.1),
        blank_lines: (
            dice.weighted(&[(6, 0), (1, 1), (1, 2)]),
            dice.weighted(&[(20, 0), (1, 1), (1, 25)]),
        ),
        cut: dice.chance(0.06),
        nul_tail: if dice.chance(0.04) {
            dice.whole(1, 4096) as usize
        } else {
            0
        },
        open_end: dice.chance(0.1),
        sentinels: if dice.chance(0.25) {
            dice.whole(1, 3) as usize
        } else {
            0
        },
        odd: Odd {
            order: Order::Plain,
            footer: 0,
            full_width: false,
            mixed_marks: false,
        },
    };
    marks(dice, &mut dialect);
    native(dice, &mut dialect);
    dialect.newest_first = dialect.clock.is_pure_wall() && truth.parts.len() == 1 && dice.chance(0.12);
    // What is lost at the end of such a file is its beginning in time.
    dialect.cut &= !dialect.newest_first;
    dialect.open_end &= !dialect.newest_first;
    if dialect.preamble > 0 && dice.chance(0.5) {
        dialect.preamble_date = Some(Wall::stamp(dice));
    }
    if dialect.units == UnitPlace::Preamble {
        dialect.preamble = dialect.preamble.max(1);
    }
    if matches!(dialect.units, UnitPlace::Row(_)) {
        dialect.two_rows = false;
    }
    dialect.odd = Odd::random(dice, truth, &dialect);
    dialect
}

/// The encodings, dates and half-days of a language of its own.
fn native(dice: &mut Dice, dialect: &mut Dialect) {
    let encoding = match dialect.language {
        7 => Encoding::Other(encoding_rs::WINDOWS_1251),
        8 => Encoding::Other(encoding_rs::SHIFT_JIS),
        9 => Encoding::Other(encoding_rs::GBK),
        _ => dialect.encoding,
    };
    if dice.chance(0.5) {
        dialect.encoding = encoding;
    }
    if let Some(wall) = &mut dialect.clock.wall {
        wall.natively(dice, dialect.language);
    }
}

fn units(dice: &mut Dice) -> UnitPlace {
    let style = dice.weighted(&[(8, '('), (6, '['), (3, '/'), (5, '_'), (2, ','), (1, ' ')]);
    let brackets = dice.pick(&["", "", "()", "[]"]);
    dice.weighted(&[
        (30, UnitPlace::Name(style)),
        (6, UnitPlace::Row(brackets)),
        (2, UnitPlace::Preamble),
        (2, UnitPlace::Missing),
    ])
}

/// Decimal mark and mark of thousands.
fn marks(dice: &mut Dice, dialect: &mut Dialect) {
    let comma_fits = dialect.delimiter != ',' || dialect.quoted;
    if comma_fits && dice.chance(if dialect.language == 0 { 0.15 } else { 0.5 }) {
        dialect.decimal = ',';
    }
    let fits = |mark: &char| {
        *mark != dialect.decimal
            && (*mark != dialect.delimiter || dialect.quoted)
            && !(dialect.delimiter == ' ' && mark.is_whitespace())
    };
    if dice.chance(0.15) {
        let marks = [',', ',', '.', '.', '\'', '\u{202f}', '\u{a0}', '\u{2009}', ' '];
        let marks: Vec<char> = marks.into_iter().filter(fits).collect();
        dialect.thousands = Some(dice.pick(&marks));
        if dialect.numbers != Numbers::Significant {
            dialect.numbers = Numbers::Fixed;
        }
    }
}
