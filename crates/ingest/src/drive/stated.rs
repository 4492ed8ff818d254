//! Which channel is the drive: what the source was told to apply goes before what was measured of it.

use super::FoundDrive;
use crate::drive::policy::DEPARTURE_V;
use ieap_domain::drive::NOMINAL_AGREES_PART;
use ieap_domain::number::fixed;
use ieap_domain::{Channel, Drive, Issue, Quantity, Severity};

/// The channel that the steps are found in: the stated control where it has a reading for each of the measured
/// voltage, so that it covers the record, else the measured voltage.
pub(super) fn driving(channels: &[Channel]) -> Option<&Channel> {
    let of = |quantity| channels.iter().find(|channel| channel.is_whole(quantity));
    match (of(Quantity::ControlVoltage), of(Quantity::Voltage)) {
        (Some(control), Some(measured)) if control.len() < measured.len() => Some(measured),
        (control, measured) => control.or(measured),
    }
}

/// What `of` finds in the channel that drives. Where most readings of a measured voltage contradict a stated one, and have a
/// drive themselves, they win; how far they depart from it is said.
pub(super) fn found(
    driving: &Channel,
    channels: &[Channel],
    of: impl Fn(&Channel) -> FoundDrive,
) -> FoundDrive {
    let found = placed(of(driving), driving);
    let measured = channels
        .iter()
        .find(|channel| channel.is_whole(Quantity::Voltage));
    let Some(measured) = measured.filter(|_| driving.quantity == Quantity::ControlVoltage) else {
        return found;
    };
    let Some(departure) = departure(driving, measured) else {
        return found;
    };
    let read = of(measured);
    let (mut found, used) = if departure.severity == Severity::Warning && read.drive.is_some() {
        (read, measured)
    } else {
        (found, driving)
    };
    let message = format!("the drive is {}; {}", used.raw_name, departure.message);
    found.issues.push(Issue { message, ..departure });
    found
}

/// Says how far the measured voltage departs from the stated one: a warning where most readings do.
fn departure(driving: &Channel, measured: &Channel) -> Option<Issue> {
    let stated = driving.time_s.iter().zip(driving.values.iter());
    let both: Vec<(f64, f64, f64)> = stated
        .filter_map(|(&time_s, &stated_v)| {
            let at = measured.time_s.binary_search_by(|t| t.total_cmp(&time_s)).ok()?;
            Some((time_s, stated_v, measured.values[at]))
        })
        .collect();
    // At rest both say nothing.
    let held = both
        .iter()
        .filter(|(_, stated_v, measured_v)| stated_v.abs().max(measured_v.abs()) > DEPARTURE_V);
    let held = held.count();
    let apart: Vec<(f64, f64, f64)> = both
        .into_iter()
        .filter(|(_, stated_v, measured_v)| (measured_v - stated_v).abs() > DEPARTURE_V)
        .collect();
    let size = |(_, stated_v, measured_v): &(f64, f64, f64)| (measured_v - stated_v).abs();
    let (time_s, stated_v, measured_v) = *apart.iter().max_by(|a, b| size(a).total_cmp(&size(b)))?;
    let message = format!(
        "the measured {} lies more than {DEPARTURE_V} V from the stated {} in {} of {} readings, farthest at {time_s} s: \
         {} V where {} V is stated",
        measured.raw_name,
        driving.raw_name,
        apart.len(),
        driving.len(),
        fixed(measured_v, 4),
        fixed(stated_v, 4)
    );
    let place = format!("column {}", measured.raw_name);
    Some(if 2 * apart.len() > held {
        Issue::warning("control-not-held", message).at(place).mend(
            "check the wiring and the limits of the source: the strip may not have had the stated voltage",
        )
    } else {
        Issue::note("control-not-held", message).at(place)
    })
}

/// Says that the readings of a voltage contradict a drive that is stated beside them: more of them lie off its levels than its
/// edges explain.
pub fn contradicted(stated: &Drive, channels: &[Channel]) -> Option<Issue> {
    let voltage = driving(channels).filter(|_| !stated.moves())?;
    let (time_s, values) = voltage.included();
    let largest_v = values
        .iter()
        .fold(stated.nominal_step_v().abs(), |most, v| most.max(v.abs()));
    let off_v = DEPARTURE_V.max(NOMINAL_AGREES_PART * largest_v);
    let readings = time_s.iter().zip(values.iter());
    let off: Vec<(f64, f64, f64)> = readings
        .filter_map(|(&t, &read_v)| Some((t, stated.level_at(t).volts()?, read_v)))
        .filter(|(_, stated_v, read_v)| (read_v - stated_v).abs() > off_v)
        .collect();
    let (at_s, stated_v, read_v) = *off.first()?;
    if off.len() <= stated.segments.len() {
        return None;
    }
    let message = format!(
        "the drive that is stated contradicts {} of {} readings of the voltage, first at {at_s} s: {} V where \
         {} V is stated; the readings are used",
        off.len(),
        time_s.len(),
        fixed(read_v, 4),
        fixed(stated_v, 4)
    );
    let issue =
        Issue::warning("drive-contradicted", message).at(format!("column {}", voltage.quantity.column()));
    Some(issue.mend("leave the drive out; or leave the voltage out, where its readings are wrong"))
}

/// The same with its issues at the column that the drive was found in.
fn placed(mut found: FoundDrive, driving: &Channel) -> FoundDrive {
    let measured = format!("column {}", Quantity::Voltage.column());
    for issue in found.issues.iter_mut().filter(|issue| issue.place == measured) {
        issue.place = format!("column {}", driving.quantity.column());
    }
    found
}
