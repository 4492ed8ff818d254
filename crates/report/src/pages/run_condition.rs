//! What a run was measured in and at, in words.

use super::wording::{humidity_label, voltage_label};
use crate::site::Site;
use ieap_analysis::conditions::{material, nominal_voltage_v};
use ieap_domain::Drive;
use ieap_domain::number::significant;
use ieap_domain::tag::keys;

/// `CNaf in air at 34 % RH stepped to 2.5 V`, as far as it is known.
pub(super) fn condition(site: &Site, run: usize) -> String {
    let material = material(site.input.record(run), &site.input.campaign);
    let parts: Vec<String> = material
        .map(str::to_owned)
        .into_iter()
        .chain(surroundings(site, run, true))
        .chain([stepped(site, run)])
        .collect();
    parts.join(" ").trim().to_owned()
}

/// `at 34 % RH stepped to 2.5 V`: what runs of one sample in one environment differ by.
pub(super) fn own_condition(site: &Site, run: usize) -> String {
    let parts: Vec<String> = surroundings(site, run, false)
        .into_iter()
        .chain([stepped(site, run)])
        .collect();
    parts.join(" ").trim().to_owned()
}

fn surroundings(site: &Site, run: usize, named: bool) -> Vec<String> {
    let conditions = &site.conditions;
    let Some(place) = site.condition_of(run) else {
        return Vec::new();
    };
    let surroundings = &conditions.surroundings[conditions.measured[place].surroundings];
    let mut parts: Vec<String> = Vec::new();
    if named {
        parts.push(format!("in {}", surroundings.environment));
    }
    let percent = site.input.record(run).tag_number(keys::RELATIVE_HUMIDITY_PERCENT);
    if let Some(percent) = percent {
        parts.push(format!("at {} % RH", significant(percent, 3)));
    } else if surroundings.humidity_varies {
        parts.push(humidity_label(surroundings));
    }
    parts
}

fn stepped(site: &Site, run: usize) -> String {
    let record = site.input.record(run);
    if record.drive.as_ref().is_some_and(Drive::moves) {
        return "under a moving voltage".to_owned();
    }
    let voltage = nominal_voltage_v(record);
    voltage.map_or_else(String::new, |voltage| {
        format!("stepped to {}", voltage_label(voltage))
    })
}
