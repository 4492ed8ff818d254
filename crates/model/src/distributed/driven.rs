//! A strip under a drive of held voltages: what its steps bring adds up.

use ieap_domain::{Drive, Level, Quantity};

use super::{BrokenStrip, DistributedModel};

/// A time after which everything has come to rest, s.
const AT_REST_S: f64 = 1e15;

/// A strip whose electrodes resist evenly along it, or otherwise from a place on.
pub struct DrivenStrip {
    along: Along,
    /// Coupling mu, 1/C.
    mu_per_c: f64,
}

/// The strip with even electrodes, or with a break in them.
enum Along {
    Even(DistributedModel),
    Broken(Box<BrokenStrip>),
}

impl DrivenStrip {
    /// The strip of `model`, whose coupling is one, with the coupling `mu_per_c` (1/C); `contact_break` is the place (cm from
    /// the clamp) from which on the electrodes have so many times the resistance.
    pub fn new(model: &DistributedModel, mu_per_c: f64, contact_break: Option<(f64, f64)>) -> DrivenStrip {
        let along = match contact_break {
            None => Along::Even(*model),
            Some((place_cm, factor)) => Along::Broken(Box::new(BrokenStrip::new(model, place_cm, factor))),
        };
        DrivenStrip { along, mu_per_c }
    }

    /// The voltages (V) or curvatures (1/cm) at places (cm from the clamp), or the current (A) at the clamp, for which one
    /// place stands: each place one after the other, over all times (s, rising). The shape at rest before the drive is
    /// subtracted; segments of open circuit are passed over.
    pub fn respond(&self, quantity: Quantity, drive: &Drive, places_cm: &[f64], time_s: &[f64]) -> Vec<f64> {
        let (places, times) = (places_cm.len(), time_s.len());
        let mut values = vec![0.0; places * times];
        // At rest at the baseline: the shape there is subtracted, so only voltage and current begin with something.
        if drive.baseline_v != 0.0 && quantity != Quantity::Curvature {
            let rest = self.unit(quantity, places_cm, &[AT_REST_S]);
            for (place, row) in values.chunks_exact_mut(times).enumerate() {
                row.fill(drive.baseline_v * rest[place]);
            }
        }
        let factor = match quantity {
            Quantity::Curvature => self.mu_per_c,
            _ => 1.0,
        };
        for (start_s, change_v) in steps(drive) {
            let change_v = change_v * factor;
            let first = time_s.partition_point(|&t| t < start_s);
            let since: Vec<f64> = time_s[first..].iter().map(|t| t - start_s).collect();
            if since.is_empty() || change_v == 0.0 {
                continue;
            }
            let response = self.unit(quantity, places_cm, &since);
            for (time, at_time) in response.chunks_exact(places).enumerate() {
                for (place, value) in at_time.iter().enumerate() {
                    values[place * times + first + time] += change_v * value;
                }
            }
        }
        values
    }

    /// Response to a step of 1 V at times since it: for each time, all places.
    fn unit(&self, quantity: Quantity, places: &[f64], since_s: &[f64]) -> Vec<f64> {
        match (&self.along, quantity) {
            (Along::Even(strip), Quantity::Voltage) => strip.voltage_v(1.0, places, since_s).values,
            (Along::Even(strip), Quantity::Curvature) => strip.curvature_per_cm(1.0, places, since_s).values,
            (Along::Even(strip), _) => strip.clamp_current_a(1.0, since_s),
            (Along::Broken(strip), Quantity::Voltage) => strip.voltage_v(1.0, places, since_s).values,
            (Along::Broken(strip), Quantity::Curvature) => {
                strip.curvature_per_cm(1.0, places, since_s).values
            }
            (Along::Broken(strip), _) => strip.clamp_current_a(1.0, since_s),
        }
    }
}

/// Changes of the held voltage: when (s) and by how much (V).
pub fn steps(drive: &Drive) -> Vec<(f64, f64)> {
    let mut before = drive.baseline_v;
    let mut steps = Vec::new();
    for segment in &drive.segments {
        let Level::Voltage(voltage_v) = segment.level else {
            continue;
        };
        steps.push((segment.start_s(), voltage_v - before));
        before = voltage_v;
    }
    steps
}
