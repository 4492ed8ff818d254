//! Of several columns of a table that measure one quantity and hold other readings, the one that is taken: first by what the
//! readings did when the voltage changed, then by the plainest name; never by their order in the file.

use super::cells::CellTable;
use super::error::{ReadError, quoted};
use super::plausible::plausible;
use super::policy::{ANSWER_FACTOR, LARGER_RIVAL, SAME_READING_SHARE};
use crate::text::header::{Header, Meaning};
use crate::text::names::words_of;
use ieap_domain::{Issue, Quantity};
use ieap_numerics::robust::upper_median;

/// Code of what is said of a column that measures what another one does.
pub const DUPLICATE: &str = "duplicate-quantity";

/// Leaves its meaning to one column of each quantity and place along the strip.
///
/// # Errors
/// Two columns of a response or of the voltage are as good: a person must say which counts.
pub fn settle(
    headers: &[Header],
    cells: &CellTable,
    meanings: &mut [Meaning],
    issues: &mut Vec<Issue>,
) -> Result<(), ReadError> {
    let raw = Asked { headers, cells };
    let raw = &raw;
    // What the voltage did is the witness of the others.
    let voltages = rivals(raw, meanings, Quantity::Voltage);
    for group in voltages.into_iter().chain(others(raw, meanings)) {
        settle_one(raw, meanings, &group, issues)?;
    }
    Ok(())
}

fn others(raw: &Asked<'_>, meanings: &[Meaning]) -> Vec<Vec<usize>> {
    let mut quantities: Vec<Quantity> = meanings.iter().filter_map(Meaning::quantity).collect();
    quantities.sort_unstable();
    quantities.dedup();
    let is_asked =
        |quantity: &Quantity| !matches!(quantity, Quantity::Time | Quantity::Other | Quantity::Voltage);
    let asked = quantities.into_iter().filter(is_asked);
    asked
        .flat_map(|quantity| rivals(raw, meanings, quantity))
        .collect()
}

/// The table whose columns are asked.
struct Asked<'t> {
    headers: &'t [Header],
    cells: &'t CellTable,
}

/// The columns of a quantity that have others of the same place beside them.
fn rivals(raw: &Asked<'_>, meanings: &[Meaning], quantity: Quantity) -> Vec<Vec<usize>> {
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for (index, meaning) in meanings.iter().enumerate() {
        let holds = raw.cells.columns[index]
            .numbers
            .iter()
            .any(|number| number.is_finite());
        if meaning.quantity() != Some(quantity) || !holds {
            continue;
        }
        let place = raw.headers[index].position_mm;
        match groups
            .iter_mut()
            .find(|group| raw.headers[group[0]].position_mm == place)
        {
            Some(group) => group.push(index),
            None => groups.push(vec![index]),
        }
    }
    groups.retain(|group| group.len() > 1);
    groups
}

fn settle_one(
    raw: &Asked<'_>,
    meanings: &mut [Meaning],
    group: &[usize],
    issues: &mut Vec<Issue>,
) -> Result<(), ReadError> {
    let Some(quantity) = meanings[group[0]].quantity() else {
        return Ok(());
    };
    let edge = (quantity != Quantity::Voltage)
        .then(|| drive_edge(raw, meanings))
        .flatten();
    let looks: Vec<Look> = group
        .iter()
        .map(|index| Look::of(raw, meanings, *index, edge))
        .collect();
    let name = |at: usize| quoted(&raw.headers[group[at]].raw_name);
    let (winner, reason) = match chosen(&looks, quantity) {
        Ok(found) => found,
        Err((first, second)) if quantity.is_response() || quantity == Quantity::Voltage => {
            return Err(ReadError::Column {
                line: raw.cells.header_line,
                index: group[second] + 1,
                column: name(second),
                reason: format!(
                    "it measures what column {} does and holds other readings, and neither what they did at the steps of the \
                     voltage nor their names tell which counts; say which counts, or mend the unit of one",
                    name(first)
                ),
            });
        }
        Err((first, second)) => {
            group.iter().for_each(|index| meanings[*index] = Meaning::Other);
            let message = format!(
                "columns {} and {} measure one quantity and hold other readings, and nothing tells which counts; neither is used",
                name(first),
                name(second)
            );
            issues.push(
                Issue::warning(DUPLICATE, message)
                    .at(format!("column {}", group[second] + 1))
                    .mend("give the one that does not count another name"),
            );
            return Ok(());
        }
    };
    for (at, index) in group.iter().enumerate().filter(|(at, _)| *at != winner) {
        meanings[*index] = Meaning::Other;
        let message = format!(
            "column {} measures what {} does{reason}; it is kept under its own name",
            name(at),
            name(winner)
        );
        issues.push(Issue::note(DUPLICATE, message).at(format!("column {}", index + 1)));
    }
    Ok(())
}

/// What is to be known of a column.
struct Look {
    values: Vec<f64>,
    /// Words of its name; none where the whole name is that of the quantity.
    words: usize,
    is_sensible: bool,
    /// Whether it moved when the voltage did; none where nothing shows it.
    answers: Option<bool>,
    spread: f64,
}

impl Look {
    fn of(raw: &Asked<'_>, meanings: &[Meaning], index: usize, edge: Option<usize>) -> Look {
        let values = converted(raw, meanings, index);
        let header = &raw.headers[index];
        let quantity = meanings[index].quantity().unwrap_or(Quantity::Other);
        let range = plausible(quantity);
        let is_sensible = values
            .iter()
            .filter(|value| value.is_finite())
            .all(|value| range.is_none_or(|(low, high)| (low..=high).contains(value)));
        let spread = spread(&values);
        let answers = match quantity {
            Quantity::Voltage => Some(edge_of(&values).is_some()),
            _ if spread == 0.0 => Some(false),
            _ => edge.and_then(|edge| moved(&values, edge)),
        };
        Look {
            words: if header.is_named_wholly() {
                0
            } else {
                words_of(&header.raw_name).iter().map(|word| letters(word)).sum()
            },
            is_sensible,
            answers,
            spread,
            values,
        }
    }

    fn is_same(&self, other: &Look) -> bool {
        let mut pairs = self.values.iter().zip(&other.values);
        // What is not there differs from nothing.
        let differs = |(a, b): (&f64, &f64)| (a - b).abs() > SAME_READING_SHARE * a.abs().max(b.abs());
        !pairs.any(differs)
    }
}

/// One for a word, one for each sign where words have no blanks between them.
fn letters(word: &str) -> usize {
    let signs = word.chars().filter(|c| *c > '\u{2e80}').count();
    signs.max(1)
}

/// The place of the one that counts, with the reason; else two that are as good.
fn chosen(looks: &[Look], quantity: Quantity) -> Result<(usize, &'static str), (usize, usize)> {
    let mut left: Vec<usize> = (0..looks.len()).collect();
    let plainest = |left: &[usize]| left.iter().map(|at| looks[*at].words).min().unwrap_or(0);
    if looks[1..].iter().all(|look| look.is_same(&looks[0])) {
        let words = plainest(&left);
        return Ok((
            left.into_iter().find(|at| looks[*at].words == words).unwrap_or(0),
            "",
        ));
    }
    if !quantity.is_response() {
        // Of a response one of two units may be wrong: a person must say which.
        only(&mut left, |at| looks[at].is_sensible);
    }
    if quantity.is_response() || matches!(quantity, Quantity::Voltage | Quantity::BlockingForce) {
        only(&mut left, |at| looks[at].answers == Some(true));
        only(&mut left, |at| looks[at].answers != Some(false));
    }
    if let [one] = left[..] {
        return Ok((one, ", which alone went with the voltage or can be one"));
    }
    let words = plainest(&left);
    let named: Vec<usize> = left
        .iter()
        .copied()
        .filter(|at| looks[*at].words == words)
        .collect();
    let [one] = named[..] else {
        return Err((named[0], named[1]));
    };
    // A word is not enough against readings: what is far smaller than another that answers is hardly the quantity itself.
    let larger = left
        .iter()
        .copied()
        .find(|at| quantity.is_response() && looks[*at].spread > LARGER_RIVAL * looks[one].spread);
    match larger {
        Some(other) => Err((one, other)),
        None => Ok((one, ", whose name is plainer")),
    }
}

/// Keeps those of which something holds, where it holds of any.
fn only(left: &mut Vec<usize>, holds: impl Fn(usize) -> bool) {
    if left.iter().any(|at| holds(*at)) {
        left.retain(|at| holds(*at));
    }
}

fn converted(raw: &Asked<'_>, meanings: &[Meaning], index: usize) -> Vec<f64> {
    let conversion = meanings[index].conversion();
    let numbers = raw.cells.columns[index].numbers.iter();
    numbers.map(|number| conversion.apply(*number)).collect()
}

/// The first row at which the voltage of a table changed.
fn drive_edge(raw: &Asked<'_>, meanings: &[Meaning]) -> Option<usize> {
    let of = |quantity| {
        (0..meanings.len())
            .filter(move |index| meanings[*index].quantity() == Some(quantity))
            .find_map(|index| edge_of(&converted(raw, meanings, index)))
    };
    of(Quantity::Voltage).or_else(|| of(Quantity::ControlVoltage))
}

/// The first row from which on readings are at another level: noise and slow courses have none.
fn edge_of(values: &[f64]) -> Option<usize> {
    const AROUND: usize = 3;
    let range = spread(values);
    let level = |rows: &[f64]| upper_median(&mut rows.to_vec());
    (1..values.len()).find(|&row| {
        let (before, after) = (
            &values[row.saturating_sub(AROUND)..row],
            &values[row..(row + AROUND).min(values.len())],
        );
        let steps = level(before).zip(level(after));
        (values[row] - values[row - 1]).abs() > 0.5 * range
            && steps.is_some_and(|(before, after)| (after - before).abs() > 0.5 * range)
    })
}

/// Whether readings moved behind a row far more than in as many rows before it; none where too few stand before it.
fn moved(values: &[f64], edge: usize) -> Option<bool> {
    let rows = edge.min(values.len() - edge);
    if rows < 2 {
        return None;
    }
    let before = spread(&values[edge - rows..edge]);
    let after = spread(&values[edge - 1..edge + rows]);
    Some(after > ANSWER_FACTOR * before)
}

fn spread(values: &[f64]) -> f64 {
    let finite = values.iter().filter(|value| value.is_finite());
    let (low, high) = finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
        (low.min(*value), high.max(*value))
    });
    (high - low).max(0.0)
}
