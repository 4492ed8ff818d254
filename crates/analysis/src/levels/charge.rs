//! The charge of a level with what its errors share with those of other levels, and sums of them.

use ieap_domain::Estimate;
use ieap_domain::quantiles::NORMAL_95;

/// A charge, C. What is not known of it has parts that add up differently over the levels of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Charge {
    pub value: f64,
    /// Standard deviation from the noise: each level has its own.
    pub noise: f64,
    /// From the curvature between readings, with its sign: that of all levels is alike.
    pub curvature: f64,
    /// Standard deviations from where its edges lie, with their signs when both lie later than thought: all edges of a run are
    /// read by one clock.
    pub edges: [f64; 2],
    /// What may have passed unseen before the first reading, with its sign, in 97.5 % of cases less.
    pub unseen: f64,
}

/// A weighted sum of charges, in the unit of the weights times C.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Sum {
    pub value: f64,
    /// How far the 95 % interval reaches down and up.
    down: f64,
    up: f64,
}

impl Sum {
    /// Of charges with their weights.
    pub fn of(parts: impl IntoIterator<Item = (f64, Charge)>) -> Sum {
        let (mut value, mut noise, mut curvature) = (0.0, 0.0_f64, 0.0);
        let (mut alike, mut apart) = (0.0, 0.0_f64);
        let (mut below, mut above) = (0.0, 0.0);
        for (weight, charge) in parts {
            value += weight * charge.value;
            noise = noise.hypot(weight * charge.noise);
            curvature += weight * charge.curvature;
            for edge in charge.edges {
                alike += weight * edge;
                apart = apart.hypot(weight * edge);
            }
            below += (weight * charge.unseen).min(0.0);
            above += (weight * charge.unseen).max(0.0);
        }
        // Edges that do not lie between their readings alike add up as if each had its own place.
        let half = NORMAL_95 * noise.hypot(curvature).hypot(f64::max(f64::abs(alike), apart));
        Sum {
            value,
            down: half.hypot(below),
            up: half.hypot(above),
        }
    }

    /// Half of the width of the interval, in standard deviations of a normal error.
    pub fn error(&self) -> f64 {
        (self.down + self.up) / (2.0 * NORMAL_95)
    }

    /// As an estimate of another value that changes with it one to one.
    pub fn about(&self, value: f64) -> Estimate {
        Estimate::determined(value, self.error(), value - self.down, value + self.up)
    }

    /// As an estimate, times a factor.
    pub fn estimate(&self, factor: f64) -> Estimate {
        self.about(self.value).scaled(factor)
    }
}

impl Charge {
    /// The charge by itself.
    pub fn alone(self) -> Sum {
        Sum::of([(1.0, self)])
    }
}
