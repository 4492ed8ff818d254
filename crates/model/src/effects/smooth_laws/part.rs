//! Which part of the model a law makes a function.

use crate::effects::Scale;
use crate::effects::acting::{LEAST, scale_capacitances, scale_resistances};
use crate::effects::mechanical_lag::lag;
use crate::effects::search::spread;
use crate::extended::{BranchLaw, Coefficients, Law, Now, Observation, RelaxationMode, System};

use super::axis::{Axis, Curve, WEIGHTS};

/// A part of the model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Part {
    /// Resistance of all branches, or of one of the base's.
    Resistance(Option<usize>),
    /// Capacitance likewise.
    Capacitance(Option<usize>),
    /// A conductance between the terminals that stores no charge.
    Leak,
    /// A voltage beside the source's, by the source's.
    Source,
    /// A voltage that the current takes away.
    Drop,
    /// What is read of the current, added, or as a part of what flows.
    ReadCurrent,
    ReadGain,
    /// Charge of the capacitors before the drive.
    FirstCharge,
    /// Further branches, that bend or do not.
    Branches(bool),
    /// Coupling of the strain; strain of the charge.
    Coupling,
    Strain,
    /// Rate of relaxation.
    Rate,
    /// Further rates of relaxation.
    Rates,
    /// Curvature beside that of the charge; that of the square of the voltage, over times.
    Added,
    Even,
    /// Curvature that comes late: lags, and a delay.
    Late,
    /// Curvature that stays behind where it turns.
    Play,
}

/// Times of elements that are spread, as parts of the longest record.
const BRANCH_TIMES: (f64, f64) = (1.0 / 600.0, 6.0);
const RATE_TIMES: (f64, f64) = (1.0 / 300.0, 8.0);
const EVEN_TIMES: (f64, f64) = (1.0 / 120.0, 0.5);
const LAG_TIMES: (f64, f64) = (1.0 / 600.0, 0.05);
/// Least time of an element, in shortest times between readings.
const LEAST_TIME: f64 = 0.3;
/// Rate of the curvature, in the largest curvature over the longest record, above which it is said to move.
const MOVES: f64 = 0.3;
/// What a weight of one adds, of the largest of its kind.
const PART: f64 = 0.05;
/// What an instrument misreads at most, of its largest reading. Chosen.
const INSTRUMENT: f64 = 0.1;
/// What a law of the strip adds at most, of the largest reading.
const WHOLE: f64 = 1.0;
/// Largest relative change of what is multiplied. Chosen: measured resistances differ 20-fold between voltages.
const FACTOR: f64 = 20.0;

impl Part {
    pub(super) fn weights(self, axis: Axis) -> usize {
        match (self, axis) {
            (Part::FirstCharge, _) => 2,
            (Part::Late, _) => 6,
            (Part::Play, _) => 1,
            _ => WEIGHTS,
        }
    }

    /// What a weight of one adds, in the unit of what it adds to; 1 of factors.
    pub(super) fn size(self, scale: &Scale) -> f64 {
        let density = scale.current_a / scale.area_cm2;
        match self {
            Part::Leak => 0.2 * PART * density / scale.voltage_v,
            Part::Source => PART,
            Part::FirstCharge => PART * scale.voltage_v,
            Part::Strain => scale.area_cm2,
            Part::Drop => PART * scale.voltage_v / density,
            Part::ReadCurrent => PART * scale.current_a,
            Part::ReadGain => scale.current_a,
            Part::Branches(_) => PART * scale.capacitance_f_per_cm2(),
            Part::Added | Part::Play => PART * scale.curvature_per_cm,
            Part::Even => PART * scale.curvature_per_cm / scale.voltage_v.powi(2),
            _ => 1.0,
        }
    }

    /// Largest weight that is sought: what instruments misread is a few per cent of what they read, and a law of the strip may
    /// make up a whole reading, or a factor of twenty.
    pub(super) fn most(self) -> f64 {
        match self {
            Part::ReadCurrent => INSTRUMENT / PART,
            Part::ReadGain => INSTRUMENT,
            Part::Leak => WHOLE / (0.2 * PART),
            Part::Source | Part::FirstCharge | Part::Drop | Part::Branches(_) | Part::Added | Part::Play => {
                WHOLE / PART
            }
            Part::Even => WHOLE / PART,
            _ => FACTOR,
        }
    }

    /// What a value of one of the function is, with its unit; `size` as of [`Part::size`].
    pub(super) fn of_one(self, size: f64) -> (f64, &'static str) {
        match self {
            Part::Leak => (size, "S/cm2"),
            Part::Drop => (size, "ohm cm2"),
            Part::ReadCurrent => (size, "A"),
            Part::Added => (size, "1/cm"),
            Part::Source => (size, "1"),
            _ => (1.0, "1"),
        }
    }

    /// Puts the function into a system.
    pub(super) fn act_on(self, system: &mut System, curve: Curve, size: f64) {
        let longest_s = curve.ends.1;
        let elements = |(first, last): (f64, f64), count: usize| {
            let least_s = LEAST_TIME * curve.time_s;
            spread((first * longest_s).max(least_s), last * longest_s, count)
        };
        let weights = curve.weights.clone();
        match self {
            Part::ReadGain => system.written_current.push(Box::new(move |_, value: f64| {
                value * (1.0 + curve.at(value.abs() / size * curve.ends.1))
            })),
            Part::FirstCharge => {
                let of_base = system.branches.iter_mut().filter(|b| b.of_base.is_some());
                of_base.zip(weights).for_each(|(b, w)| b.residual_v += size * w);
            }
            Part::Branches(bends) => {
                let times_s = elements(BRANCH_TIMES, WEIGHTS);
                for (time_s, weight) in times_s.into_iter().zip(weights) {
                    if weight != 0.0 {
                        system.branches.push(BranchLaw {
                            bends: f64::from(u8::from(bends)),
                            ..BranchLaw::added(size * weight, time_s)
                        });
                    }
                }
            }
            Part::Strain => {
                let before = system.bending_charge.take();
                system.bending_charge = Some(Box::new(move |q| {
                    before.as_ref().map_or(q, |map| map(q)) * (1.0 + curve.at(strained(&curve, q / size)))
                }));
            }
            Part::Rates => {
                let times_s = elements(RATE_TIMES, WEIGHTS - 1);
                let rates = std::iter::once(0.0).chain(times_s.into_iter().map(f64::recip));
                let whole: f64 = weights.iter().sum();
                system
                    .relaxation
                    .iter_mut()
                    .for_each(|own| own.weight *= 1.0 - whole);
                let modes = rates.zip(weights).filter(|(_, weight)| *weight != 0.0);
                let modes = modes.map(|(rate_per_s, weight)| RelaxationMode { rate_per_s, weight });
                system.relaxation.extend(modes);
            }
            Part::Even => {
                let times_s = elements(EVEN_TIMES, WEIGHTS);
                for (time_s, weight) in times_s.into_iter().zip(weights) {
                    system.laws.push(Box::new(Square {
                        time_s,
                        per_v2: size * weight,
                    }));
                }
            }
            Part::Late => {
                let times_s = elements(LAG_TIMES, weights.len() - 1);
                system.camera.delay_s += weights[weights.len() - 1] * times_s[0];
                system.observations.push(Box::new(Lags { times_s, weights }));
            }
            _ => system.laws.push(Box::new(Smooth {
                part: self,
                curve,
                size,
            })),
        }
    }
}

/// The charge as the variable of a curve has it: with its sign, or its size.
fn strained(curve: &Curve, charge: f64) -> f64 {
    if curve.ends.0 < 0.0 { charge } else { charge.abs() }
}

/// A law that a curve says at every instant.
struct Smooth {
    part: Part,
    curve: Curve,
    size: f64,
}

impl Law for Smooth {
    fn memory_time_s(&self) -> Option<f64> {
        self.curve.axis.remembers().then_some(self.curve.time_s)
    }

    fn memory_input(&self, now: &Now) -> f64 {
        self.curve.axis.input(now) / self.curve.time_s
    }

    fn act(&self, now: &Now, memory: f64, c: &mut Coefficients) {
        let (part, curve, size) = (self.part, &self.curve, self.size);
        if let (Part::Capacitance(of_base), Axis::OwnVoltage) = (part, curve.axis) {
            return scale_capacitances(now, c, of_base, |v| 1.0 + curve.at(v));
        }
        let by = curve.now(now, memory);
        let of = |of_base: Option<usize>, values: &mut [f64]| {
            for (value, branch) in values.iter_mut().zip(now.branches) {
                if branch.of_base == of_base {
                    *value *= (1.0 + by).max(LEAST);
                }
            }
        };
        match part {
            Part::Resistance(None) => scale_resistances(c, 1.0 + by),
            Part::Resistance(only) => of(only, &mut c.resistance_ohm_cm2),
            Part::Capacitance(only) => {
                scale_capacitances(now, c, only, |_| 1.0 + by);
                let branches = c.storage.iter_mut().zip(now.branches);
                let own = branches.filter(|(_, branch)| only.is_none() || branch.of_base == only);
                own.for_each(|(storage, _)| *storage *= (1.0 + by).max(LEAST));
            }
            Part::Leak => c.leak_s_per_cm2 += size * by,
            Part::Source => c.emf_v += size * by * now.source_v,
            Part::Drop => c.emf_v -= size * by * now.current_a_per_cm2,
            Part::Coupling => c.coupling_factor *= (1.0 + by).max(LEAST),
            Part::Rate => c.relaxation_factor *= (1.0 + by).max(LEAST),
            Part::ReadCurrent => c.added_current_a += size * by,
            Part::Added => c.added_curvature_per_cm += size * by,
            Part::Play => {
                let unit = MOVES * size / PART / curve.ends.1;
                let moves = (now.curvature_rate_per_cm_s / unit).tanh();
                c.added_curvature_per_cm -= size * curve.weights[0] * moves;
            }
            _ => {}
        }
    }
}

/// What bends by the square of the voltage, some time later.
struct Square {
    time_s: f64,
    per_v2: f64,
}

impl Law for Square {
    fn memory_time_s(&self) -> Option<f64> {
        Some(self.time_s)
    }

    fn memory_input(&self, now: &Now) -> f64 {
        now.terminal_v * now.terminal_v / self.time_s
    }

    fn act(&self, _now: &Now, memory: f64, c: &mut Coefficients) {
        c.added_curvature_per_cm += self.per_v2 * memory;
    }
}

/// A curvature of which parts come by first-order lags.
struct Lags {
    times_s: Vec<f64>,
    weights: Vec<f64>,
}

impl Observation for Lags {
    fn observe(&self, clock_s: &[f64], curvature_per_cm: &mut [f64]) {
        let own = curvature_per_cm.to_vec();
        for (time_s, weight) in self.times_s.iter().zip(&self.weights) {
            let mut late = own.clone();
            lag(*time_s, clock_s, &mut late);
            for ((out, late), own) in curvature_per_cm.iter_mut().zip(&late).zip(&own) {
                *out += weight * (late - own);
            }
        }
    }

    fn resolves_s(&self) -> f64 {
        self.times_s.iter().copied().fold(f64::INFINITY, f64::min)
    }
}
