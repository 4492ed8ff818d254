//! The readings that a page of runs draws, as stored: a file for each page, from which a figure is saved as CSV. It is loaded
//! when somebody asks for it, and a script, for a page opened from a disk may load nothing else.

use std::io::Write as _;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::DeflateEncoder;

use super::visible::one_line;
use ieap_domain::number::to_digits;
use ieap_domain::{Quantity, RunCurve};

/// Digits of a fitted curve: finer than what noise leaves of it, and a third of all that a number holds.
const FITTED_DIGITS: usize = 5;
/// Digits of a residual, in units of the noise.
const RESIDUAL_DIGITS: usize = 3;

/// Folder of these files.
pub const FOLDER: &str = "readings";

/// The file of the page of runs of that slug.
pub fn file(slug: &str) -> String {
    format!("{FOLDER}/{slug}.js")
}

/// `window.ieapReadings="..."`: CSV, deflated, in base 64. Of a long run those readings that are drawn.
pub fn text<'a>(runs: impl Iterator<Item = (&'a str, &'a [RunCurve])>) -> String {
    packed(&csv(runs))
}

fn packed(table: &str) -> String {
    let mut encoder = DeflateEncoder::new(Vec::new(), Compression::default());
    // The best compression is 2 % smaller and takes twice as long. Writing to memory cannot fail.
    let deflated = encoder
        .write_all(table.as_bytes())
        .and_then(|()| encoder.finish())
        .unwrap_or_default();
    format!("window.ieapReadings=\"{}\";\n", STANDARD.encode(deflated))
}

/// What the lines of a quantity of a run begin with.
pub fn key(run: &str, quantity: Quantity) -> String {
    let run = one_line(run).replace([',', '"'], " ");
    format!("{run},{} ({})", quantity.label(), quantity.unit())
}

/// `run,quantity,time_s,measured,fitted,residual_over_noise`: the measured numbers with all their digits.
fn csv<'a>(runs: impl Iterator<Item = (&'a str, &'a [RunCurve])>) -> String {
    let mut lines = String::from("run,quantity,time_s,measured,fitted,residual_over_noise\n");
    for (name, curves) in runs {
        for curve in curves {
            let key = key(name, curve.quantity);
            let rounded = |values: &[f64], at: usize, digits: usize| match values.get(at) {
                Some(value) => to_digits(*value, digits).to_string(),
                None => String::new(),
            };
            for (at, (time_s, measured)) in curve.time_s.iter().zip(&curve.measured).enumerate() {
                lines += &format!(
                    "{key},{time_s},{measured},{},{}\n",
                    rounded(&curve.fitted, at, FITTED_DIGITS),
                    rounded(&curve.residual_sigma, at, RESIDUAL_DIGITS),
                );
            }
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;
    use flate2::read::DeflateDecoder;
    use std::io::Read as _;

    #[test]
    fn readings_come_out_as_they_are_stored() {
        let measured = vec![0.0, 2.2657891234567e-4, -1e-300];
        let curve = RunCurve {
            quantity: Quantity::Current,
            time_s: vec![-0.1, 0.0, 0.25],
            measured: measured.clone(),
            fitted: vec![1.0 / 3.0; 3],
            residual_sigma: vec![],
            readings: 3,
        };
        let text = packed(&csv(std::iter::once(("a, b", [curve].as_slice()))));
        let packed = text.split('"').nth(1).unwrap();
        let mut csv = String::new();
        DeflateDecoder::new(STANDARD.decode(packed).unwrap().as_slice())
            .read_to_string(&mut csv)
            .unwrap();
        let rows: Vec<Vec<&str>> = csv
            .lines()
            .skip(1)
            .map(|line| line.split(',').collect())
            .collect();
        let back: Vec<f64> = rows.iter().map(|row| row[3].parse().unwrap()).collect();
        assert_eq!(back, measured);
        assert_eq!(
            (rows[0][0], rows[0][2], rows[0][4], rows[0][5]),
            ("a  b", "-0.1", "0.33333", "")
        );
    }
}
