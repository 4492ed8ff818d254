//! `ieap convert`.

use clap::Args;

use super::exit::{CliError, DONE};
use super::output::Output;
use super::typed;
use crate::domain::number::estimates::{in_words, interval_in_words};
use crate::domain::typed_value::Measured;
use crate::domain::words::capital;
use crate::pipeline::findings::strip_modulus::strip_modulus;
use crate::pipeline::standalone::convert::{MeasuredStrip, convert};

/// Convert curvature, displacement, strain, moment
///
/// From one measure of bending all others follow: displacement, curvature, angle, strains, moment, energy. It
/// needs no campaign.
///
/// Values carry their unit, and an error where one is known: `displacement=1.2±0.05mm`.
#[derive(Debug, Args)]
pub struct ConvertArgs {
    /// What is known: curvature, radius, displacement, tip-displacement, tangent-angle, strain-difference,
    /// bending-strain, moment or energy
    #[arg(value_name = "NAME=VALUE")]
    given: String,
    /// Free length of the strip
    #[arg(long, value_name = "5mm", value_parser = typed::length)]
    length: Option<Measured>,
    /// Where the displacement is seen, straight ahead of the clamp [default: the free length]
    #[arg(long, value_name = "4mm", value_parser = typed::length)]
    at: Option<Measured>,
    /// Width of the strip
    #[arg(long, value_name = "2mm", value_parser = typed::length)]
    width: Option<Measured>,
    /// Thickness of the strip
    #[arg(long, value_name = "0.22mm", value_parser = typed::length)]
    thickness: Option<Measured>,
    /// Effective Young's modulus
    #[arg(long, value_name = "460MPa", value_parser = typed::modulus)]
    modulus: Option<Measured>,
    /// Distance of the neutral layer from the middle of the thickness [default: 0mm]
    #[arg(long, value_name = "0mm", value_parser = typed::length)]
    neutral_shift: Option<Measured>,
    /// Mean elongation of the strip, for the exact strain difference [default: 0%]
    #[arg(long, value_name = "0%", value_parser = typed::strain, allow_hyphen_values = true)]
    elongation: Option<Measured>,
    /// Take what is not given from this sample of the campaign of this folder (or of -C)
    #[arg(long, value_name = "SAMPLE")]
    sample: Option<String>,
    /// Relative humidity at which the sample's modulus is taken
    #[arg(long, value_name = "PERCENT", value_parser = typed::humidity, requires = "sample")]
    rh: Option<f64>,
}

pub fn run(args: &ConvertArgs, output: &Output) -> Result<u8, CliError> {
    let mut strip = MeasuredStrip {
        length_mm: args.length,
        seen_at_mm: args.at,
        width_mm: args.width,
        thickness_mm: args.thickness,
        modulus_mpa: args.modulus,
        neutral_layer_shift_mm: args.neutral_shift,
        mean_elongation: args.elongation,
    };
    let mut remarks = Vec::new();
    if let Some(id) = &args.sample {
        remarks.push(fill(&mut strip, id, args, output)?);
    }
    let mut document = convert(&args.given, &strip)?;
    document
        .remarks
        .splice(0..0, remarks.into_iter().filter(|remark| !remark.is_empty()));
    for (key, estimate) in &document.values {
        output.result(&format!(
            "{key:<32} {}{}",
            in_words(estimate),
            interval_in_words(estimate)
        ));
    }
    document.remarks.iter().for_each(|remark| output.result(remark));
    output.document(&document)?;
    Ok(DONE)
}

/// Takes what is not given from a sample of the campaign; says where the modulus is from, or why there is none.
fn fill(
    strip: &mut MeasuredStrip,
    id: &str,
    args: &ConvertArgs,
    output: &Output,
) -> Result<String, CliError> {
    let context = super::campaign::open_to_show(&super::campaign::folder(None)?, output)?;
    let sample = context.campaign.sample(id).ok_or_else(|| {
        let known: Vec<&str> = context.campaign.samples.iter().map(|s| s.id.as_str()).collect();
        CliError::usage(&format!(
            "no sample is called {id:?}; campaign.toml has {}",
            known.join(", ")
        ))
    })?;
    let exact = |value: Option<f64>| value.map(Measured::exact);
    strip.length_mm = strip.length_mm.or(exact(sample.length_mm));
    strip.width_mm = strip.width_mm.or(exact(sample.width_mm));
    strip.thickness_mm = strip.thickness_mm.or(exact(sample.thickness_mm));
    if strip.modulus_mpa.is_some() {
        return Ok(String::new());
    }
    let found = strip_modulus(&context, sample, args.rh)?;
    strip.modulus_mpa = found.modulus_mpa.value.map(|value| Measured {
        value,
        standard_error: found.modulus_mpa.standard_error.unwrap_or(0.0),
    });
    Ok(match found.modulus_mpa.reason {
        Some(reason) if strip.modulus_mpa.is_none() => format!("No modulus: {reason}."),
        _ => format!("{}.", capital(&found.source)),
    })
}
