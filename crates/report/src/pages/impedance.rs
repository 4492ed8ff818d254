//! Impedance spectra: whether each can be one, which circuit describes it, and whether a step tells the same circuit.

use ieap_domain::words::counted;
use std::collections::BTreeMap;

use serde::Serialize;

use super::Content;
use super::wording::{EstimateText, IssueText, RunLink};
use crate::error::ReportError;
use crate::figures::Ink;
use crate::figures::relaxation::relaxation;
use crate::figures::spectrum::{DrawnFit, bode, nyquist, residuals};
use crate::pages::policy::MOST_SECTIONS;
use crate::site::Site;
use ieap_analysis::impedance::{Comparison, StepSide};
use ieap_domain::number::{fixed, plain, significant};
use ieap_domain::tag::keys;
use ieap_domain::{
    Consistency, Issue, KramersKronig, RelaxationPeak, RelaxationTimes, SpectrumAnalysis, SpectrumRun, Sweep,
    ZHit,
};

/// Circuits that every spectrum is fitted with; others were asked for, and are drawn.
const BUILT_IN: [&str; 5] = [
    "lumped-1",
    "lumped-2",
    "constant-phase",
    "warburg-finite",
    "warburg-parallel",
];
/// Keys of the circuits' numbers with how pages print them.
const LABELS: [(&str, &str); 12] = [
    ("r1_ohm", "R₁ (Ω)"),
    ("c1_f", "C₁ (F)"),
    ("r2_ohm", "R₂ (Ω)"),
    ("c2_f", "C₂ (F)"),
    ("rss_ohm", "R_ss (Ω)"),
    ("cpe_s_sn", "Q (S sⁿ)"),
    ("cpe_exponent", "n"),
    ("rw_ohm", "R_W (Ω)"),
    ("cw_f", "C_W (F)"),
    ("warburg_s_s05", "Y_W (S s^½)"),
    ("c_total_f", "C_total (F)"),
    ("r_parallel_ohm", "R∥ (Ω)"),
];
/// Ends of the keys of circuits as texts with their units; an exponent is `n`.
const UNITS: [(&str, &str); 7] = [
    ("ohm", "Ω"),
    ("f", "F"),
    ("h", "H"),
    ("s", "s"),
    ("s_sn", "S sⁿ"),
    ("s_s05", "S s^½"),
    ("exponent", "n"),
];
/// The same per unit area.
const OF_AREA: [(&str, &str); 7] = [
    ("r1_ohm_cm2", "R₁ (Ω cm²)"),
    ("c1_f_per_cm2", "C₁ (F/cm²)"),
    ("r2_ohm_cm2", "R₂ (Ω cm²)"),
    ("c2_f_per_cm2", "C₂ (F/cm²)"),
    ("rss_ohm_cm2", "R_ss (Ω cm²)"),
    ("c_total_f_per_cm2", "C_total (F/cm²)"),
    ("r_parallel_ohm_cm2", "R∥ (Ω cm²)"),
];

#[derive(Debug, Serialize)]
struct ImpedancePage {
    findings: Vec<String>,
    beside: Vec<BesideSection>,
    sweeps: Vec<Section>,
    more: String,
    not_analysed: Vec<NotAnalysed>,
}

#[derive(Debug, Serialize)]
struct BesideSection {
    heading: String,
    sentences: Vec<String>,
    runs: Vec<RunLink>,
    lowest: String,
    highest: String,
    rows: Vec<BesideText>,
}

#[derive(Debug, Serialize)]
struct BesideText {
    name: &'static str,
    spectrum: EstimateText,
    step: EstimateText,
    highest: Option<EstimateText>,
    ratio: EstimateText,
    verdict: &'static str,
}

#[derive(Debug, Serialize)]
struct Section {
    anchor: String,
    heading: String,
    facts: Vec<(String, String)>,
    test: String,
    nyquist: String,
    bode: String,
    residuals: String,
    z_hit: String,
    relaxation: String,
    relaxation_figure: String,
    circuits: Vec<Circuit>,
    issues: Vec<IssueText>,
}

#[derive(Debug, Serialize)]
struct Circuit {
    name: String,
    verdict: &'static str,
    residual: String,
    bic: String,
    numbers: Vec<(String, EstimateText)>,
}

#[derive(Debug, Serialize)]
struct NotAnalysed {
    path: String,
    issues: Vec<IssueText>,
}

/// Makes the page.
pub fn content(site: &Site) -> Result<Content, ReportError> {
    let mut figures = BTreeMap::new();
    let all: Vec<(&SpectrumRun, usize, &Sweep)> = (site.input.spectra.iter())
        .flat_map(|run| {
            run.sweeps
                .iter()
                .enumerate()
                .map(move |(at, sweep)| (run, at, sweep))
        })
        .collect();
    let analysed: Vec<(&SpectrumRun, usize, &Sweep, &SpectrumAnalysis)> = all
        .iter()
        .filter_map(|(run, at, sweep)| Some((*run, *at, *sweep, sweep.analysis.as_ref().ok()?)))
        .collect();
    let sections = analysed.iter().take(MOST_SECTIONS).enumerate();
    let sweeps: Result<Vec<Section>, ReportError> = sections
        .map(|(number, (run, at, sweep, found))| section(site, run, *at, sweep, found, number, &mut figures))
        .collect();
    let left_out = analysed.len().saturating_sub(MOST_SECTIONS);
    let refused = all.iter().filter_map(|(run, at, sweep)| {
        let issue = sweep.analysis.as_ref().err()?;
        Some(NotAnalysed {
            path: heading(run, *at),
            issues: vec![IssueText::from(issue)],
        })
    });
    let page = ImpedancePage {
        findings: findings(site),
        beside: site
            .input
            .spectra_beside
            .iter()
            .map(|found| beside(site, found))
            .collect(),
        sweeps: sweeps?,
        more: match left_out {
            0 => String::new(),
            _ => format!(
                "{} more stand in the table impedance.",
                counted(left_out, "spectrum")
            ),
        },
        not_analysed: refused.collect(),
    };
    Content::new("impedance.html", &page, figures)
}

/// What the spectra say in sentences, comparisons first.
pub fn findings(site: &Site) -> Vec<String> {
    let mut sentences: Vec<String> = Vec::new();
    for found in &site.input.spectra_beside {
        let run = site
            .input
            .spectra
            .iter()
            .find(|run| run.run.path == found.spectrum);
        let name = run.map_or(found.spectrum.clone(), |run| heading(run, found.sweep));
        sentences.extend(found.sentences.first().map(|first| format!("{name}: {first}")));
    }
    let sweeps = site.input.spectra.iter().flat_map(|run| &run.sweeps);
    let violated = sweeps
        .filter_map(|sweep| sweep.analysis.as_ref().ok())
        .filter(|found| found.kramers_kronig.verdict == Consistency::Violated)
        .count();
    if violated > 0 {
        sentences.push(match violated {
            1 => "One spectrum is no impedance of anything linear and unchanging at some frequencies (Kramers-Kronig).".to_owned(),
            count => format!(
                "{count} spectra are no impedance of anything linear and unchanging at some frequencies (Kramers-Kronig)."
            ),
        });
    }
    sentences
}

/// Sample and surroundings, else the file.
fn heading(run: &SpectrumRun, sweep: usize) -> String {
    let record = &run.run;
    let mut words: Vec<String> = [keys::SAMPLE, keys::ENVIRONMENT]
        .iter()
        .filter_map(|key| record.tag(key).map(str::to_owned))
        .collect();
    let humidity = record.tag_number(keys::RELATIVE_HUMIDITY_PERCENT);
    words.extend(humidity.map(|percent| format!("{}\u{a0}%\u{a0}RH", fixed(percent, 0))));
    if record.tag(keys::SAMPLE).is_none() {
        words = vec![record.path.clone()];
    }
    if run.sweeps.len() > 1 {
        words.push(format!("sweep {}", sweep + 1));
    }
    words.join(", ")
}

fn section(
    site: &Site,
    run: &SpectrumRun,
    at: usize,
    sweep: &Sweep,
    found: &SpectrumAnalysis,
    number: usize,
    figures: &mut BTreeMap<String, String>,
) -> Result<Section, ReportError> {
    let heading = heading(run, at);
    let mut drawn: Vec<DrawnFit> = Vec::new();
    let asked = found.circuits.iter().map(|fit| fit.circuit.as_str());
    let asked = asked.filter(|id| !BUILT_IN.contains(id));
    let inks = [("lumped-2", Ink::Vermillion), (&found.best, Ink::Blue)];
    for (circuit, ink) in inks.into_iter().chain(asked.map(|id| (id, Ink::Green))) {
        let is_new = drawn.iter().all(|fit| fit.name != circuit);
        drawn.extend(found.circuit(circuit).filter(|_| is_new).map(|fit| DrawnFit {
            name: circuit.to_owned(),
            fit,
            ink,
        }));
    }
    let names: Vec<&str> = drawn.iter().map(|fit| fit.name.as_str()).collect();
    let desc = format!(
        "Circles: readings; lines: the fitted circuits {}.",
        names.join(" and ")
    );
    let mut draw = |kind: &str, svg: Result<String, String>| -> Result<String, ReportError> {
        let id = format!("{kind}-{}", number + 1);
        let svg = svg.map_err(|reason| ReportError::Figure {
            figure: id.clone(),
            reason,
        })?;
        figures.insert(id.clone(), svg);
        Ok(id)
    };
    let title = |what: &str| format!("{what} of {heading}");
    let left =
        "What Voigt elements leave of the real (blue) and the imaginary part (vermillion), percent of |Z|.";
    let own = found.issues.iter();
    let issues: Vec<&Issue> = run.run.issues.iter().chain(own).collect();
    Ok(Section {
        anchor: format!("spectrum-{}", number + 1),
        facts: facts(site, run, sweep),
        test: test(&found.kramers_kronig),
        nyquist: draw(
            "nyquist",
            nyquist(&sweep.spectrum, &drawn, &title("Nyquist plot"), &desc),
        )?,
        bode: draw("bode", bode(&sweep.spectrum, &drawn, &title("Bode plot"), &desc))?,
        residuals: draw(
            "residuals",
            residuals(
                &sweep.spectrum,
                &found.kramers_kronig,
                &title("Kramers-Kronig test"),
                left,
            ),
        )?,
        z_hit: found.z_hit.as_ref().map_or(String::new(), z_hit),
        relaxation: found.relaxation.as_ref().map_or(String::new(), relaxation_words),
        relaxation_figure: match &found.relaxation {
            Some(told) => draw(
                "relaxation",
                relaxation(told, &title("Relaxation times"), RELAXATION),
            )?,
            None => String::new(),
        },
        circuits: circuits(found),
        issues: issues.into_iter().map(IssueText::from).collect(),
        heading,
    })
}

/// What stands under the figure of the relaxation times.
const RELAXATION: &str = "Resistance for a unit of the natural logarithm of the time constant; the frequencies tell of what lies \
     between the dashed lines; dots are peaks.";

fn z_hit(found: &ZHit) -> String {
    let (low, high) = found.lowest_hz;
    let side = if found.lowest_percent < 0.0 {
        "below"
    } else {
        "above"
    };
    let seen = format!(
        "between {} and {} Hz |Z| lies {}\u{a0}% {side} what its phase gives, where noise and the method explain {}\u{a0}%.",
        significant(low, 2),
        significant(high, 2),
        significant(found.lowest_percent.abs(), 2),
        significant(found.limit_percent, 2)
    );
    if found.drifts {
        format!("It drifted during the sweep (Z-HIT): {seen}")
    } else {
        format!("No drift is seen (Z-HIT): {seen}")
    }
}

fn relaxation_words(found: &RelaxationTimes) -> String {
    let peak = |peak: &RelaxationPeak| {
        format!(
            "{}\u{a0}s with {}\u{a0}Ω",
            significant(peak.tau_s, 2),
            significant(peak.resistance_ohm, 2)
        )
    };
    let peaks: Vec<String> = found.peaks.iter().map(peak).collect();
    let peaks = match peaks.as_slice() {
        [] => "Relaxation times: no peak.".to_owned(),
        [only] => format!("Relaxation times: one peak, at {only}."),
        several => format!(
            "Relaxation times: {} peaks, at {}.",
            several.len(),
            several.join(", ")
        ),
    };
    let left = if found.describes {
        String::new()
    } else {
        " It does not describe the spectrum.".to_owned()
    };
    format!(
        "{peaks} The smoothest distribution that leaves no more than the readings scatter (Tikhonov, λ\u{a0}=\u{a0}{}) leaves {}\u{a0}% of |Z|.{left}",
        significant(found.regularisation, 2),
        significant(found.residual_rms_percent, 2)
    )
}

fn facts(site: &Site, run: &SpectrumRun, sweep: &Sweep) -> Vec<(String, String)> {
    let record = &run.run;
    let sample = record
        .tag(keys::SAMPLE)
        .and_then(|id| site.input.campaign.sample(id));
    let mut facts = Vec::new();
    facts.extend(sample.map(|sample| ("material", sample.material.clone())));
    facts.push(("frequencies", sweep.spectrum.len().to_string()));
    facts.extend(sweep.spectrum.range_hz().map(|(low, high)| {
        (
            "range",
            format!("{} to {} Hz", significant(low, 2), significant(high, 2)),
        )
    }));
    facts.extend(
        record
            .area_cm2
            .map(|area| ("area", format!("{} cm²", plain(area)))),
    );
    for (name, key) in [("instrument", keys::INSTRUMENT), ("started", keys::STARTED_AT)] {
        facts.extend(record.tag(key).map(|text| (name, text.to_owned())));
    }
    facts.push((
        "file",
        format!(
            "{} ({}, revision {})",
            record.path, record.format, record.revision
        ),
    ));
    facts
        .into_iter()
        .map(|(key, value)| (key.to_owned(), value))
        .collect()
}

fn test(found: &KramersKronig) -> String {
    let rest = format!(
        "{} Voigt elements leave {}\u{a0}% of |Z|; neighbouring readings scatter by {}\u{a0}%.",
        found.elements,
        significant(found.residual_rms_percent, 2),
        significant(found.scatter_percent, 2)
    );
    match (found.verdict, found.off_hz) {
        (Consistency::Consistent, _) => format!("It can be an impedance (Kramers-Kronig): {rest}"),
        (Consistency::Violated, Some((low, high))) => format!(
            "Between {} and {} Hz it is no impedance of anything linear and unchanging (Kramers-Kronig): neighbouring readings lie \
             {}\u{a0}% of |Z| off together. {rest}",
            significant(low, 2),
            significant(high, 2),
            significant(found.largest_mean_percent, 2)
        ),
        _ => "Kramers-Kronig is not tested: there are too few frequencies.".to_owned(),
    }
}

/// A key as pages print it: `cpe1_s_sn` of a circuit as a text is `CPE1 (S sⁿ)`.
fn label(key: &str) -> String {
    if let Some((_, label)) = LABELS.iter().find(|(known, _)| *known == key) {
        return (*label).to_owned();
    }
    let (name, unit) = key.split_once('_').unwrap_or((key, ""));
    let name = match name.chars().next() {
        Some('w') => format!("W{}", &name[1..]),
        _ => name.to_uppercase(),
    };
    match UNITS.iter().find(|(known, _)| *known == unit) {
        Some((_, unit)) => format!("{name} ({unit})"),
        None => format!("{name} {unit}"),
    }
}

fn circuits(found: &SpectrumAnalysis) -> Vec<Circuit> {
    let circuit = |fit: &ieap_domain::CircuitFit| Circuit {
        name: fit.circuit.clone(),
        verdict: match (fit.circuit == found.best, fit.describes) {
            (true, true) => "describes it best",
            (true, false) => "best, and does not describe it",
            (false, true) => "describes it",
            (false, false) => "does not describe it",
        },
        residual: significant(fit.residual_rms_percent, 3),
        bic: fixed(fit.bic_above_best, 0),
        numbers: (fit.parameters.iter())
            .map(|parameter| (label(&parameter.key), EstimateText::of(&parameter.estimate, 1.0)))
            .collect(),
    };
    found.circuits.iter().map(circuit).collect()
}

fn beside(site: &Site, found: &Comparison) -> BesideSection {
    let run = site
        .input
        .spectra
        .iter()
        .find(|run| run.run.path == found.spectrum);
    let sides = found.highest.iter().chain([&found.lowest]);
    let link = |path: &String| {
        let at = site.input.runs.iter().position(|run| run.path == *path)?;
        Some(RunLink::to(site, at))
    };
    let volts = |side: &StepSide| format!("{}\u{a0}V", plain(side.voltage_v));
    let label = |key: &str| {
        OF_AREA
            .iter()
            .find(|(known, _)| *known == key)
            .map(|(_, label)| *label)
    };
    BesideSection {
        heading: run.map_or(found.spectrum.clone(), |run| heading(run, found.sweep)),
        sentences: found.sentences.clone(),
        runs: sides.flat_map(|side| side.runs.iter().filter_map(link)).collect(),
        lowest: volts(&found.lowest),
        highest: found.highest.as_ref().map_or(String::new(), volts),
        rows: (found.rows.iter())
            .filter_map(|row| {
                Some(BesideText {
                    name: label(row.key)?,
                    spectrum: EstimateText::of(&row.spectrum, 1.0),
                    step: EstimateText::of(&row.step, 1.0),
                    highest: row.step_at_highest.as_ref().map(|own| EstimateText::of(own, 1.0)),
                    ratio: EstimateText::of(&row.ratio, 1.0),
                    verdict: match row.agrees {
                        Some(true) => "agree",
                        Some(false) => "differ",
                        None => "cannot be compared",
                    },
                })
            })
            .collect(),
    }
}
