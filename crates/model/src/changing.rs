//! A lumped strip whose parameters change while it is driven, as those of a strip in changing humidity do.
//!
//! From each time on it is another strip; between two such times each stretch is solved in closed form. What goes on at a
//! change is what a strip carries: the charge of every branch, and the strain of its spring.

use ieap_domain::{Drive, Level, Segment};

use crate::lumped::{Branch, LumpedModel, SegmentResponse};
use crate::scaling::propagation::{values, with_values};

/// From a time on, s: a factor for each parameter, in the order of [`values`].
pub type Change = (f64, Vec<f64>);

/// A stretch in which neither voltage nor parameters change.
struct Stretch {
    model: LumpedModel,
    level: Level,
    /// Voltages of the branches at its start, V.
    volts: Vec<f64>,
    response: SegmentResponse,
    /// Charge that has leaked before it, whichever way it flowed, C/cm2.
    leaked: f64,
}

/// What a strip whose parameters change does under a drive.
pub struct Changing {
    stretches: Vec<Stretch>,
    before: LumpedModel,
    baseline_v: f64,
}

/// What it does at a time, for the whole strip.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Now {
    /// Current, A.
    pub current_a: f64,
    /// Charge on the capacitors, C.
    pub charge_c: f64,
    /// Charge that has leaked since the drive began, whichever way it flowed, C.
    pub leaked_charge_c: f64,
    /// Curvature, 1/cm.
    pub curvature_per_cm: f64,
}

impl Changing {
    /// Of a strip that is `model` times the factors of the last change. Changes stand in the order of their times; before the
    /// first of them its factors hold, too.
    pub fn new(model: &LumpedModel, changes: &[Change], drive: &Drive) -> Changing {
        let of = |factors: &[f64]| {
            let own = values(model).into_iter().zip(factors);
            with_values(&own.map(|(value, factor)| value * factor).collect::<Vec<f64>>())
        };
        let models: Vec<(f64, LumpedModel)> = changes
            .iter()
            .map(|(from_s, factors)| (*from_s, of(factors)))
            .collect();
        let at = |time_s: f64| {
            let next = models.partition_point(|(from_s, _)| *from_s <= time_s);
            models.get(next.saturating_sub(1)).map_or(model, |(_, own)| own)
        };
        let mut made = Changing {
            stretches: Vec::new(),
            before: drive
                .segments
                .first()
                .map_or(model, |first| at(first.start_s()))
                .clone(),
            baseline_v: drive.baseline_v,
        };
        for (k, segment) in drive.segments.iter().enumerate() {
            let (start_s, end_s) = (
                segment.start_s(),
                drive.segments.get(k + 1).map_or(f64::INFINITY, Segment::start_s),
            );
            let within = models.iter().map(|(from_s, _)| *from_s);
            let within = within.filter(|from_s| start_s < *from_s && *from_s < end_s);
            for from_s in std::iter::once(start_s).chain(within) {
                made.append(from_s, segment.level, at(from_s).clone());
            }
        }
        made
    }

    /// Goes on from a time with that voltage and that model.
    fn append(&mut self, from_s: f64, level: Level, model: LumpedModel) {
        let (volts, strain, leaked) = match self.stretches.last() {
            None => (vec![self.baseline_v; model.branches.len()], 0.0, 0.0),
            Some(last) => last.carried_to(from_s, &model),
        };
        let alone = Drive {
            baseline_v: self.baseline_v,
            segments: vec![Segment::at(from_s, level)],
        };
        let response = model.segment_responses_from(&alone, volts.clone(), strain).pop();
        self.stretches.extend(response.map(|response| Stretch {
            model,
            level,
            volts,
            response,
            leaked,
        }));
    }

    /// What a strip of that area does at a time.
    pub fn at(&self, time_s: f64, area_cm2: f64) -> Now {
        let after = self
            .stretches
            .partition_point(|own| own.response.start_s <= time_s);
        let Some(own) = after.checked_sub(1).map(|k| &self.stretches[k]) else {
            return Now {
                current_a: area_cm2 * self.baseline_v / self.before.steady_state_resistance_ohm_cm2,
                charge_c: area_cm2 * self.baseline_v * self.before.total_capacitance_f_per_cm2(),
                leaked_charge_c: 0.0,
                curvature_per_cm: 0.0,
            };
        };
        let elapsed_s = time_s - own.response.start_s;
        let strain = own
            .response
            .strain_c_per_cm2(elapsed_s, own.model.relaxation_rate_per_s);
        Now {
            current_a: area_cm2 * own.response.current_a_per_cm2(elapsed_s),
            charge_c: area_cm2 * own.response.charge_c_per_cm2(elapsed_s),
            leaked_charge_c: area_cm2 * own.leaked_until(elapsed_s),
            curvature_per_cm: own.model.charge_to_curvature_per_c_cm * area_cm2 * strain,
        }
    }
}

impl Stretch {
    /// Voltages of the branches, V, strain and leaked charge, C/cm2, at its end, where another model takes over.
    fn carried_to(&self, end_s: f64, next: &LumpedModel) -> (Vec<f64>, f64, f64) {
        let lasting_s = end_s - self.response.start_s;
        let volts = self.model.voltages_after(self.level, &self.volts, lasting_s);
        let branches = self.model.branches.iter().zip(&next.branches);
        let at_one_charge = |(volts, (own, next)): (f64, (&Branch, &Branch))| {
            if own.capacitance_f_per_cm2 == next.capacitance_f_per_cm2 {
                volts
            } else {
                volts * own.capacitance_f_per_cm2 / next.capacitance_f_per_cm2
            }
        };
        (
            volts.into_iter().zip(branches).map(at_one_charge).collect(),
            self.response
                .strain_c_per_cm2(lasting_s, self.model.relaxation_rate_per_s),
            self.leaked_until(lasting_s),
        )
    }

    fn leaked_until(&self, elapsed_s: f64) -> f64 {
        let volts = self.level.volts().map_or(0.0, f64::abs);
        self.leaked + volts * elapsed_s / self.model.steady_state_resistance_ohm_cm2
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const AREA_CM2: f64 = 0.1;

    fn model() -> LumpedModel {
        with_values(&[500.0, 0.1, 2500.0, 0.13, 5000.0, 14.0, 4e-3])
    }

    fn drive() -> Drive {
        Drive {
            baseline_v: 0.5,
            segments: vec![
                Segment::at(0.0, Level::Voltage(2.0)),
                Segment::at(150.0, Level::OpenCircuit),
                Segment::at(220.0, Level::Voltage(-1.0)),
            ],
        }
    }

    #[test]
    fn what_does_not_change_is_the_lumped_model() {
        let (model, drive) = (model(), drive());
        let unchanged = [
            (0.0, vec![1.0; 7]),
            (37.0, vec![1.0; 7]),
            (150.0, vec![1.0; 7]),
            (300.0, vec![1.0; 7]),
        ];
        let changing = Changing::new(&model, &unchanged, &drive);
        let time_s: Vec<f64> = (-5..80).map(|k| 5.0 * f64::from(k)).collect();
        let current = model.current_a(&drive, AREA_CM2, &time_s);
        let charge = model.charge_c(&drive, AREA_CM2, &time_s);
        let bent = model.curvature_per_cm(&drive, AREA_CM2, &time_s);
        for (k, time_s) in time_s.into_iter().enumerate() {
            let now = changing.at(time_s, AREA_CM2);
            let pairs = [
                (now.current_a, current[k]),
                (now.charge_c, charge[k]),
                (now.curvature_per_cm, bent[k]),
            ];
            for (own, expected) in pairs {
                assert!(
                    (own - expected).abs() <= 1e-12 * expected.abs().max(1e-3),
                    "{time_s}: {own} {expected}"
                );
            }
        }
    }

    /// Against small steps of the differential equations, in which the charge of each branch goes on across a change.
    #[test]
    fn a_strip_that_changes_carries_its_charge_and_its_strain() {
        let (model, drive) = (model(), Drive::step(2.0));
        let factors = [
            vec![1.0; 7],
            vec![0.5, 1.3, 0.8, 1.1, 0.6, 1.2, 2.0],
            vec![0.7, 0.9, 1.5, 0.7, 0.9, 0.8, 0.5],
        ];
        let changes = [
            (0.0, factors[0].clone()),
            (60.0, factors[1].clone()),
            (140.0, factors[2].clone()),
        ];
        let changing = Changing::new(&model, &changes, &drive);
        let (mut charge, mut strain, mut leaked) = ([0.0; 2], 0.0, 0.0);
        let step_s = 1e-3;
        for k in 0..250_000_u32 {
            let time_s = step_s * f64::from(k);
            let which = changes.iter().rposition(|(from_s, _)| *from_s <= time_s).unwrap();
            let own: Vec<f64> = values(&model)
                .iter()
                .zip(&factors[which])
                .map(|(a, b)| a * b)
                .collect();
            let flows = [0, 1].map(|b: usize| (2.0 - charge[b] / own[2 * b + 1]) / own[2 * b]);
            if k % 9_973 == 0 && k > 0 {
                let now = changing.at(time_s, AREA_CM2);
                let current = AREA_CM2 * (flows.iter().sum::<f64>() + 2.0 / own[4]);
                let pairs = [
                    (now.current_a, current),
                    (now.charge_c, AREA_CM2 * charge.iter().sum::<f64>()),
                    (now.leaked_charge_c, AREA_CM2 * leaked),
                    (now.curvature_per_cm, own[5] * AREA_CM2 * strain),
                ];
                for ((told, expected), scale) in pairs.into_iter().zip([4e-4, 0.05, 0.01, 0.5]) {
                    assert!(
                        (told - expected).abs() < 2e-4 * scale,
                        "{time_s} s: {told} for {expected}"
                    );
                }
            }
            let flow: f64 = flows.iter().sum();
            strain += step_s * (flow - own[6] * strain);
            leaked += step_s * 2.0 / own[4];
            charge
                .iter_mut()
                .zip(flows)
                .for_each(|(charge, flow)| *charge += step_s * flow);
        }
    }
}
