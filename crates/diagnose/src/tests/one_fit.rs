//! Fits of extended models: the stated parameters, of the base and of the effects, leave the stated residual, R^2 and curve.

use super::*;
use ieap_domain::Fit;
use ieap_model::ModelChoice;
use ieap_model::effects::{Applied, TagAt, tag_places};
use ieap_model::extended::ExtendedModel;

/// The model that a fit states; the form of an effect that has several stands in the words on the method.
fn stated(fit: &Fit, choice: &ModelChoice) -> ExtendedModel {
    let value = |key: String| {
        let found = fit.parameter(&key).and_then(|estimate| estimate.value);
        found.unwrap_or_else(|| panic!("{key} has no value: {:#?}", fit.parameters))
    };
    let branch = |k: usize| Branch {
        resistance_ohm_cm2: value(format!("r{k}_ohm_cm2")),
        capacitance_f_per_cm2: value(format!("c{k}_f_per_cm2")),
    };
    let applied = |effect: &&'static dyn ieap_model::effects::Effect| {
        let about = effect.about();
        let says = |form: &&str| fit.method.contains(&format!("{} as {form}", about.id));
        let form = about.variants.iter().position(says);
        assert_eq!(form.is_some(), !about.variants.is_empty(), "{}", fit.method);
        Applied {
            effect: *effect,
            variant: form.unwrap_or(0),
            parameters: about
                .parameters
                .iter()
                .map(|parameter| value(format!("{}.{}", about.id, parameter.key)))
                .collect(),
        }
    };
    ExtendedModel {
        base: LumpedModel {
            branches: (1..=choice.base.branches).map(branch).collect(),
            steady_state_resistance_ohm_cm2: value("rss_ohm_cm2".to_owned()),
            charge_to_curvature_per_c_cm: value("alpha_per_c_cm".to_owned()),
            relaxation_rate_per_s: value("lambda_per_s".to_owned()),
        },
        effects: choice.effects.iter().map(applied).collect(),
    }
}

fn hold_together(inputs: &[RunInput], model: &str) {
    let choice = ModelChoice::parse(model).unwrap();
    let fits = fit_extended(inputs, &choice);
    assert_eq!(fits.len(), inputs.len(), "{model}");
    let group = group::RunGroup::new(inputs);
    for (place, fit) in fits {
        let found = stated(&fit, &choice);
        let context = group.runs[place].context(place, None);
        let [current, curvature] = inputs[place].input.channels else {
            panic!("two channels")
        };
        let predicted = found.responses(&context, &current.time_s, &curvature.time_s);
        for (channel, predicted, r_squared) in [
            (current, &predicted.current_a, fit.r_squared_current),
            (curvature, &predicted.curvature_per_cm, fit.r_squared_curvature),
        ] {
            let readings = channel.values.len() as f64;
            let left = channel.values.iter().zip(predicted).map(|(y, f)| (y - f).powi(2));
            let square: f64 = left.sum();
            let mean = channel.values.iter().sum::<f64>() / readings;
            let total: f64 = channel.values.iter().map(|y| (y - mean).powi(2)).sum();
            let is_its = |noise: &&ieap_domain::ChannelNoise| noise.quantity == channel.quantity;
            let rms = fit.noise.iter().find(is_its).unwrap().residual_rms;
            assert!(
                ((square / readings).sqrt() / rms - 1.0).abs() < 1e-6,
                "{model}, {:?}: {} stated {rms}",
                channel.quantity,
                (square / readings).sqrt()
            );
            assert!(
                (r_squared.unwrap() - (1.0 - square / total)).abs() < 1e-6,
                "{model}"
            );
            let curve = fit.curves.iter().find(|curve| curve.quantity == channel.quantity);
            let curve = curve.unwrap();
            let peak = predicted.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
            for (time_s, drawn) in curve.time_s.iter().zip(&curve.fitted) {
                let at = channel.time_s.iter().position(|t| t == time_s).unwrap();
                assert!(
                    (predicted[at] - drawn).abs() < 1e-6 * peak,
                    "{model} at {time_s} s"
                );
            }
        }
    }
}

#[test]
fn the_stated_parameters_of_an_extended_model_leave_the_stated_residual() {
    let filling: Hidden = (
        "voltage-dependent-capacitance",
        Some("all"),
        &[("quadratic_per_v2", 0.15)],
    );
    let offset: Hidden = ("current-offset", None, &[("offset_a", 4e-5)]);
    let curved: Hidden = ("quadratic-coupling", None, &[("quadratic_cm_per_c2", 60.0)]);
    let runs = Runs::hiding(&[filling], FOUR, 61);
    hold_together(&runs.inputs(), "lumped-2 + voltage-dependent-capacitance");
    let runs = Runs::hiding(&[offset, curved], FOUR, 62);
    for model in [
        "lumped-1 + current-offset",
        "lumped-2 + current-offset",
        "lumped-2 + current-offset + quadratic-coupling",
    ] {
        hold_together(&runs.inputs(), model);
    }
}

/// One parameter set, and the tag of each run: the curve of every run is that of the parameters at its tag.
#[test]
fn the_stated_parameters_at_the_tag_of_a_run_leave_its_residual() {
    let runs = Runs::with(None, FOUR, 63);
    let tags: Vec<Vec<TagAt>> = tag_places("pre_charge_s", &[Some("0"), Some("10"), Some("5"), Some("2")]);
    let tagged = |(input, tags)| RunInput { tags, ..input };
    let tags = tags.iter().map(Vec::as_slice);
    let inputs: Vec<RunInput> = runs.inputs().into_iter().zip(tags).map(tagged).collect();
    hold_together(&inputs, "lumped-2 + follows:pre_charge_s");
}
