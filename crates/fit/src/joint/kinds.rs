//! The noise of a channel as one of a few kinds, each asked in closed form beside what a fit searches: white noise alone, or with
//! what an amplifier, a lamp or a room adds over seconds to hours.
//!
//! Nothing is switched on: the covariance that a fit goes on with is the mean of those of all kinds, each as likely as the
//! readings make it. What a slow noise does to a time constant is not seen in what a fit leaves, for the parameters take it up;
//! the likelihood beside the parameters knows that.

mod bins;
mod processes;

use ieap_numerics::decay::even_step;
use ieap_numerics::sums::dot;
use ieap_numerics::symmetric::Symmetric;

use crate::instrument_noise::ChannelNoises;
use crate::joint::policy::{KIND_RATIO, LARGEST_SLOW_RATIO, SLOWEST_RECORDS};
use crate::kind_of_noise::{KindEvidence, NoiseForm, NoiseKind};
use crate::sampled::Sampled;

pub(crate) use bins::Bins;
use processes::{BinWhitener, Covariance, MOST_PROCESSES, Process};

/// The noise that a channel was found to have.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct KindsOfNoise {
    bins: Bins,
    whitener: BinWhitener,
    /// Means that the size of the noise is known from, beside the parameters.
    pub(crate) freedom: f64,
    /// What the readings tell of every kind.
    pub(crate) evidence: Vec<KindEvidence>,
}

/// Slow noise of one kind: the parts that processes have in its variance.
type Kind = Vec<f64>;

impl KindsOfNoise {
    /// From what a fit has left of the readings, in units that the noise has the same size in; `columns` are what it searches,
    /// at the means. None where too few means are left to tell a size.
    pub(crate) fn of(
        sampled: &Sampled,
        bins: Bins,
        rest: &[f64],
        columns: &[Vec<f64>],
        least: f64,
        known: &ChannelNoises,
    ) -> Option<KindsOfNoise> {
        let freedom = bins.len() as f64 - columns.len() as f64;
        if freedom < 3.0 {
            return None;
        }
        let (shortest_s, _) = sampled.time_scales_s();
        if !(shortest_s > 0.0 && shortest_s.is_finite()) {
            return None;
        }
        let record_s = sampled.time_s[sampled.len() - 1] - sampled.time_s[0];
        let scales_s = scales_s(shortest_s, SLOWEST_RECORDS * record_s);
        let dying = |scale_s: &f64| Process::dying(&bins, &sampled.time_s, *scale_s);
        let mut processes: Vec<Process> = scales_s.iter().map(dying).collect();
        processes.push(Process::line(&bins));
        let rest = bins.means(rest);
        // What is searched, and what is left, side by side.
        let each = |bin: usize| columns.iter().map(move |column| column[bin]).chain([rest[bin]]);
        let series: Vec<f64> = (0..bins.len()).flat_map(each).collect();
        let ask = |kind: NoiseKind, of_processes: Vec<f64>| {
            Asked::of(&bins, &processes, (kind, of_processes), &series, freedom)
        };
        let ratios = ratios(sampled.len());
        let white = NoiseKind {
            form: NoiseForm::White,
            size: 0,
        };
        let mut asked = vec![ask(white, vec![0.0; processes.len()])];
        for (form, parts) in kinds(&scales_s) {
            asked.extend(ratios.iter().zip(0..).map(|(ratio, size)| {
                let of_processes = parts.iter().map(|part| part * ratio).collect();
                ask(NoiseKind { form, size }, of_processes)
            }));
        }
        let evidence: Vec<KindEvidence> = asked.iter().map(Asked::evidence).collect();
        let kinds: Vec<NoiseKind> = asked.iter().map(|own| own.kind).collect();
        for (own, prior) in asked.iter_mut().zip(known.log_priors(&kinds)) {
            own.log_posterior += prior;
        }
        let mut mean = mean(&asked, processes.len());
        mean.white = mean.white.max(least * least);
        Some(KindsOfNoise {
            whitener: BinWhitener::new(&bins, &processes, &mean),
            freedom,
            evidence,
            bins,
        })
    }
}

/// The mean of the covariances, each as likely as the readings make it.
fn mean(asked: &[Asked], processes: usize) -> Covariance {
    let most = asked
        .iter()
        .map(|own| own.log_posterior)
        .fold(f64::NEG_INFINITY, f64::max);
    let weight = |own: &Asked| (own.log_posterior - most).exp();
    let all: f64 = asked.iter().map(weight).sum();
    let mut mean = Covariance {
        white: 0.0,
        of_processes: vec![0.0; processes],
    };
    for own in asked {
        let white = weight(own) / all * own.variance;
        mean.white += white;
        for (mean, ratio) in mean.of_processes.iter_mut().zip(&own.of_processes) {
            *mean += white * ratio;
        }
    }
    mean
}

impl KindsOfNoise {
    /// e^(-rate t) of every rate, and the `values`, over the means of a span: in units of `scale` and white. Times are since the
    /// first reading of the span.
    pub(crate) fn white_columns(
        &self,
        span: usize,
        values: &[f64],
        scale: &[f64],
        elapsed_s: &[f64],
        rates_per_s: &[f64],
    ) -> (Vec<Vec<f64>>, Vec<f64>) {
        let (from, to) = self.bins.spans[span];
        let parts = &self.bins.parts()[from..to];
        let begin = parts.first().map_or(0, |part| part.0);
        let scale = &scale[begin..begin + elapsed_s.len()];
        let mean = |series: &dyn Fn(usize) -> f64| -> Vec<f64> {
            let of = |&(first, end): &(usize, usize)| {
                let own = first - begin..end - begin;
                own.map(|k| series(k) / scale[k]).sum::<f64>() / (end - first) as f64
            };
            let mut means: Vec<f64> = parts.iter().map(of).collect();
            self.whitener.whiten(from, &mut means);
            means
        };
        let is_even = scale.iter().all(|own| *own == scale[0]);
        let steps_s: Vec<Option<f64>> = parts
            .iter()
            .map(|&(first, end)| even_step(&elapsed_s[first - begin..end - begin]).filter(|_| is_even))
            .collect();
        let column = |rate: &f64| {
            let decay = |k: usize| (-rate * elapsed_s[k]).exp();
            let of = |(&(first, end), step_s): (&(usize, usize), &Option<f64>)| {
                let (own, count) = (first - begin, (end - first) as f64);
                match step_s {
                    // A geometric series.
                    Some(step_s) if rate * step_s > 0.0 => {
                        let fall = -rate * step_s;
                        decay(own) * (fall * count).exp_m1() / fall.exp_m1() / count / scale[own]
                    }
                    Some(_) => scale[own].recip(),
                    None => (own..end - begin).map(|k| decay(k) / scale[k]).sum::<f64>() / count,
                }
            };
            let mut means: Vec<f64> = parts.iter().zip(&steps_s).map(of).collect();
            self.whitener.whiten(from, &mut means);
            means
        };
        let columns = rates_per_s.iter().map(column).collect();
        (columns, mean(&|k| values[k]))
    }
}

/// Correlation times of slow noise, s: the same for every record, so that those of an instrument can be compared.
fn scales_s(shortest_s: f64, longest_s: f64) -> Vec<f64> {
    let power = |time_s: f64| time_s.ln() / KIND_RATIO.ln();
    let (first, last) = (power(shortest_s).ceil(), power(longest_s).floor());
    let count = ((last - first).max(0.0) as usize + 1).min(MOST_PROCESSES - 1);
    (0..count).map(|k| KIND_RATIO.powf(first + k as f64)).collect()
}

/// Variances of slow noise in that of the white noise of a reading: from what the whole record just shows.
fn ratios(readings: usize) -> Vec<f64> {
    let least = KIND_RATIO / readings as f64;
    (0..)
        .map(|k| LARGEST_SLOW_RATIO / KIND_RATIO.powi(k))
        .take_while(|ratio| *ratio >= least)
        .collect()
}

/// Every process alone; as much of each (1/f); a line; both.
fn kinds(scales_s: &[f64]) -> Vec<(NoiseForm, Kind)> {
    let scales = scales_s.len();
    let only = |place: usize| {
        (0..=scales)
            .map(move |k| f64::from(u8::from(k == place)))
            .collect::<Kind>()
    };
    let each = |k: usize| if k < scales { (scales as f64).recip() } else { 0.0 };
    let flicker: Kind = (0..=scales).map(each).collect();
    let line = only(scales);
    let both = flicker.iter().zip(&line).map(|(a, b)| 0.5 * (a + b)).collect();
    let process = |time_s: &f64| NoiseForm::Process((time_s.ln() / KIND_RATIO.ln()).round() as i8);
    let alone = (0..scales).map(|k| (process(&scales_s[k]), only(k)));
    let others = [
        (NoiseForm::Flicker, flicker),
        (NoiseForm::Line, line),
        (NoiseForm::FlickerAndLine, both),
    ];
    alone.chain(others).collect()
}

/// One kind and size of slow noise, asked.
struct Asked {
    kind: NoiseKind,
    /// Variances of the processes, in that of the white noise of a reading.
    of_processes: Vec<f64>,
    /// Restricted log likelihood, the size integrated; then, with the logarithm of the prior.
    log_posterior: f64,
    /// Variance of the white noise of a reading.
    variance: f64,
}

impl Asked {
    fn evidence(&self) -> KindEvidence {
        KindEvidence {
            kind: self.kind,
            log_likelihood: self.log_posterior,
        }
    }

    fn of(
        bins: &Bins,
        processes: &[Process],
        (kind, of_processes): (NoiseKind, Vec<f64>),
        series: &[f64],
        freedom: f64,
    ) -> Asked {
        let unit = Covariance {
            white: 1.0,
            of_processes,
        };
        let whitener = BinWhitener::new(bins, processes, &unit);
        let mut series = series.to_vec();
        let width = series.len() / bins.len();
        whitener.whiten_beside(bins, &mut series, width);
        let mut products = vec![0.0; width * width];
        for row in series.chunks_exact(width) {
            for (own, products) in row.iter().zip(products.chunks_exact_mut(width)) {
                for (product, other) in products.iter_mut().zip(row) {
                    *product += own * other;
                }
            }
        }
        let searched = width - 1;
        let normal = Symmetric::from_fn(searched, |a, b| products[a * width + b]);
        let right = &products[searched * width..][..searched];
        let (shift, determinant) = normal.solve_with_log_determinant(right);
        let square = products[width * width - 1] - dot(right, &shift);
        let variance = (square / freedom).max(f64::MIN_POSITIVE);
        let deviance = whitener.log_determinant() + determinant + freedom * variance.ln();
        Asked {
            kind,
            log_posterior: -0.5 * deviance,
            of_processes: unit.of_processes,
            variance,
        }
    }
}
