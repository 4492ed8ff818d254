//! From the table of a four-point probe to the series of each sample: resistance per square, its standard error, flexings.
//!
//! Readings of one sample at one moment are repeats; where the table names faces, the resistance of the strip's electrodes
//! is the sum over its faces, for the current that goes out along one comes back along the other.

use ieap_domain::quantiles::NORMAL_95;
use ieap_domain::{ClimateQuantity, Issue, LogReadings};
use ieap_numerics::student::quantile_95;

use super::climate_log::Series;
use super::formats::probe_table::{ERROR, FACE, FLEXINGS, HUMIDITY, RESISTANCE};
use super::{Reading, RunTable};

/// The series of every sample, and what is left out.
pub fn series(reading: &Reading) -> (Vec<Series>, Vec<Issue>) {
    let faces = faces(reading);
    let (mut found, mut issues) = (Vec::new(), Vec::new());
    for table in &reading.tables {
        let mut values: Vec<(f64, Value)> = Vec::new();
        let mut without_face = 0;
        for moment in moments(table) {
            match value(table, moment, faces) {
                Some(value) => values.push((moment, value)),
                None => without_face += 1,
            }
        }
        if without_face > 0 {
            let message = format!(
                "{without_face} of the dates of {} have a reading of one face only: the resistance of both is not known there",
                table.name
            );
            issues.push(
                Issue::warning("probe-face-missing", message)
                    .at(table.name.clone())
                    .mend("measure both faces on a day, or leave the column of faces away where both were measured at once"),
            );
        }
        let mut add = |quantity, of: &dyn Fn(&Value) -> Option<f64>| {
            let known = values
                .iter()
                .filter_map(|(moment, value)| Some((*moment, of(value)?)));
            let (elapsed_s, values): (Vec<f64>, Vec<f64>) = known.unzip();
            if !values.is_empty() {
                found.push(Series::plain(
                    &table.name,
                    quantity,
                    LogReadings { elapsed_s, values },
                ));
            }
        };
        add(ClimateQuantity::ElectrodeResistance, &|value| {
            Some(value.ohm_per_sq)
        });
        add(ClimateQuantity::ElectrodeResistanceError, &|value| {
            value.error_ohm_per_sq
        });
        add(ClimateQuantity::Flexings, &|value| value.flexings);
        add(ClimateQuantity::ProbeHumidity, &|value| value.humidity_percent);
    }
    (found, issues)
}

/// What a sample had at one moment.
struct Value {
    ohm_per_sq: f64,
    error_ohm_per_sq: Option<f64>,
    flexings: Option<f64>,
    humidity_percent: Option<f64>,
}

/// Number of faces that the table tells apart.
fn faces(reading: &Reading) -> usize {
    let of_table = |table: &RunTable| at(table, FACE, None).into_iter().fold(0.0, f64::max) as usize + 1;
    reading.tables.iter().map(of_table).max().unwrap_or(1)
}

/// Numbers of a column, at a moment or at all.
fn at(table: &RunTable, name: &str, moment: Option<f64>) -> Vec<f64> {
    let channel = table.channels.iter().find(|channel| channel.raw_name == name);
    let pairs = channel
        .into_iter()
        .flat_map(|channel| channel.time_s.iter().zip(channel.values.iter()));
    pairs
        .filter(|(time, _)| moment.is_none_or(|moment| **time == moment))
        .map(|(_, value)| *value)
        .collect()
}

fn moments(table: &RunTable) -> Vec<f64> {
    let channel = table
        .channels
        .iter()
        .find(|channel| channel.raw_name == RESISTANCE);
    let mut moments: Vec<f64> = channel.map_or_else(Vec::new, |channel| channel.time_s.to_vec());
    moments.sort_by(f64::total_cmp);
    moments.dedup();
    moments
}

fn value(table: &RunTable, moment: f64, faces: usize) -> Option<Value> {
    let (ohms, of_face) = (at(table, RESISTANCE, Some(moment)), at(table, FACE, Some(moment)));
    let errors = at(table, ERROR, Some(moment));
    let (mut ohm_per_sq, mut variance) = (0.0, Some(0.0));
    for face in 0..faces {
        let is_of = |k: &usize| faces == 1 || of_face.get(*k) == Some(&(face as f64));
        let own: Vec<f64> = (0..ohms.len()).filter(is_of).map(|k| ohms[k]).collect();
        // Errors belong to readings only where every reading has one.
        let stated: Vec<f64> = if errors.len() == ohms.len() {
            (0..ohms.len()).filter(is_of).map(|k| errors[k]).collect()
        } else {
            Vec::new()
        };
        let mean = own.iter().sum::<f64>() / own.len() as f64;
        if own.is_empty() {
            return None;
        }
        ohm_per_sq += mean;
        let own = error(&own, mean, &stated);
        variance = variance
            .zip(own)
            .map(|(variance, error)| variance + error * error);
    }
    let mean =
        |values: Vec<f64>| (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64);
    Some(Value {
        ohm_per_sq,
        error_ohm_per_sq: variance.map(f64::sqrt).filter(|error| *error > 0.0),
        flexings: at(table, FLEXINGS, Some(moment)).into_iter().reduce(f64::max),
        humidity_percent: mean(at(table, HUMIDITY, Some(moment))),
    })
}

/// Standard error of the mean of repeats: by what they state, or by their scatter where that is more. That of few is
/// widened so that 1.96 of it is an interval of 95 %.
fn error(repeats: &[f64], mean: f64, stated: &[f64]) -> Option<f64> {
    let n = repeats.len() as f64;
    let by_statement = (!stated.is_empty())
        .then(|| stated.iter().map(|error| error * error).sum::<f64>().sqrt() / stated.len() as f64);
    let by_scatter = (repeats.len() > 1).then(|| {
        let square: f64 = repeats.iter().map(|value| (value - mean).powi(2)).sum();
        (square / (n - 1.0) / n).sqrt() * quantile_95(n - 1.0) / NORMAL_95
    });
    match (by_statement, by_scatter) {
        (Some(stated), Some(scatter)) if repeats.len() > 2 => Some(stated.max(scatter)),
        // What is stated says more than the scatter of two.
        (Some(stated), _) => Some(stated),
        (None, scatter) => scatter,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::{ReadContext, read};

    fn of(text: &str) -> (Vec<Series>, Vec<Issue>) {
        series(&read("a.csv", text.as_bytes(), &ReadContext::default()).unwrap())
    }

    fn values(found: &[Series], sample: &str, quantity: ClimateQuantity) -> Vec<f64> {
        let own = found
            .iter()
            .find(|one| one.sensor == sample && one.quantity == quantity);
        own.map_or_else(Vec::new, |own| own.readings.values.clone())
    }

    #[test]
    fn repeats_of_a_moment_are_one_value_with_their_scatter() {
        let text = "date,sample,resistance_ohm_per_sq,flexings\n2026-03-01,S1,2.4,10\n2026-03-01,S1,2.5,10\n2026-03-01,S1,2.6,10\n2026-03-08,S1,3.0,500\n";
        let (found, issues) = of(text);
        assert!(issues.is_empty());
        assert_eq!(values(&found, "S1", ClimateQuantity::Flexings), [10.0, 500.0]);
        let ohms = values(&found, "S1", ClimateQuantity::ElectrodeResistance);
        assert!((ohms[0] - 2.5).abs() < 1e-12 && ohms[1] == 3.0);
        // 0.1 / sqrt 3, times t of 2 degrees of freedom (4.303) over 1.96; the single reading has none.
        let errors = values(&found, "S1", ClimateQuantity::ElectrodeResistanceError);
        assert_eq!(errors.len(), 1);
        assert!(
            (errors[0] - 0.1 / 3f64.sqrt() * 4.303 / 1.96).abs() < 1e-3,
            "{errors:?}"
        );
    }

    #[test]
    fn the_faces_of_a_strip_add_up() {
        let text = "date,sample,face,resistance_ohm_per_sq,standard_error_ohm_per_sq\n2026-03-01,S1,top,1.2,0.03\n2026-03-01,S1,bottom,1.4,0.04\n2026-03-08,S1,top,1.3,0.03\n";
        let (found, issues) = of(text);
        assert_eq!(
            values(&found, "S1", ClimateQuantity::ElectrodeResistance),
            [2.5999999999999996]
        );
        let error = values(&found, "S1", ClimateQuantity::ElectrodeResistanceError)[0];
        assert!((error - 0.05).abs() < 1e-12);
        assert_eq!(issues[0].code, "probe-face-missing");
    }
}
