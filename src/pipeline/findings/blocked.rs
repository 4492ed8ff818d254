//! The blocking forces of a campaign as moments per charge and per volt. Nothing of it is stored: it follows from the
//! readings whenever it is read.
//!
//! The moment obeys the law of the free strip's curvature with mu in place of alpha, and is fitted with it.

use crate::analysis::stiffness::product;
use crate::domain::blocked::FORCE_AT_MM;
use crate::domain::fault::caught;
use crate::domain::tag::keys;
use crate::domain::{BlockedRun, Campaign, Channel, Estimate, Fit, Issue, Quantity, RunRecord};
use crate::fit::{FitInput, FitOptions, fit_run};
use crate::model::geometry::blocking::blocked_moment_mn_mm;
use crate::pipeline::campaign::batch::compute;
use crate::pipeline::{Context, PipelineError};

/// Code of what is said of a run that gives no moment.
const NO_MOMENT: &str = "no-moment";
/// Model whose law the moment is fitted with where the run itself is fitted with none that has it.
const MODEL: &str = "lumped-2";

/// What the blocking forces of these runs say, in the order of the runs.
///
/// # Errors
/// The database cannot be read; a force that gives no moment is no error.
pub fn blocked_runs(context: &Context, runs: &[RunRecord]) -> Result<Vec<BlockedRun>, PipelineError> {
    let is_blocked = |run: &&RunRecord| {
        let mut channels = run.channels.iter();
        channels.any(|channel| channel.quantity == Quantity::BlockingForce)
    };
    let blocked: Vec<&RunRecord> = runs.iter().filter(is_blocked).collect();
    let campaign = &context.campaign;
    let load = |context: &Context, run: &&RunRecord| Ok(context.store.channels(run.id)?);
    compute(context, &blocked, load, |run, channels: Vec<Channel>| {
        caught(|| of_run(run, &channels, campaign)).unwrap_or_else(|reason| {
            let issue = Issue::fault("analysis-fault", "the fit of the moment", &reason);
            BlockedRun::without_moment(run.id, &run.path, issue.mend("report it with this run"))
        })
    })
}

/// Why a force gives no moment, and how that is mended.
type Missing = (&'static str, &'static str);

/// Channels of a held run with its moment in the place of the curvature, whose law it obeys; the factor between them, mu over
/// alpha, is in no other number.
///
/// # Errors
/// There is no distance to the sensor, or no reading of the force.
pub(super) fn with_moment(
    run: &RunRecord,
    channels: &[Channel],
    campaign: &Campaign,
) -> Result<Vec<Channel>, Missing> {
    let lever_mm = lever_mm(run, campaign).ok_or((
        "a blocking force gives no moment without the distance from the clamp to the sensor",
        "give the sample length_mm in campaign.toml, or the run the tag blocking_force_at_mm",
    ))?;
    let force = force_of(channels).ok_or((
        "the column of the blocking force holds no reading",
        "look at the file",
    ))?;
    let moment = force
        .values
        .iter()
        .map(|&force_mn| blocked_moment_mn_mm(force_mn, lever_mm));
    let moment = Channel {
        quantity: Quantity::Curvature,
        values: moment.collect(),
        ..force.clone()
    };
    let current = channels.iter().filter(|c| c.quantity == Quantity::Current);
    Ok(current.cloned().chain([moment]).collect())
}

/// Distance from the clamp to the sensor of the force: that of the run, else the length of its strip.
pub(super) fn lever_mm(run: &RunRecord, campaign: &Campaign) -> Option<f64> {
    let sample = || campaign.sample(run.tag(keys::SAMPLE)?)?.length_mm;
    let lever = run.tag_number(FORCE_AT_MM).or_else(sample);
    lever.filter(|lever| *lever > 0.0)
}

fn force_of(channels: &[Channel]) -> Option<&Channel> {
    channels
        .iter()
        .find(|c| c.quantity == Quantity::BlockingForce && !c.is_empty())
}

fn of_run(run: &RunRecord, channels: &[Channel], campaign: &Campaign) -> BlockedRun {
    let without = |message: &str, mend: &str| {
        let issue = Issue::warning(NO_MOMENT, message).mend(mend);
        BlockedRun::without_moment(run.id, &run.path, issue.at(Quantity::BlockingForce.column()))
    };
    let fitted = match with_moment(run, channels, campaign) {
        Ok(fitted) => fitted,
        Err((message, mend)) => return without(message, mend),
    };
    let (Some(drive), Some(area_cm2)) = (&run.drive, run.area_cm2) else {
        return without(
            "a blocking force gives no coupling without the voltage and the area of the strip",
            "give the run its voltage_v, and the sample length_mm and width_mm in campaign.toml",
        );
    };
    let input = FitInput {
        channels: &fitted,
        drive,
        area_cm2,
    };
    let of_run = run.fit.as_ref().map(|fit| fit.model.as_str());
    let model = of_run
        .filter(|model| matches!(*model, "lumped-1" | "lumped-2"))
        .unwrap_or(MODEL);
    let fit = FitOptions::for_model(model).and_then(|options| fit_run(&input, &options));
    let fit = match fit {
        Ok(fit) => fit,
        Err(error) => return without(&error.to_string(), "look at the readings of the force"),
    };
    let forces = force_of(channels)
        .into_iter()
        .flat_map(|force| force.values.iter());
    let largest = forces.copied().filter(|force| force.is_finite());
    BlockedRun {
        run: run.id,
        path: run.path.clone(),
        largest_force_mn: largest.max_by(|a, b| a.abs().total_cmp(&b.abs())),
        force_at_mm: lever_mm(run, campaign),
        per_charge_mn_mm_per_c: size(number(&fit, "alpha_per_c_cm")),
        per_volt_mn_mm_per_v: per_volt(&fit, area_cm2),
        relaxation_per_s: number(&fit, "lambda_per_s"),
        issues: if fit.converged {
            Vec::new()
        } else {
            vec![Issue::warning(
                NO_MOMENT,
                format!("the fit of the moment did not converge: {}", fit.why_stopped),
            )]
        },
    }
}

fn number(fit: &Fit, key: &str) -> Estimate {
    let found = fit.parameter(key).filter(|_| fit.converged);
    found
        .cloned()
        .unwrap_or_else(|| Estimate::not_determined("the fit of the moment does not tell it"))
}

/// A force may be read with either sign: its size counts.
pub(super) fn size(estimate: Estimate) -> Estimate {
    match estimate.value {
        Some(value) if value < 0.0 => estimate.scaled(-1.0),
        _ => estimate,
    }
}

/// The moment per volt once charged: known as such without a current; else mu times the capacitance of the strip, whose
/// errors are taken as independent, which is no less than they are.
fn per_volt(fit: &Fit, area_cm2: f64) -> Estimate {
    if let Some(alone) = fit.parameter("curvature_total_per_cm_v") {
        return size(alone.clone());
    }
    let charge = size(number(fit, "alpha_per_c_cm"));
    let capacitance = number(fit, "c_total_f_per_cm2");
    let area = Estimate::determined(area_cm2, 0.0, area_cm2, area_cm2);
    product(&[(&charge, 1.0), (&capacitance, 1.0), (&area, 1.0)])
}
