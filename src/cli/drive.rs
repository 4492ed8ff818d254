//! The voltage for a wanted motion: `ieap predict --wanted`.

use std::ffi::OsStr;
use std::path::Path;

use clap::Args;

use super::campaign::CampaignArg;
use super::exit::{CliError, DONE};
use super::output::Output;
use super::predict::words;
use super::strip_args::OutputFile;
use super::table::write;
use super::typed;
use crate::domain::number::fixed;
use crate::domain::typed_value::Measured;
use crate::domain::words::counted;
use crate::pipeline::standalone::forward::drive_file::{read_course, write_drive};
use crate::pipeline::standalone::forward::{DriveCourse, DriveDocument, Wanted, course_figure};

/// How the voltage may change, and within which limits.
#[derive(Debug, Args)]
#[group(id = "limits", requires = "wanted")]
pub struct LimitArgs {
    /// Time between changes of the voltage, as 1s [default: a two-hundredth of the course]
    #[arg(long, value_name = "TIME", value_parser = typed::time)]
    pub every: Option<f64>,
    /// Largest voltage of either sign, as 2.5V [default: the largest that was measured]
    #[arg(long, value_name = "VOLTAGE", value_parser = typed::voltage)]
    pub max_voltage: Option<f64>,
    /// Largest rate of change, as 0.1V/s [default: none]
    #[arg(long, value_name = "RATE", value_parser = typed::voltage_rate)]
    pub max_slope: Option<f64>,
    /// Onset of electrolysis, which the voltage stays below, as 1.23V [default: as a diagnosis found it]
    #[arg(long, value_name = "VOLTAGE", value_parser = typed::measured_voltage)]
    pub onset: Option<Measured>,
}

/// What is wanted: a displacement that is held for that time, or the course in a file, whose name has an ending or begins as no
/// number does.
pub fn wanted(text: &str, for_s: Option<f64>) -> Result<Wanted, CliError> {
    let path = Path::new(text);
    let is_letter = |text: &str| text.starts_with(char::is_alphabetic);
    let is_file = is_letter(text) || path.extension().and_then(OsStr::to_str).is_some_and(is_letter);
    let wrong = |what: &str| Err(CliError::usage(&format!("--wanted {text}: {what}")));
    match (typed::length(text), for_s) {
        (Ok(tip), Some(for_s)) => Ok(Wanted::Hold {
            tip_mm: tip.value,
            for_s,
        }),
        (Ok(_), None) => wrong("needed for how long it is held, as --for 300s"),
        (Err(_), None) if is_file => Ok(Wanted::Course(read_course(path)?)),
        (Err(_), Some(_)) if is_file => wrong("a course has its own end; leave --for out"),
        (Err(error), _) => wrong(&format!("{error}; or the file of a course, as FILE.csv")),
    }
}

/// Shows the drive that is found, and writes it where a file is asked for.
pub fn show(
    campaign: &CampaignArg,
    course: &DriveCourse,
    file: &OutputFile,
    output: &Output,
) -> Result<u8, CliError> {
    let context = campaign.open_to_show(output)?;
    let document = course.run(&context)?;
    print(&document, output);
    if let Some((path, ending, overwrite)) = file.asked() {
        let bytes = match ending.as_str() {
            "csv" => write_drive(&document.drive).into_bytes(),
            format => course_figure(&document, context.campaign.notice.as_deref(), format)?,
        };
        write(path, &bytes, overwrite, output)?;
    }
    output.document(&document)?;
    Ok(DONE)
}

fn print(document: &DriveDocument, output: &Output) {
    let mm = |value: f64| format!("{} mm", fixed(value, 4));
    output.result(&format!(
        "{} in {}, {} mm by {} mm, {} model, from {}",
        document.sample,
        document.environment,
        document.strip.length_mm,
        document.strip.width_mm,
        document.model,
        counted(document.sources.len(), "run")
    ));
    output.result(&match document.reached_after_s {
        None => "The wanted course is not reached within the limits.".to_owned(),
        Some(from) => format!(
            "Reached to 5 % after {} s; within 5 % for {} of {} s.",
            fixed(from, 1),
            fixed(document.near_for_s, 0),
            fixed(document.end_s, 0)
        ),
    });
    output.result(&format!(
        "Error against the wanted course: {} root mean square, {} at most; no voltage within the limits has less than {}.",
        mm(document.rms_error_mm),
        mm(document.largest_error_mm),
        mm(document.least_rms_error_mm)
    ));
    output.result(&format!(
        "Lost into the leak, either way: {} mC.",
        words(&document.leaked_charge_c, 1e3)
    ));
    output.result(&format!(
        "Voltage: at most {} V either way, set by {}.",
        fixed(document.voltage_limit_v, 3),
        document.limited_by
    ));
    output.result("\n     time   voltage    wanted   reached, mm");
    for row in &document.rows {
        output.result(&format!(
            "{:>7} s {:>7} V {:>6} mm   {}",
            fixed(row.time_s, 1),
            fixed(row.voltage_v, 3),
            fixed(row.wanted_mm, 3),
            words(&row.reached_mm, 1.0)
        ));
    }
    output.result("");
    for entry in &document.left_out {
        output.result(&format!("Not used: {}: {}.", entry.run, entry.reason));
    }
    document.remarks.iter().for_each(|remark| output.result(remark));
}
