//! Made-up findings for the tests of the report: every verdict that a page words differently.

use ieap::domain::finding_words::say;
use ieap::domain::testing::{self, held_out, missing_law, parameter, shift};
use ieap::domain::{
    Account, EffectFinding, Estimate, Gain, GroupDiagnosis, HeldOutGain, Hypothesis, HypothesisKind,
    LawCurve, MisfitPercent, MisfitStretch, MissingLaw, NextRun, Prediction, Ratio, ResidualCurve,
    StrengthProfile, VaryingParameter, VaryingValue, Verdict, Whereabouts,
};
use ieap::report::{EffectParameterText, EffectText, Findings, Input};

use super::report_fixture::troubled_input;

fn parameter_text(key: &str, symbol: &str, unit: &str, meaning: &str) -> EffectParameterText {
    EffectParameterText {
        key: key.to_owned(),
        symbol: symbol.to_owned(),
        unit: unit.to_owned(),
        meaning: meaning.to_owned(),
    }
}

fn effects() -> Vec<EffectText> {
    vec![
        EffectText {
            id: "faradaic-leak".to_owned(),
            summary: "electrolysis current above an onset voltage".to_owned(),
            equation: "i_F = i_0 (e^((|w| - E_on)/s) - 1)".to_owned(),
            signature: "the end current grows faster than the voltage".to_owned(),
            separated_by: "four or more voltages around the onset".to_owned(),
            parameters: vec![
                parameter_text("leak_current_a_per_cm2", "i_0", "A/cm2", "scale of the current"),
                parameter_text("onset_v", "E_on", "V", "voltage above which it flows"),
            ],
        },
        EffectText {
            id: "diffusion-limited-leak".to_owned(),
            summary: "a leak that falls with the root of the time".to_owned(),
            equation: "i_D = k sgn(w)/sqrt(t + t_0)".to_owned(),
            signature: "a current that falls slowly and is not recovered".to_owned(),
            separated_by: "a discharge".to_owned(),
            parameters: vec![parameter_text(
                "scale_a_s05_per_cm2",
                "k",
                "A s^0.5/cm2",
                "scale of the current",
            )],
        },
    ]
}

/// A steady current over the voltage, with the band that these runs leave.
fn curve() -> LawCurve {
    let x: Vec<f64> = (-20..=20).map(|k| 0.1 * f64::from(k)).collect();
    let without: Vec<f64> = x.iter().map(|v| 1e-5 * v).collect();
    let leak = x.iter().map(|v| 2e-5 * v * (v.abs() - 1.2).max(0.0));
    let y: Vec<f64> = leak.zip(&without).map(|(leak, without)| leak + without).collect();
    LawCurve {
        low_95: y.iter().map(|y| y - 3e-6).collect(),
        high_95: y.iter().map(|y| y + 3e-6).collect(),
        x,
        y,
        unit: "A/cm2".to_owned(),
        without,
    }
}

/// Of what the error of a group is made.
fn account(between_runs: f64, within_runs: f64) -> Account {
    Account {
        noise: 20.0,
        between_runs,
        within_runs,
        unexplained: 80.0 - between_runs - within_runs,
        ..Account::default()
    }
}

fn residual(run: &str) -> ResidualCurve {
    let time_s: Vec<f64> = (1..60).map(|k| f64::from(k) * 5.0).collect();
    let decay = |slope: f64| {
        time_s
            .iter()
            .map(|t| 2e-3 * (-t / 60.0).exp() + slope * t)
            .collect()
    };
    ResidualCurve {
        run: run.to_owned(),
        channel: "current".to_owned(),
        before_sigma: time_s.iter().map(|t| 0.02 * t - 1.0).collect(),
        after_sigma: time_s.iter().map(|t| (0.1 * t).sin()).collect(),
        measured: decay(1e-6),
        base: decay(0.0),
        extended: decay(1e-6),
        time_s,
    }
}

/// A cause with everything that is known of it, in the runs given.
fn named(runs: &[&str]) -> GroupDiagnosis {
    let leak = vec![
        parameter(
            "leak_current_a_per_cm2",
            Estimate::determined(2.13e-5, 1.2e-6, 1.9e-5, 2.4e-5),
        ),
        parameter("onset_v", Estimate::below(1.3, "no run stays below the onset")),
    ];
    GroupDiagnosis {
        verdict: Verdict::Law,
        tolerance_percent: 1.0,
        account: Some(account(2.0, 75.0)),
        missing: vec![MissingLaw {
            curve: Some(curve()),
            ..missing_law(Some("faradaic-leak"), "1 of 1")
        }],
        misfit_percent: MisfitPercent {
            current: Some(4.1),
            curvature: Some(0.6),
            charge: Some(7.0),
        },
        p_misfit: Some(0.001),
        draws: 999,
        q_misfit: Some(0.004),
        p_leftover: Some(0.62),
        effects: vec![EffectFinding {
            variant: Some("terminal".to_owned()),
            q: Some(0.004),
            ..testing::effect("faradaic-leak", leak)
        }],
        set: vec!["faradaic-leak".to_owned()],
        gain: Some(Gain {
            held_out: "run".to_owned(),
            proof: HeldOutGain {
                parts: runs.iter().map(|run| ((*run).to_owned(), 75.05)).collect(),
                nrmse_current_before: Some(0.0812),
                nrmse_current_after: Some(0.0103),
                coverage_before: Some(0.412),
                coverage_after: Some(0.9514),
                ..held_out(150.1, 12.0)
            },
            outside: None,
            predictions: vec![Prediction {
                quantity: "end_current".to_owned(),
                before_percent: 7.31,
                after_percent: 0.62,
            }],
            residual_rms_sigma_before: 6.12,
            residual_rms_sigma_after: 1.021,
            later: Some(HeldOutGain {
                parts: runs
                    .iter()
                    .map(|run| (format!("{run} after 360 s"), 30.65))
                    .collect(),
                nrmse_current_before: Some(0.0412),
                nrmse_current_after: Some(0.0151),
                coverage_before: Some(0.512),
                coverage_after: Some(0.948),
                ..held_out(61.3, 9.1)
            }),
        }),
        whereabouts: Some(Whereabouts {
            text: "current too small after 200 s at 2.0 and 2.5 V".to_owned(),
            segments: vec![MisfitStretch {
                run: runs[0].to_owned(),
                channel: "current".to_owned(),
                from_s: 200.0,
                to_s: 600.0,
                sigma: -7.13,
            }],
        }),
        shifts: vec![
            shift("alpha_per_c_cm", 12.04, 14.0, 0.392),
            shift("lambda_per_s", 1.1e-4, 1.11e-4, 2e-6),
        ],
        profiles: vec![StrengthProfile {
            effect: "faradaic-leak".to_owned(),
            key: "leak_current_a_per_cm2".to_owned(),
            values: vec![1.77e-5, 1.89e-5, 2.01e-5, 2.13e-5, 2.25e-5, 2.37e-5, 2.49e-5],
            rises: vec![9.6, 4.2, 1.0, 0.0, 1.0, 3.9, 8.7],
        }],
        held_out_residuals: runs.iter().map(|run| residual(run)).collect(),
        residuals: runs.iter().map(|run| residual(run)).collect(),
        group: "sample=CNaf-01,environment=air".to_owned(),
        runs: runs.iter().map(|run| (*run).to_owned()).collect(),
        ..testing::finding()
    }
}

/// Two runs that are right by themselves and differ in R_ss.
fn varies(runs: &[&str]) -> GroupDiagnosis {
    let hypothesis = |kind: HypothesisKind, mass: f64| Hypothesis {
        kind,
        effect: (kind == HypothesisKind::Effect).then(|| "faradaic-leak".to_owned()),
        parameters_that_differ: match kind {
            HypothesisKind::Varies => vec!["rss_ohm_cm2".to_owned()],
            _ => Vec::new(),
        },
        with: (kind == HypothesisKind::Varies).then(|| "voltage_v".to_owned()),
        mass,
    };
    let value = |(run, step_v, value): (&str, f64, f64)| VaryingValue {
        run: run.to_owned(),
        step_v,
        value,
        standard_error: 0.02 * value,
    };
    let values = [(runs[0], 1.2, 17_900.0), (runs[1], 2.5, 1_900.0)];
    GroupDiagnosis {
        verdict: Verdict::Differs,
        account: Some(account(77.0, 0.0)),
        p_misfit: Some(0.001),
        draws: 999,
        q_misfit: Some(0.004),
        set: vec!["varies:rss_ohm_cm2".to_owned()],
        posterior: vec![
            hypothesis(HypothesisKind::Varies, 0.9991),
            hypothesis(HypothesisKind::Effect, 0.0009),
        ],
        misfit_percent: MisfitPercent {
            current: Some(9.3),
            curvature: None,
            charge: Some(120.0),
        },
        differs: vec![VaryingParameter {
            key: "rss_ohm_cm2".to_owned(),
            with: "voltage_v".to_owned(),
            share_percent: 96.0,
            ratio: Some(Ratio {
                value: 9.4,
                low_95: 8.9,
                high_95: 10.0,
            }),
            values: values.map(value).to_vec(),
        }],
        group: "sample=CNaf-02,environment=air".to_owned(),
        runs: runs.iter().map(|run| (*run).to_owned()).collect(),
        ..testing::finding()
    }
}

/// The troubled campaign with a group for each of five verdicts; one of a hostile name.
pub fn input_with_findings() -> Input {
    let mut input = troubled_input();
    let path = |k: usize| input.runs[k].path.clone();
    let (a, b, c, d) = (path(0), path(1), path(2), path(3));
    let mut set = named(&[&b]);
    set.group = "sample=CNaf-01,environment=<b>vacuum</b>".to_owned();
    set.set.push("diffusion-limited-leak".to_owned());
    set.effects[0].twins = vec!["diffusion-limited-leak".to_owned()];
    set.missing[0].name = None;
    set.missing[0].names.clone_from(&set.set);
    set.next_run = Some(NextRun {
        drive: "reverse the voltage for 600 s".to_owned(),
        splits: vec!["faradaic-leak".to_owned(), "diffusion-limited-leak".to_owned()],
        expected_set_size: 1.0,
    });
    let consistent = GroupDiagnosis {
        verdict: Verdict::Right,
        p_misfit: Some(0.31),
        q_misfit: Some(0.41),
        group: "sample=CPvf-01,environment=air".to_owned(),
        runs: vec![c.clone()],
        ..testing::finding()
    };
    let apart = GroupDiagnosis::data_problem(
        "sample=CPvf-01,environment=air,started_at=2020-02-03",
        vec![d, "runs/gone.csv".to_owned()],
        "lumped-2",
        "Set apart, not diagnosed: not the same series.".to_owned(),
    );
    let varies = varies(&[&a, &b]);
    let mut alone = consistent.clone();
    alone.group.clone_from(&c);
    let turn = ieap::analysis::online::online_decisions(&[0.31])[0];
    input.findings = Findings {
        groups: vec![named(&[&a]), set, consistent, apart, varies],
        runs: vec![alone],
        turns: [(c, turn)].into(),
        shared: Vec::new(),
        effects: effects(),
        laws: Vec::new(),
    };
    let (known, findings) = (effects(), &mut input.findings);
    let about = |id: &str| Some(known.iter().find(|own| own.id == id)?.summary.as_str());
    let found = findings.groups.iter_mut().chain(&mut findings.runs);
    found.for_each(|found| say(found, &about));
    input
}
