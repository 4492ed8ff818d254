//! `ieap impedance`.

use clap::Args;

use super::campaign::CampaignArg;
use super::exit::{self, CliError};
use super::global::Global;
use super::ingest;
use super::output::Output;
use crate::domain::Consistency;
use crate::domain::number::estimates::in_words;
use crate::model::impedance::{SpectrumCircuit, circuit, spectrum_circuit};
use crate::pipeline::Ingest;
use crate::pipeline::documents::impedance::{BesideEntry, SpectrumEntry, impedance_document};
use crate::pipeline::findings::impedance::spectra;

/// Test the impedance spectra of a campaign, fit circuits to them, and set them beside the steps of the same samples,
/// after taking in new files
#[derive(Debug, Args)]
pub struct ImpedanceArgs {
    #[command(flatten)]
    campaign: CampaignArg,
    /// Print the numbers of every circuit, not only of those of the thesis and of the best
    #[arg(long)]
    all: bool,
    /// Fit this circuit as well, such as "R0-p(R1,CPE1)-W1": `-` in series, p(..,..) beside each other, elements R C L
    /// CPE W Wo Ws TLMQ; may be given again
    #[arg(long, value_name = "CIRCUIT", value_parser = parsed)]
    circuit: Vec<SpectrumCircuit>,
}

fn parsed(text: &str) -> Result<SpectrumCircuit, String> {
    circuit(text).map_err(|error| error.to_string())
}

pub fn run(args: &ImpedanceArgs, global: &Global, output: &Output) -> Result<u8, CliError> {
    let mut context = args.campaign.open(global, output)?;
    let ingest = Ingest { ready: &mut |_| true }.run(&mut context, output)?;
    ingest::left_out(&ingest, output);
    let found = spectra(&context, &args.circuit)?;
    let document = impedance_document(&found);
    if document.spectra.is_empty() {
        output.message("no impedance spectrum is there: put files into impedance/ or beside the runs");
    }
    for issue in &document.refused_circuits {
        output.issue("campaign.toml", issue);
    }
    for entry in &document.spectra {
        print(entry, args.all, output);
    }
    document
        .beside_steps
        .iter()
        .for_each(|entry| print_beside(entry, output));
    output.document(&document)?;
    Ok(exit::after(found.has_fault(), !ingest.left_out_inputs()))
}

fn print(entry: &SpectrumEntry, all: bool, output: &Output) {
    let sample = entry.sample.as_deref().unwrap_or("no sample");
    let sweep = match entry.sweep {
        1 => String::new(),
        number => format!(" (sweep {number})"),
    };
    let range = entry.lowest_hz.zip(entry.highest_hz);
    let range = range.map_or(String::new(), |(low, high)| {
        format!(", {low:.3e} to {high:.3e} Hz")
    });
    output.result(&format!(
        "{}{sweep}  {sample}  {} frequencies{range}",
        entry.run, entry.frequencies
    ));
    if let Some(test) = &entry.kramers_kronig {
        let verdict = match (test.verdict, test.off_hz) {
            (Consistency::Violated, Some((low, high))) => {
                format!("violated between {low:.3e} and {high:.3e} Hz")
            }
            (Consistency::NotTested, _) => "not tested".to_owned(),
            _ => "consistent".to_owned(),
        };
        output.result(&format!(
            "  Kramers-Kronig: {verdict} ({} elements leave {:.2} % of |Z|, scatter {:.2} %)",
            test.elements, test.residual_rms_percent, test.scatter_percent
        ));
    }
    print_z_hit(entry, output);
    print_relaxation(entry, output);
    for circuit in &entry.circuits {
        let is_best = entry.best.as_ref() == Some(&circuit.circuit);
        let is_asked = spectrum_circuit(&circuit.circuit).is_none();
        let describes = match (is_best, circuit.describes) {
            (true, true) => "describes it best",
            (true, false) => "best, and does not describe it",
            (false, true) => "describes it",
            (false, false) => "does not describe it",
        };
        output.result(&format!(
            "  {:<18} leaves {:.2} % of |Z|: {describes}",
            circuit.circuit, circuit.residual_rms_percent
        ));
        if all || is_best || is_asked || circuit.circuit.starts_with("lumped") {
            for (key, estimate) in &circuit.parameters {
                output.result(&format!("    {key:<18} {}", in_words(estimate)));
            }
        }
    }
    entry
        .issues
        .iter()
        .for_each(|issue| output.issue(&entry.run, issue));
}

fn print_z_hit(entry: &SpectrumEntry, output: &Output) {
    let Some(found) = &entry.z_hit else { return };
    let verdict = if found.drifts { "drifts" } else { "no drift seen" };
    output.result(&format!(
        "  Z-HIT: {verdict} (|Z| is {:+.1} % off its phase between {:.3e} and {:.3e} Hz, {:.1} % are explained)",
        found.lowest_percent, found.lowest_hz.0, found.lowest_hz.1, found.limit_percent
    ));
}

fn print_relaxation(entry: &SpectrumEntry, output: &Output) {
    let Some(found) = &entry.relaxation else { return };
    let peaks = found.peaks.iter();
    let peaks: Vec<String> = peaks
        .map(|peak| format!("{:.3e} s with {:.3e} Ω", peak.tau_s, peak.resistance_ohm))
        .collect();
    let peaks = if peaks.is_empty() {
        "no peak".to_owned()
    } else {
        peaks.join(", ")
    };
    let describes = if found.describes {
        ""
    } else {
        ", and does not describe it"
    };
    output.result(&format!(
        "  relaxation times: {peaks} (λ = {:.2e} leaves {:.2} % of |Z|{describes})",
        found.regularisation, found.residual_rms_percent
    ));
}

fn print_beside(entry: &BesideEntry, output: &Output) {
    output.result(&format!(
        "{} beside {} at {} V",
        entry.run,
        match entry.steps.runs.len() {
            1 => "the step".to_owned(),
            count => format!("{count} steps"),
        },
        entry.steps.voltage_v
    ));
    entry
        .sentences
        .iter()
        .for_each(|sentence| output.result(&format!("  {sentence}")));
    for number in &entry.numbers {
        let verdict = match number.agrees {
            Some(true) => "agree",
            Some(false) => "differ",
            None => "cannot be compared",
        };
        output.result(&format!(
            "    {:<20} spectrum {}, step {}: {verdict}",
            number.key,
            in_words(&number.spectrum),
            in_words(&number.step)
        ));
    }
}
