//! `ieap predict`.

use std::path::PathBuf;

use clap::Args;

use super::campaign::CampaignArg;
use super::drive::{self, LimitArgs};
use super::exit::{CliError, DONE};
use super::output::Output;
use super::strip_args::{OutputFile, StripArgs};
use super::table::write;
use super::typed;
use crate::domain::Drive;
use crate::domain::number::estimates::in_words;
use crate::domain::typed_value::Measured;
use crate::domain::words::counted;
use crate::pipeline::standalone::forward::drive_file::read_drive;
use crate::pipeline::standalone::forward::{
    DriveCourse, Forecast, Predict, PredictedRow, PredictionDocument, prediction_figure,
};

/// Predict a run from fits, or the voltage for a motion
///
/// Of another strip, voltage or drive: each number has the interval in which a further run lies in 95 of 100 cases.
///
/// With --wanted it finds the voltage that gives a wanted motion, within limits, open loop. With -o FILE.csv the drive is
/// written as the source takes it: time_s, voltage_v, each row held until the next.
#[derive(Debug, Args)]
pub struct PredictArgs {
    #[command(flatten)]
    campaign: CampaignArg,
    #[command(flatten)]
    strip: StripArgs,
    /// Voltage of a step at time zero, as 2V
    #[arg(long, value_name = "VOLTAGE", value_parser = typed::voltage, required_unless_present_any = ["drive", "wanted"], conflicts_with_all = ["limits", "duration"], allow_hyphen_values = true)]
    voltage: Option<f64>,
    /// A drive in place of a step: a table of time_s and voltage_v, each row held until the next
    #[arg(long, value_name = "FILE.csv", conflicts_with_all = ["voltage", "limits", "duration"])]
    drive: Option<PathBuf>,
    /// Times to predict at, as 10s,5min [default: 1, 3, 10, ... s up to the longest run]
    #[arg(long = "at", id = "times", value_name = "TIME,TIME,...", value_delimiter = ',', value_parser = typed::time)]
    times: Vec<f64>,
    /// Modulus for the blocked moment, as 460MPa [default: from the modulus logs at that humidity]
    #[arg(long, value_name = "MODULUS", value_parser = typed::modulus)]
    modulus: Option<Measured>,
    /// Find the voltage that holds the tip at a displacement, as 1mm, or that follows a course: a table of time_s and
    /// tip_displacement_mm
    #[arg(long, aliases = ["hold", "course"], value_name = "DISPLACEMENT|FILE.csv", allow_hyphen_values = true,
        conflicts_with_all = ["voltage", "drive", "times", "modulus"])]
    wanted: Option<String>,
    /// For how long a displacement is held, as 300s
    #[arg(long = "for", id = "duration", value_name = "TIME", value_parser = typed::time, requires = "wanted")]
    duration: Option<f64>,
    #[command(flatten)]
    limits: LimitArgs,
    #[command(flatten)]
    file: OutputFile,
}

pub fn run(args: &PredictArgs, output: &Output) -> Result<u8, CliError> {
    if let Some(motion) = &args.wanted {
        let course = DriveCourse {
            strip: args.strip.asked(None)?,
            wanted: drive::wanted(motion, args.duration)?,
            every_s: args.limits.every,
            max_voltage_v: args.limits.max_voltage,
            max_slope_v_per_s: args.limits.max_slope,
            onset_v: args.limits.onset,
        };
        return drive::show(&args.campaign, &course, &args.file, output);
    }
    let context = args.campaign.open_to_show(output)?;
    let drive = match (&args.drive, args.voltage) {
        (Some(path), _) => read_drive(path)?,
        (None, volts) => Drive::step(volts.unwrap_or_default()),
    };
    let predict = Predict {
        strip: args.strip.asked(args.modulus)?,
        drive,
        at_s: args.times.clone(),
    };
    let document = predict.run(&context)?;
    print(&document, output);
    if let Some((path, ending, overwrite)) = args.file.asked() {
        let rows = if args.times.is_empty() {
            &document.course
        } else {
            &document.rows
        };
        let bytes = match ending.as_str() {
            "csv" => document.csv(rows).into_bytes(),
            format => prediction_figure(&document, context.campaign.notice.as_deref(), format)?,
        };
        write(path, &bytes, overwrite, output)?;
    }
    output.document(&document)?;
    Ok(DONE)
}

fn print(document: &PredictionDocument, output: &Output) {
    let strip = &document.strip;
    output.result(&format!(
        "{} in {}, {} mm by {} mm, {} model, from {}",
        document.sample,
        document.environment,
        strip.length_mm,
        strip.width_mm,
        document.model,
        counted(document.sources.len(), "run")
    ));
    type Column = fn(&PredictedRow) -> Option<Forecast>;
    let columns: [(&str, f64, Column); 5] = [
        ("current, mA", 1e3, |row| Some(row.current_a)),
        ("charge, mC", 1e3, |row| Some(row.charge_c)),
        ("curvature, 1/cm", 1.0, |row| row.curvature_per_cm),
        ("tip, mm", 1.0, |row| row.tip_displacement_mm),
        ("blocked moment, mN mm", 1.0, |row| row.blocked_moment_mn_mm),
    ];
    for (name, scale, of) in columns {
        if document.rows.iter().all(|row| of(row).is_none()) {
            continue;
        }
        output.result(&format!("\n{name}"));
        for row in &document.rows {
            if let Some(predicted) = of(row) {
                output.result(&format!("{:>9} s  {}", row.time_s, words(&predicted, scale)));
            }
        }
    }
    output.result("");
    for entry in &document.left_out {
        output.result(&format!("Not used: {}: {}.", entry.run, entry.reason));
    }
    document.remarks.iter().for_each(|remark| output.result(remark));
}

/// `0.123 ± 0.011  (95 %: 0.101 to 0.145)`.
pub(super) fn words(predicted: &Forecast, scale: f64) -> String {
    let estimate = predicted.estimate(scale);
    let interval = crate::domain::number::estimates::interval_in_words(&estimate);
    format!("{}{interval}", in_words(&estimate))
}
