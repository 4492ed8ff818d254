//! Kinds of noise that an instrument may have, and what the readings of a run tell of each.

use serde::{Deserialize, Serialize};

/// A kind of noise, as an instrument has it in all its runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct NoiseKind {
    /// What is there beside white noise.
    pub form: NoiseForm,
    /// Its variance is 9 / 4^size of that of the white noise of one reading; 0 of white noise alone.
    pub size: u8,
}

/// What a noise has beside what is new at every reading.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum NoiseForm {
    /// Nothing.
    White,
    /// A process that forgets in 4^k s.
    Process(i8),
    /// As much of each such process (1/f).
    Flicker,
    /// A straight line over the record.
    Line,
    /// Half of each of the last two.
    FlickerAndLine,
}

/// What the readings of one channel of a run tell of a kind of noise.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct KindEvidence {
    /// The kind.
    pub kind: NoiseKind,
    /// Natural logarithm of how likely it makes the readings, beside what a fit searches; only differences tell.
    pub log_likelihood: f64,
}

/// What a run tells of the noise of its instrument; nothing of a channel that it has not, or that tells of none.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ToldOfNoise {
    /// By the current.
    pub current: Vec<KindEvidence>,
    /// By the curvature.
    pub curvature: Vec<KindEvidence>,
}

impl ToldOfNoise {
    /// Whether it tells nothing.
    pub fn is_empty(&self) -> bool {
        self.current.is_empty() && self.curvature.is_empty()
    }
}
