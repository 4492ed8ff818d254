//! The series of one sensor and quantity from all of its files.

use std::collections::BTreeMap;
use std::rc::Rc;

use super::shelf::{Loaded, Shelf};
use crate::analysis::climate::{Piece, Window, merge, merged, rank};
use crate::domain::{Campaign, ClimateQuantity};
use crate::pipeline::PipelineError;
use crate::store::Store;

/// Sensor, quantity and the numbers of its series on the shelf, in the order in which sensors are asked.
pub type Groups = BTreeMap<((usize, String), ClimateQuantity), Vec<usize>>;

/// Groups series by sensor and quantity. Series that are not used are left out.
pub fn groups(shelf: &Shelf, campaign: &Campaign, numbers: impl Iterator<Item = usize>) -> Groups {
    let mut groups = Groups::new();
    for at in
        numbers.filter(|&at| shelf.series[at].not_used.is_none() && !shelf.series[at].quantity.is_of_probe())
    {
        let identity = shelf.identity(campaign, at);
        let key = (rank(campaign, &identity), shelf.series[at].quantity);
        groups.entry(key).or_default().push(at);
    }
    groups
}

/// Readings of a sensor around a window.
#[derive(Debug, Clone, PartialEq)]
pub struct Around {
    /// Time of each reading, s since 1970 UTC.
    pub times_s: Vec<f64>,
    /// Readings.
    pub values: Vec<f64>,
    /// Time between most readings, s.
    pub interval_s: f64,
}

/// Readings of the series `numbers`, all of one sensor and quantity, within `margin_s` of `window` and the next one
/// on each side; none where no clock is known.
///
/// # Errors
/// The database cannot be read.
pub fn around(
    store: &Store,
    campaign: &Campaign,
    shelf: &Shelf,
    numbers: &[usize],
    (window, margin_s): (Window, f64),
) -> Result<Option<Around>, PipelineError> {
    let mut pieces: Vec<(usize, Rc<Loaded>)> = Vec::new();
    for &at in numbers {
        if let Some(loaded) = shelf.load(store, campaign, at)? {
            pieces.push((at, loaded));
        }
    }
    if pieces.is_empty() {
        return Ok(None);
    }
    let cut = pieces.iter().map(|(at, loaded)| {
        let times = &loaded.times_s;
        let from = times
            .partition_point(|&t| t < window.from_s - margin_s)
            .saturating_sub(1);
        let to = (times.partition_point(|&t| t <= window.to_s + margin_s) + 1).min(times.len());
        Piece {
            times_s: &times[from..to],
            values: &loaded.values[from..to],
            interval_s: shelf.series[*at].interval_s,
            hash: &shelf.series[*at].data_hash,
        }
    });
    let merge::Merged { times_s, values, .. } = merged(cut.collect());
    let interval_s = pieces
        .iter()
        .map(|(at, _)| shelf.series[*at].interval_s)
        .fold(0.0, f64::max);
    Ok(Some(Around {
        times_s,
        values,
        interval_s,
    }))
}
