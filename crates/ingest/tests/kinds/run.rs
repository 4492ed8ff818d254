//! A run, a log and what is read of them.

use ieap_domain::{Channel, Quantity};
use ieap_ingest::Reading;
use ieap_ingest::formats::{ReadContext, ReadError, read};

use super::dice::Dice;

/// Rows of a run: time s, voltage V, current mA, displacement mm.
pub fn rows(dice: &mut Dice) -> Vec<[f64; 4]> {
    let (volts, peak, tip) = (
        dice.number(0.5, 3.0),
        dice.decade(0.5, 40.0),
        dice.decade(0.05, 5.0),
    );
    let (every_s, before) = (dice.pick(&[0.1, 0.25, 0.5, 1.0]), dice.whole(4, 12));
    let row = |k: i64| {
        let t = (k - before) as f64 * every_s;
        let (v, i, d) = if t < 0.0 {
            (0.0, 0.0, 0.0)
        } else {
            (
                volts,
                peak * (0.85 * (-t / 1.5).exp() + 0.12 * (-t / 12.0).exp() + 0.03),
                tip * (1.0 - (-t / 4.0).exp()),
            )
        };
        [k as f64 * every_s, v, i, d]
    };
    (0..dice.whole(60, 160)).map(row).collect()
}

pub fn read_text(name: &str, text: &str) -> Result<Reading, ReadError> {
    read(name, text.as_bytes(), &ReadContext::default())
}

pub fn channel(reading: &Reading, quantity: Quantity) -> Option<&Channel> {
    reading
        .tables
        .first()?
        .channels
        .iter()
        .find(|channel| channel.quantity == quantity)
}

pub fn close(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-4 * a.abs().max(b.abs()) + 1e-6
}
