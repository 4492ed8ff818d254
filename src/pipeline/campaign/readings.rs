//! Readings of a run as results are made of them: current and curvature of the strip, whatever was measured in their place.

use crate::domain::tag::keys;
use crate::domain::{Channel, ClimateQuantity, Drive, Quantity, RunRecord, range_of};
use crate::fit::{FitInput, FitOptions, placed_drive};
use crate::ingest::derived;
use crate::pipeline::{Context, PipelineError};
use crate::store::FitTask;

/// Of a run that can be fitted.
///
/// # Errors
/// The database cannot be read.
pub(crate) fn of_task(context: &Context, task: &FitTask) -> Result<Vec<Channel>, PipelineError> {
    Ok(derived::responses(
        &context.store.channels(task.run_id)?,
        task.length_cm,
        Some(&task.drive),
    ))
}

/// The channels of a run as they are stored, and what logs beside it say of the air while it went on, where no column of its own
/// does.
///
/// # Errors
/// As of [`of_task`].
pub(crate) fn with_climate(context: &Context, task: &FitTask) -> Result<Vec<Channel>, PipelineError> {
    let mut channels = context.store.channels(task.run_id)?;
    if task.climate_hash.is_none() {
        return Ok(channels);
    }
    let (first_s, _) = range_of(channels.iter().filter_map(|own| own.time_s.first().copied()));
    for curve in context.store.run_climate_curves(task.run_id)? {
        let mut measured = Quantity::ALL.into_iter();
        let Some(quantity) = measured.find(|own| ClimateQuantity::measured(*own) == Some(curve.quantity))
        else {
            continue;
        };
        if first_s.is_finite() && !channels.iter().any(|own| own.is_whole(quantity)) {
            let time_s: Vec<f64> = curve.time_s.iter().map(|since_s| first_s + since_s).collect();
            channels.push(Channel::new(quantity, time_s.into(), curve.values.into()));
        }
    }
    Ok(channels)
}

/// Of each of them, in their order.
///
/// # Errors
/// As of [`of_task`].
pub(crate) fn of_tasks(context: &Context, tasks: &[FitTask]) -> Result<Vec<Vec<Channel>>, PipelineError> {
    tasks.iter().map(|task| of_task(context, task)).collect()
}

/// The drive of a run with its edges where a fit of these readings takes them to be; what is not fitted keeps them as they are told.
pub(crate) fn placed(task: &FitTask, channels: &[Channel]) -> Drive {
    let input = FitInput {
        channels,
        drive: &task.drive,
        area_cm2: task.area_cm2,
    };
    placed_drive(&input, &FitOptions::default()).unwrap_or_else(|_| task.drive.clone())
}

/// Of any run; the length of the strip is that of its sample.
///
/// # Errors
/// As of [`of_task`].
pub(crate) fn of_run(context: &Context, run: &RunRecord) -> Result<Vec<Channel>, PipelineError> {
    let sample = run.tag(keys::SAMPLE).and_then(|id| context.campaign.sample(id));
    let length_cm = sample
        .and_then(|sample| sample.length_mm)
        .map(|length_mm| length_mm / 10.0);
    Ok(derived::responses(
        &context.store.channels(run.id)?,
        length_cm,
        run.drive.as_ref(),
    ))
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use crate::domain::{Channel, Drive, Quantity};
    use crate::fit::{FitInput, FitOptions, fit_run};
    use crate::ingest::derived;
    use crate::model::geometry::conversion::{Bending, KnownStrip};
    use crate::model::{Branch, LumpedModel};

    /// A displacement sensor that was not zeroed: the intervals hold for strips of any length, and of any zero.
    #[test]
    fn a_displacement_may_count_from_anywhere() {
        // The edge lies on a reading.
        let time_s: Vec<f64> = (-30..600).map(|k| 2.0 * f64::from(k)).collect();
        let drive = Drive::step(2.0);
        let (mut held, mut stated) = (0, 0);
        for (number, (length_mm, part)) in [2.0, 10.0, 30.0]
            .into_iter()
            .flat_map(|length_mm| [0.0, 0.02, 0.1, -0.2].map(|part| (length_mm, part)))
            .cycle()
            .take(48)
            .enumerate()
        {
            let mut random = ChaCha8Rng::seed_from_u64(number as u64);
            // The tip moves by about 0.4 of the length.
            let model = LumpedModel {
                branches: vec![
                    Branch {
                        resistance_ohm_cm2: 300.0,
                        capacitance_f_per_cm2: 0.05,
                    },
                    Branch {
                        resistance_ohm_cm2: 1200.0,
                        capacitance_f_per_cm2: 0.11,
                    },
                ],
                steady_state_resistance_ohm_cm2: 9000.0,
                charge_to_curvature_per_c_cm: 27.0 / length_mm * 10.0,
                relaxation_rate_per_s: 3e-4,
            };
            let strip = KnownStrip {
                length_mm: Some(length_mm),
                seen_at_mm: None,
                width_mm: None,
                thickness_mm: None,
                modulus_mpa: None,
                neutral_layer_shift_mm: 0.0,
                mean_elongation: 0.0,
            };
            let exact: Vec<f64> = model
                .curvature_per_cm(&drive, 0.1, &time_s)
                .iter()
                .map(|kappa| strip.from_curvature(Bending::Displacement, *kappa).unwrap())
                .collect();
            let stroke = exact.iter().copied().fold(0.0, f64::max);
            assert!(
                stroke > 0.2 * length_mm && stroke < 0.7 * length_mm,
                "{stroke} of {length_mm}"
            );
            let mut noise = |size: f64| size * (0..12).map(|_| random.random::<f64>() - 0.5).sum::<f64>();
            let mut tip = exact
                .iter()
                .map(|d| d + part * stroke + noise(0.003 * stroke))
                .collect::<Vec<f64>>();
            if number % 3 == 0 {
                // A reading at rest of something else.
                tip[4] += 0.5 * stroke;
            }
            let current = model.current_a(&drive, 0.1, &time_s);
            let peak = current.iter().copied().fold(0.0, f64::max);
            let current: Vec<f64> = current.iter().map(|i| i + noise(0.002 * peak)).collect();
            // Every other record has lost some readings, and some of them at rest.
            let lost = |k: &usize| number % 2 == 1 && k % 7 == number % 7;
            let kept: Vec<usize> = (0..time_s.len()).filter(|k| !lost(k)).collect();
            let of_kept = |values: &[f64]| kept.iter().map(|k| values[*k]).collect::<Vec<f64>>().into();
            let channel =
                |quantity, values: Vec<f64>| Channel::new(quantity, of_kept(&time_s), of_kept(&values));
            let channels = derived::responses(
                &[
                    channel(Quantity::Current, current),
                    channel(Quantity::TipDisplacement, tip),
                ],
                Some(length_mm / 10.0),
                Some(&drive),
            );
            let input = FitInput {
                channels: &channels,
                drive: &drive,
                area_cm2: 0.1,
            };
            let fit = fit_run(&input, &FitOptions::for_model("lumped-2").unwrap()).unwrap();
            let truths = [
                ("alpha_per_c_cm", model.charge_to_curvature_per_c_cm),
                ("lambda_per_s", 3e-4),
                ("r1_ohm_cm2", 300.0),
            ];
            for (key, truth) in truths {
                let own = fit.parameter(key).unwrap();
                let (low, high) = (own.low_95.unwrap(), own.high_95.unwrap());
                stated += 1;
                held += u32::from(low <= truth && truth <= high);
            }
        }
        assert!(100 * held >= 90 * stated, "{held} of {stated}");
    }
}
