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
    /// Standard deviation from noise and curvature.
    noise: f64,
    edges: Edges,
    unseen: f64,
}

/// Standard deviations from edges: what they share, and what is their own.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct Edges {
    /// Where all lie alike.
    alike: [f64; 2],
    /// Where each lies somewhere.
    apart: [f64; 2],
}

impl Sum {
    /// Of charges with their weights. Of edges it is not known whether they lie alike: the larger error counts.
    pub fn of(parts: impl IntoIterator<Item = (f64, Charge)>) -> Sum {
        let (mut value, mut unseen, mut noise, mut curvature) = (0.0, 0.0, 0.0_f64, 0.0);
        let mut edges = Edges::default();
        for (weight, charge) in parts.into_iter().filter(|(weight, _)| *weight != 0.0) {
            value += weight * charge.value;
            noise = noise.hypot(weight * charge.noise);
            curvature += weight * charge.curvature;
            // What passes unseen is the same in all levels, as large as their steps.
            unseen += weight * charge.unseen;
            for place in charge.edges {
                for (k, part) in [place.shared, place.own].into_iter().enumerate() {
                    edges.alike[k] += weight * part;
                    edges.apart[k] = edges.apart[k].hypot(weight * part);
                }
            }
        }
        Sum {
            value,
            noise: noise.hypot(curvature),
            edges,
            unseen,
        }
    }

    /// The same where what differs from edge to edge is told by how much its like scatter.
    pub fn of_many(mut self) -> Sum {
        self.edges.apart[0] = 0.0;
        self
    }

    fn half(&self) -> f64 {
        let Edges { alike, apart } = self.edges;
        let each = |k: usize| alike[k].abs().max(apart[k]);
        let together = (alike[0] + alike[1]).abs();
        NORMAL_95 * self.noise.hypot(each(0).hypot(each(1)).max(together))
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

    /// One sum over another, where `change` is what the first order gives of it: what all levels share may change both a lot.
    pub fn over(&self, below: &Sum, change: &Sum) -> Estimate {
        let part = self.value / below.value;
        let mut found = change.about(part);
        for by in [-NORMAL_95, NORMAL_95] {
            let moved = |sum: &Sum| (sum.value + by * sum.edges.alike[0]).max(0.0);
            let other = match moved(below) {
                0.0 => 0.0,
                below => moved(self) / below,
            };
            found.low_95 = found.low_95.map(|low| low.min(other));
            found.high_95 = found.high_95.map(|high| high.max(other));
        }
        found
    }
}

impl Charge {
    /// Which way it flows: where its interval holds nothing, the way of what passed unseen.
    pub fn way(&self) -> f64 {
        let is_told = self.value.abs() > NORMAL_95 * self.alone().error();
        if is_told || self.unseen == 0.0 {
            self.value.signum()
        } else {
            self.unseen.signum()
        }
    }

    /// The charge by itself.
    pub fn alone(self) -> Sum {
        Sum::of([(1.0, self)])
    }
}
