//! What the page of impedance shows and `ieap run --only impedance` prints: whether each spectrum can be an impedance, which circuit describes
//! it, and whether a step tells the same circuit.

use ieap_domain::number::{fixed, plain, significant};
use ieap_domain::tag::keys;
use ieap_domain::words::{counted, in_a_row};
use ieap_domain::{
    Campaign, Consistency, KramersKronig, RelaxationTimes, SpectrumAnalysis, SpectrumRun, Sweep, ZHit,
};
use ieap_show::Block;

use super::beside::Comparison;
use super::sheet::{Analysed, beside, circuits};
use super::{Spectra, charts};

/// Columns that the title of a spectrum's part says already, and the key that its symbol stands for.
const SAID: [&str; 5] = [
    "spectrum",
    "sample",
    "environment",
    "relative_humidity_percent",
    "number",
];

/// Everything, comparisons first.
pub fn view(spectra: &Spectra, campaign: &Campaign) -> Vec<Block> {
    let mut blocks: Vec<Block> = findings(spectra).into_iter().map(Block::Say).collect();
    if spectra.runs.is_empty() {
        blocks.push(Block::say(super::sheet::NO_SPECTRUM));
    }
    blocks.extend(Block::issues(&spectra.refused_circuits));
    if !spectra.beside_steps.is_empty() {
        let lead = "The circuit of the step's fit, fitted to the spectrum of the same sample in the same environment and humidity; numbers per unit area. The step at the lowest voltage is nearest to the small voltage of a spectrum.";
        let found = spectra
            .beside_steps
            .iter()
            .map(|found| of_comparison(spectra, found));
        let blocks_of = [Block::say(lead)].into_iter().chain(found).collect();
        blocks.push(Block::part(
            "Beside the steps: is it the same circuit?",
            blocks_of,
        ));
    }
    blocks.extend(charts::over_voltage(&spectra.runs).map(Block::Chart));
    for run in &spectra.runs {
        let sweeps = run.sweeps.iter().enumerate();
        blocks.extend(sweeps.map(|(at, sweep)| of_sweep(spectra, (run, at), sweep, campaign)));
    }
    blocks
}

/// What the spectra say in sentences, comparisons first.
pub fn findings(spectra: &Spectra) -> Vec<String> {
    let mut sentences: Vec<String> = Vec::new();
    for found in &spectra.beside_steps {
        let title = title_of(spectra, found);
        sentences.extend(found.sentences.first().map(|first| format!("{title}: {first}")));
    }
    let sweeps = spectra.runs.iter().flat_map(|run| &run.sweeps);
    let violated = sweeps
        .filter_map(|sweep| sweep.analysis.as_ref().ok())
        .filter(|found| found.kramers_kronig.verdict == Consistency::Violated)
        .count();
    if violated > 0 {
        let (those, are) = (
            counted(violated, "spectrum"),
            if violated == 1 { "is" } else { "are" },
        );
        sentences.push(format!(
            "{those} {are} no impedance of anything linear and unchanging at some frequencies (Kramers-Kronig)."
        ));
    }
    sentences
}

/// Sample and surroundings, with the file where several spectra have those; else the file.
fn title(spectra: &Spectra, run: &SpectrumRun, sweep: usize) -> String {
    let mut words = surroundings(run);
    let alike = spectra.runs.iter().filter(|other| surroundings(other) == words);
    if words.is_empty() || alike.count() > 1 {
        words.push(run.run.path.clone());
    }
    if run.sweeps.len() > 1 {
        words.push(format!("sweep {}", sweep + 1));
    }
    words.join(", ")
}

/// Sample, environment, humidity and voltage, as far as they are stated; empty without a sample.
fn surroundings(run: &SpectrumRun) -> Vec<String> {
    let record = &run.run;
    let Some(sample) = record.tag(keys::SAMPLE) else {
        return Vec::new();
    };
    let humidity = record.tag_number(keys::RELATIVE_HUMIDITY_PERCENT);
    let volts = record.tag_number(keys::VOLTAGE_V);
    let stated = [
        Some(sample.to_owned()),
        record.tag(keys::ENVIRONMENT).map(str::to_owned),
        humidity.map(|percent| format!("{}\u{a0}%\u{a0}RH", fixed(percent, 0))),
        volts.map(|volts| format!("{}\u{a0}V", plain(volts))),
    ];
    stated.into_iter().flatten().collect()
}

fn title_of(spectra: &Spectra, found: &Comparison) -> String {
    let run = spectra.runs.iter().find(|run| run.run.path == found.spectrum);
    run.map_or(found.spectrum.clone(), |run| title(spectra, run, found.sweep - 1))
}

fn of_comparison(spectra: &Spectra, found: &Comparison) -> Block {
    let said = found.sentences.iter().cloned().map(Block::Say);
    let sides = [&found.lowest].into_iter().chain(&found.highest);
    let volts = sides
        .clone()
        .map(|side| format!("{}\u{a0}V", plain(side.voltage_v)));
    let steps = Block::say(format!("Steps of {}.", in_a_row(&volts.collect::<Vec<_>>())));
    let runs = Block::Runs("Steps", sides.flat_map(|side| side.runs.clone()).collect());
    let shown = [Block::Table(beside(found)), steps, runs];
    Block::part(title_of(spectra, found), said.chain(shown).collect())
}

fn of_sweep(
    spectra: &Spectra,
    (run, at): (&SpectrumRun, usize),
    sweep: &Sweep,
    campaign: &Campaign,
) -> Block {
    let mut blocks = Vec::new();
    let own = match &sweep.analysis {
        Err(issue) => vec![issue],
        Ok(found) => {
            blocks.extend(of_analysis(run, at, sweep, found));
            found.issues.iter().collect()
        }
    };
    blocks.extend(Block::issues(run.run.issues.iter().chain(own)));
    blocks.push(Block::facts_of(&run.run, campaign, facts(run, sweep)));
    Block::part(title(spectra, run, at), blocks)
}

fn of_analysis(run: &SpectrumRun, at: usize, sweep: &Sweep, found: &SpectrumAnalysis) -> Vec<Block> {
    let mut blocks = vec![Block::Say(kramers_kronig(&found.kramers_kronig))];
    blocks.extend(found.z_hit.as_ref().map(|told| Block::Say(z_hit(told))));
    blocks.extend(found.relaxation.as_ref().map(|told| Block::Say(relaxation(told))));
    let test = charts::of_test(sweep, &found.kramers_kronig);
    let drawn = charts::of_spectrum(sweep, found).into_iter().chain([test]);
    let drawn = drawn.chain(found.relaxation.as_ref().map(charts::of_relaxation));
    blocks.extend(drawn.map(Block::Chart));
    let this = Analysed {
        run,
        sweep: at,
        found,
    };
    let drawn = charts::drawn(found);
    let shown = drawn.iter().map(|(fit, _)| (this, *fit));
    blocks.push(Block::Table(circuits(shown).without(&SAID)));
    let others = found
        .circuits
        .iter()
        .filter(|fit| drawn.iter().all(|(own, _)| own.circuit != fit.circuit));
    let others = others.map(|fit| format!("{} leaves {}", fit.circuit, percent(fit.residual_rms_percent)));
    let others: Vec<String> = others.collect();
    if !others.is_empty() {
        blocks.push(Block::Say(format!(
            "Of |Z| {}; `ieap table circuits` has their numbers.",
            in_a_row(&others)
        )));
    }
    blocks
}

fn facts(run: &SpectrumRun, sweep: &Sweep) -> Vec<(&'static str, String)> {
    let mut facts = vec![("frequencies", sweep.spectrum.len().to_string())];
    let range = sweep.spectrum.range_hz();
    facts.extend(range.map(|range| ("range", format!("{} Hz", from_to(range)))));
    let area_cm2 = run.run.area_cm2;
    facts.extend(area_cm2.map(|area| ("area", format!("{} cm²", plain(area)))));
    facts
}

fn from_to((low, high): (f64, f64)) -> String {
    format!("{} to {}", significant(low, 2), significant(high, 2))
}

fn percent(number: f64) -> String {
    format!("{}\u{a0}%", significant(number, 2))
}

fn kramers_kronig(found: &KramersKronig) -> String {
    let rest = format!(
        "{} Voigt elements leave {} of |Z|; neighbouring readings scatter by {}.",
        found.elements,
        percent(found.residual_rms_percent),
        percent(found.scatter_percent)
    );
    match (found.verdict, found.off_hz) {
        (Consistency::Consistent, _) => format!("It can be an impedance (Kramers-Kronig): {rest}"),
        (Consistency::Violated, Some(off_hz)) => format!(
            "From {} Hz it is no impedance of anything linear and unchanging (Kramers-Kronig): neighbouring readings lie {} of |Z| off together. {rest}",
            from_to(off_hz),
            percent(found.largest_mean_percent)
        ),
        _ => "Kramers-Kronig is not tested: there are too few frequencies.".to_owned(),
    }
}

fn z_hit(found: &ZHit) -> String {
    let lead = if found.drifts {
        "It drifted during the sweep"
    } else {
        "No drift is seen"
    };
    let side = if found.lowest_percent < 0.0 {
        "below"
    } else {
        "above"
    };
    format!(
        "{lead} (Z-HIT): from {} Hz |Z| lies {} {side} what its phase gives, where noise and the method explain {}.",
        from_to(found.lowest_hz),
        percent(found.lowest_percent.abs()),
        percent(found.limit_percent)
    )
}

fn relaxation(found: &RelaxationTimes) -> String {
    let peaks: Vec<String> = (found.peaks.iter())
        .map(|peak| {
            let (tau_s, ohm) = (significant(peak.tau_s, 2), significant(peak.resistance_ohm, 2));
            format!("{tau_s}\u{a0}s with {ohm}\u{a0}Ω")
        })
        .collect();
    let peaks = match peaks.as_slice() {
        [] => "no peak".to_owned(),
        several => format!("{}, at {}", counted(several.len(), "peak"), in_a_row(several)),
    };
    let left = if found.describes {
        ""
    } else {
        " It does not describe the spectrum."
    };
    format!(
        "Relaxation times: {peaks}. The smoothest distribution that leaves no more than the readings scatter (Tikhonov, λ\u{a0}=\u{a0}{}) leaves {} of |Z|.{left}",
        significant(found.regularisation, 2),
        percent(found.residual_rms_percent)
    )
}
