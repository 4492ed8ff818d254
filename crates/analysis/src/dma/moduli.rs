//! The complex modulus and the loss factor of a log: as the instrument gives them, else computed.

use super::policy::{DISAGREEMENT, FEWEST_OF_FREQUENCY, FREQUENCY_SHARE, SAME_FREQUENCY};

use ieap_domain::number::fixed;
use ieap_domain::{Channel, Issue, Quantity};

/// Moduli over time.
#[derive(Debug, Clone, PartialEq)]
pub struct Moduli {
    /// Times, s.
    pub time_s: Vec<f64>,
    /// |E*|, MPa.
    pub complex_mpa: Vec<f64>,
    /// tan delta at the same times, where it can be had.
    pub loss_factor: Option<Vec<f64>>,
    /// How |E*| was had, in words.
    pub source: String,
    /// Frequency, Hz, where the log states it.
    pub frequency_hz: Option<f64>,
    /// What a reader must know.
    pub issues: Vec<Issue>,
}

/// The first channel of that quantity that has readings.
pub fn channel(channels: &[Channel], quantity: Quantity) -> Option<&Channel> {
    channels.iter().find(|channel| channel.is_whole(quantity))
}

/// One row of readings taken at once.
#[derive(Debug, Clone, Copy, Default)]
struct Row {
    time_s: f64,
    storage: Option<f64>,
    loss: Option<f64>,
    complex: Option<f64>,
    loss_factor: Option<f64>,
    frequency: Option<f64>,
}

impl Row {
    /// |E*| from the other columns: sqrt(E'^2 + E''^2), or by tan delta = E''/E'.
    fn computed_complex(&self) -> Option<f64> {
        let slope = self.loss_factor.map(|tan| (1.0 + tan * tan).sqrt());
        match (self.storage, self.loss) {
            (Some(storage), Some(loss)) => Some(storage.hypot(loss)),
            (Some(storage), None) => Some(storage.abs() * slope?),
            (None, Some(loss)) => Some((loss / self.loss_factor?).abs() * slope?),
            (None, None) => None,
        }
    }

    /// tan delta from the other columns.
    fn computed_loss_factor(&self) -> Option<f64> {
        match (self.storage, self.loss, self.complex) {
            (Some(storage), Some(loss), _) => Some(loss / storage),
            (Some(storage), None, Some(complex)) if complex >= storage && storage > 0.0 => {
                Some(((complex / storage).powi(2) - 1.0).sqrt())
            }
            _ => None,
        }
    }
}

/// The moduli of a log's channels, those of one frequency.
///
/// # Errors
/// |E*| cannot be had from the columns, or no frequency has readings enough.
pub fn moduli(channels: &[Channel]) -> Result<Moduli, Issue> {
    let mut issues = Vec::new();
    let mut rows = rows(channels);
    let frequency_hz = one_frequency(&mut rows, &mut issues)?;
    let is_given = channel(channels, Quantity::ComplexModulus).is_some();
    let pairs: Vec<(Row, f64)> = rows
        .iter()
        .filter_map(|row| {
            let complex = if is_given {
                row.complex
            } else {
                row.computed_complex()
            };
            Some((*row, complex.filter(|e| e.is_finite())?))
        })
        .collect();
    if pairs.is_empty() {
        return Err(not_complex(channels));
    }
    if is_given {
        let check = |row: &Row| row.complex.zip(row.computed_complex());
        issues.extend(disagreement(&rows, "|E*|", check));
    }
    let gives_factor = channel(channels, Quantity::LossFactor).is_some();
    if gives_factor {
        let check = |row: &Row| {
            let computed = row.storage.zip(row.loss).map(|(storage, loss)| loss / storage);
            row.loss_factor.zip(computed)
        };
        issues.extend(disagreement(&rows, "the loss factor", check));
    }
    let factor = |row: &Row| {
        if gives_factor {
            row.loss_factor
        } else {
            row.computed_loss_factor()
        }
    };
    let loss_factor: Option<Vec<f64>> = pairs
        .iter()
        .map(|(row, _)| factor(row).filter(|tan| tan.is_finite()))
        .collect();
    Ok(Moduli {
        time_s: pairs.iter().map(|(row, _)| row.time_s).collect(),
        complex_mpa: pairs.iter().map(|(_, complex)| *complex).collect(),
        loss_factor,
        source: source(channels, is_given).to_owned(),
        frequency_hz,
        issues,
    })
}

fn source(channels: &[Channel], is_given: bool) -> &'static str {
    let has = |quantity| channel(channels, quantity).is_some();
    match (
        is_given,
        has(Quantity::StorageModulus),
        has(Quantity::LossModulus),
    ) {
        (true, ..) => "|E*| as the instrument gives it",
        (false, true, true) => "|E*| = √(E′² + E″²) from storage and loss modulus",
        (false, true, false) => "|E*| from storage modulus and loss factor",
        _ => "|E*| from loss modulus and loss factor",
    }
}

/// Readings by the times of the first modulus; what was not read at that very time is missing in the row.
fn rows(channels: &[Channel]) -> Vec<Row> {
    let base = [
        Quantity::ComplexModulus,
        Quantity::StorageModulus,
        Quantity::LossModulus,
    ];
    let Some(base) = base.into_iter().find_map(|quantity| channel(channels, quantity)) else {
        return Vec::new();
    };
    let (time_s, _) = base.included();
    let mut rows: Vec<Row> = time_s
        .iter()
        .map(|&time_s| Row {
            time_s,
            ..Row::default()
        })
        .collect();
    let mut fill = |quantity, set: fn(&mut Row, f64)| {
        let Some(channel) = channel(channels, quantity) else {
            return;
        };
        let (time_s, values) = channel.included();
        let mut at = 0;
        for row in &mut rows {
            while at < time_s.len() && time_s[at] < row.time_s {
                at += 1;
            }
            if time_s.get(at) == Some(&row.time_s) {
                set(row, values[at]);
            }
        }
    };
    fill(Quantity::StorageModulus, |row, v| row.storage = Some(v));
    fill(Quantity::LossModulus, |row, v| row.loss = Some(v));
    fill(Quantity::ComplexModulus, |row, v| row.complex = Some(v));
    fill(Quantity::LossFactor, |row, v| row.loss_factor = Some(v));
    fill(Quantity::Frequency, |row, v| row.frequency = Some(v));
    rows
}

/// Keeps the rows of the frequency that most rows have; gives it.
fn one_frequency(rows: &mut Vec<Row>, issues: &mut Vec<Issue>) -> Result<Option<f64>, Issue> {
    let mut all: Vec<f64> = rows.iter().filter_map(|row| row.frequency).collect();
    if all.is_empty() {
        return Ok(None);
    }
    all.sort_by(f64::total_cmp);
    let close = |low: f64, high: f64| high - low <= SAME_FREQUENCY * high.abs();
    // The longest run of sorted frequencies that lie close to its first.
    let (mut best, mut first) = ((0, 0), 0);
    for last in 0..all.len() {
        while !close(all[first], all[last]) {
            first += 1;
        }
        if last + 1 - first > best.1 {
            best = (first, last + 1 - first);
        }
    }
    let (low, high) = (all[best.0], all[best.0 + best.1 - 1]);
    let frequency = all[best.0 + best.1 / 2];
    if best.1 == all.len() {
        return Ok(Some(frequency));
    }
    if (best.1 as f64) < FREQUENCY_SHARE * all.len() as f64 || best.1 < FEWEST_OF_FREQUENCY {
        let message = format!(
            "the frequency sweeps from {} to {} Hz, and no frequency has {FEWEST_OF_FREQUENCY} readings and a fifth of all: \
             a modulus over time needs one frequency",
            all[0],
            all[all.len() - 1]
        );
        return Err(Issue::error("frequency-sweep", message).mend("export the readings of one frequency"));
    }
    let message = format!(
        "{} of {} readings, those at {frequency} Hz, are used; the others have other frequencies",
        best.1,
        all.len()
    );
    issues.push(Issue::note("one-frequency", message));
    rows.retain(|row| row.frequency.is_some_and(|f| (low..=high).contains(&f)));
    Ok(Some(frequency))
}

fn not_complex(channels: &[Channel]) -> Issue {
    let moduli = channels.iter().filter(|c| c.quantity.is_modulus());
    let names: Vec<&str> = moduli.map(|c| c.quantity.label()).collect();
    let found = if names.is_empty() {
        "no modulus".to_owned()
    } else {
        names.join(", ")
    };
    let message = format!("the complex modulus cannot be had from {found} alone");
    let mend = "export the loss modulus or the loss factor beside the storage modulus, or |E*| itself";
    Issue::error("no-complex-modulus", message).mend(mend)
}

/// Points out a column of the instrument that its other columns contradict.
fn disagreement(rows: &[Row], what: &str, pair: impl Fn(&Row) -> Option<(f64, f64)>) -> Option<Issue> {
    let off = |row: &Row| {
        let (given, computed) = pair(row)?;
        let off = (given - computed).abs() / computed.abs().max(f64::MIN_POSITIVE);
        (off > DISAGREEMENT || off.is_nan()).then_some((row.time_s, given, computed))
    };
    let all: Vec<(f64, f64, f64)> = rows.iter().filter_map(off).collect();
    let (time_s, given, computed) = *all.first()?;
    let message = format!(
        "{what} of the instrument differs by more than 1 % from what follows from its other columns in {} of {} \
         readings, first at {time_s} s: {given} against {}; the instrument's is used",
        all.len(),
        rows.len(),
        fixed(computed, 5)
    );
    Some(
        Issue::warning("moduli-disagree", message)
            .mend("check which columns the export holds, and their units"),
    )
}
