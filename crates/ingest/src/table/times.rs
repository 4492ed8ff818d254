//! What times the rows: an elapsed time, a wall clock, or both, each held against the other.
//!
//! A time is taken when the file says its unit or its form, or when another column shows it. Where elapsed time and wall clock
//! of the same rows contradict each other a person is asked.

use jiff::tz::TimeZone;

use super::duration::{self, Fields, TwoFields};
use super::kind::Kind;
use super::order::{in_name, taken};
use super::question::Question;
use super::read::{Settled, Table};
use super::rows;
use super::stated_times;
use crate::formats::ReadContext;
use crate::formats::climate::moments::{Moments, NoOrder, moments_in};
use crate::formats::error::{ReadError, quoted};
use crate::formats::policy::{BAD_SHARE, GOING_BACK_SHARE};
use crate::formats::stamp::{DateOrder, in_digits};
use crate::table::policy::{CLOCK_RESOLUTIONS, CLOCKS_AGREE_SHARE};
use crate::text::header::{Header, Meaning};
use crate::text::names::{counts_from_a_start, is_unit_of_time, names_time};
use crate::{StartedAt, Timestamp};
use ieap_domain::unit::{self, Conversion};
use ieap_domain::words::in_a_row;
use ieap_domain::{Issue, Quantity};

/// An elapsed time: its column and its numbers, with the unit that the file states.
pub(super) struct Elapsed {
    pub column: usize,
    pub numbers: Vec<f64>,
    pub stated: Option<Conversion>,
}

/// A wall clock: the columns that it stands in, and the moments of the rows.
pub(super) struct Wall {
    columns: Vec<usize>,
    moments: Moments,
    /// Which rows have a moment.
    at: Vec<usize>,
    raw: String,
    reason: String,
    offset: Option<String>,
}

/// Settles what times the rows of a table, whose cells it may put into another order.
///
/// # Errors
/// Nothing times them, or what does can be read in several ways.
pub fn settle(
    table: &mut Table<'_>,
    context: &ReadContext,
    issues: &mut Vec<Issue>,
) -> Result<Settled, ReadError> {
    if let Some((stated, placed)) = context.answers.table().zip(table.layout.stated.clone()) {
        return stated_times::settle(table, (stated, &placed), context, issues);
    }
    let wall = wall(table, context, issues)?;
    let elapsed = elapsed(table, wall.as_ref(), context, issues)?;
    match (elapsed, wall) {
        (Some(elapsed), wall) => with_elapsed(table, elapsed, wall, context, issues),
        (None, Some(wall)) => Ok(by_wall(table, wall)),
        (None, None) => Ok(Settled::default()),
    }
}

/// The rows are timed by the elapsed time; the wall clock is its witness and gives the start.
pub(super) fn with_elapsed(
    table: &mut Table<'_>,
    mut elapsed: Elapsed,
    wall: Option<Wall>,
    context: &ReadContext,
    issues: &mut Vec<Issue>,
) -> Result<Settled, ReadError> {
    let header = table.headers[elapsed.column].clone();
    let line = table.cells.line_of_row.first().map_or(0, |line| *line as usize);
    let conversion = unit_of(&elapsed, &header, wall.as_ref(), context, line, issues)?;
    if elapsed.numbers.iter().any(|number| number.is_finite()) {
        rows::go_on(
            table,
            &mut elapsed.numbers,
            wall.as_ref()
                .map(|wall| (&wall.at[..], &wall.moments.elapsed_s[..])),
            conversion,
            issues,
        )?;
    }
    let column = &mut table.cells.columns[elapsed.column];
    column.numbers = elapsed.numbers;
    column.filled = column.numbers.len();
    column.text = Default::default();
    column.texts.clear();
    column.keep_text = false;
    let dated = wall
        .as_ref()
        .and_then(|wall| wall.at.first().copied())
        .unwrap_or(0);
    let first = table.cells.columns[elapsed.column]
        .numbers
        .get(dated)
        .copied()
        .filter(|first| first.is_finite());
    time_by(table, elapsed.column, conversion);
    let started_at = wall.as_ref().map(|wall| {
        let zero_s = first.map_or(0.0, |first| conversion.apply(first))
            - wall.moments.elapsed_s.first().copied().unwrap_or(0.0);
        wall.start(zero_s)
    });
    Ok(Settled {
        started_at,
        is_clock: false,
        spent: wall.map_or(Vec::new(), |wall| wall.columns),
        set_back: Vec::new(),
    })
}

/// The unit of an elapsed time: stated and not contradicted, answered, or shown by the wall clock beside it.
fn unit_of(
    elapsed: &Elapsed,
    header: &Header,
    wall: Option<&Wall>,
    context: &ReadContext,
    line: usize,
    issues: &mut Vec<Issue>,
) -> Result<Conversion, ReadError> {
    let unit = |word: &str| unit::conversion(Quantity::Time, word).ok();
    // An answer settles what is open, and nothing else.
    let or_answered = |asked: ReadError| context.answers.of("elapsed").and_then(unit).ok_or(asked);
    let shown = wall.and_then(|wall| wall.seconds_per(elapsed));
    let by_wall = wall.and_then(|wall| unit_shown(wall, elapsed));
    match (elapsed.stated, shown) {
        (Some(stated), None) => Ok(stated),
        (Some(stated), Some(shown)) if agrees(stated, shown) => Ok(stated),
        (Some(stated), Some((ratio, _))) => {
            let stated_word = UNITS
                .into_iter()
                .find(|word| unit(word) == Some(stated))
                .unwrap_or("s");
            let mut answers = vec![(
                stated_word.to_owned(),
                "it counts as its name says, and the dates are wrong".to_owned(),
            )];
            answers.extend(
                by_wall.map(|word| (word.to_owned(), format!("it counts {word}, as the dates show"))),
            );
            or_answered(ReadError::Asked(Question {
                key: "elapsed",
                column: header.raw_name.clone(),
                line,
                found: format!(
                    "counts by its name {} s where the dates beside it count {} s",
                    rounded(stated.apply(1.0)),
                    rounded(ratio)
                ),
                answers,
            }))
        }
        (None, Some(_)) if by_wall.is_some() => {
            let word = by_wall.unwrap_or("s");
            let message = format!(
                "column {} names no unit; it counts {word}, as the dates beside it show",
                quoted(&header.raw_name)
            );
            issues.push(Issue::note("time-unit-shown", message));
            unit(word).ok_or_else(|| no_unit(header, line))
        }
        (None, _) => or_answered(no_unit(header, line)),
    }
}

/// Units that an elapsed time may count.
const UNITS: [&str; 6] = ["s", "ms", "us", "min", "h", "d"];

fn agrees(conversion: Conversion, (ratio, error): (f64, f64)) -> bool {
    (conversion.apply(1.0) - ratio).abs() <= error
}

/// The unit of an elapsed time that the wall clock beside it shows.
fn unit_shown(wall: &Wall, elapsed: &Elapsed) -> Option<&'static str> {
    let shown = wall.seconds_per(elapsed)?;
    let is_it = |word: &&str| unit::conversion(Quantity::Time, word).is_ok_and(|unit| agrees(unit, shown));
    UNITS.into_iter().find(is_it)
}

/// A ratio with two digits, as people compare it.
fn rounded(ratio: f64) -> f64 {
    let digits = 10f64.powf(1.0 - ratio.abs().log10().floor());
    (ratio * digits).round() / digits
}

fn no_unit(header: &Header, line: usize) -> ReadError {
    ReadError::Asked(Question {
        key: "elapsed",
        column: header.raw_name.clone(),
        line,
        found: match header.raw_unit.as_str() {
            "" => "names no unit of time".to_owned(),
            unit => format!("has the unit {}, which is no known one of time", quoted(unit)),
        },
        answers: [
            ("s", "it counts seconds"),
            ("ms", "milliseconds"),
            ("min", "minutes"),
            ("h", "hours"),
        ]
        .map(|(word, meaning)| (word.to_owned(), meaning.to_owned()))
        .to_vec(),
    })
}

impl Wall {
    /// Seconds by the dates for one unit of the elapsed time, with how far off that may be; none where the dates stand still.
    fn seconds_per(&self, elapsed: &Elapsed) -> Option<(f64, f64)> {
        let own: Vec<(f64, f64)> = (self.at.iter().zip(&self.moments.elapsed_s))
            .map(|(row, wall_s)| (elapsed.numbers[*row], *wall_s))
            .filter(|(number, _)| number.is_finite())
            .collect();
        let (first, last) = (own.first()?, own.last()?);
        let (counted, passed_s) = (last.0 - first.0, last.1 - first.1);
        // Printed to whole seconds or minutes, a date may be off by that much at both ends.
        let step_s = own
            .windows(2)
            .map(|pair| (pair[1].1 - pair[0].1).abs())
            .filter(|step| *step > 0.0)
            .fold(f64::INFINITY, f64::min);
        let resolution_s = step_s.min(self.printed_s());
        if counted == 0.0 || passed_s.abs() < CLOCK_RESOLUTIONS * resolution_s {
            return None;
        }
        let ratio = passed_s / counted;
        Some((
            ratio,
            ratio.abs() * CLOCKS_AGREE_SHARE + 2.0 * self.printed_s() / counted.abs(),
        ))
    }

    /// The last digit of the dates, s.
    fn printed_s(&self) -> f64 {
        let raw = in_digits(&self.raw);
        let seconds = raw.matches(':').count() >= 2;
        let fraction = raw
            .rsplit(':')
            .next()
            .is_some_and(|last| last.contains(['.', ',']));
        match (fraction, seconds) {
            (true, _) => 1e-3,
            (false, true) => 1.0,
            (false, false) if raw.contains(':') => 60.0,
            _ => 1e-3,
        }
    }

    /// The moment `zero_s` before the first row's.
    fn start(&self, zero_s: f64) -> StartedAt {
        let nanoseconds = (zero_s * 1e9).round();
        let first = self.moments.first;
        let span = jiff::SignedDuration::from_nanos(nanoseconds as i64);
        let local = first.checked_sub(span).unwrap_or(first);
        StartedAt {
            raw: self.raw.clone(),
            kind: Timestamp::Start,
            local: Some(local.to_string()),
            offset: self.offset.clone(),
            basis: format!("the first row, {}{}", self.moments.order.words(), self.reason),
        }
    }
}

/// One column times the rows; other times are columns of their own.
fn time_by(table: &mut Table<'_>, column: usize, conversion: Conversion) {
    for header in &mut table.headers {
        if header.meaning.named_quantity() == Some(Quantity::Time) {
            header.meaning = Meaning::Other;
        }
    }
    table.headers[column].meaning = Meaning::Known {
        quantity: Quantity::Time,
        conversion,
    };
}

/// The rows are timed by the wall clock, in seconds from the first.
pub(super) fn by_wall(table: &mut Table<'_>, wall: Wall) -> Settled {
    let [at, others @ ..] = wall.columns.as_slice() else {
        return Settled::default();
    };
    let mut seconds = vec![f64::NAN; table.cells.rows()];
    for (row, elapsed_s) in wall.at.iter().zip(&wall.moments.elapsed_s) {
        seconds[*row] = *elapsed_s;
    }
    let column = &mut table.cells.columns[*at];
    column.numbers = seconds;
    column.filled = wall.at.len();
    column.text = Default::default();
    column.texts.clear();
    column.keep_text = false;
    table.headers[*at].raw_unit = String::new();
    time_by(table, *at, Conversion::IDENTITY);
    Settled {
        started_at: Some(wall.start(0.0)),
        is_clock: true,
        spent: others.to_vec(),
        set_back: wall.moments.set_back,
    }
}

/// The elapsed time of a table, numbers before durations; none where there is none.
fn elapsed(
    table: &Table<'_>,
    wall: Option<&Wall>,
    context: &ReadContext,
    issues: &mut Vec<Issue>,
) -> Result<Option<Elapsed>, ReadError> {
    let is_spent = |column: &usize| wall.is_some_and(|wall| wall.columns.contains(column));
    let columns = || (0..table.headers.len()).filter(|column| !is_spent(column));
    let is_number = |column: &usize| table.kind(*column) == Kind::Number;
    let is_time = |column: &usize| {
        let header = &table.headers[*column];
        header.meaning.named_quantity() == Some(Quantity::Time) || is_unit_of_time(&header.raw_name)
    };
    let corrected = |column: &usize| {
        table.headers[*column]
            .raw_name
            .to_lowercase()
            .starts_with("corrected time")
    };
    let numeric: Vec<usize> = columns().filter(is_number).filter(is_time).collect();
    // A letter may be a temperature as well: words go before it, and what states its unit before what does not.
    let weight = |column: &usize| {
        let header = &table.headers[*column];
        (
            !corrected(column),
            header.meaning.quantity().is_none() && !is_unit_of_time(&header.raw_name),
            header.raw_name.chars().count() == 1,
        )
    };
    let whole_clock = columns().find(|column| table.kind(*column) == Kind::Clock);
    if let Some(column) = numeric.into_iter().min_by_key(weight) {
        let header = &table.headers[column];
        let stated = match &header.meaning {
            Meaning::Known { conversion, .. } => Some(*conversion),
            _ => unit::conversion(Quantity::Time, header.raw_name.trim()).ok(),
        };
        let found = Elapsed {
            column,
            numbers: table.cells.columns[column].numbers.clone(),
            stated,
        };
        // A letter that no clock beside it shows to be a time is something else.
        let is_letter = header.raw_name.chars().count() == 1;
        let is_other = is_letter && wall.is_some_and(|wall| unit_shown(wall, &found).is_none());
        if stated.is_some() || (whole_clock.is_none() && !is_other) {
            return Ok(Some(found));
        }
    }
    whole_clock
        .map(|column| durations(table, column, wall, context, issues))
        .transpose()
}

/// Seconds of a column of durations or times of day.
fn durations(
    table: &Table<'_>,
    column: usize,
    wall: Option<&Wall>,
    context: &ReadContext,
    issues: &mut Vec<Issue>,
) -> Result<Elapsed, ReadError> {
    let header = &table.headers[column];
    let texts = table.texts_of(column);
    let fields: Vec<Option<Fields>> = texts.iter().map(|text| duration::fields(text)).collect();
    let known: Vec<&Fields> = fields.iter().flatten().collect();
    let seconds = |two: TwoFields| -> Vec<f64> {
        fields
            .iter()
            .map(|found| found.as_ref().map_or(f64::NAN, |found| found.seconds(two)))
            .collect()
    };
    let two = two_fields(table, column, &known, wall, context, &seconds)?;
    let mut numbers = seconds(two);
    let lower = header.raw_name.to_lowercase();
    let counts = counts_from_a_start(&lower) || known.iter().any(|found| !found.fits_a_day());
    if !counts {
        past_midnight(&mut numbers, issues);
        let first = numbers
            .iter()
            .copied()
            .find(|number| number.is_finite())
            .unwrap_or(0.0);
        numbers.iter_mut().for_each(|number| *number -= first);
    }
    Ok(Elapsed {
        column,
        numbers,
        stated: Some(Conversion::IDENTITY),
    })
}

/// What two fields are: as the name says, as only minutes and seconds have a fraction, as the dates beside it show, or asked.
fn two_fields(
    table: &Table<'_>,
    column: usize,
    known: &[&Fields],
    wall: Option<&Wall>,
    context: &ReadContext,
    seconds: &dyn Fn(TwoFields) -> Vec<f64>,
) -> Result<TwoFields, ReadError> {
    let header = &table.headers[column];
    let of_two = known.iter().filter(|found| found.count == 2);
    if of_two.clone().next().is_none() {
        return Ok(TwoFields::MinutesSeconds);
    }
    let unit = table.layout.shape.units.get(column).map_or("", String::as_str);
    if let Some(stated) = TwoFields::stated_in(&header.raw_name).or_else(|| TwoFields::stated_in(unit)) {
        return Ok(stated);
    }
    if of_two.clone().any(|found| found.is_of_day) {
        return Ok(TwoFields::HoursMinutes);
    }
    if known.iter().any(|found| found.count == 3) {
        // `59:59` goes on to `1:00:00`.
        return Ok(TwoFields::MinutesSeconds);
    }
    if of_two.clone().any(|found| found.has_fraction) {
        return Ok(TwoFields::MinutesSeconds);
    }
    let by_wall = wall.and_then(|wall| {
        let agrees = |two: &TwoFields| {
            let own = Elapsed {
                column,
                numbers: seconds(*two),
                stated: None,
            };
            wall.seconds_per(&own)
                .is_some_and(|(ratio, error)| (ratio - 1.0).abs() <= error)
        };
        TwoFields::ALL.into_iter().find(agrees)
    });
    let answered = context.answers.of("clock");
    let answer = || {
        TwoFields::ALL
            .into_iter()
            .find(|two| answered == Some(two.word()))
    };
    if let Some(two) = by_wall.or_else(answer) {
        return Ok(two);
    }
    let texts = table.texts_of(column);
    let last = texts
        .iter()
        .rev()
        .find(|text| !text.is_empty())
        .copied()
        .unwrap_or("");
    let meaning = |two: TwoFields| {
        let all = seconds(two);
        let last = all
            .iter()
            .rev()
            .find(|number| number.is_finite())
            .copied()
            .unwrap_or(0.0);
        (two.word().to_owned(), format!("the last row is {last} s"))
    };
    Err(ReadError::Asked(Question {
        key: "clock",
        column: header.raw_name.clone(),
        line: table.cells.line_of_row.first().map_or(0, |line| *line as usize),
        found: format!("holds two fields, last {}", quoted(last)),
        answers: TwoFields::ALL.map(meaning).to_vec(),
    }))
}

/// Times of day that go back by most of a day have passed midnight.
pub(super) fn past_midnight(seconds: &mut [f64], issues: &mut Vec<Issue>) {
    const DAY_S: f64 = 86_400.0;
    let (mut days, mut before) = (0.0, f64::NEG_INFINITY);
    for second in seconds.iter_mut().filter(|second| second.is_finite()) {
        let today = *second;
        if today < before - DAY_S / 2.0 {
            days += 1.0;
        }
        before = today;
        *second += days * DAY_S;
    }
    if days > 0.0 {
        let message = format!("the times of day pass midnight {days} time(s)");
        issues.push(Issue::note("midnight-passed", message));
    }
}

/// The wall clock of a table; none where there is none.
fn wall(
    table: &mut Table<'_>,
    context: &ReadContext,
    issues: &mut Vec<Issue>,
) -> Result<Option<Wall>, ReadError> {
    let of_kind = |table: &Table<'_>, kind: Kind| -> Vec<usize> {
        (0..table.headers.len())
            .filter(|column| table.kind(*column) == kind)
            .collect()
    };
    let moments_in = of_kind(table, Kind::Moment);
    let by_name = |column: &&usize| names_time(&table.headers[**column].raw_name);
    let whole = moments_in.iter().find(by_name).or(moments_in.first()).copied();
    let pair = || {
        let date = *of_kind(table, Kind::Date).first()?;
        // Beside a time of day there may be an elapsed time in the same form, which begins at zero.
        let weight = |column: &usize| {
            let lower = table.headers[*column].raw_name.to_lowercase();
            let counts = counts_from_a_start(&lower);
            let first = table.texts_of(*column).into_iter().find_map(duration::fields);
            let is_zero = first.is_some_and(|first| first.seconds(TwoFields::MinutesSeconds) == 0.0);
            (counts, is_zero)
        };
        let clock = of_kind(table, Kind::Clock).into_iter().min_by_key(weight);
        Some((date, clock.filter(|clock| !weight(clock).0)))
    };
    let epoch = super::epoch::find(table);
    let found = match (whole, pair()) {
        (Some(column), _) => Some((
            vec![column],
            table
                .texts_of(column)
                .into_iter()
                .map(str::to_owned)
                .collect::<Vec<_>>(),
        )),
        (None, Some((date, Some(clock)))) => {
            let (dates, clocks) = (table.texts_of(date), table.texts_of(clock));
            let texts = dates
                .iter()
                .zip(&clocks)
                .map(|(date, clock)| format!("{date} {clock}"));
            Some((vec![date, clock], texts.collect()))
        }
        _ => None,
    };
    let mut wall = match found {
        Some((columns, texts)) => {
            let dates = Dates {
                orders: &DateOrder::ALL,
                order: context.date_order,
                zone: None,
            };
            Some(by_dates(table, columns, &texts, dates, issues)?)
        }
        None => None,
    };
    if let Some(epoch) = epoch {
        wall = Some(
            super::epoch::wall(table, epoch, wall.map(|wall| (wall.columns, wall.moments.first))).into(),
        );
    }
    Ok(wall)
}

impl From<super::epoch::EpochWall> for Wall {
    fn from(found: super::epoch::EpochWall) -> Wall {
        Wall {
            columns: found.columns,
            at: found.at,
            moments: found.moments,
            raw: found.raw,
            reason: found.reason.to_owned(),
            offset: found.offset,
        }
    }
}

/// The order that the name of the column states, where it is one of these.
fn named_order(name: &str, orders: &[DateOrder]) -> Option<(DateOrder, &'static str)> {
    let order = in_name(name).filter(|order| orders.contains(order))?;
    Some((order, ", as the name of the column states"))
}

/// How dates may be read.
#[derive(Clone, Copy)]
pub(super) struct Dates<'d> {
    /// In one of these orders of day, month and year.
    pub orders: &'d [DateOrder],
    /// The order that counts where several fit.
    pub order: Option<DateOrder>,
    /// Where the clock stood, where that is known.
    pub zone: Option<&'d TimeZone>,
}

/// What is wrong with a column of which more than a twentieth of the cells are none of what it must hold, and the first of them.
pub(super) fn unread<'t>(
    texts: &'t [impl AsRef<str>],
    reads: impl Fn(&str) -> bool,
    needed: &str,
) -> Option<(String, &'t str)> {
    let filled = texts
        .iter()
        .map(AsRef::as_ref)
        .filter(|text| !text.trim().is_empty());
    let unread: Vec<&str> = filled.filter(|text| !reads(text)).collect();
    let rows = texts.len();
    let are_many = unread.len() > 1 && unread.len() as f64 > BAD_SHARE * rows as f64;
    let found = format!("{} of {rows} rows hold no {needed}", unread.len());
    are_many.then(|| (found, unread[0]))
}

fn no_dates(table: &Table<'_>, column: usize, found: &str, first: &str) -> ReadError {
    ReadError::AmbiguousDates {
        line: table.cells.line_of_row.first().map_or(0, |line| *line as usize),
        column: quoted(&table.headers[column].raw_name),
        found: format!("{found}, first {}", quoted(first)),
        first: first.to_owned(),
    }
}

/// The moments of dates under the one order that fits all of them; the newest may come first.
pub(super) fn by_dates(
    table: &mut Table<'_>,
    columns: Vec<usize>,
    texts: &[String],
    Dates { orders, order, zone }: Dates<'_>,
    issues: &mut Vec<Issue>,
) -> Result<Wall, ReadError> {
    let is_date = |text: &str| super::kind::is_moment_in(&in_digits(text), orders);
    let mut at: Vec<usize> = (0..texts.len()).filter(|row| is_date(&texts[*row])).collect();
    let mut dates: Vec<&str> = at.iter().map(|row| texts[*row].as_str()).collect();
    if let Some((found, first)) = unread(texts, is_date, "date") {
        return Err(no_dates(table, columns[0], &found, first));
    }
    // An order that is stated is no guess that rows in disorder speak against; more going back than forward are newest first.
    let is_stated = orders.len() < DateOrder::ALL.len();
    let back = if is_stated { 0.5 } else { GOING_BACK_SHARE };
    let name = table.headers[columns[0]].raw_name.clone();
    let refused = |table: &Table<'_>, found: &str, first: &str| no_dates(table, columns[0], found, first);
    if dates.is_empty() {
        return Err(refused(table, "no row holds a date", ""));
    }
    let mut found = moments_in(&dates, orders, zone, back);
    if found == Err(NoOrder::Fits) {
        dates.reverse();
        found = moments_in(&dates, orders, zone, back);
        if found != Err(NoOrder::Fits) {
            let rows = texts.len();
            at = at.into_iter().rev().map(|row| rows - 1 - row).collect();
            table.reverse();
            issues.push(Issue::note(
                "newest-first",
                "the newest row comes first; rows are read from the last to the first",
            ));
        }
    }
    let (moments, reason) = match found {
        Ok(found) => (found, String::new()),
        Err(NoOrder::Fits) => {
            let reason = "no order of day, month and year makes all rows dates that follow each other";
            return Err(refused(table, reason, texts.first().map_or("", String::as_str)));
        }
        Err(NoOrder::Several(orders)) => {
            match named_order(&name, &orders).or_else(|| taken(dates[0], &orders, order)) {
                Some((order, reason)) => match moments_in(&dates, &[order], zone, back) {
                    Ok(found) => (found, reason.to_owned()),
                    Err(_) => return Err(refused(table, "no order fits", dates[0])),
                },
                None => {
                    let orders: Vec<&str> = orders.into_iter().map(DateOrder::words).collect();
                    let found = format!("{} fit all rows alike", in_a_row(&orders));
                    return Err(refused(table, &found, dates[0]));
                }
            }
        }
    };
    let mut moments = moments;
    let mut offset = moments.in_utc.then(|| "+00:00".to_owned());
    if let Some((zone, utc)) = zone.zip(TimeZone::UTC.to_timestamp(moments.first).ok()) {
        moments.first = zone.to_datetime(utc);
        offset = Some(super::zone::shown(i64::from(zone.to_offset(utc).seconds()) / 60));
    }
    Ok(Wall {
        columns,
        raw: dates[0].to_owned(),
        moments,
        at,
        reason,
        offset,
    })
}
