//! Readings of the four-point probe.

/// Seconds in a day.
pub const DAY_S: f64 = 86_400.0;

/// One reading of a sample's electrodes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProbeReading {
    /// When, s since 1970 UTC.
    pub at_s: f64,
    /// Resistance of both electrodes along the strip, Ohm per square.
    pub ohm_per_sq: f64,
    /// Its standard error; none where neither the table states one nor repeats show it.
    pub error_ohm_per_sq: Option<f64>,
    /// Flexings of the strip so far.
    pub flexings: Option<f64>,
    /// Relative humidity, percent.
    pub humidity_percent: Option<f64>,
}

/// The readings of a sample, by date.
#[derive(Debug, Clone, PartialEq)]
pub struct ProbeSeries {
    /// The sample.
    pub sample: String,
    /// Readings at different moments.
    pub readings: Vec<ProbeReading>,
}
