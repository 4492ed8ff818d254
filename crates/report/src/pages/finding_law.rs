//! The account of a group's error, and the laws that are missing, drawn.

use serde::Serialize;

use crate::blocks::Writer;
use crate::error::ReportError;
use crate::figures::axis::Axis;
use crate::figures::law::{Beside, Curve, law_panel};
use ieap_domain::finding_words::short_name;
use ieap_domain::number::significant;
use ieap_domain::{Account, ClimateQuantity, GroupDiagnosis, LawCurve, MissingLaw, range_of};
use ieap_show::Block;

/// A part of the account, as a piece of one bar.
#[derive(Debug, Serialize)]
pub struct AccountPart {
    name: &'static str,
    /// Percent of what is beyond noise.
    percent: String,
    from: f64,
    width: f64,
    /// Class of its colour.
    ink: &'static str,
}

/// The account as one bar; empty where nothing is beyond noise.
pub fn account_parts(account: Option<&Account>) -> Vec<AccountPart> {
    /// Least part that is seen, percent.
    const LEAST: f64 = 0.5;
    let Some(account) = account.filter(|own| own.beyond_noise() > LEAST) else {
        return Vec::new();
    };
    let inks = ["k-6", "k-3", "k-1", "k-4", "k-2"];
    let mut from = 0.0;
    let beyond = account.parts().into_iter().skip(1).zip(inks);
    let all = beyond.map(|((name, part), ink)| {
        let width = account.share(part);
        from += width;
        AccountPart {
            name,
            percent: significant(width, 2),
            from: from - width,
            width,
            ink,
        }
    });
    all.filter(|own| own.width >= LEAST).collect()
}

/// The missing laws of a group, each drawn.
///
/// # Errors
/// [`ReportError::Figure`] where a figure cannot be drawn.
pub fn laws(page: &mut Writer, found: &GroupDiagnosis) -> Result<(), ReportError> {
    for (place, law) in found.missing.iter().enumerate() {
        page.part(&short_name(law), |part| {
            match &law.curve {
                Some(curve) => {
                    let heading = format!("{}: line, with its 95 % band", law.words);
                    let figure = format!("law-{}", place + 1);
                    part.drawing(&figure, (&heading, ""), drawn(law, curve))?;
                }
                None => part.write([Block::say(format!("That {}.", law.words))])?,
            }
            part.write(proof(law).into_iter().chain(about(law)))
        })?;
    }
    Ok(())
}

/// What the law gains on readings that were held out.
fn proof(law: &MissingLaw) -> Option<Block> {
    let held_out = &law.held_out;
    let channel = match law.place.as_str() {
        "bending" => "curvature",
        _ => "current",
    };
    Some(Block::say(format!(
        "Held-out error of the {channel}: {} % of its range without it, {} % with it; {} held-out parts come out better.",
        significant(held_out.error_percent_before?, 2),
        significant(held_out.error_percent_after?, 2),
        held_out.better_parts
    )))
}

/// Textbook curves within the band, where no single one is the name.
fn about(law: &MissingLaw) -> Option<Block> {
    let is_told = law.name.is_none() && !law.names.is_empty();
    is_told.then(|| Block::say(format!("Within the band lies: {}.", law.names.join(", "))))
}

fn drawn(law: &MissingLaw, curve: &LawCurve) -> Result<String, String> {
    // A relative change is told in percent.
    let (factor, unit) = match curve.unit.as_str() {
        "1" => (100.0, "%"),
        unit => (1.0, unit),
    };
    let scaled = |values: &[f64]| values.iter().map(|v| factor * v).collect::<Vec<f64>>();
    let (low, high) = (scaled(&curve.low_95), scaled(&curve.high_95));
    let y = scaled(&curve.y);
    let without = scaled(&curve.without);
    let ends = range_of(low.iter().chain(&high).chain(&without).copied());
    let of_x = range_of(curve.x.iter().copied());
    let (what, x_unit) = axis_words(law.variable.as_deref().unwrap_or_default());
    let x = Axis::linear_rounded(of_x.0, of_x.1, what, x_unit, 5);
    let y_axis = Axis::linear_rounded(ends.0.min(0.0), ends.1.max(0.0), change_words(law, unit), unit, 5);
    let beside = Beside {
        law: Curve {
            x: curve.x.clone(),
            y,
            band: low.into_iter().zip(high).collect(),
        },
        without,
        ..Beside::default()
    };
    let thin = match curve.without.as_slice() {
        [] => "",
        _ => " Thin: without it.",
    };
    let desc = format!("That {}: line, with its 95 % band.{thin}", law.words);
    law_panel((&x, &y_axis), &[], &beside, &short_name(law), &desc)
}

fn change_words(law: &MissingLaw, unit: &str) -> &'static str {
    match (law.law.as_deref(), unit) {
        (Some("resistance"), _) => "Change of the resistance",
        (Some("capacitance"), _) => "Change of the capacitance",
        (Some("leak"), "A/cm2") => "Steady current",
        (Some("leak"), _) => "Conductance of the leak",
        (Some("source"), "%") => "Change of the driving voltage",
        (Some("source"), _) => "Resistance in series",
        (Some("current-reading"), _) => "Error of the current",
        (Some("coupling"), _) => "Change of the bending per charge",
        (Some("relaxation"), _) => "Change of the relaxation rate",
        (Some("added-bending"), _) => "Added curvature",
        _ => "Change",
    }
}

/// What an axis is called, and its unit.
fn axis_words(variable: &str) -> (&'static str, &'static str) {
    match variable {
        "time_s" => ("Time since the start", "s"),
        "time_since_edge_s" => ("Time since the voltage changed", "s"),
        "voltage_v" => ("Voltage", "V"),
        "largest_voltage_v" => ("Largest voltage so far", "V"),
        "edges" => ("Changes of the voltage so far", ""),
        "charge_c_per_cm2" => ("Charge", "C/cm²"),
        "curvature_per_cm" => ("Curvature", "1/cm"),
        "current_a_per_cm2" => ("Current", "A/cm²"),
        "heat" => ("Power, mean of late", "W/cm²"),
        "flow" => ("Current, mean of late", "A/cm²"),
        other => ClimateQuantity::from_key(other).map_or(("Variable", ""), |own| (own.label(), own.unit())),
    }
}
