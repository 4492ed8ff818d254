//! Every law.

use std::sync::LazyLock;

use super::axis::Axis;
use super::law::{Place, SmoothLaw};
use super::part::Part;
use crate::effects::{Effect, Site};
use ieap_domain::ClimateQuantity;
use ieap_domain::diagnosis::LAW;

/// Parts of the longest record for which a variable is remembered.
const MEMORIES: [f64; 3] = [1.0 / 120.0, 1.0 / 30.0, 1.0 / 8.0];

/// Every variable that a run has at each instant, by its sign and by its size where both are asked.
const VARIABLES: [Axis; 13] = [
    Axis::Time,
    Axis::LogTime,
    Axis::SinceEdge,
    Axis::Edges,
    Axis::Largest,
    Axis::Voltage,
    Axis::VoltageSize,
    Axis::Charge,
    Axis::ChargeSize,
    Axis::Curvature,
    Axis::CurvatureSize,
    Axis::Current,
    Axis::CurrentSize,
];

/// Parts of the longest record by which a strip may follow the air late.
const LATE: [f64; 3] = [0.0, MEMORIES[1], MEMORIES[2]];

/// Every variable that sensors beside the strip may read.
fn logged() -> Vec<Axis> {
    let late = |quantity| LATE.map(|part| Axis::Logged(quantity, part));
    ClimateQuantity::MEASURED.into_iter().flat_map(late).collect()
}

/// Parts that follow every variable: law, what of several has it, and the part.
const FOLLOWING: [(Site, &str, &str, Part); 9] = [
    (Site::Current, "resistance", "", Part::Resistance(None)),
    (
        Site::Current,
        "resistance",
        "fast-branch",
        Part::Resistance(Some(0)),
    ),
    (
        Site::Current,
        "resistance",
        "slow-branch",
        Part::Resistance(Some(1)),
    ),
    (Site::Current, "capacitance", "", Part::Capacitance(None)),
    (
        Site::Current,
        "capacitance",
        "fast-branch",
        Part::Capacitance(Some(0)),
    ),
    (
        Site::Current,
        "capacitance",
        "slow-branch",
        Part::Capacitance(Some(1)),
    ),
    (Site::Current, "leak", "", Part::Leak),
    (Site::Bending, "coupling", "", Part::Coupling),
    (Site::Bending, "relaxation", "", Part::Rate),
];

/// What a part follows by an axis, as its key.
fn variable(part: Part, axis: Axis) -> &'static str {
    match (part, axis) {
        (Part::Even, _) => "voltage_v",
        (Part::FirstCharge, _) => "time_s",
        (Part::Play, _) => "curvature_per_cm",
        (_, Axis::Time | Axis::LogTime) => "time_s",
        (_, Axis::SinceEdge) => "time_since_edge_s",
        (_, Axis::Edges) => "edges",
        (_, Axis::Largest) => "largest_voltage_v",
        (_, Axis::Voltage | Axis::VoltageSize | Axis::OwnVoltage) => "voltage_v",
        (_, Axis::Charge | Axis::ChargeSize) => "charge_c_per_cm2",
        (_, Axis::Curvature | Axis::CurvatureSize) => "curvature_per_cm",
        (_, Axis::Current | Axis::CurrentSize) => "current_a_per_cm2",
        (_, Axis::Logged(quantity, _)) => quantity.key(),
        (_, Axis::Power(_)) => "heat",
        (_, Axis::Flow(_) | Axis::FlowSize(_)) => "flow",
        (_, Axis::Elements) => "time_constant_s",
    }
}

/// Parts of which only some variables make sense, or that are spectra: a capacitor by its own voltage, what remembers, the
/// source, instruments, and bending that needs no charge.
fn others() -> Vec<(Site, &'static str, &'static str, Part, Axis)> {
    let current = |law, of, part, axis| (Site::Current, law, of, part, axis);
    let bending = |law, part, axis| (Site::Bending, law, "", part, axis);
    let own = [("", None), ("fast-branch", Some(0)), ("slow-branch", Some(1))];
    let mut found: Vec<_> = (own.into_iter())
        .map(|(of, branch)| current("capacitance", of, Part::Capacitance(branch), Axis::OwnVoltage))
        .collect();
    for part in MEMORIES {
        for axis in [Axis::Power(part), Axis::Flow(part), Axis::FlowSize(part)] {
            found.push(current("resistance", "", Part::Resistance(None), axis));
        }
    }
    found.extend([
        current("time-scales", "", Part::Branches(true), Axis::Elements),
        current("time-scales", "silent", Part::Branches(false), Axis::Elements),
        current("source", "", Part::Drop, Axis::CurrentSize),
        current("source", "", Part::Source, Axis::SinceEdge),
        current("source", "", Part::Source, Axis::Time),
        current("source", "", Part::Source, Axis::Voltage),
        current("current-reading", "", Part::ReadCurrent, Axis::Time),
        current("current-reading", "", Part::ReadCurrent, Axis::Charge),
        current("current-reading", "", Part::ReadCurrent, Axis::Curvature),
        current("current-reading", "", Part::ReadGain, Axis::CurrentSize),
        current("first-charge", "", Part::FirstCharge, Axis::Elements),
        bending("coupling", Part::Strain, Axis::Charge),
        bending("coupling", Part::Strain, Axis::ChargeSize),
        bending("relaxation", Part::Rate, Axis::Flow(MEMORIES[2])),
        bending("relaxation", Part::Rates, Axis::Elements),
        bending("added-bending", Part::Added, Axis::Time),
        bending("added-bending", Part::Added, Axis::LogTime),
        bending("added-bending", Part::Added, Axis::Voltage),
        bending("added-bending", Part::Added, Axis::CurrentSize),
        bending("added-bending", Part::Even, Axis::Elements),
        bending("delay", Part::Late, Axis::Elements),
        bending("play", Part::Play, Axis::Time),
    ]);
    found.extend(
        logged()
            .into_iter()
            .map(|axis| bending("added-bending", Part::Added, axis)),
    );
    found
}

fn laws() -> Vec<(Place, Part, Axis)> {
    let variables = [VARIABLES.to_vec(), logged()].concat();
    let every = |(site, law, of, part)| {
        variables
            .clone()
            .into_iter()
            .map(move |axis| (site, law, of, part, axis))
    };
    let all = FOLLOWING.into_iter().flat_map(every).chain(others());
    let placed = |(site, law, of, part, axis)| {
        let place = Place {
            site,
            law,
            of,
            variable: variable(part, axis),
        };
        (place, part, axis)
    };
    all.map(placed).collect()
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_law_has_an_id_of_its_own() {
        let ids: std::collections::BTreeSet<&str> = SMOOTH_LAWS.iter().map(|law| law.about().id).collect();
        assert_eq!(ids.len(), SMOOTH_LAWS.len(), "{ids:?}");
        assert!(smooth_law("law:resistance:slow-branch:time").is_some());
    }
}
