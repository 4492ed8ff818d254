//! What a mixed model is made of.

/// A reading.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reading {
    /// Its value.
    pub value: f64,
    /// What is known of its variance; 0 where nothing is.
    pub variance: f64,
    /// As how many readings it counts: 1, and less where it may be of something else.
    pub weight: f64,
}

impl Reading {
    /// A reading that counts as one.
    pub fn new(value: f64, variance: f64) -> Reading {
        Reading {
            value,
            variance,
            weight: 1.0,
        }
    }
}

/// Readings of one block that have the same row in `X` and in `Z`.
#[derive(Debug, Clone, PartialEq)]
pub struct Unit {
    /// Which block: readings of different blocks share nothing that is left to chance.
    pub block: usize,
    /// Row of `X`.
    pub fixed: Vec<f64>,
    /// Row of `Z`: the columns of all components, those of a block only.
    pub random: Vec<f64>,
    /// Its readings, one at least.
    pub readings: Vec<Reading>,
}

/// Of which size a component may be before its values are looked at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Width {
    /// That of what differs from reading to reading: what the readings of a sample in one environment share.
    Readings,
    /// That of all that differs: samples are not alike because their readings repeat.
    All,
}

/// The model.
#[derive(Debug, Clone)]
pub struct MixedModel {
    /// Readings.
    pub units: Vec<Unit>,
    /// To which component each column of `Z` belongs, from 0.
    pub component_of: Vec<usize>,
    /// The size of each component before its values are looked at.
    pub widths: Vec<Width>,
}

impl MixedModel {
    /// Number of readings, each as it counts.
    pub fn readings(&self) -> f64 {
        let all = self.units.iter().flat_map(|unit| &unit.readings);
        all.map(|reading| reading.weight).sum()
    }

    /// Number of components.
    pub fn components(&self) -> usize {
        self.widths.len()
    }
}
