//! What the next run will show, from what several runs say of it: centre, and spread by its sources.
//!
//! Every run's own parameters give a value of the same thing, with the error that they carry. Between the runs lie
//! repeats (scatter from run to run), voltages (parameters that go with the voltage) and samples (strips of one
//! material that differ). A sample's runs at one voltage are averaged; between two voltages the value is taken to go
//! as a random walk, whose rate is that of the steps between neighbouring voltages: a straight line between them, with
//! the variance of a bridge. Beyond the last voltage it stays, with the variance of the walk.

use ieap_domain::Estimate;
use ieap_domain::quantiles::NORMAL_95;
use ieap_numerics::student::quantile_95;
use schemars::JsonSchema;
use serde::Serialize;

/// Voltages are one level where they differ by less than this part: what a source is set to is met to 1 % or better.
const LEVELS_ALIKE: f64 = 0.02;

/// The voltages of a drive, which parameters may go with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Applied {
    /// Root mean square over time, with the sign of the largest: of a step its voltage, V.
    pub typical_v: f64,
    /// How far the size of the voltage strays from that, root mean square over time, V: nothing for a step.
    pub strays_v: f64,
}

impl Applied {
    /// Of a step.
    pub fn step(typical_v: f64) -> Applied {
        Applied {
            typical_v,
            strays_v: 0.0,
        }
    }
}

/// What one run says.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Told {
    /// Its sample; 0 is the one that is asked for.
    pub sample: usize,
    /// Typical voltage of its drive, V.
    pub step_v: f64,
    /// Value.
    pub value: f64,
    /// Standard error from its parameters.
    pub standard_error: f64,
}

/// Standard deviations that do not come from how the runs differ.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Beside {
    /// Of the laws that brought runs to the conditions asked for; nothing where they were made there.
    pub conditions: f64,
    /// Of what the model is known to get wrong.
    pub misfit: f64,
}

/// A number with the interval in which a further run lies in 95 of 100 cases.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct Forecast {
    /// Value.
    pub value: f64,
    /// Lower end.
    pub low_95: f64,
    /// Upper end.
    pub high_95: f64,
    /// Standard deviations by source; null where the runs cannot tell it.
    pub standard_deviation: Parts,
}

impl Forecast {
    /// The number times `scale`, with its interval.
    pub fn estimate(&self, scale: f64) -> Estimate {
        let half = scale * (self.high_95 - self.low_95) / 2.0;
        Estimate::determined(
            scale * self.value,
            half / NORMAL_95,
            scale * self.low_95,
            scale * self.high_95,
        )
    }
}

/// Standard deviations of a prediction, in its unit.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct Parts {
    /// From the parameters of the fits and the dimensions.
    pub parameters: f64,
    /// From run to run; none without repeats.
    pub runs: Option<f64>,
    /// Of the way between voltages; none where another voltage is asked for than the only one measured.
    pub voltages: Option<f64>,
    /// From strip to strip; none with one sample, or where the strip itself is asked for.
    pub samples: Option<f64>,
    /// Of the laws that brought runs to the conditions asked for; 0 where none was.
    pub conditions: f64,
    /// Of what the model gets wrong.
    pub misfit: f64,
}

/// A voltage at which a sample was measured.
struct VoltageLevel {
    step_v: f64,
    mean: f64,
    /// Variance of the mean from the parameters.
    parameters: f64,
    runs: usize,
    /// Sum of squares about the mean.
    squares: f64,
}

/// The forecast of a drive, of another strip of the material or of the sample itself; none where no run of the asked
/// sample tells anything.
pub fn forecast(told: &[Told], applied: Applied, of_another_strip: bool, beside: Beside) -> Option<Forecast> {
    let step_v = applied.typical_v;
    let own = levels(told, 0);
    let (mut value, mut parameters) = between(&own, step_v)?;
    let mut samples: Vec<f64> = vec![value];
    let others = told.iter().map(|t| t.sample).max().unwrap_or(0);
    for sample in 1..=others {
        samples.extend(between(&levels(told, sample), step_v).map(|(value, _)| value));
    }
    let mut freedom = Vec::new();
    let mut of_samples = None;
    if of_another_strip && samples.len() > 1 {
        let n = samples.len() as f64;
        value = samples.iter().sum::<f64>() / n;
        let squares: f64 = samples.iter().map(|v| (v - value).powi(2)).sum();
        let variance = squares / (n - 1.0) * (1.0 + 1.0 / n);
        parameters /= n;
        freedom.push((variance, n - 1.0));
        of_samples = Some(variance);
    }
    let runs = repeats(told).map(|(variance, degrees)| {
        let here = own.iter().filter(|level| is_alike(level.step_v, step_v));
        let runs = here.map(|level| level.runs).next().unwrap_or(1) as f64;
        let variance = variance * (1.0 + 1.0 / runs);
        freedom.push((variance, degrees));
        variance
    });
    let voltages = way_between(&own, applied);
    let known = [runs, voltages, of_samples].into_iter().flatten();
    let of_runs = known.fold(parameters, |sum, variance| sum + variance);
    let total = of_runs + beside.conditions.powi(2) + beside.misfit.powi(2);
    let half = quantile(total, &freedom) * total.sqrt();
    let root = |variance: Option<f64>| variance.map(f64::sqrt);
    Some(Forecast {
        value,
        low_95: value - half,
        high_95: value + half,
        standard_deviation: Parts {
            parameters: parameters.sqrt(),
            runs: root(runs),
            voltages: root(voltages),
            samples: root(of_samples),
            conditions: beside.conditions,
            misfit: beside.misfit,
        },
    })
}

/// Whether two voltages are one level.
pub fn is_alike(a: f64, b: f64) -> bool {
    (a - b).abs() <= LEVELS_ALIKE * a.abs().max(b.abs())
}

/// The voltages at which a sample was measured, in rising order.
fn levels(told: &[Told], sample: usize) -> Vec<VoltageLevel> {
    let mut of_sample: Vec<&Told> = told.iter().filter(|told| told.sample == sample).collect();
    of_sample.sort_by(|a, b| a.step_v.total_cmp(&b.step_v));
    let groups = of_sample.chunk_by(|a, b| is_alike(a.step_v, b.step_v));
    let level = |runs: &[&Told]| {
        let n = runs.len() as f64;
        let mean = runs.iter().map(|run| run.value).sum::<f64>() / n;
        VoltageLevel {
            step_v: runs.iter().map(|run| run.step_v).sum::<f64>() / n,
            mean,
            parameters: runs.iter().map(|run| run.standard_error.powi(2)).sum::<f64>() / (n * n),
            runs: runs.len(),
            squares: runs.iter().map(|run| (run.value - mean).powi(2)).sum(),
        }
    };
    groups.map(level).collect()
}

/// Levels below and above a voltage, with the share of the upper one; one level twice beyond the ends.
fn around(levels: &[VoltageLevel], step_v: f64) -> Option<(&VoltageLevel, &VoltageLevel, f64)> {
    if let Some(here) = levels.iter().find(|level| is_alike(level.step_v, step_v)) {
        return Some((here, here, 0.0));
    }
    let above = levels.iter().find(|level| level.step_v > step_v);
    let below = levels.iter().rev().find(|level| level.step_v < step_v);
    match (below, above) {
        (Some(a), Some(b)) => Some((a, b, (step_v - a.step_v) / (b.step_v - a.step_v))),
        (Some(only), None) | (None, Some(only)) => Some((only, only, 0.0)),
        (None, None) => None,
    }
}

/// Value and variance of its parameters at a voltage.
fn between(levels: &[VoltageLevel], step_v: f64) -> Option<(f64, f64)> {
    let (below, above, share) = around(levels, step_v)?;
    let parameters = (1.0 - share).powi(2) * below.parameters + share.powi(2) * above.parameters;
    Some(((1.0 - share) * below.mean + share * above.mean, parameters))
}

/// Variance of the random walk from the nearest voltages, and over those that the drive strays to; none where only one
/// voltage was measured and the drive has others.
fn way_between(levels: &[VoltageLevel], applied: Applied) -> Option<f64> {
    let step_v = applied.typical_v;
    let (below, above, share) = around(levels, step_v)?;
    let is_there = share == 0.0 && is_alike(below.step_v, step_v);
    let apart_v = match share > 0.0 {
        _ if is_there => 0.0,
        true => share * (1.0 - share) * (above.step_v - below.step_v),
        false => (step_v - below.step_v).abs(),
    };
    if is_there && applied.strays_v <= LEVELS_ALIKE * step_v.abs() {
        return Some(0.0);
    }
    let rate = |pair: &[VoltageLevel]| {
        let known = pair[0].parameters + pair[1].parameters;
        ((pair[1].mean - pair[0].mean).powi(2) - known).max(0.0) / (pair[1].step_v - pair[0].step_v)
    };
    let rates: Vec<f64> = levels.windows(2).map(rate).collect();
    if rates.is_empty() {
        return None;
    }
    let mean = rates.iter().sum::<f64>() / rates.len() as f64;
    Some(mean * (apart_v + applied.strays_v))
}

/// Variance from run to run at one voltage, over all samples and voltages, with its degrees of freedom; none without
/// repeats. What the parameters alone would make runs differ by is contained.
fn repeats(told: &[Told]) -> Option<(f64, f64)> {
    let samples = told.iter().map(|told| told.sample).max()?;
    let all: Vec<VoltageLevel> = (0..=samples).flat_map(|sample| levels(told, sample)).collect();
    let freedom: usize = all.iter().map(|level| level.runs - 1).sum();
    let squares: f64 = all.iter().map(|level| level.squares).sum();
    (freedom > 0).then(|| (squares / freedom as f64, freedom as f64))
}

/// Student's quantile of a sum of variances of which some were estimated with few degrees of freedom: Satterthwaite's
/// (Biometrics Bulletin 2, 110, 1946).
fn quantile(total: f64, estimated: &[(f64, f64)]) -> f64 {
    let sum: f64 = estimated
        .iter()
        .map(|(variance, freedom)| variance * variance / freedom)
        .sum();
    if sum > 0.0 {
        quantile_95(total * total / sum)
    } else {
        NORMAL_95
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    fn told(step_v: f64, value: f64) -> Told {
        Told {
            sample: 0,
            step_v,
            value,
            standard_error: 0.1,
        }
    }

    #[test]
    fn one_run_tells_its_value_with_the_error_of_its_parameters() {
        let found = forecast(&[told(2.0, 5.0)], Applied::step(2.01), false, Beside::default()).unwrap();
        assert_eq!(found.value, 5.0);
        assert!((found.high_95 - 5.0 - 0.1 * NORMAL_95).abs() < 1e-12);
        let parts = found.standard_deviation;
        assert_eq!((parts.runs, parts.samples), (None, None));
        assert_eq!(parts.voltages, Some(0.0));
        assert_eq!(
            forecast(&[told(2.0, 5.0)], Applied::step(1.0), false, Beside::default())
                .unwrap()
                .standard_deviation
                .voltages,
            None
        );
        assert_eq!(forecast(&[], Applied::step(1.0), false, Beside::default()), None);
    }

    fn of_voltages(found: &Forecast) -> f64 {
        found.standard_deviation.voltages.unwrap().powi(2)
    }

    #[test]
    fn between_two_voltages_it_goes_straight_and_may_stray_most_in_the_middle() {
        let runs = [told(1.0, 1.0), told(2.0, 3.0)];
        let middle = forecast(&runs, Applied::step(1.5), false, Beside::default()).unwrap();
        assert!((middle.value - 2.0).abs() < 1e-12);
        // The step of 2, less what the errors explain, is the rate of the walk; a bridge has a quarter in the middle.
        assert!((of_voltages(&middle) - (4.0 - 0.02) / 4.0).abs() < 1e-12);
        let beyond = forecast(&runs, Applied::step(2.5), false, Beside::default()).unwrap();
        assert_eq!(beyond.value, 3.0);
        // A drive that strays about a measured voltage has that much of the walk.
        let straying = Applied {
            typical_v: 2.0,
            strays_v: 0.25,
        };
        let straying = forecast(&runs, straying, false, Beside::default()).unwrap();
        assert!((of_voltages(&straying) - 0.25 * 3.98 / 1.0).abs() < 1e-12);
        assert!((of_voltages(&beyond) - (4.0 - 0.02) / 2.0).abs() < 1e-12);
    }

    #[test]
    fn a_misfit_widens_the_interval() {
        let found = forecast(
            &[told(2.0, 5.0)],
            Applied::step(2.0),
            false,
            Beside {
                misfit: 0.4,
                ..Beside::default()
            },
        )
        .unwrap();
        assert!((found.high_95 - 5.0 - NORMAL_95 * 0.17_f64.sqrt()).abs() < 1e-12);
    }

    /// How often the interval holds a further run, of samples and repeats that scatter.
    fn coverage(samples: usize, runs: usize, of_another_strip: bool) -> f64 {
        let mut rng = ChaCha8Rng::seed_from_u64(30 + samples as u64 + 7 * runs as u64);
        let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
        let (draws, mut held) = (4000, 0);
        for _ in 0..draws {
            let mut strip = |sample: usize| -> (f64, Vec<Told>) {
                let level = 10.0 + 2.0 * normal();
                let run = |value: f64| Told {
                    sample,
                    step_v: 2.0,
                    value,
                    standard_error: 0.2,
                };
                let told = (0..runs)
                    .map(|_| run(level + normal() + 0.2 * normal()))
                    .collect();
                (level, told)
            };
            let strips: Vec<(f64, Vec<Told>)> = (0..samples).map(&mut strip).collect();
            let truth = if of_another_strip {
                10.0 + 2.0 * normal() + normal()
            } else {
                strips[0].0 + normal()
            };
            let all: Vec<Told> = strips.into_iter().flat_map(|(_, told)| told).collect();
            let found = forecast(&all, Applied::step(2.0), of_another_strip, Beside::default()).unwrap();
            held += usize::from((found.low_95..=found.high_95).contains(&truth));
        }
        held as f64 / draws as f64
    }

    #[test]
    fn intervals_hold_a_further_run_of_the_strip_and_of_another() {
        // 4,000 draws know a share near 0.95 to 0.0035.
        let same = coverage(1, 4, false);
        assert!((0.935..0.985).contains(&same), "{same}");
        for samples in [3, 6] {
            let other = coverage(samples, 3, true);
            assert!((0.935..0.995).contains(&other), "{samples}: {other}");
        }
    }
}
