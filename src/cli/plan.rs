//! `ieap plan`.

use std::path::PathBuf;

use clap::{ArgGroup, Args};

use super::campaign::CampaignArg;
use super::exit::{CliError, DONE};
use super::global::Global;
use super::output::Output;
use super::{next, typed};
use crate::domain::Drive;
use crate::domain::typed_value::Measured;
use crate::pipeline::findings::study_plan::{self, StudyPlan};
use crate::pipeline::standalone::forward::AskedStrip;
use crate::pipeline::standalone::forward::drive_file::read_drive;
use crate::pipeline::standalone::preflight::{DRAWS, PlanDocument, Preflight, Subject, Trial, table};

/// List runs to make next, or say what a run would tell
///
/// Alone it lists the runs to make next, and what each tells.
/// With --sample, --run or --spec it says what one run would determine: it is simulated with its noise several times, and each
/// is fitted as the run itself will be.
/// With --study whole campaigns are simulated, and the study is asked in how many it sees a change.
#[derive(Debug, Args)]
#[command(group(ArgGroup::new("subject").multiple(true).args(["sample", "run", "spec", "study"])))]
#[command(group(ArgGroup::new("trial").multiple(true).requires("subject").args([
    "every", "voltage", "drive", "duration", "bending_every", "start_known", "current_noise", "curvature_noise", "max_voltage",
    "length", "width",
])))]
pub struct PlanArgs {
    #[command(flatten)]
    campaign: CampaignArg,
    /// Write the runs to make next as a table to fill the bench's day with. Kept in the runs folder, it tags the files that are
    /// saved under its names
    #[arg(long, value_name = "FILE.csv", conflicts_with_all = ["subject", "trial"])]
    sheet: Option<PathBuf>,
    /// Sample whose fits tell; of its runs the one nearest in voltage
    #[arg(long, value_name = "SAMPLE", conflicts_with_all = ["run", "spec"], requires = "driven", requires = "every")]
    sample: Option<String>,
    /// Environment of the runs [default: the only one]
    #[arg(long, value_name = "ENVIRONMENT", requires = "sample")]
    environment: Option<String>,
    /// Relative humidity: of the runs, to 5 %, or between theirs, by the laws of the study [default: all runs]
    #[arg(long, value_name = "PERCENT", value_parser = typed::humidity, requires = "sample")]
    rh: Option<f64>,
    /// An earlier run whose fit and noise tell; with --spec one of its runs [default: the first]
    #[arg(long, value_name = "RUN", requires = "every")]
    run: Option<String>,
    /// Parameters and noise from a file as `ieap simulate` takes it, in place of a campaign
    #[arg(long, value_name = "SPEC.toml", conflicts_with_all = ["campaign", "length", "width"], requires = "every")]
    spec: Option<PathBuf>,
    /// Length of another strip of the laminate, as 12mm [default: the sample's]
    #[arg(long, value_name = "LENGTH", value_parser = typed::length)]
    length: Option<Measured>,
    /// Its width
    #[arg(long, value_name = "WIDTH", value_parser = typed::length)]
    width: Option<Measured>,
    /// Voltage of a step at time zero, as 1.2V [default: the drive of the earlier run]
    #[arg(long, value_name = "VOLTAGE", value_parser = typed::voltage, allow_hyphen_values = true, group = "driven")]
    voltage: Option<f64>,
    /// A drive in place of a step: a table of time_s and voltage_v, each row held until the next
    #[arg(long, value_name = "FILE.csv", conflicts_with = "voltage", group = "driven")]
    drive: Option<PathBuf>,
    /// Time between readings, as 0.25s
    #[arg(long, value_name = "TIME", value_parser = typed::time, allow_hyphen_values = true)]
    every: Option<f64>,
    /// Time between readings of the bending, as 1s [default: as --every]
    #[arg(long, value_name = "TIME", value_parser = typed::time, allow_hyphen_values = true)]
    bending_every: Option<f64>,
    /// Length of the record, as 600s [default: that of the earlier run]
    #[arg(long = "for", id = "duration", value_name = "TIME", value_parser = typed::time, allow_hyphen_values = true)]
    duration: Option<f64>,
    /// The instrument states when the drive begins [default: as of the earlier run; else known between two readings only]
    #[arg(long)]
    start_known: bool,
    /// Noise of a reading of the current, standard deviation, A [default: that of the earlier run]
    #[arg(long, value_name = "AMPERE", allow_hyphen_values = true)]
    current_noise: Option<f64>,
    /// Noise of a reading of the curvature, standard deviation, 1/cm [default: that of the earlier run]
    #[arg(long, value_name = "PER_CM", allow_hyphen_values = true)]
    curvature_noise: Option<f64>,
    /// Largest voltage that may be proposed, as 2.5V [default: the largest that was measured]
    #[arg(long, value_name = "VOLTAGE", value_parser = typed::voltage)]
    max_voltage: Option<f64>,
    /// Simulated runs for each way to make the run, or campaigns for each number of strips [default: 20, or 100]
    #[arg(long, value_name = "N", requires = "subject")]
    draws: Option<usize>,
    /// Ask in how many campaigns like this one the study would see a change
    #[arg(long, conflicts_with_all = ["sample", "run", "spec", "trial"])]
    study: bool,
    /// Numbers of strips a material [default: 2,3,4,6]
    #[arg(long, value_name = "N,N", value_delimiter = ',', requires = "study")]
    strips: Vec<usize>,
    /// Change that is to be seen, percent [default: `alike_percent` of the study]
    #[arg(long, value_name = "PERCENT", requires = "study")]
    change: Option<f64>,
    /// Runs a strip and condition [default: as in the campaign]
    #[arg(long, value_name = "N", requires = "study")]
    repeats: Option<usize>,
}

pub fn run(args: &PlanArgs, global: &Global, output: &Output) -> Result<u8, CliError> {
    let every_s = match args.every {
        Some(every_s) => every_s,
        None if args.study => return plan_study(args, global, output),
        None => return next::show(&args.campaign, args.sheet.as_deref(), output),
    };
    let drive = match (&args.drive, args.voltage) {
        (Some(path), _) => Some(read_drive(path)?),
        (None, volts) => volts.map(Drive::step),
    };
    let mut subject = subject(args, drive.as_ref(), output)?;
    if let Some(size) = args.current_noise {
        subject.current_noise.standard_deviation = size;
    }
    if let (Some(size), Some(noise)) = (args.curvature_noise, &mut subject.curvature_noise) {
        noise.standard_deviation = size;
    }
    let plan = Preflight {
        trial: Trial {
            drive: drive.unwrap_or_else(|| subject.drive.clone()),
            every_s,
            bending_every_s: args.bending_every.unwrap_or(every_s),
            for_s: args.duration.unwrap_or(subject.for_s),
            start_is_known: args.start_known || subject.start_is_known,
        },
        max_voltage_v: args.max_voltage.unwrap_or(subject.largest_v),
        draws: args.draws.unwrap_or(DRAWS),
        seed: global.seed.unwrap_or_default(),
        subject,
    };
    let document = plan.run(output)?;
    print(&document, output);
    output.document(&document)?;
    Ok(DONE)
}

fn plan_study(args: &PlanArgs, global: &Global, output: &Output) -> Result<u8, CliError> {
    let context = args.campaign.open_to_show(output)?;
    let plan = StudyPlan {
        strips: if args.strips.is_empty() {
            study_plan::STRIPS.to_vec()
        } else {
            args.strips.clone()
        },
        change_percent: args.change,
        repeats: args.repeats,
        draws: args.draws.unwrap_or(study_plan::DRAWS),
        seed: global.seed.unwrap_or_default(),
    };
    let document = plan.run(&context, output)?;
    let said = document.answer.iter().chain(&document.remarks);
    said.for_each(|sentence| output.result(sentence));
    output.document(&document)?;
    Ok(DONE)
}

fn subject(args: &PlanArgs, drive: Option<&Drive>, output: &Output) -> Result<Subject, CliError> {
    if let Some(spec) = &args.spec {
        return Ok(Subject::of_spec(spec, args.run.as_deref())?);
    }
    let context = args.campaign.open_to_show(output)?;
    let asked = AskedStrip {
        sample: args.sample.clone().unwrap_or_default(),
        environment: args.environment.clone(),
        relative_humidity_percent: args.rh,
        length_mm: args.length,
        width_mm: args.width,
        ..AskedStrip::default()
    };
    let volts = drive.map(Drive::nominal_step_v);
    Ok(Subject::of_campaign(&context, asked, args.run.as_deref(), volts)?)
}

fn print(document: &PlanDocument, output: &Output) {
    document
        .answer
        .iter()
        .for_each(|sentence| output.result(sentence));
    let rows = table(document);
    let wide = rows
        .iter()
        .map(|row| row[0].chars().count())
        .max()
        .unwrap_or_default();
    output.result("");
    for row in &rows {
        let cells: String = row[1..].iter().map(|cell| format!("{cell:>11}")).collect();
        output.result(&format!("{:<wide$}{cells}", row[0]));
    }
    output.result("");
    document.remarks.iter().for_each(|remark| output.result(remark));
}
