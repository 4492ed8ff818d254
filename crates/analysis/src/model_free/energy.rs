//! Energy and power of a run: electrical from voltage and current, elastic from curvature, modulus and dimensions (the
//! thesis's equation 10), and one over the other.

#[cfg(test)]
mod tests;

use ieap_domain::quantiles::NORMAL_95;
use ieap_domain::{Drive, Edge, Estimate, Sample};

use super::no_bending;
use super::policy::TOLD;
use crate::levels::{Flow, Level, Sum, levels, symmetric};
use crate::stiffness::{product, second_moment_m4, size};

/// Every energy of a run, in the order in which it has them.
pub const ENERGIES: [ieap_show::Quantity; 9] = [
    ieap_show::Quantity::new(
        "energy_level_mj",
        "E_level",
        "electrical energy that went in until the end of the first level",
        "mJ",
    ),
    ieap_show::Quantity::new(
        "energy_in_mj",
        "E_in",
        "electrical energy that went in over the whole run, level by level",
        "mJ",
    ),
    ieap_show::Quantity::new(
        "energy_out_mj",
        "E_out",
        "electrical energy that came back over the whole run",
        "mJ",
    ),
    ieap_show::Quantity::new(
        "energy_net_mj",
        "E_net",
        "electrical energy that stayed over the whole run",
        "mJ",
    ),
    ieap_show::Quantity::new(
        "elastic_energy_uj",
        "U_peak",
        "elastic energy of the strip at the peak",
        "µJ",
    ),
    ieap_show::Quantity::new(
        "efficiency_percent",
        "efficiency",
        "elastic energy at the peak over the electrical energy until then",
        "%",
    ),
    ieap_show::Quantity::new(
        "energy_density_wh_per_dm3",
        "energy density",
        "electrical energy of the first level per volume of the strip",
        "Wh dm⁻³",
    ),
    ieap_show::Quantity::new(
        "mean_power_density_w_per_dm3",
        "mean power density",
        "electrical power per volume of the strip, mean over the first level",
        "W dm⁻³",
    ),
    ieap_show::Quantity::new(
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

/// What an elastic energy and a density need of the strip.
pub(super) struct Strip<'a> {
    pub sample: Option<&'a Sample>,
    pub area_cm2: Option<f64>,
    /// |E*| at the humidity of the run, MPa.
    pub modulus_mpa: &'a Estimate,
}

/// The energies of a run whose first level is `first`, in the order of [`ENERGIES`]; `reached_s` is when the peak is first
/// reached within its error.
pub(super) fn energies(
    drive: &Drive,
    first: &Level,
    flow: Result<&Flow, &str>,
    (peak, to_peak, reached_s): (&Estimate, &Estimate, Option<f64>),
    strip: &Strip,
) -> [Estimate; 9] {
    let joule = match flow.and_then(|flow| energy(flow, &first.as_far_as(flow.ends_s().1.next_up()))) {
        Ok(joule) => joule.estimate(1.0),
        Err(reason) => Estimate::not_determined(reason),
    };
    let power = match flow.map(|flow| flow.largest(first, TOLD)) {
        Ok(Some((ampere, error))) => symmetric(ampere, error).scaled(first.voltage_v),
        Ok(None) => Estimate::not_determined("a level has no reading of the current"),
        Err(reason) => Estimate::not_determined(reason),
    };
    let elastic = strip.elastic_uj(peak);
    let efficiency = match flow {
        Ok(flow) => efficiency(flow, first, &elastic, to_peak, reached_s),
        Err(reason) => Estimate::not_determined(reason),
    };
    let [inward, outward, net] = match flow.and_then(|flow| whole(drive, flow)) {
        Ok(sums) => sums.map(|sum| sum.estimate(MILLI.recip())),
        Err(reason) => [(); 3].map(|()| Estimate::not_determined(reason)),
    };
    [
        joule.scaled(MILLI.recip()),
        inward,
        outward,
        net,
        elastic,
        efficiency,
        strip.per_dm3(&joule, WATT_HOUR.recip()),
        strip.per_dm3(&joule, first.held_s().recip()),
        strip.per_dm3(&power, 1.0),
    ]
}

/// Electrical energy of a level, J.
fn energy(flow: &Flow, level: &Level) -> Result<Sum, &'static str> {
    Ok(Sum::of([(level.voltage_v, flow.charge(level)?)]))
}

/// What went in, what came back and what stayed of all levels, J: what a level takes and gives within itself is one.
fn whole(drive: &Drive, flow: &Flow) -> Result<[Sum; 3], &'static str> {
    let (first_s, last_s) = flow.ends_s();
    let rest = drive.segments.first().map(|segment| Level {
        voltage_v: drive.baseline_v,
        change_v: 0.0,
        from: Edge::at(first_s),
        until: segment.edge,
    });
    // The rest before the first level counts, too, as far as it is read.
    let all = rest.filter(|rest| first_s < rest.until.no_earlier_s).into_iter();
    let all = all.chain(levels(drive, last_s).into_iter().flatten());
    let of = |level: Level| Ok((level.voltage_v, flow.charge(&level)?));
    let parts: Vec<(f64, _)> = all
        .filter(|level| level.voltage_v != 0.0)
        .map(of)
        .collect::<Result<_, &str>>()?;
    let sum = |keep: fn(f64) -> bool, sign: f64| {
        let kept = parts.iter().filter(|(volts, charge)| keep(volts * charge.value));
        Sum::of(kept.map(|(volts, charge)| (sign * volts, *charge)))
    };
    Ok([
        sum(|joule| joule > 0.0, 1.0),
        sum(|joule| joule < 0.0, -1.0),
        sum(|_| true, 1.0),
    ])
}

/// The elastic energy at the peak over the electrical energy until then. Where the strip may still bend on, until the bending
/// first is what it is at the most, within its error: what flows while nothing bends is no part of it.
fn efficiency(
    flow: &Flow,
    first: &Level,
    elastic_uj: &Estimate,
    to_peak: &Estimate,
    reached_s: Option<f64>,
) -> Estimate {
    let low_s = to_peak.low_95;
    let (Some(low_s), Some(at_s)) = (
        low_s,
        to_peak.value.or(reached_s.zip(low_s).map(|(a, b)| a.max(b))),
    ) else {
        return to_peak.clone();
    };
    let until = |after_s: f64| energy(flow, &first.as_far_as(first.from.middle_s() + after_s));
    let (joule, low, high) = match (until(at_s), until(low_s), until(to_peak.high_95.unwrap_or(at_s))) {
        (Ok(joule), low, Ok(high)) => (joule, low.map_or(0.0, |low| low.value), high.value),
        (Err(reason), ..) | (.., Err(reason)) => return Estimate::not_determined(reason),
    };
    // The peak may lie anywhere in its interval.
    let error = joule.error().hypot((high - low) / (2.0 * NORMAL_95));
    if joule.value <= TOLD * error {
        return Estimate::not_determined(
            "the electrical energy until the peak cannot be told from its error",
        );
    }
    let share = product(&[(elastic_uj, 1.0), (&symmetric(joule.value, error), -1.0)]);
    let percent = share.scaled(100.0 * MICRO);
    if to_peak.value.is_some() || percent.value.is_none() {
        return percent;
    }
    // It may as well come at the end of the level.
    let most = until(first.held_s()).map_or(joule.value, |most| most.value);
    Estimate {
        low_95: percent.low_95.map(|low| low * (joule.value / most).min(1.0)),
        reason: Some("until the curvature first is what it is when the level ends".to_owned()),
        ..percent
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
