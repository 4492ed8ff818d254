//! Energy and power of a run: electrical from voltage and current, elastic from curvature, modulus and dimensions (the
//! thesis's equation 10), and one over the other.

#[cfg(test)]
mod tests;

use ieap_domain::quantiles::NORMAL_95;
use ieap_domain::{Drive, Estimate, Level, Sample};

use super::flow::Flow;
use super::held::{Held, edge, no_bending, symmetric};
use super::policy::TOLD;
use crate::figure::Figure;
use crate::stiffness::{product, second_moment_m4, size};

/// Every energy of a run, in the order in which it has them.
pub const ENERGIES: [Figure; 9] = [
    Figure::new(
        "energy_level_mj",
        "E_level",
        "electrical energy that went in until the end of the first level",
        "mJ",
    ),
    Figure::new(
        "energy_in_mj",
        "E_in",
        "electrical energy that went in over the whole run, level by level",
        "mJ",
    ),
    Figure::new(
        "energy_out_mj",
        "E_out",
        "electrical energy that came back over the whole run",
        "mJ",
    ),
    Figure::new(
        "energy_net_mj",
        "E_net",
        "electrical energy that stayed over the whole run",
        "mJ",
    ),
    Figure::new(
        "elastic_energy_uj",
        "U_peak",
        "elastic energy of the strip at the peak",
        "µJ",
    ),
    Figure::new(
        "efficiency_percent",
        "efficiency",
        "elastic energy at the peak over the electrical energy until then",
        "%",
    ),
    Figure::new(
        "energy_density_wh_per_dm3",
        "energy density",
        "electrical energy of the first level per volume of the strip",
        "Wh dm⁻³",
    ),
    Figure::new(
        "mean_power_density_w_per_dm3",
        "mean power density",
        "electrical power per volume of the strip, mean over the first level",
        "W dm⁻³",
    ),
    Figure::new(
        "peak_power_density_w_per_dm3",
        "peak power density",
        "largest electrical power per volume of the strip in the first level, from the first reading on",
        "W dm⁻³",
    ),
];

/// J per mJ.
const MILLI: f64 = 1e-3;
/// J per uJ.
const MICRO: f64 = 1e-6;
/// J per Wh.
const WATT_HOUR: f64 = 3600.0;
const NO_READING: &str = "a level has no reading of the current";

/// What an elastic energy and a density need of the strip.
pub(super) struct Strip<'a> {
    pub sample: Option<&'a Sample>,
    pub area_cm2: Option<f64>,
    /// |E*| at the humidity of the run, MPa.
    pub modulus_mpa: &'a Estimate,
}

/// The energies of a run whose first level is `first`, in the order of [`ENERGIES`].
pub(super) fn energies(
    drive: &Drive,
    first: &Held,
    flow: Result<&Flow, &str>,
    (peak, to_peak): (&Estimate, &Estimate),
    strip: &Strip,
) -> [Estimate; 9] {
    let of = |told: fn(&Flow, &Held) -> Option<(f64, f64)>| match flow.map(|flow| told(flow, first)) {
        Ok(Some((value, error))) => symmetric(value, error),
        Ok(None) => Estimate::not_determined(NO_READING),
        Err(reason) => Estimate::not_determined(reason),
    };
    let (joule, power) = (of(energy), of(power));
    let elastic = strip.elastic_uj(peak);
    let efficiency = match flow {
        Ok(flow) => efficiency(flow, first, &elastic, to_peak),
        Err(reason) => Estimate::not_determined(reason),
    };
    let [inward, outward, net] = match flow.map(|flow| whole(drive, flow)) {
        Ok(Some(sums)) => sums.map(|(value, error)| symmetric(value / MILLI, error / MILLI)),
        Ok(None) => [(); 3].map(|()| Estimate::not_determined(NO_READING)),
        Err(reason) => [(); 3].map(|()| Estimate::not_determined(reason)),
    };
    let held_s = first.end_s - first.step_s;
    [
        joule.scaled(MILLI.recip()),
        inward,
        outward,
        net,
        elastic,
        efficiency,
        strip.per_dm3(&joule, WATT_HOUR.recip()),
        strip.per_dm3(&joule, held_s.recip()),
        strip.per_dm3(&power, 1.0),
    ]
}

/// Electrical energy of a level, J, and its standard error.
fn energy(flow: &Flow, held: &Held) -> Option<(f64, f64)> {
    let (charge, error) = flow.charge(held)?;
    Some((held.voltage_v * charge, held.voltage_v.abs() * error))
}

/// Largest electrical power of a level, W, and its standard error.
fn power(flow: &Flow, held: &Held) -> Option<(f64, f64)> {
    let (ampere, error) = flow.largest(held)?;
    Some((held.voltage_v * ampere, held.voltage_v.abs() * error))
}

/// What went in, what came back and what stayed of all levels, J: what a level takes and gives within itself is one.
fn whole(drive: &Drive, flow: &Flow) -> Option<[(f64, f64); 3]> {
    let levels = levels(drive, flow.ends_s());
    let of: Vec<(f64, f64)> = levels
        .iter()
        .map(|held| energy(flow, held))
        .collect::<Option<_>>()?;
    let sum = |keep: fn(f64) -> bool, sign: f64| {
        let kept = of.iter().filter(|(joule, _)| keep(*joule));
        kept.fold((0.0f64, 0.0f64), |(sum, error), (joule, e)| {
            (sum + sign * joule, error.hypot(*e))
        })
    };
    Some([
        sum(|joule| joule > 0.0, 1.0),
        sum(|joule| joule < 0.0, -1.0),
        sum(|_| true, 1.0),
    ])
}

/// Every level at which energy can flow, the rest before the first one too, each until the next begins.
fn levels(drive: &Drive, (first_s, last_s): (f64, f64)) -> Vec<Held> {
    let starts = drive.segments.iter().map(edge);
    let starts: Vec<(f64, f64)> = std::iter::once((first_s, 0.0)).chain(starts).collect();
    let baseline = Level::Voltage(drive.baseline_v);
    let held = std::iter::once(baseline).chain(drive.segments.iter().map(|segment| segment.level));
    let of = |(k, level): (usize, Level)| {
        let end_s = starts.get(k + 1).map_or(last_s, |next| next.0.min(last_s));
        let (step_s, step_error_s) = starts[k];
        match level {
            Level::Voltage(voltage_v) if voltage_v != 0.0 && step_s < end_s => Some(Held {
                voltage_v,
                step_s,
                end_s,
                step_error_s,
            }),
            _ => None,
        }
    };
    held.enumerate().filter_map(of).collect()
}

/// The elastic energy at the peak over the electrical energy until then; until the end of the level where the strip may
/// still bend on.
fn efficiency(flow: &Flow, first: &Held, elastic_uj: &Estimate, to_peak: &Estimate) -> Estimate {
    let (at_s, low_s, high_s) = match (to_peak.value, to_peak.low_95, to_peak.high_95) {
        (Some(at_s), Some(low_s), Some(high_s)) => (at_s, low_s, high_s),
        (None, Some(low_s), None) => (f64::INFINITY, low_s, f64::INFINITY),
        _ => return to_peak.clone(),
    };
    let until = |after_s: f64| {
        let end_s = (first.step_s + after_s).min(first.end_s);
        energy(flow, &Held { end_s, ..*first }).unwrap_or_default()
    };
    let (joule, error) = until(at_s);
    // The peak may lie anywhere in its interval.
    let of_place = if at_s.is_finite() {
        (until(high_s).0 - until(low_s).0) / (2.0 * NORMAL_95)
    } else {
        0.0
    };
    let error = error.hypot(of_place);
    if joule <= TOLD * error {
        return Estimate::not_determined(
            "the electrical energy until the peak cannot be told from its error",
        );
    }
    let share = product(&[(elastic_uj, 1.0), (&symmetric(joule, error), -1.0)]);
    let percent = share.scaled(100.0 * MICRO);
    if at_s.is_finite() || percent.value.is_none() {
        percent
    } else {
        Estimate {
            reason: Some("until the end of the level: the curvature may still grow then".to_owned()),
            ..percent
        }
    }
}

impl Strip<'_> {
    /// `U = E I L kappa^2 / 2` at the peak, uJ.
    fn elastic_uj(&self, peak: &Estimate) -> Estimate {
        let (Some(value), Some(error)) = (peak.value, peak.standard_error) else {
            return peak.clone();
        };
        if value.abs() <= TOLD * error {
            return no_bending();
        }
        let sample = self.sample;
        let known = sample.and_then(|sample| second_moment_m4(sample).zip(sample.length_mm));
        let Some((moment_m4, length_mm)) = known else {
            return self.needs(&["length_mm", "width_mm", "thickness_mm"]);
        };
        // MPa and 1/cm to Pa and 1/m.
        let joule = 0.5 * (1e6 * moment_m4) * (1e-3 * length_mm) * 1e4;
        let of_squares = product(&[(&size(peak), 2.0), (self.modulus_mpa, 1.0)]);
        of_squares.scaled(joule / MICRO)
    }

    /// A number per volume of the strip, active area times thickness.
    fn per_dm3(&self, of: &Estimate, factor: f64) -> Estimate {
        let thickness_mm = self.sample.and_then(|sample| sample.thickness_mm);
        match self.area_cm2.zip(thickness_mm) {
            // 1 cm2 mm is 1e-4 dm3.
            Some((area_cm2, thickness_mm)) => of.scaled(factor / (1e-4 * area_cm2 * thickness_mm)),
            None if self.area_cm2.is_some() => self.needs(&["thickness_mm"]),
            None => self.needs(&["length_mm", "width_mm", "thickness_mm"]),
        }
    }

    /// Which of these dimensions campaign.toml does not state.
    fn needs(&self, of: &[&str]) -> Estimate {
        let stated = |key: &&&str| {
            self.sample.is_some_and(|sample| {
                let number = match **key {
                    "length_mm" => sample.length_mm,
                    "width_mm" => sample.width_mm,
                    _ => sample.thickness_mm,
                };
                number.is_some()
            })
        };
        let missing: Vec<&str> = of.iter().filter(|key| !stated(key)).copied().collect();
        Estimate::not_determined(format!("needs {} of the sample", missing.join(", ")))
    }
}
