//! Runs whose voltage is a sine or a chirp: current and bending per volt against frequency, measured and by the fitted model.

mod response;
pub mod view;

use ieap_domain::{Channel, Drive, Quantity, RunRecord};
use ieap_numerics::complex::Complex;
use ieap_numerics::waveform::{LEAST_TURN, Waveform, recognise, turns};

use response::{Window, per_volt, windows};

/// Frequencies at which the model's line is drawn, in each factor of ten.
const LINE_PER_DECADE: f64 = 24.0;
/// How far beyond the measured frequencies it goes, as a factor.
const BEYOND: f64 = 1.5;

/// A response per volt at one frequency, in the unit of the response.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PerVolt {
    /// Complex: its angle is how far the response leads the voltage.
    pub value: Complex,
    /// Half-width of the 95 % interval of its real and its imaginary part; 0 of a model.
    pub half_95: f64,
}

impl PerVolt {
    /// Size per volt.
    pub fn amplitude(&self) -> f64 {
        self.value.magnitude()
    }

    /// How far the response leads the voltage, degrees from -180 to 180.
    pub fn phase_deg(&self) -> f64 {
        self.value.im.atan2(self.value.re).to_degrees()
    }

    /// Half-width of the 95 % interval of the phase, degrees; none where the response may be zero.
    pub fn phase_half_deg(&self) -> Option<f64> {
        let part = self.half_95 / self.amplitude();
        (part < 1.0).then(|| part.asin().to_degrees())
    }
}

/// Responses at one frequency.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrequencyPoint {
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// Current, A/V.
    pub current: Option<PerVolt>,
    /// Curvature, 1/(cm V).
    pub curvature: Option<PerVolt>,
}

/// One run.
#[derive(Debug, Clone, PartialEq)]
pub struct FrequencyRun {
    /// Row id of the run.
    pub run_id: i64,
    /// Its path.
    pub path: String,
    /// `sine` or `chirp`.
    pub waveform: &'static str,
    /// Amplitude of the voltage, V.
    pub amplitude_v: f64,
    /// Measured, by frequency.
    pub measured: Vec<FrequencyPoint>,
    /// The fitted model at the same frequencies; empty where the fit determines no circuit.
    pub modelled: Vec<FrequencyPoint>,
    /// The fitted model at many frequencies, for a line.
    pub line: Vec<FrequencyPoint>,
}

/// The model of a fit: current, A/V, and curvature, 1/(cm V), at a frequency, Hz.
pub type Model<'a> = &'a dyn Fn(f64) -> FrequencyPoint;

/// What a run with these channels says; none where its voltage is neither a sine nor a chirp.
pub fn frequency_run(run: &RunRecord, channels: &[Channel], model: Option<Model>) -> Option<FrequencyRun> {
    let drive = run.drive.as_ref().filter(|drive| drive.moves())?;
    let (time_s, volts) = course(drive);
    let range = ieap_domain::range_of(volts.iter().copied());
    let turns = turns(&volts, LEAST_TURN * (range.1 - range.0));
    let (waveform, amplitude_v, windows) = match recognise(&time_s, &volts, &turns) {
        Waveform::Sine { amplitude, .. } => ("sine", amplitude, windows(&time_s, &volts, &turns, None)),
        Waveform::Chirp { amplitude, .. } => (
            "chirp",
            amplitude,
            windows(&time_s, &volts, &turns, Some(PERIODS_OF_CHIRP)),
        ),
        Waveform::Triangle { .. } | Waveform::Other => return None,
    };
    let of = |window: &Window, quantity: Quantity| {
        let channel = channels.iter().find(|channel| channel.is_whole(quantity))?;
        let (own_s, values) = channel.included();
        per_volt(window, (&time_s, &volts), (&own_s, &values))
    };
    let point = |window: &Window| FrequencyPoint {
        frequency_hz: window.frequency_hz,
        current: of(window, Quantity::Current),
        curvature: of(window, Quantity::Curvature),
    };
    let told = |point: &FrequencyPoint| point.current.is_some() || point.curvature.is_some();
    let measured: Vec<FrequencyPoint> = windows.iter().map(point).filter(told).collect();
    let (low, high) = ieap_domain::range_of(measured.iter().map(|point| point.frequency_hz));
    let (modelled, line) = match model.filter(|_| !measured.is_empty()) {
        Some(model) => (
            measured.iter().map(|point| model(point.frequency_hz)).collect(),
            between(low / BEYOND, high * BEYOND)
                .into_iter()
                .map(model)
                .collect(),
        ),
        None => (Vec::new(), Vec::new()),
    };
    (!measured.is_empty()).then(|| FrequencyRun {
        run_id: run.id,
        path: run.path.clone(),
        waveform,
        amplitude_v,
        measured,
        modelled,
        line,
    })
}

/// Periods of a chirp that are looked at together: so many that a trend is told from them, and so few that the frequency
/// hardly changes.
const PERIODS_OF_CHIRP: usize = 2;

/// The voltage's own readings: each stands in the middle of its step. What is held at the end is none of the wave.
fn course(drive: &Drive) -> (Vec<f64>, Vec<f64>) {
    let pairs = drive.segments.windows(2).filter_map(|pair| {
        let volts = pair[0].level.volts()?;
        Some((0.5 * (pair[0].start_s() + pair[1].start_s()), volts))
    });
    pairs.unzip()
}

/// Frequencies evenly spread on a logarithmic scale.
fn between(low_hz: f64, high_hz: f64) -> Vec<f64> {
    let count = ((high_hz / low_hz).log10() * LINE_PER_DECADE).ceil().max(1.0) as usize;
    (0..=count)
        .map(|k| low_hz * (high_hz / low_hz).powf(k as f64 / count as f64))
        .collect()
}

#[cfg(test)]
mod tests;
