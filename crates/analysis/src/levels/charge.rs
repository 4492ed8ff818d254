//! The charge of a level with what its errors share with those of other levels, and sums of them.

use ieap_domain::Estimate;
use ieap_domain::quantiles::NORMAL_95;

const PASSED_UNSEEN: &str =
    "what flowed between an edge and the first reading behind it may have passed unseen";

/// A charge, C. What is not known of it has parts that add up differently over the levels of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Charge {
    pub value: f64,
    /// Standard deviation from the noise: each level has its own.
    pub noise: f64,
    /// From the curvature between readings, with its sign: that of all levels is alike.
    pub curvature: f64,
    /// From where its edges lie.
    pub edges: [Place; 2],
    /// What may have passed unseen before the first reading, with its sign, in 97.5 % of cases less.
    pub unseen: f64,
}

/// What the place of an edge does to a charge: standard deviations, C.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Place {
    /// With its sign when the edge lies later than thought: all edges of a run are read by one clock, and may lie alike.
    shared: f64,
    /// Where an edge is less well known than others of its run.
    own: f64,
}

impl Place {
    /// Of an edge of whose stretch that part is the shortest one of the run.
    pub fn of(change: f64, part: f64) -> Place {
        Place {
            shared: change * part,
            own: change * (1.0 - part * part).max(0.0).sqrt(),
        }
    }
}

/// A weighted sum of charges, in the unit of the weights times C.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Sum {
    pub value: f64,
    /// Standard deviation from all that is each level's own; from edges that all lie alike, and that each lie somewhere.
    noise: f64,
    alike: f64,
    apart: f64,
    unseen: f64,
}

impl Sum {
    /// Of charges with their weights. Of edges it is not known whether they lie alike: the larger error counts.
    pub fn of(parts: impl IntoIterator<Item = (f64, Charge)>) -> Sum {
        let (mut noise, mut curvature) = (0.0_f64, 0.0);
        let mut sum = Sum {
            value: 0.0,
            noise: 0.0,
            alike: 0.0,
            apart: 0.0,
            unseen: 0.0,
        };
        for (weight, charge) in parts {
            sum.value += weight * charge.value;
            noise = noise.hypot(weight * charge.noise);
            curvature += weight * charge.curvature;
            // What passes unseen is the same in all levels, as large as their steps.
            if weight != 0.0 {
                sum.unseen += weight * charge.unseen;
            }
            for edge in charge.edges {
                sum.alike += weight * edge.shared;
                sum.apart = sum.apart.hypot(weight * edge.shared);
                noise = noise.hypot(weight * edge.own);
            }
        }
        sum.noise = noise.hypot(curvature);
        sum
    }

    /// The same where what differs from edge to edge is told by how much its like scatter.
    pub fn of_many(self) -> Sum {
        Sum { apart: 0.0, ..self }
    }

    fn half(&self) -> f64 {
        NORMAL_95 * self.noise.hypot(self.alike.abs().max(self.apart))
    }

    /// Half of the width of the interval, in standard deviations of a normal error.
    pub fn error(&self) -> f64 {
        0.5 * (self.half() + self.half().hypot(self.unseen)) / NORMAL_95
    }

    /// As an estimate of another value that changes with it one to one; a bound where nothing tells how much passed unseen.
    pub fn about(&self, value: f64) -> Estimate {
        let half = self.half();
        if self.unseen == f64::INFINITY {
            return Estimate::above(value - half, PASSED_UNSEEN);
        }
        if self.unseen == f64::NEG_INFINITY {
            return Estimate::below(value + half, PASSED_UNSEEN);
        }
        if !self.unseen.is_finite() {
            return Estimate::not_determined(PASSED_UNSEEN);
        }
        let (down, up) = (half.hypot(self.unseen.min(0.0)), half.hypot(self.unseen.max(0.0)));
        Estimate::determined(value, self.error(), value - down, value + up)
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
