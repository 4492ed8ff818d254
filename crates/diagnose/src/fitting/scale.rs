//! Sizes of the data and of a fitted model.

use ieap_domain::{ClimateQuantity, range_of};
use ieap_model::effects::Scale;
use ieap_numerics::sums::peak;

use crate::fitting::policy::least_width;
use crate::fitting::problem::ExtendedProblem;
use crate::readings::group::{GroupRun, RunGroup};

/// Sizes of the data and of the base model, from which limits of effects follow.
pub(crate) fn scale(group: &RunGroup, problem: &ExtendedProblem, at: &[f64]) -> Scale {
    let model = problem.model(at);
    let mut scale = Scale {
        base: model.base.clone(),
        area_cm2: group.runs.first().map_or(1.0, |run| run.given.input.area_cm2),
        length_cm: group
            .runs
            .iter()
            .map(|run| run.given.length_cm)
            .collect::<Option<Vec<f64>>>()
            .and_then(|l| l.first().copied()),
        durations_s: group.runs.iter().map(|run| run.duration_s).collect(),
        shortest_s: f64::INFINITY,
        voltage_v: 0.0,
        current_a: 0.0,
        curvature_per_cm: 0.0,
        charge_c: 0.0,
        edges: group
            .runs
            .iter()
            .map(|run| run.drive().segments.len())
            .max()
            .unwrap_or(0),
        logged: logged(group),
    };
    for (index, run) in group.runs.iter().enumerate() {
        let [current_a, curvature_per_cm] = run.fitted(&model, &run.context(index, None));
        scale.current_a = scale.current_a.max(peak(&current_a));
        scale.curvature_per_cm = scale.curvature_per_cm.max(peak(&curvature_per_cm));
        let drive = run.drive();
        scale.voltage_v = scale.voltage_v.max(drive.nominal_step_v().abs());
        for channel in run.channels.iter().flatten() {
            let steps = channel.time_s().windows(2).map(|pair| pair[1] - pair[0]);
            scale.shortest_s = scale.shortest_s.min(steps.fold(f64::INFINITY, f64::min));
        }
    }
    if !scale.shortest_s.is_finite() {
        scale.shortest_s = 1.0;
    }
    scale.charge_c = scale.capacitance_f_per_cm2() * scale.voltage_v * scale.area_cm2;
    scale
}

/// What sensors logged of the air in every run, from its lowest to its highest value while runs went on; but a strip's answer turns
/// within no less than the least width.
fn logged(group: &RunGroup) -> Vec<(ClimateQuantity, f64, f64)> {
    let of_run = |(index, run): (usize, &GroupRun), quantity| {
        let context = run.context(index, None);
        let (time_s, values) = context.logged(quantity)?.included();
        let reading = time_s.iter().zip(values.iter());
        let during = reading.filter(|(t, _)| (context.start_s()..=run.duration_s).contains(t));
        let (low, high) = range_of(during.map(|(_, value)| *value));
        (low <= high).then_some([low, high])
    };
    let of = |quantity: ClimateQuantity| {
        let runs = group.runs.iter().enumerate();
        let each: Option<Vec<[f64; 2]>> = runs.map(|run| of_run(run, quantity)).collect();
        let (low, high) = range_of(each?.into_iter().flatten());
        let wider = 0.5 * (least_width(quantity, high) - (high - low)).max(0.0);
        (high > low).then_some((quantity, low - wider, high + wider))
    };
    ClimateQuantity::MEASURED.into_iter().filter_map(of).collect()
}
