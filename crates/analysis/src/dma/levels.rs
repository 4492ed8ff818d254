//! The humidities that a modulus log held, with the modulus there.

use ieap_domain::modulus::step_keys;
use ieap_domain::{Estimate, ModulusAnalysis, ModulusStep};

/// A humidity that was held, with the modulus there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeldLevel {
    /// Relative humidity, percent.
    pub relative_humidity_percent: f64,
    /// |E*|, MPa.
    pub modulus_mpa: f64,
    /// Its standard error, MPa.
    pub standard_error_mpa: f64,
    /// 1 after a rise of the humidity, -1 after a fall, 0 at the start.
    pub direction: i8,
}

/// Change of |E*| over the whole span of humidity that was held before it turned back.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WholeSpan {
    /// Humidity at the start and at the turn, percent.
    pub from_to_percent: (f64, f64),
    /// Change relative to the value at the start, percent.
    pub change_percent: f64,
    /// Its standard error, percent.
    pub standard_error_percent: f64,
}

/// The levels that a log held, in the order of time; none where a step lacks its numbers.
pub fn levels(found: &ModulusAnalysis) -> Option<Vec<HeldLevel>> {
    let first = found.steps.first()?;
    let mut levels = vec![level(
        first,
        (step_keys::HUMIDITY_BEFORE, step_keys::MODULUS_BEFORE),
        0,
    )?];
    for step in &found.steps {
        let before = levels.last()?.relative_humidity_percent;
        let keys = (step_keys::HUMIDITY_AFTER, step_keys::MODULUS_AFTER);
        let after = level(step, keys, 0)?;
        let direction = if after.relative_humidity_percent > before {
            1
        } else {
            -1
        };
        levels.push(HeldLevel { direction, ..after });
    }
    Some(levels)
}

fn level(step: &ModulusStep, (humidity, modulus): (&str, &str), direction: i8) -> Option<HeldLevel> {
    let modulus: &Estimate = step.estimate(modulus)?;
    Some(HeldLevel {
        relative_humidity_percent: step.estimate(humidity)?.value?,
        modulus_mpa: modulus.value?,
        standard_error_mpa: modulus.standard_error.unwrap_or(0.0),
        direction,
    })
}

/// The whole way to where the humidity first turned back; none where that is one step, whose numbers stand already.
pub fn whole_span(found: &ModulusAnalysis) -> Option<WholeSpan> {
    let levels = levels(found)?;
    let way = levels.get(1)?.direction;
    let last = levels
        .iter()
        .skip(1)
        .take_while(|level| level.direction == way)
        .count();
    if last < 2 {
        return None;
    }
    let (start, end) = (levels[0], levels[last]);
    let ratio = end.modulus_mpa / start.modulus_mpa;
    let relative = |level: HeldLevel| level.standard_error_mpa / level.modulus_mpa;
    Some(WholeSpan {
        from_to_percent: (start.relative_humidity_percent, end.relative_humidity_percent),
        change_percent: 100.0 * (ratio - 1.0),
        standard_error_percent: 100.0 * ratio * relative(start).hypot(relative(end)),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use ieap_domain::Parameter;

    fn log(levels: &[(f64, f64)]) -> ModulusAnalysis {
        let number = |key: &str, value: f64| Parameter {
            key: key.to_owned(),
            estimate: Estimate::determined(value, 0.01 * value, 0.98 * value, 1.02 * value),
        };
        let step = |pair: &[(f64, f64)]| ModulusStep {
            start_s: 0.0,
            settled_s: 1.0,
            end_s: 2.0,
            estimates: vec![
                number(step_keys::HUMIDITY_BEFORE, pair[0].0),
                number(step_keys::HUMIDITY_AFTER, pair[1].0),
                number(step_keys::MODULUS_BEFORE, pair[0].1),
                number(step_keys::MODULUS_AFTER, pair[1].1),
            ],
        };
        ModulusAnalysis {
            version: 1,
            modulus_source: String::new(),
            frequency_hz: None,
            temperature_c: None,
            readings: 0,
            steps: levels.windows(2).map(step).collect(),
            estimates: Vec::new(),
            issues: Vec::new(),
            curves: Vec::new(),
        }
    }

    #[test]
    fn a_staircase_is_told_as_a_whole_and_one_step_is_not() {
        let staircase = log(&[(0.0, 100.0), (30.0, 90.0), (60.0, 80.0), (30.0, 88.0)]);
        let whole = whole_span(&staircase).unwrap();
        assert_eq!(whole.from_to_percent, (0.0, 60.0));
        assert!((whole.change_percent + 20.0).abs() < 1e-9);
        assert!((whole.standard_error_percent - 80.0 * 0.01 * 2f64.sqrt()).abs() < 1e-9);
        assert_eq!(whole_span(&log(&[(0.0, 100.0), (40.0, 80.0), (0.0, 99.0)])), None);
        let ways: Vec<i8> = levels(&staircase)
            .unwrap()
            .iter()
            .map(|level| level.direction)
            .collect();
        assert_eq!(ways, [0, 1, 1, -1]);
    }
}
