//! Values made up for the tests of every room, complete and the same wherever they are asked for: a test writes down
//! only what it is about, `GroupDiagnosis { verdict, ..finding() }`.

pub mod clocks;

use crate::quantiles::NORMAL_95_ROUNDED;
use crate::tag::keys;
use crate::{
    Branch, Campaign, Drive, EffectFinding, Environment, Estimate, Fit, Gain, GroupDiagnosis, HeldOutError,
    HeldOutGain, MissingLaw, Parameter, ParameterShift, RunFile, RunKind, RunRecord, RunState, RunStatus,
    Sample, Tag, TagSource,
};

/// A sample of 5 x 2 x 0.22 mm.
pub fn sample(id: &str, material: &str) -> Sample {
    Sample {
        id: id.to_owned(),
        material: material.to_owned(),
        length_mm: Some(5.0),
        width_mm: Some(2.0),
        thickness_mm: Some(0.22),
        area_cm2: None,
        electrode_resistance_ohm_per_sq: None,
        batch: None,
    }
}

/// Surroundings of which only the humidity is stated, percent, or nothing.
pub fn environment(id: &str, relative_humidity_percent: Option<f64>) -> Environment {
    Environment {
        id: id.to_owned(),
        relative_humidity_percent,
        temperature_c: None,
        pressure_pa: None,
    }
}

/// Two materials, the built-in environments.
pub fn campaign() -> Campaign {
    Campaign {
        id: "made-up".to_owned(),
        title: "Back-relaxation under humidity".to_owned(),
        timezone: None,
        date_order: None,
        answers: Default::default(),
        notice: None,
        samples: vec![sample("CNaf-01", "CNaf"), sample("CPvf-01", "CPvf")].into(),
        materials: vec![],
        environments: ["vacuum", "inert", "air"]
            .map(|id| environment(id, None))
            .to_vec(),
        runs_folder: "runs".to_owned(),
        name_pattern: None,
        dma_folder: "dma".to_owned(),
        dma_name_pattern: None,
        impedance_folder: "impedance".to_owned(),
        impedance_name_pattern: None,
        impedance_circuits: Vec::new(),
        templates_folder: None,
        model: "lumped-2".to_owned(),
        group_by: Vec::new(),
        tolerance_percent: None,
        adopted: Vec::new(),
        sensors: vec![],
        climate: Default::default(),
        monitoring: Default::default(),
        compare: Default::default(),
        study: Default::default(),
        extra_tags: Vec::new(),
        pairs: Default::default(),
        fit: Default::default(),
    }
}

/// A tagged run without a fit.
pub fn run(name: &str, sample: &str, environment: &str, humidity: Option<f64>, voltage_v: f64) -> RunRecord {
    let mut tags = vec![
        tag(keys::SAMPLE, sample),
        tag(keys::ENVIRONMENT, environment),
        tag(keys::VOLTAGE_V, &voltage_v.to_string()),
    ];
    tags.extend(humidity.map(|rh| tag(keys::RELATIVE_HUMIDITY_PERCENT, &rh.to_string())));
    RunRecord {
        kind: RunKind::Actuation,
        id: 0,
        path: format!("runs/{name}.csv"),
        revision: 1,
        state: RunState::Ready,
        status: RunStatus::Complete,
        status_evidence: "the last line ends with a line break".to_owned(),
        format: "plain-csv".to_owned(),
        reader_version: 1,
        technique: None,
        files: vec![RunFile {
            path: format!("runs/{name}.csv"),
            hash: blake3::hash(name.as_bytes()).to_hex().to_string(),
            size_bytes: 48_213,
            aliases: vec![],
        }],
        tags,
        channels: vec![],
        origin: Default::default(),
        drive: Some(Drive::step(voltage_v)),
        area_cm2: Some(0.1),
        data_hash: "0".repeat(64),
        ingested_at: "2026-11-20T06:00:00Z".to_owned(),
        issues: vec![],
        fit: None,
        climate: vec![],
        fit_made_by: None,
        standing: Default::default(),
    }
}

/// A tag read from the file name.
pub fn tag(key: &str, value: &str) -> Tag {
    Tag {
        key: key.to_owned(),
        value: value.to_owned(),
        source: TagSource::FileName,
        detail: "{sample}_{environment}_{voltage_v}V".to_owned(),
    }
}

/// A value with a standard error of `relative` times the value.
pub fn known(value: f64, relative: f64) -> Estimate {
    let error = value * relative;
    Estimate::determined(
        value,
        error,
        value - NORMAL_95_ROUNDED * error,
        value + NORMAL_95_ROUNDED * error,
    )
}

/// A fit with these parameters.
pub fn fit(parameters: &[(&str, Estimate)]) -> Fit {
    Fit {
        model: "lumped-2".to_owned(),
        model_version: 1,
        method: "two-step variable projection".to_owned(),
        converged: true,
        why_stopped: "the cost changed by less than 1e-12".to_owned(),
        n_samples: 1200,
        parameters: parameters
            .iter()
            .map(|(key, estimate)| parameter(key, estimate.clone()))
            .collect(),
        nuisances: vec![],
        r_squared_current: Some(0.996),
        r_squared_curvature: Some(0.957),
        noise: vec![],
        curves: vec![],
        along: vec![],
        issues: vec![],
        evaluations: 321,
        extended: None,
    }
}

/// The parameter of that key.
pub fn parameter(key: &str, estimate: Estimate) -> Parameter {
    Parameter {
        key: key.to_owned(),
        estimate,
    }
}

/// A group `g` of one run `r`, of which nothing is said.
pub fn finding() -> GroupDiagnosis {
    GroupDiagnosis::data_problem("g", vec!["r".to_owned()], "lumped-2", String::new())
}

/// An accepted effect with p = 0.001 and these parameters.
pub fn effect(id: &str, parameters: Vec<Parameter>) -> EffectFinding {
    EffectFinding {
        effect: id.to_owned(),
        variant: None,
        parameters,
        p: 0.001,
        q: None,
        twins: Vec::new(),
    }
}

/// A missing law of that name, with that share of held-out parts better.
pub fn missing_law(name: Option<&str>, better_parts: &str) -> MissingLaw {
    MissingLaw {
        place: "current".to_owned(),
        law: Some("leak".to_owned()),
        of: None,
        variable: Some("voltage_v".to_owned()),
        words: "a current leaks that changes with the voltage".to_owned(),
        name: name.map(str::to_owned),
        names: name.map(str::to_owned).into_iter().collect(),
        probability: 0.98,
        curve: None,
        held_out: HeldOutError {
            error_percent_before: Some(4.1),
            error_percent_after: Some(0.4),
            better_parts: better_parts.to_owned(),
        },
    }
}

/// A fall of the deviance on what was held out, with its standard error and nothing else known.
pub fn held_out(deviance: f64, standard_error: f64) -> HeldOutGain {
    HeldOutGain {
        deviance,
        standard_error,
        parts: Vec::new(),
        nrmse_current_before: None,
        nrmse_current_after: None,
        nrmse_curvature_before: None,
        nrmse_curvature_after: None,
        coverage_before: None,
        coverage_after: None,
    }
}

/// The gain with that proof on a run that was held out.
pub fn gain(proof: HeldOutGain) -> Gain {
    Gain {
        held_out: "run".to_owned(),
        proof,
        outside: None,
        predictions: Vec::new(),
        residual_rms_sigma_before: 20.0,
        residual_rms_sigma_after: 10.0,
        later: None,
    }
}

/// What an extension did to a parameter.
pub fn shift(key: &str, before: f64, after: f64, standard_error: f64) -> ParameterShift {
    ParameterShift {
        key: key.to_owned(),
        before,
        after,
        standard_error,
    }
}

/// A branch of a circuit.
pub fn branch(resistance_ohm_cm2: f64, capacitance_f_per_cm2: f64) -> Branch {
    Branch {
        resistance_ohm_cm2,
        capacitance_f_per_cm2,
    }
}

/// A drive by the start of each segment, s, and its voltage; none of an open circuit.
pub fn drive(baseline_v: f64, levels: &[(f64, Option<f64>)]) -> Drive {
    Drive::of_levels(baseline_v, levels.iter().copied())
}
