//! Every law, and where every effect of the library has its place among them.

use std::sync::LazyLock;

use super::axis::Axis;
use super::law::{Place, SmoothLaw};
use super::part::Part;
use crate::effects::{Effect, Site, mechanism_of};
use ieap_domain::diagnosis::LAW;

const fn current(law: &'static str, of: &'static str, variable: &'static str) -> Place {
    Place {
        site: Site::Current,
        law,
        of,
        variable,
    }
}

const fn bending(law: &'static str, variable: &'static str) -> Place {
    Place {
        site: Site::Bending,
        ..current(law, "", variable)
    }
}

/// Parts of the longest record for which a variable is remembered.
const MEMORIES: [f64; 3] = [1.0 / 120.0, 1.0 / 30.0, 1.0 / 8.0];

fn laws() -> Vec<(Place, Part, Axis)> {
    let by_resistance = |variable, axis| (current("resistance", "", variable), Part::Resistance(None), axis);
    let mut found = vec![
        by_resistance("time_s", Axis::Time),
        by_resistance("time_s", Axis::LogTime),
        by_resistance("curvature_per_cm", Axis::Curvature),
        by_resistance("curvature_per_cm", Axis::CurvatureSize),
        by_resistance("charge_c_per_cm2", Axis::Charge),
        by_resistance("charge_c_per_cm2", Axis::ChargeSize),
        by_resistance("current_a_per_cm2", Axis::CurrentSize),
    ];
    for part in MEMORIES {
        found.push(by_resistance("heat", Axis::Power(part)));
        found.push(by_resistance("flow", Axis::Flow(part)));
        found.push(by_resistance("flow", Axis::FlowSize(part)));
    }
    let one = |of, k| {
        let place = current("resistance", of, "time_s");
        (place, Part::Resistance(Some(k)), Axis::Time)
    };
    found.extend([one("fast-branch", 0), one("slow-branch", 1)]);
    let by_current = |law, of, variable, part, axis| (current(law, of, variable), part, axis);
    found.extend([
        by_current(
            "capacitance",
            "",
            "voltage_v",
            Part::Capacitance(None),
            Axis::OwnVoltage,
        ),
        by_current(
            "capacitance",
            "slow-branch",
            "voltage_v",
            Part::Capacitance(Some(1)),
            Axis::OwnVoltage,
        ),
        by_current("capacitance", "", "time_s", Part::Capacitance(None), Axis::Time),
        by_current("leak", "", "voltage_v", Part::Leak, Axis::Voltage),
        by_current("leak", "", "time_since_edge_s", Part::Leak, Axis::SinceEdge),
        by_current("leak", "", "time_s", Part::Leak, Axis::Time),
        by_current(
            "time-scales",
            "",
            "time_constant_s",
            Part::Branches(true),
            Axis::Elements,
        ),
        by_current(
            "time-scales",
            "silent",
            "time_constant_s",
            Part::Branches(false),
            Axis::Elements,
        ),
        by_current("source", "", "current_a_per_cm2", Part::Drop, Axis::CurrentSize),
        by_current("source", "", "time_since_edge_s", Part::Source, Axis::SinceEdge),
        by_current("source", "", "time_s", Part::Source, Axis::Time),
        by_current("source", "", "voltage_v", Part::Source, Axis::Voltage),
        by_current("current-reading", "", "time_s", Part::ReadCurrent, Axis::Time),
        by_current(
            "current-reading",
            "",
            "current_a_per_cm2",
            Part::ReadGain,
            Axis::CurrentSize,
        ),
        by_current("first-charge", "", "time_s", Part::FirstCharge, Axis::Elements),
    ]);
    let by_bending = |law, variable, part, axis| (bending(law, variable), part, axis);
    found.extend([
        by_bending("coupling", "curvature_per_cm", Part::Coupling, Axis::Curvature),
        by_bending(
            "coupling",
            "curvature_per_cm",
            Part::Coupling,
            Axis::CurvatureSize,
        ),
        by_bending("coupling", "charge_c_per_cm2", Part::Coupling, Axis::Charge),
        by_bending("coupling", "charge_c_per_cm2", Part::Coupling, Axis::ChargeSize),
        by_bending("coupling", "charge_c_per_cm2", Part::Strain, Axis::Charge),
        by_bending("coupling", "charge_c_per_cm2", Part::Strain, Axis::ChargeSize),
        by_bending("coupling", "time_s", Part::Coupling, Axis::Time),
        by_bending("coupling", "time_s", Part::Coupling, Axis::LogTime),
        by_bending("coupling", "voltage_v", Part::Coupling, Axis::Voltage),
        by_bending("relaxation", "voltage_v", Part::Rate, Axis::VoltageSize),
        by_bending("relaxation", "charge_c_per_cm2", Part::Rate, Axis::ChargeSize),
        by_bending("relaxation", "time_s", Part::Rate, Axis::Time),
        by_bending("relaxation", "flow", Part::Rate, Axis::Flow(MEMORIES[2])),
        by_bending("relaxation", "time_constant_s", Part::Rates, Axis::Elements),
        by_bending("added-bending", "time_s", Part::Added, Axis::Time),
        by_bending("added-bending", "time_s", Part::Added, Axis::LogTime),
        by_bending("added-bending", "voltage_v", Part::Added, Axis::Voltage),
        by_bending("added-bending", "voltage_v", Part::Even, Axis::Elements),
        by_bending("delay", "time_constant_s", Part::Late, Axis::Elements),
        by_bending("play", "curvature_per_cm", Part::Play, Axis::Time),
    ]);
    found
}

/// Every law, in the order of the list.
pub static SMOOTH_LAWS: LazyLock<Vec<&'static SmoothLaw>> = LazyLock::new(|| {
    let kept = |(place, part, axis): (Place, Part, Axis)| -> &'static SmoothLaw {
        let id: &'static str = Box::leak(id(place, part, axis).into_boxed_str());
        Box::leak(Box::new(SmoothLaw::new(id, place, part, axis)))
    };
    laws().into_iter().map(kept).collect()
});

/// Stored id, `law:resistance:slow-branch:time`: never renamed.
fn id(place: Place, part: Part, axis: Axis) -> String {
    let of = match (place.of, part) {
        ("", Part::Strain) => "strain:",
        ("", Part::Even) => "even:",
        ("", _) => "",
        (of, _) => return format!("{LAW}{}:{of}:{}", place.law, axis.key()),
    };
    format!("{LAW}{}:{of}{}", place.law, axis.key())
}

/// The law of that id.
pub fn smooth_law(id: &str) -> Option<&'static SmoothLaw> {
    SMOOTH_LAWS.iter().copied().find(|law| law.about().id == id)
}

/// The place of an effect of the library: the law that its equation is a curve of.
pub fn place_of(effect: &str) -> Option<Place> {
    let site = mechanism_of(effect)?.site;
    let at = |law, of, variable| Place {
        site,
        law,
        of,
        variable,
    };
    Some(match effect {
        "series-resistance" | "current-limit" | "lengthwise-resistance" => {
            at("source", "", "current_a_per_cm2")
        }
        "source-rise" => at("source", "", "time_since_edge_s"),
        "sensing-feedback" => at("source", "", "curvature_per_cm"),
        "slow-branch" | "fast-branch" | "dispersion" | "warburg" | "constant-phase" => {
            at("time-scales", "", "time_constant_s")
        }
        "voltage-dependent-capacitance" | "asymmetric-capacitance" | "redox-peak" => {
            at("capacitance", "", "voltage_v")
        }
        "polarity-memory" => at("capacitance", "", "history"),
        "faradaic-leak" => at("leak", "", "voltage_v"),
        "diffusion-limited-leak" => at("leak", "", "time_since_edge_s"),
        "self-discharge" => at("leak", "slow-branch", "voltage_v"),
        "resistance-drift"
        | "water-exchange"
        | "ambient-temperature"
        | "contact-break"
        | "parameter-wander" => at("resistance", "", "time_s"),
        "electrolytic-drying" | "joule-heating" => at("resistance", "", "heat"),
        "piezoresistive-electrode" => at("resistance", "", "curvature_per_cm"),
        "water-redistribution" => at("resistance", "", "flow"),
        "current-offset" | "current-event" => at("current-reading", "", "time_s"),
        "residual-charge" => at("first-charge", "", "time_s"),
        "coupling-saturation" | "quadratic-coupling" => at("coupling", "", "charge_c_per_cm2"),
        "softening" | "tip-formula" | "noncircular-shape" | "curvature-limit" => {
            at("coupling", "", "curvature_per_cm")
        }
        "polarity-coupling" => at("coupling", "", "voltage_v"),
        "modulus-drift" => at("coupling", "", "time_s"),
        "unequal-coupling" => at("coupling", "slow-branch", ""),
        "leak-coupling" => at("coupling", "leak", ""),
        "even-bending" => at("added-bending", "", "voltage_v"),
        "partial-relaxation" | "second-relaxation" | "fractional-relaxation" | "counter-flow" => {
            at("relaxation", "", "time_constant_s")
        }
        "threshold-relaxation" => at("relaxation", "", "voltage_v"),
        "moisture-bending" | "creep" | "precurvature" | "camera-zero" | "bending-event" => {
            at("added-bending", "", "time_s")
        }
        "camera-delay" | "mechanical-lag" | "exposure-smoothing" | "resonance" => {
            at("delay", "", "time_constant_s")
        }
        "friction" => at("play", "", "curvature_per_cm"),
        "clock-rate" => at("delay", "", "time_s"),
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::ALL;

    #[test]
    fn every_law_has_an_id_of_its_own() {
        let ids: std::collections::BTreeSet<&str> = SMOOTH_LAWS.iter().map(|law| law.about().id).collect();
        assert_eq!(ids.len(), SMOOTH_LAWS.len(), "{ids:?}");
        assert!(smooth_law("law:resistance:slow-branch:time").is_some());
    }

    #[test]
    fn every_effect_has_its_place() {
        for effect in ALL {
            assert!(place_of(effect.about().id).is_some(), "{}", effect.about().id);
        }
    }
}
