//! A law as an effect.

use super::axis::{Axis, Curve, WEIGHTS};
use super::course::Course;
use super::part::Part;
use super::shapes::{Textbook, simple};
use crate::effects::{About, Effect, EffectParameter, Limits, Scale, Search, Site};
use crate::extended::{RunContext, System};
use ieap_domain::ClimateQuantity;

/// Where something is missing: a law of the model, and what it follows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Place {
    /// Where it acts.
    pub site: Site,
    /// The law: a part of the model.
    pub law: &'static str,
    /// Which part of several it is a law of; empty where of all.
    pub of: &'static str,
    /// What it follows.
    pub variable: &'static str,
}

/// A law drawn over its variable.
#[derive(Debug, Clone, PartialEq)]
pub struct Drawn {
    /// Places, in the unit that the variable's key ends in.
    pub x: Vec<f64>,
    /// Values there: what is added, or the relative change of what is multiplied.
    pub y: Vec<f64>,
    /// Unit of the values; 1 of relative changes.
    pub unit: &'static str,
}

/// What stands behind the weights among a law's parameters: ends of the variable, its time, the size of what is added.
const HELD: usize = 4;
/// A weight at which a law is looked at: its answer goes along a straight line there.
const PROBE: f64 = 0.02;

/// A law as a smooth function of a variable.
pub struct SmoothLaw {
    about: &'static About,
    /// Law, variable, and what has them.
    pub place: Place,
    part: Part,
    axis: Axis,
}

const fn parameter(key: &'static str, symbol: &'static str, meaning: &'static str) -> EffectParameter {
    EffectParameter {
        key,
        symbol,
        unit: "",
        meaning,
    }
}

/// Parameters of every law.
static PARAMETERS: [EffectParameter; WEIGHTS + HELD] = [
    parameter("weight_1", "w_1", "weight of the first bell"),
    parameter("weight_2", "w_2", "weight of the second bell"),
    parameter("weight_3", "w_3", "weight of the third bell"),
    parameter("weight_4", "w_4", "weight of the fourth bell"),
    parameter("weight_5", "w_5", "weight of the fifth bell"),
    parameter("weight_6", "w_6", "weight of the sixth bell"),
    parameter("weight_7", "w_7", "weight of the seventh bell"),
    parameter("weight_8", "w_8", "weight of the straight line"),
    parameter("from", "x_0", "least value of the variable"),
    parameter("to", "x_1", "greatest value of the variable"),
    parameter("time_s", "t_0", "time that the variable is measured by"),
    parameter("size", "s", "what a weight of one adds, or the area"),
];

impl SmoothLaw {
    /// Kept for as long as the program runs: laws stand in one list.
    pub(super) fn new(id: &'static str, place: Place, part: Part, axis: Axis) -> SmoothLaw {
        SmoothLaw {
            about: Box::leak(Box::new(About {
                id,
                code: "",
                summary: Box::leak(place.words().into_boxed_str()),
                equation: "",
                variants: &[],
                parameters: &PARAMETERS,
                vanishes: "all weights 0",
                signature: "",
                twins: &[],
                separated_by: "",
                sources: "",
            })),
            place,
            part,
            axis,
        }
    }

    /// Whether it is one of these laws, by the size of its variable, where the voltage has one sign, or never falls.
    pub fn is_by_size_among(&self, laws: &[&SmoothLaw]) -> bool {
        let sized = self.axis.by_size();
        let is_twin = |other: &&SmoothLaw| {
            let (own, theirs) = (self.place, other.place);
            (theirs.law, theirs.of, other.part) == (own.law, own.of, self.part) && Some(other.axis) == sized
        };
        laws.iter().any(is_twin)
    }

    /// Whether it follows what one edge a run says nothing of: the time since an edge is the time there.
    pub fn needs_edges(&self) -> bool {
        self.axis.is_of_edges()
    }

    /// What it follows of what sensors beside the strip read; it says nothing of a run without such readings.
    pub fn logged(&self) -> Option<ClimateQuantity> {
        match self.axis {
            Axis::Logged(quantity, _) => Some(quantity),
            _ => None,
        }
    }

    /// Weights that it has.
    pub fn weights(&self) -> usize {
        self.part.weights(self.axis)
    }

    /// The function with these parameters at so many places over its variable; none of a law that is no function of one
    /// variable but a spectrum.
    pub fn drawn(&self, parameters: &[f64], count: usize) -> Option<Drawn> {
        let is_drawn = self.axis != Axis::Elements && self.part != Part::Play;
        is_drawn.then(|| {
            let (by_unit, unit) = self.part.of_one(parameters[WEIGHTS + 3]);
            let places = self.function(parameters).drawn(count);
            let (x, y) = places.into_iter().map(|(x, y)| (x, by_unit * y)).unzip();
            Drawn { x, y, unit }
        })
    }

    /// Weights of curves of textbooks over its variable, each of size one, but for these; none of a spectrum, nor of a law of
    /// fewer weights. Ends as of parameters.
    pub fn simple(&self, parameters: &[f64], without: &[Textbook]) -> Vec<&'static [f64]> {
        let (low, high) = (parameters[WEIGHTS], parameters[WEIGHTS + 1]);
        let is_signed = low == -high;
        if self.weights() < WEIGHTS {
            return Vec::new();
        }
        simple(self.axis, is_signed, without)
    }

    fn function(&self, parameters: &[f64]) -> Curve {
        let held = &parameters[WEIGHTS..];
        Curve {
            weights: parameters[..self.weights()].to_vec(),
            axis: self.axis,
            ends: (held[0], held[1]),
            time_s: held[2],
            course: None,
        }
    }
}

impl Effect for SmoothLaw {
    fn about(&self) -> &'static About {
        self.about
    }

    fn search(&self, _variant: usize, scale: &Scale) -> Search {
        let bends = scale.curvature_per_cm > 0.0;
        let (low, high, time_s) = self.axis.over(scale);
        let needs_bending = self.place.site == Site::Bending || self.axis.is_of_bending();
        let is_there = scale.voltage_v > 0.0 && scale.current_a > 0.0 && (bends || !needs_bending);
        let is_wide = high > low && (high - low).is_finite();
        if !(is_there && is_wide) {
            return Search::none();
        }
        let (free, size) = (self.weights(), self.part.size(scale));
        let mut limits = vec![Limits::held(); WEIGHTS + HELD];
        limits[..free].fill(Limits::linear(-self.part.most(), self.part.most()));
        let mut probe = vec![0.0; WEIGHTS];
        probe[..free].fill(PROBE);
        probe.extend([low, high, time_s, size]);
        Search {
            limits,
            probes: vec![probe],
            absent: 0.0,
        }
    }

    fn apply(&self, _variant: usize, parameters: &[f64], run: &RunContext, system: &mut System) {
        if parameters[..self.weights()].iter().all(|weight| *weight == 0.0) {
            return;
        }
        let mut function = self.function(parameters);
        function.course = match self.axis {
            Axis::Logged(quantity, _) => Course::logged(run, quantity, function.time_s),
            Axis::Edges => Some(Course::of_edges(run, |_, before| before + 1.0)),
            Axis::Largest => Some(Course::of_edges(run, |volts, before| volts.abs().max(before))),
            _ => None,
        };
        self.part.act_on(system, function, parameters[WEIGHTS + 3]);
    }
}
