//! What a law follows: a variable of the run, and bells over it.

use ieap_domain::ClimateQuantity;

use super::course::Course;
use crate::effects::Scale;
use crate::extended::Now;

/// Most weights of a law.
pub const WEIGHTS: usize = 8;

/// What a law follows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Axis {
    /// Time since the start, s, or its logarithm.
    Time,
    LogTime,
    /// Logarithm of the time since the last edge.
    SinceEdge,
    /// Voltage of the source, or its size, V.
    Voltage,
    VoltageSize,
    /// Voltage of each capacitor, V.
    OwnVoltage,
    /// Charge that bends, or its size, C/cm2.
    Charge,
    ChargeSize,
    /// Curvature, or its size, 1/cm.
    Curvature,
    CurvatureSize,
    /// Current, or its size, A/cm2.
    Current,
    CurrentSize,
    /// Changes of the voltage so far; the largest voltage so far, whatever its sign, V.
    Edges,
    Largest,
    /// What a sensor beside the strip read, late by so large a part of the longest record: a strip takes time to take up water.
    Logged(ClimateQuantity, f64),
    /// Power, current, or its size, remembered for so large a part of the longest record.
    Power(f64),
    Flow(f64),
    FlowSize(f64),
    /// No variable: weights are of elements one by one, time scales mostly.
    Elements,
}

/// Width of a bell in distances of bells.
const WIDTH: f64 = 0.8;
/// Time from which logarithms of the time since the start go, as a part of the longest record.
const EARLY: f64 = 1.0 / 120.0;
/// Time from which logarithms of the time since an edge go, in shortest times between readings.
const SOON: f64 = 0.3;

impl Axis {
    /// Ends of the variable in data of that scale, and the time that it is measured by.
    pub(super) fn over(self, scale: &Scale) -> (f64, f64, f64) {
        let longest_s = scale.longest_s();
        let about = |most: f64| (-most, most, 0.0);
        let density = scale.current_a / scale.area_cm2;
        // No more flows on average than what is stored.
        let flow = |part: f64| density.min(scale.charge_c / scale.area_cm2 / (part * longest_s));
        match self {
            Axis::Time => (0.0, longest_s, 0.0),
            Axis::LogTime => (0.0, (1.0 + EARLY.recip()).ln(), EARLY * longest_s),
            Axis::SinceEdge => {
                let soon_s = SOON * scale.shortest_s;
                (soon_s.ln(), (longest_s + soon_s).ln(), soon_s)
            }
            Axis::Voltage | Axis::OwnVoltage => about(scale.voltage_v),
            Axis::Edges => (0.0, scale.edges as f64, 0.0),
            Axis::VoltageSize | Axis::Largest => (0.0, scale.voltage_v, 0.0),
            Axis::Charge => about(scale.charge_c / scale.area_cm2),
            Axis::ChargeSize => (0.0, scale.charge_c / scale.area_cm2, 0.0),
            Axis::Curvature => about(scale.curvature_per_cm),
            Axis::CurvatureSize => (0.0, scale.curvature_per_cm, 0.0),
            Axis::Current => about(density),
            Axis::CurrentSize => (0.0, density, 0.0),
            Axis::Logged(quantity, part) => {
                let (low, high) = scale.logged_over(quantity);
                (low, high, part * longest_s)
            }
            Axis::Power(part) => (0.0, flow(part) * scale.voltage_v, part * longest_s),
            Axis::Flow(part) => (-flow(part), flow(part), part * longest_s),
            Axis::FlowSize(part) => (0.0, flow(part), part * longest_s),
            Axis::Elements => (0.0, longest_s, scale.shortest_s),
        }
    }

    /// The same by its size, where both are one as long as the voltage has one sign, or never falls.
    pub(super) fn by_size(self) -> Option<Axis> {
        match self {
            Axis::Voltage | Axis::Largest => Some(Axis::VoltageSize),
            Axis::Charge => Some(Axis::ChargeSize),
            _ => None,
        }
    }

    /// Whether under one edge a run it is the time, or nothing.
    pub(super) fn is_of_edges(self) -> bool {
        matches!(self, Axis::SinceEdge | Axis::Edges | Axis::Largest)
    }

    /// Name in ids.
    pub(super) fn key(self) -> String {
        let parts = |part: f64| format!("{}th", part.recip().round() as u32);
        match self {
            Axis::Time => "time".to_owned(),
            Axis::LogTime => "log-time".to_owned(),
            Axis::SinceEdge => "since-edge".to_owned(),
            Axis::Voltage => "voltage".to_owned(),
            Axis::VoltageSize => "voltage-size".to_owned(),
            Axis::OwnVoltage => "own-voltage".to_owned(),
            Axis::Charge => "charge".to_owned(),
            Axis::ChargeSize => "charge-size".to_owned(),
            Axis::Curvature => "curvature".to_owned(),
            Axis::CurvatureSize => "curvature-size".to_owned(),
            Axis::Edges => "edges".to_owned(),
            Axis::Largest => "largest-voltage".to_owned(),
            Axis::Current => "current".to_owned(),
            Axis::CurrentSize => "current-size".to_owned(),
            Axis::Logged(quantity, 0.0) => quantity.key().replace('_', "-"),
            Axis::Logged(quantity, part) => format!("{}-{}", quantity.key().replace('_', "-"), parts(part)),
            Axis::Power(part) => format!("heat-{}", parts(part)),
            Axis::Flow(part) => format!("flow-{}", parts(part)),
            Axis::FlowSize(part) => format!("flow-size-{}", parts(part)),
            Axis::Elements => "elements".to_owned(),
        }
    }

    pub(super) fn is_of_bending(self) -> bool {
        matches!(self, Axis::Curvature | Axis::CurvatureSize)
    }

    /// Whether the variable is remembered.
    pub(super) fn remembers(self) -> bool {
        matches!(self, Axis::Power(_) | Axis::Flow(_) | Axis::FlowSize(_))
    }

    /// What a remembered variable is made of.
    pub(super) fn input(self, now: &Now) -> f64 {
        match self {
            Axis::Power(_) => (now.terminal_v * now.current_a_per_cm2).abs(),
            Axis::FlowSize(_) => now.current_a_per_cm2.abs(),
            _ => now.current_a_per_cm2,
        }
    }

    /// The variable now; `memory` is its mean over the time that it is measured by.
    fn of(self, now: &Now, memory: f64, time_s: f64) -> f64 {
        match self {
            Axis::Time => now.clock_s.max(0.0),
            Axis::LogTime => (now.clock_s.max(0.0) / time_s).ln_1p(),
            Axis::SinceEdge => (now.since_edge_s.max(0.0) + time_s).ln(),
            Axis::Voltage => now.source_v,
            Axis::VoltageSize => now.source_v.abs(),
            Axis::OwnVoltage | Axis::Elements | Axis::Edges | Axis::Largest | Axis::Logged(..) => 0.0,
            Axis::Charge => now.charge_c_per_cm2,
            Axis::ChargeSize => now.charge_c_per_cm2.abs(),
            Axis::Curvature => now.curvature_per_cm,
            Axis::CurvatureSize => now.curvature_per_cm.abs(),
            Axis::Current => now.current_a_per_cm2,
            Axis::CurrentSize => now.current_a_per_cm2.abs(),
            Axis::Power(_) | Axis::Flow(_) | Axis::FlowSize(_) => memory,
        }
    }
}

/// A smooth function of a variable.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Curve {
    pub(super) weights: Vec<f64>,
    pub(super) axis: Axis,
    pub(super) ends: (f64, f64),
    pub(super) time_s: f64,
    /// The course of its variable, where the drive or a sensor tells it ahead.
    pub(super) course: Option<Course>,
}

impl Curve {
    /// Its value where the variable is `x`: bells, the last weight a straight line.
    pub(super) fn at(&self, x: f64) -> f64 {
        let (low, high) = self.ends;
        let bells = WEIGHTS - 1;
        let step = (high - low) / (bells - 1) as f64;
        let x = x.clamp(low, high);
        let bell = |k: usize| (-0.5 * ((x - low - step * k as f64) / (WIDTH * step)).powi(2)).exp();
        let line = if low == -high {
            x / high
        } else {
            (x - low) / (high - low)
        };
        let each = self
            .weights
            .iter()
            .enumerate()
            .filter(|(_, weight)| **weight != 0.0);
        each.map(|(k, weight)| weight * if k < bells { bell(k) } else { line })
            .sum()
    }

    /// Its value now; see [`Axis::of`] for `memory`.
    pub(super) fn now(&self, now: &Now, memory: f64) -> f64 {
        let ahead = self.course.as_ref().map(|course| course.at(now.clock_s));
        self.at(ahead.unwrap_or_else(|| self.axis.of(now, memory, self.time_s)))
    }

    /// So many places over its variable, in the variable's own unit, with the value at each.
    pub(super) fn drawn(&self, count: usize) -> Vec<(f64, f64)> {
        let (low, high) = self.ends;
        let place = |k: usize| low + (high - low) * k as f64 / (count.max(2) - 1) as f64;
        (0..count)
            .map(|k| (self.unwarped(place(k)), self.at(place(k))))
            .collect()
    }

    fn unwarped(&self, x: f64) -> f64 {
        match self.axis {
            Axis::LogTime => self.time_s * x.exp_m1(),
            Axis::SinceEdge => (x.exp() - self.time_s).max(0.0),
            _ => x,
        }
    }
}
