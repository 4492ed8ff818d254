//! A made-up campaign for the tests and the benchmark of the report: runs, fits and curves from formulas.

use ieap::analysis::frequency::{FrequencyPoint, FrequencyRun, PerVolt};
use ieap::analysis::laws::doubt::Doubts;
use ieap::analysis::study::{Evidence, Study};
use ieap::domain::tag::keys;
use ieap::domain::{
    Campaign, ChannelNoise, ChannelSummary, CurveSource, Estimate, FileState, Fit, Issue, MadeBy, Quantity,
    RunCurve, RunFile, RunRecord, RunState, SourceFile, Tag, TagSource, testing,
};
use ieap::numerics::complex::Complex;
use ieap::report::{Findings, Input, Origin};

/// Readings of each drawn curve.
const DRAWN: usize = 450;
/// Surroundings with their humidity, percent.
const SURROUNDINGS: [(&str, Option<f64>); 3] = [("vacuum", None), ("inert", None), ("air", Some(34.0))];
/// Steps, V.
const VOLTAGES_V: [f64; 3] = [1.2, 2.0, 2.5];

/// The campaign with these materials, one sample each.
pub fn campaign(materials: &[&str]) -> Campaign {
    let sample = |material: &&str| testing::sample(&format!("{material}-01"), material);
    Campaign {
        title: "CNaf and CPvf in vacuum, nitrogen and humid air".to_owned(),
        timezone: Some("Europe/Tallinn".to_owned()),
        notice: Some("Simulated, not measured.".to_owned()),
        samples: materials.iter().map(sample).collect(),
        ..testing::campaign()
    }
}

/// True parameters of a made-up material; `water` is 0 in dry surroundings and rises with the voltage in air.
#[derive(Clone, Copy)]
struct Truth {
    r: [f64; 2],
    c: [f64; 2],
    rss_ohm_cm2: f64,
    alpha_per_c_cm: f64,
    lambda_per_s: f64,
}

fn truth(ionic: bool, water: f64, voltage_v: f64) -> Truth {
    if ionic {
        Truth {
            r: [
                90.0 + 400.0 * water / voltage_v.abs().max(1.0),
                330.0 + 500.0 * water,
            ],
            c: [0.04 + 0.02 * water * voltage_v, 0.10 + 0.04 * water],
            rss_ohm_cm2: 71_000.0 / (1.0 + 14.0 * water * voltage_v),
            alpha_per_c_cm: 23.0 - 9.5 * water,
            lambda_per_s: 1.1e-4 * (1.0 + 2.6 * water * (voltage_v - 1.0)).powi(3),
        }
    } else {
        Truth {
            r: [36.0 - 14.0 * water, 74.0 - 32.0 * water],
            c: [0.042, 1.4 + 0.4 * water],
            rss_ohm_cm2: 1_700.0 / (1.0 + 0.6 * water * voltage_v),
            alpha_per_c_cm: 4.2 - 1.1 * water,
            lambda_per_s: 2.1e-5 + 9e-5 * water,
        }
    }
}

/// An estimate that misses the truth by `miss` standard errors of `relative` each.
fn estimate(truth: f64, relative: f64, miss: f64) -> Estimate {
    let error = truth * relative;
    let value = truth + miss * error;
    Estimate::determined(value, error, value - 1.96 * error, value + 1.96 * error)
}

/// A number in -1..1 that depends on `seed` only.
fn noise(seed: u64) -> f64 {
    let mixed = seed
        .wrapping_mul(0x9e37_79b9_7f4a_7c15)
        .rotate_left(31)
        .wrapping_mul(0xbf58_476d_1ce4_e5b9);
    (mixed >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

/// Run number `index` of `material` with everything a page shows.
pub fn run(index: usize, material: &str, surroundings: usize, voltage_v: f64, repeat: usize) -> RunRecord {
    let (environment, humidity) = SURROUNDINGS[surroundings];
    let path = format!("runs/{material}-01_{environment}_{voltage_v}V_{repeat}.csv");
    let mut tags = vec![
        tag(keys::SAMPLE, &format!("{material}-01")),
        tag(keys::ENVIRONMENT, environment),
        tag(keys::VOLTAGE_V, &voltage_v.to_string()),
        tag(
            keys::STARTED_AT,
            &format!("2026-11-{:02}T{:02}:00:00Z", 1 + index / 24 % 28, index % 24),
        ),
    ];
    tags.extend(humidity.map(|rh| {
        tag(
            keys::RELATIVE_HUMIDITY_PERCENT,
            &(rh + noise(index as u64)).to_string(),
        )
    }));
    tags.push(Tag {
        source: TagSource::Header,
        detail: "VSTEP1".to_owned(),
        ..tag(keys::VOLTAGE_V, "1.19")
    });
    let water = if humidity.is_some() { 1.0 } else { 0.0 };
    let truth = truth(material == "CNaf", water, voltage_v);
    RunRecord {
        id: index as i64 + 1,
        files: vec![RunFile {
            hash: format!("{:064x}", index + 1),
            path: path.clone(),
            size_bytes: 48_213,
            aliases: vec![],
        }],
        path,
        tags,
        channels: vec![
            channel(Quantity::Current, 2e-5),
            channel(Quantity::Curvature, 0.31),
        ],
        data_hash: "5f".repeat(32),
        fit: Some(fit(truth, index as u64, material == "CNaf")),
        fit_made_by: Some(MadeBy::new("ieap 0.1.0", "unknown")),
        ..testing::run("", "", environment, humidity, voltage_v)
    }
}

/// A tag read from the file name.
pub fn tag(key: &str, value: &str) -> Tag {
    Tag {
        key: key.to_owned(),
        value: value.to_owned(),
        source: TagSource::FileName,
        detail: "{sample}_{environment}_{voltage_v}V_{cycle}".to_owned(),
    }
}

fn channel(quantity: Quantity, last: f64) -> ChannelSummary {
    ChannelSummary {
        quantity,
        raw_name: quantity.column().to_owned(),
        raw_unit: quantity.unit().to_owned(),
        position_mm: None,
        readings: 3610,
        excluded: 3,
        first_time_s: Some(-10.0),
        last_time_s: Some(3600.0),
        first: Some(0.0),
        last: Some(last),
    }
}

fn fit(truth: Truth, seed: u64, ionic: bool) -> Fit {
    let miss = |k: u64| 1.2 * noise(31 * seed + k);
    let lambda = if truth.lambda_per_s < 3e-5 {
        Estimate::below(4.2e-5, "the run is too short against 1/λ")
    } else {
        estimate(truth.lambda_per_s, 0.06, miss(7))
    };
    let parallel = 1.0 / (1.0 / truth.r[0] + 1.0 / truth.r[1]);
    let ratio = if ionic { 1.08 } else { 12.4 };
    let parameters = [
        ("r1_ohm_cm2", estimate(truth.r[0], 0.011, miss(1))),
        ("c1_f_per_cm2", estimate(truth.c[0], 0.023, miss(2))),
        ("r2_ohm_cm2", estimate(truth.r[1], 0.031, miss(3))),
        ("c2_f_per_cm2", estimate(truth.c[1], 0.018, miss(4))),
        ("rss_ohm_cm2", estimate(truth.rss_ohm_cm2, 0.027, miss(5))),
        ("alpha_per_c_cm", estimate(truth.alpha_per_c_cm, 0.013, miss(6))),
        ("lambda_per_s", lambda),
        (
            "c_total_f_per_cm2",
            estimate(truth.c[0] + truth.c[1], 0.012, miss(8)),
        ),
        ("r_parallel_ohm_cm2", estimate(parallel, 0.02, miss(9))),
    ];
    Fit {
        n_samples: 7214,
        r_squared_current: Some(if ionic { 0.9962 } else { 0.9731 }),
        r_squared_curvature: Some(0.9874),
        noise: vec![
            channel_noise(Quantity::Current, 1.4e-6, ratio, if ionic { 0.05 } else { 0.97 }),
            channel_noise(Quantity::Curvature, 4e-4, 1.1, 0.1),
        ],
        ..testing::fit(&parameters)
    }
}

fn channel_noise(quantity: Quantity, standard_deviation: f64, ratio: f64, correlation: f64) -> ChannelNoise {
    ChannelNoise {
        quantity,
        standard_deviation,
        basis: "second differences".to_owned(),
        character: Default::default(),
        residual_autocorrelation: correlation,
        residual_rms: ratio * standard_deviation,
        readings: 3607,
        r_squared: None,
    }
}

/// `repeats` runs of each material in each condition, in the thesis's order, with nothing wrong.
pub fn input(materials: &[&str], repeats: usize) -> Input {
    let mut runs = Vec::new();
    for material in materials {
        for surroundings in 0..SURROUNDINGS.len() {
            for voltage_v in VOLTAGES_V {
                for repeat in 1..=repeats {
                    runs.push(run(runs.len(), material, surroundings, voltage_v, repeat));
                }
            }
        }
    }
    let campaign = campaign(materials);
    let study = Study::of(Evidence {
        runs: &runs,
        campaign: &campaign,
        doubts: &Doubts::default(),
        curves: &[],
    });
    Input {
        next_runs: Vec::new(),
        campaign,
        climate: Default::default(),
        doubts: Default::default(),
        doubted: Vec::new(),
        study,
        monitoring: Default::default(),
        faults: vec![],
        run_spans_s: vec![],
        comparisons: vec![],
        outdated_comparisons: 0,
        before: Default::default(),
        templates: Default::default(),
        runs,
        set_aside: vec![],
        modulus_logs: vec![],
        spectra: Default::default(),
        blocked: vec![],
        frequency: vec![],
        model_free: vec![],
        cycles: vec![],
        electrodes: vec![],
        superseded: vec![],
        file_stories: Vec::new(),
        files: vec![],
        findings: Findings::default(),
        origin: Origin {
            program: "ieap 0.1.0".to_owned(),
            database: "change 412 of 20 Nov 2026, 06:00 UTC".to_owned(),
        },
    }
}

/// A chirp whose response is that of one branch, and a sine whose fit tells no circuit.
pub fn frequency_runs(input: &Input) -> Vec<FrequencyRun> {
    let point = |frequency_hz: f64, half: f64| {
        let lag = Complex::new(1.0, 40.0 * frequency_hz);
        let per_volt = |value: Complex| {
            Some(PerVolt {
                value,
                half_95: half * value.magnitude(),
            })
        };
        FrequencyPoint {
            frequency_hz,
            current: per_volt(Complex::new(2e-5, 8e-3 * frequency_hz) / lag),
            curvature: per_volt(Complex::new(0.3, 0.0) / lag),
        }
    };
    let run = |at: usize, waveform, frequencies: &[f64], has_line: bool| FrequencyRun {
        run_id: input.runs[at].id,
        path: input.runs[at].path.clone(),
        waveform,
        amplitude_v: 2.0,
        measured: frequencies.iter().map(|&f| point(f, 0.05)).collect(),
        modelled: frequencies
            .iter()
            .filter(|_| has_line)
            .map(|&f| point(f, 0.0))
            .collect(),
        line: (0..60)
            .filter(|_| has_line)
            .map(|k| point(1e-3 * 1.1_f64.powi(k), 0.0))
            .collect(),
    };
    vec![
        run(0, "chirp", &[2e-3, 6e-3, 0.02, 0.06, 0.2], true),
        run(1, "sine", &[0.1], false),
    ]
}

/// The same campaign with everything that can be wrong, and names that try to be markup.
pub fn troubled_input() -> Input {
    let mut input = input(&["CNaf", "CPvf"], 1);
    input.runs.remove(4);
    let next = input.runs.len();
    let mut repeat = run(40, "CNaf", 2, 2.5, 2);
    repeat.path = "runs/a\"b.csv".to_owned();
    input.runs.push(repeat);
    let mut hostile = run(41, "<script>alert(1)</script>", 2, 2.5, 1);
    hostile.path = "runs/<script>alert(1)</script>.csv".to_owned();
    hostile.tags.push(tag(
        "note",
        "\u{1b}[31mred\u{1b}[0m <img src=x onerror=alert(2)> \u{202e}gpj",
    ));
    hostile.status_evidence = "</dd><script>alert(3)</script>".to_owned();
    input.runs.push(hostile);
    let mut untagged = run(42, "CNaf", 0, 1.2, 9);
    untagged.path = "runs/lost\u{fffd}\u{fffd}.csv".to_owned();
    untagged.tags.retain(|tag| tag.key != keys::ENVIRONMENT);
    untagged.state = RunState::Untagged;
    untagged.fit = None;
    untagged.issues = vec![
        Issue::error("tag-missing", "no environment is known")
            .at("environment")
            .mend("ieap tag 'runs/lost.csv' environment=air"),
    ];
    input.runs.push(untagged);
    trouble_fits(&mut input.runs[..next]);
    let mut earlier = input.runs[2].clone();
    input.runs[2].revision = 2;
    earlier.files[0].hash = "ab".repeat(32);
    input.superseded.push(earlier);
    input.files = troubled_files();
    input
}

fn trouble_fits(runs: &mut [RunRecord]) {
    if let Some(fit) = &mut runs[0].fit {
        fit.converged = false;
        fit.why_stopped = "200 iterations were not enough".to_owned();
    }
    for run in &mut runs[5..8] {
        let fit = run.fit.as_mut().expect("fitted");
        let alpha = fit
            .parameters
            .iter_mut()
            .find(|p| p.key == "alpha_per_c_cm")
            .expect("alpha");
        alpha.estimate = Estimate::not_determined("the run has no curvature channel");
        fit.issues.push(
            Issue::warning(
                "no-curvature",
                "alpha and lambda are not determined: there is no curvature channel",
            )
            .mend("add a.curvature.csv beside the file"),
        );
    }
    runs[9]
        .issues
        .push(Issue::warning("overload-excluded", "3 readings are overloads and left out").at("column Im"));
}

fn troubled_files() -> Vec<SourceFile> {
    let file = |path: &str, state, issue| SourceFile {
        path: path.to_owned(),
        size_bytes: 812,
        modified_ns: 0,
        state,
        issue: Some(issue),
        missing: false,
    };
    vec![
        file(
            "runs/<b>bad</b>.csv",
            FileState::Refused,
            Issue::error("bad-number", "found \"1;2\" where a number is needed")
                .at("line 17, column 3")
                .mend("export with a decimal point"),
        ),
        file(
            "runs/empty.csv",
            FileState::Pending,
            Issue::note("empty", "the file is empty").mend("nothing to do; it is read when it grows"),
        ),
    ]
}

/// Fifteen steps of one sample in one environment, with a current only.
pub fn current_only_input() -> Input {
    let mut input = input(&["CNaf"], 1);
    input.campaign.title = "Potentiostatic steps across the onset of electrolysis".to_owned();
    input.campaign.notice = None;
    input.runs = (0..15)
        .map(|k| {
            let voltage_v = -0.05 * f64::from(k);
            let mut run = run(k as usize, "CNaf", 1, voltage_v, 1);
            run.channels.truncate(1);
            let fit = run.fit.as_mut().expect("fitted");
            for parameter in &mut fit.parameters {
                if parameter.key.starts_with("alpha") || parameter.key.starts_with("lambda") {
                    parameter.estimate = Estimate::not_determined("no run has a curvature channel");
                }
            }
            fit.r_squared_curvature = None;
            fit.noise.truncate(1);
            run
        })
        .collect();
    input
}

/// Curves computed on demand; runs without a fit have readings only.
pub struct MadeUpCurves {
    fitted: Vec<bool>,
    quantities: Vec<usize>,
}

impl MadeUpCurves {
    /// Curves for the runs of `input`, by id.
    pub fn of(input: &Input) -> MadeUpCurves {
        let last = input.records().map(|run| run.id as usize).max().unwrap_or(0);
        let mut curves = MadeUpCurves {
            fitted: vec![false; last + 1],
            quantities: vec![0; last + 1],
        };
        for run in input.records() {
            curves.fitted[run.id as usize] = run.fit.is_some();
            curves.quantities[run.id as usize] = run.channels.len();
        }
        curves
    }
}

impl CurveSource for MadeUpCurves {
    fn curves(&self, run_id: i64) -> Result<Vec<RunCurve>, String> {
        let index = run_id as usize;
        let fitted = *self
            .fitted
            .get(index)
            .ok_or_else(|| format!("run {run_id} has no curves"))?;
        let all = [(Quantity::Current, 1.4e-6), (Quantity::Curvature, 4e-4)];
        let shown = all.into_iter().take(self.quantities[index]);
        Ok(shown
            .map(|(quantity, sigma)| curve(quantity, sigma, run_id as u64, fitted))
            .collect())
    }

    fn drawn_from(&self, run_id: i64) -> Result<Option<String>, String> {
        Ok(self
            .fitted
            .get(run_id as usize)
            .map(|fitted| format!("{run_id} {fitted}")))
    }
}

fn curve(quantity: Quantity, sigma: f64, seed: u64, fitted: bool) -> RunCurve {
    let time_s: Vec<f64> = (0..DRAWN)
        .map(|k| match k {
            0..=20 => -10.0 + 0.5 * k as f64 - 0.001,
            _ => 0.1 * (36_000f64.ln() * (k - 21) as f64 / (DRAWN - 22) as f64).exp(),
        })
        .collect();
    let response = |t: f64| match quantity {
        _ if t < 0.0 => 0.0,
        Quantity::Current => 2.5e-4 * ((-t / 4.0).exp() + 0.3 * (-t / 35.0).exp()) + 4e-6,
        _ => 0.42 * ((-t / 2600.0).exp() - (-t / 21.0).exp()),
    };
    let model: Vec<f64> = time_s.iter().map(|&t| response(t)).collect();
    let deviation = |k: usize| noise(1000 * seed + k as u64) * 1.7 + 0.4 * (time_s[k] / 300.0).sin();
    let measured = (0..DRAWN).map(|k| model[k] + sigma * deviation(k)).collect();
    RunCurve {
        quantity,
        residual_sigma: if fitted {
            (0..DRAWN).map(deviation).collect()
        } else {
            vec![]
        },
        fitted: if fitted { model } else { vec![] },
        measured,
        time_s,
        readings: 3610,
    }
}
