//! Runs made up for tests of this module and of the report.

use ieap_domain::quantiles::NORMAL_95_ROUNDED;
use ieap_domain::tag::keys;
use ieap_domain::{
    Campaign, Environment, Estimate, Fit, Parameter, RunFile, RunKind, RunRecord, RunState, RunStatus,
    Sample, Tag, TagSource,
};

/// Two materials, the built-in environments.
pub fn campaign() -> Campaign {
    let sample = |id: &str, material: &str| Sample {
        id: id.to_owned(),
        material: material.to_owned(),
        length_mm: Some(5.0),
        width_mm: Some(2.0),
        thickness_mm: Some(0.22),
        area_cm2: None,
        electrode_resistance_ohm_per_sq: None,
        batch: None,
    };
    let environment = |id: &str| Environment {
        id: id.to_owned(),
        relative_humidity_percent: None,
        temperature_c: None,
        pressure_pa: None,
    };
    Campaign {
        id: "made-up".to_owned(),
        title: "Back-relaxation under humidity".to_owned(),
        timezone: None,
        date_order: None,
        notice: None,
        samples: vec![sample("CNaf-01", "CNaf"), sample("CPvf-01", "CPvf")],
        materials: vec![],
        environments: ["vacuum", "inert", "air"].map(environment).to_vec(),
        runs_folder: "runs".to_owned(),
        name_pattern: None,
        dma_folder: "dma".to_owned(),
        dma_name_pattern: None,
        impedance_folder: "impedance".to_owned(),
        impedance_name_pattern: None,
        model: "lumped-2".to_owned(),
        group_by: Vec::new(),
        adopted: Vec::new(),
        sensors: vec![],
        climate: Default::default(),
        monitoring: Default::default(),
        compare: Default::default(),
        extra_tags: Vec::new(),
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
        drive: Some(ieap_domain::Drive::step(voltage_v)),
        area_cm2: Some(0.1),
        data_hash: "0".repeat(64),
        ingested_at: "2026-11-20T06:00:00Z".to_owned(),
        issues: vec![],
        fit: None,
        climate: vec![],
        fit_code_version: None,
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
            .map(|(key, estimate)| Parameter {
                key: (*key).to_owned(),
                estimate: estimate.clone(),
            })
            .collect(),
        r_squared_current: Some(0.996),
        r_squared_curvature: Some(0.957),
        noise: vec![],
        curves: vec![],
        along: vec![],
        issues: vec![],
        evaluations: 321,
    }
}
