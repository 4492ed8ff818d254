//! Readings of a channel as a diagnosis sees them: with their noise, found without the model, and made white by it.

use std::borrow::Cow;
use std::sync::Arc;

use ieap_domain::{Channel, Drive, NoiseCharacter, Quantity};

use super::joint::noise::{Noise, slow};
use super::joint::readings::Response;
use super::joint::whitening::{Autocorrelation, Whitener, longest_s};
use super::means::{self, Means};
use super::noise_again::NoiseAgain;
use super::sampled::{Sampled, Span};
use crate::policy::{GAP_FACTOR, READINGS_AT_EDGE, SLOW_PARAMETERS};

/// One channel of a run with its noise.
#[derive(Debug, Clone)]
pub struct WhitenedChannel {
    response: Response,
    /// How its values are means of readings; none where they are readings.
    means: Option<Means>,
    autocorrelation: Continuing,
    readings_per_independent: f64,
    /// Whether the memory is one that it shares with other channels.
    is_shared: bool,
}

/// The whitener over stretches of readings without a gap: noise remembers across the edges of the drive.
#[derive(Debug, Clone)]
pub(super) struct Continuing {
    stretches: Vec<Span>,
    whitener: Whitener,
}

impl Continuing {
    pub(super) fn new(sampled: &Sampled, sd: &[f64], autocorrelation: &Autocorrelation) -> Continuing {
        let mut joined = sampled.clone();
        joined.spans = without_gaps(sampled);
        Continuing {
            whitener: Whitener::new(&joined, sd, autocorrelation),
            stretches: joined.spans,
        }
    }

    /// Two series over the readings, stretch by stretch.
    pub(super) fn stretches_of<'a>(
        &'a self,
        a: &'a [f64],
        b: &'a [f64],
    ) -> impl Iterator<Item = (&'a [f64], &'a [f64])> {
        let spans = self.stretches.iter();
        spans.map(move |span| (&a[span.first..span.end], &b[span.first..span.end]))
    }

    pub(super) fn each(&self, series: &mut [f64], what: impl Fn(&Whitener, &Span, &mut [f64])) {
        for stretch in &self.stretches {
            what(&self.whitener, stretch, &mut series[stretch.first..stretch.end]);
        }
    }

    pub(super) fn whiten(&self, series: &mut [f64]) {
        self.each(series, Whitener::whiten);
    }
}

/// The spans of the drive's segments, joined where one follows the other without readings missing between them.
fn without_gaps(sampled: &Sampled) -> Vec<Span> {
    let mut stretches: Vec<Span> = Vec::new();
    for span in &sampled.spans {
        match stretches.last_mut() {
            Some(last) if is_near(&sampled.time_s, span.first) => last.end = span.end,
            _ => stretches.push(*span),
        }
    }
    stretches
}

/// Whether the reading at `first` follows the one before it as closely as its neighbours follow each other.
fn is_near(time_s: &[f64], first: usize) -> bool {
    let gap = |k: usize| {
        let later = time_s.get(k)?;
        Some(later - time_s.get(k.checked_sub(1)?)?)
    };
    let around = [gap(first.wrapping_sub(1)), gap(first + 1)];
    let usual = around.into_iter().flatten().fold(0.0, f64::max);
    gap(first).is_some_and(|own| own <= GAP_FACTOR * usual)
}

impl WhitenedChannel {
    /// The usable readings of `channel`; none where fewer than `needed` follow the step. Currents read while the
    /// circuit was open are left out: the drive alone says that they are zero.
    /// A record of more than `most` is taken by means of neighbours ([`WhitenedChannel::nodes_s`]).
    pub fn new(channel: &Channel, drive: &Drive, needed: usize, most: usize) -> Option<WhitenedChannel> {
        let sampled =
            Sampled::new(channel, drive, channel.quantity == Quantity::Curvature).between_edges(drive);
        if sampled.after_step() < needed {
            return None;
        }
        let (sampled, means) = Means::of(sampled, most);
        Some(WhitenedChannel::of(Response::new(sampled), means))
    }

    /// Times at which a model is asked for what these values are, s: those of the readings, or for a long record a few that
    /// stand for the readings behind each mean.
    pub fn nodes_s(&self) -> &[f64] {
        self.means.as_ref().map_or(self.time_s(), Means::nodes_s)
    }

    /// What a model that gives these values at [`WhitenedChannel::nodes_s`] says of the channel's values.
    pub fn over_nodes<'v>(&self, at_nodes: &'v [f64]) -> Cow<'v, [f64]> {
        means::over(self.means.as_ref(), at_nodes)
    }

    /// Without the values at these places, which increase; none where fewer than `needed` would follow the step.
    pub fn without(&self, places: &[usize], needed: usize) -> Option<WhitenedChannel> {
        let keep = |k: usize| places.binary_search(&k).is_err();
        let sampled = self.response.sampled.kept(keep);
        if sampled.after_step() < needed {
            return None;
        }
        let means = self.means.as_ref().map(|means| means.kept(keep));
        Some(WhitenedChannel::of(Response::new(sampled), means))
    }

    /// Number of readings behind its values.
    pub fn readings(&self) -> usize {
        self.response.sampled.counts().iter().sum::<f64>().round() as usize
    }

    fn of(response: Response, means: Option<Means>) -> WhitenedChannel {
        WhitenedChannel {
            means,
            autocorrelation: Continuing::new(
                &response.sampled,
                &response.noise.sd,
                &response.noise.autocorrelation,
            ),
            readings_per_independent: response.sampled.len() as f64 / response.effective_readings(),
            is_shared: false,
            response,
        }
    }

    /// The same readings with noise found anew from what `fitted` leaves of them. Smooth misfit is not taken for
    /// noise; fast transients, which no free smooth curve follows, are taken out by the fit. The standard deviation
    /// grows with what is fitted as `sqrt(1 + (per_signal fitted)^2)`.
    ///
    /// `like` lends its memory where the readings' own cannot be told.
    pub fn renoised(
        &self,
        fitted: &[f64],
        per_signal: f64,
        like: Option<&WhitenedChannel>,
    ) -> WhitenedChannel {
        self.with_noise_of(fitted, per_signal, |left, scale, least| match like {
            Some(like) => Noise::of_rest_with(left, scale, least, &like.response.noise.autocorrelation),
            None => Noise::of_rest(left, scale, least),
        })
    }

    /// The same readings with the noise that `of` finds in what `fitted` leaves, for a scale and a least standard
    /// deviation.
    fn with_noise_of(
        &self,
        fitted: &[f64],
        per_signal: f64,
        of: impl FnOnce(&Sampled, &[f64], f64) -> Noise,
    ) -> WhitenedChannel {
        let least = self.response.noise.quantum / 12.0_f64.sqrt();
        let found = of(
            &self.left(fitted),
            &self.growing(fitted, per_signal),
            least.max(f64::MIN_POSITIVE),
        );
        let noise = Noise {
            quantum: self.response.noise.quantum,
            proportional: found.floor * per_signal,
            ..found
        };
        let response = Response::with_noise(self.response.sampled.clone(), noise);
        WhitenedChannel::of(response, self.means.clone())
    }

    /// Standard deviation of every value in units of that at signal zero.
    fn growing(&self, fitted: &[f64], per_signal: f64) -> Vec<f64> {
        let spread = self.response.sampled.spread();
        growing(fitted, &spread, per_signal)
    }

    /// The same readings with the memory of the noise cut to `longest` readings for an independent one, and to a fifth of
    /// all readings.
    pub fn forgetting(&self, fitted: &[f64], per_signal: f64, longest: f64) -> WhitenedChannel {
        let longest = longest.min(self.len() as f64 / 5.0).max(1.0);
        if self.readings_per_independent <= longest {
            return self.clone();
        }
        let correlation = (longest - 1.0) / (longest + 1.0);
        let mut like = self.clone();
        like.response.noise.autocorrelation = Autocorrelation::Order(vec![correlation]);
        self.renoised(fitted, per_signal, Some(&like))
    }

    /// The correlation of neighbouring readings that all these channels' noises have; none where there is one channel
    /// only, where their memories are of another kind, or where they differ by more than chance.
    pub fn shared_correlation(channels: &[&WhitenedChannel]) -> Option<f64> {
        let noises: Vec<&Noise> = channels.iter().map(|channel| &channel.response.noise).collect();
        Noise::shared_correlation(&noises)
    }

    /// As [`WhitenedChannel::renoised`], with a correlation that `among` channels share.
    pub fn sharing(
        &self,
        fitted: &[f64],
        per_signal: f64,
        correlation: f64,
        among: usize,
    ) -> WhitenedChannel {
        WhitenedChannel {
            is_shared: true,
            ..self.with_noise_of(fitted, per_signal, |left, scale, least| {
                Noise::of_rest_shared(left, scale, least, correlation, among)
            })
        }
    }

    /// The same channels with slow noise beside the white, one memory for all of them, where that is more likely than what each
    /// has been found to have, each number that describes a memory being `worth` so much in twice the log likelihood;
    /// of the memories within `evidence` of the likeliest the slowest. None where it is not. `fitted` is taken from each.
    pub fn with_slow_noise(
        channels: &[&WhitenedChannel],
        fitted: &[&[f64]],
        per_signal: f64,
        worth: f64,
        evidence: f64,
    ) -> Option<Vec<WhitenedChannel>> {
        let shortest = channels.iter().min_by_key(|channel| channel.len())?;
        let slow = slow::tried(&shortest.response.sampled);
        // A memory that channels share is one for all of them.
        let sharing = channels.iter().filter(|channel| channel.is_shared).count() as f64;
        let of_channel = |(channel, fitted): (&&WhitenedChannel, &&[f64])| {
            let own = std::iter::once(&channel.response.noise.autocorrelation);
            let memories: Vec<Autocorrelation> = own.chain(&slow).cloned().collect();
            let scale = channel.growing(fitted, per_signal);
            let found = slow::deviances(&channel.left(fitted), &scale, &memories);
            let own = channel.response.noise.autocorrelation.parameters() as f64;
            let parts = if channel.is_shared { sharing } else { 1.0 };
            let before = found[0] + worth.max(0.0) * own / parts;
            found[1..].iter().map(|own| before - own).collect()
        };
        let gains: Vec<Vec<f64>> = channels.iter().zip(fitted).map(of_channel).collect();
        let whole = |place: usize| gains.iter().map(|own| own[place]).sum::<f64>();
        let most = (0..slow.len()).map(whole).fold(f64::NEG_INFINITY, f64::max);
        // Of those that are as likely the slowest: what the readings do not exclude may be there.
        let step_s = shortest.response.sampled.time_scales_s().0;
        let slowness = |place: usize| slow[place].readings_per_independent(step_s);
        let best = (0..slow.len())
            .filter(|&place| whole(place) >= most - evidence)
            .max_by(|&a, &b| slowness(a).total_cmp(&slowness(b)))?;
        let memory = &slow[best];
        (whole(best) > worth * SLOW_PARAMETERS).then(|| {
            let each = channels.iter().zip(fitted);
            let with = |(channel, fitted): (&&WhitenedChannel, &&[f64])| {
                channel.with_noise_of(fitted, per_signal, |left, scale, least| {
                    Noise::of_rest_with(left, scale, least, memory)
                })
            };
            each.map(with).collect()
        })
    }

    /// Whether its own readings tell a correlation of neighbours, and no other memory.
    pub fn tells_correlation(&self) -> bool {
        !self.response.noise.by_correlation.is_empty()
    }

    /// Whether the memory of its noise is one that it shares with other channels.
    pub fn is_shared(&self) -> bool {
        self.is_shared
    }

    /// Evidence against noise that grows as each of `per_signal` says, beside what `fitted` leaves: minus twice the log
    /// likelihood ratio to even noise, which is below zero where the readings ask for growth.
    pub fn against_growth(&self, fitted: &[f64], per_signal: &[f64]) -> Vec<f64> {
        let mut level = self.response.sampled.clone();
        level.values = fitted.into();
        let level = level.without_edges(READINGS_AT_EDGE);
        let left = self.left(fitted).without_edges(READINGS_AT_EDGE);
        let scales: Vec<Vec<f64>> = std::iter::once(&0.0)
            .chain(per_signal)
            .map(|per| growing(&level.values, &level.spread(), *per))
            .collect();
        let deviances = Noise::deviances(&left, &scales, &self.response.noise.autocorrelation);
        deviances[1..].iter().map(|own| own - deviances[0]).collect()
    }

    fn left(&self, fitted: &[f64]) -> Sampled {
        let mut left = self.response.sampled.clone();
        let rest = left
            .values
            .iter()
            .zip(fitted)
            .map(|(y, f)| y - f)
            .collect::<Vec<f64>>();
        left.values = rest.into();
        left
    }

    /// Times of the readings, s.
    pub fn time_s(&self) -> &Arc<[f64]> {
        &self.response.sampled.time_s
    }

    /// Readings, canonical unit.
    pub fn values(&self) -> &Arc<[f64]> {
        &self.response.sampled.values
    }

    /// Number of readings.
    pub fn len(&self) -> usize {
        self.response.sampled.len()
    }

    /// Whether there is none; never so for one that was made.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Standard deviation of the noise of every reading, canonical unit.
    pub fn standard_deviation(&self) -> &[f64] {
        &self.response.noise.sd
    }

    /// Readings that carry as much as one independent one.
    pub fn readings_per_independent(&self) -> f64 {
        self.readings_per_independent
    }

    /// Degrees of freedom with which the size of slow noise is known.
    pub fn freedom(&self) -> f64 {
        self.response.noise.freedom
    }

    /// What the noise is like.
    pub fn character(&self) -> NoiseCharacter {
        let noise = &self.response.noise;
        let (autoregression, correlation_time_s) = match &noise.autocorrelation {
            Autocorrelation::Order(coefficients) => (coefficients.clone(), None),
            Autocorrelation::Time { correlation_time_s } => (Vec::new(), Some(*correlation_time_s)),
            Autocorrelation::Slow(processes) => (Vec::new(), longest_s(processes)),
        };
        NoiseCharacter {
            autoregression,
            correlation_time_s,
            proportional: noise.proportional,
            quantum: noise.quantum,
            runs_of_instrument: 0,
        }
    }

    /// Appends measured minus `fitted`, made white and in standard deviations.
    pub fn residuals(&self, fitted: &[f64], out: &mut Vec<f64>) {
        let first = out.len();
        out.extend(self.values().iter().zip(fitted).map(|(y, f)| y - f));
        self.autocorrelation.whiten(&mut out[first..]);
    }

    /// Makes a series over the readings white, in standard deviations, in place.
    pub fn whiten(&self, series: &mut [f64]) {
        self.autocorrelation.whiten(series);
    }

    /// The inverse of [`WhitenedChannel::whiten`].
    pub fn colour(&self, series: &mut [f64]) {
        self.autocorrelation.each(series, Whitener::colour);
    }

    /// What finds the noise again in other residuals at the same readings.
    pub fn noise_again(&self) -> NoiseAgain {
        NoiseAgain::of(&self.response.sampled, &self.response.noise)
    }
}

fn growing(fitted: &[f64], spread: &[f64], per_signal: f64) -> Vec<f64> {
    let pairs = fitted.iter().zip(spread);
    pairs
        .map(|(level, spread)| spread * (per_signal * level).hypot(1.0))
        .collect()
}
