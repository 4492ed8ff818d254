//! Impedance spectra: whether one can be an impedance (the linear Kramers-Kronig test), and which circuit describes it.
//!
//! The noise of a spectrum is taken as a part of |Z|, equal at all frequencies: both parts of every reading are
//! weighted by 1/|Z|, and the size of the noise is what the fit leaves.

mod circuits;
mod intervals;
pub mod kramers_kronig;
mod policy;
pub mod relaxation;
mod search;
mod starts;
#[cfg(test)]
mod tests;
pub mod z_hit;

use ieap_domain::impedance::FEWEST_FREQUENCIES;
use ieap_domain::number::{fixed, significant};
use ieap_domain::{CircuitFit, Consistency, Issue, KramersKronig, Spectrum, SpectrumAnalysis};
use ieap_model::impedance::{SpectrumCircuit, circuits as built_in};
use policy::{DESCRIBES_WITHIN, FINE_RMS};

/// Version of the analysis: raised when the same spectrum would give other numbers.
pub const VERSION: u32 = 3;

/// Tests a spectrum and fits every circuit to it: those that every spectrum is fitted with, then those asked for.
///
/// # Errors
/// Too few frequencies, or no circuit can be fitted.
pub fn analyse(spectrum: &Spectrum, asked: &[SpectrumCircuit]) -> Result<SpectrumAnalysis, Issue> {
    if spectrum.len() < FEWEST_FREQUENCIES {
        let message = format!(
            "{} frequencies are too few to test a spectrum and to fit circuits to it: {FEWEST_FREQUENCIES} are needed",
            spectrum.len()
        );
        return Err(Issue::error("few-frequencies", message).mend("measure more frequencies"));
    }
    let magnitude = spectrum.magnitude_ohm();
    let numbers = spectrum.real_ohm.iter().chain(&spectrum.imaginary_ohm);
    if !numbers
        .chain(&spectrum.frequency_hz)
        .all(|value| value.is_finite())
        || magnitude.iter().any(|size| *size <= 0.0)
    {
        return Err(Issue::error(
            "no-impedance",
            "the spectrum holds readings that are no impedance",
        ));
    }
    let tested = kramers_kronig::test(spectrum);
    let asked = asked
        .iter()
        .filter_map(|circuit| circuits::fit(circuit, spectrum));
    let fitted: Vec<(CircuitFit, f64)> = built_in()
        .iter()
        .filter_map(|circuit| circuits::behind_leads_or_not(circuit, spectrum))
        .chain(asked)
        .collect();
    let lowest = fitted.iter().map(|(_, bic)| *bic).fold(f64::INFINITY, f64::min);
    let best = fitted.iter().find(|(_, bic)| *bic <= lowest);
    let Some(best) = best.map(|(fit, _)| fit.circuit.clone()) else {
        return Err(Issue::error(
            "no-circuit",
            "no circuit can be fitted to the spectrum",
        ));
    };
    let enough = (DESCRIBES_WITHIN * 0.01 * tested.residual_rms_percent).max(FINE_RMS);
    let circuits = fitted.into_iter().map(|(fit, bic)| CircuitFit {
        bic_above_best: bic - lowest,
        describes: 0.01 * fit.residual_rms_percent <= enough,
        ..fit
    });
    let circuits: Vec<CircuitFit> = circuits.collect();
    let issues = issues(&tested, &circuits);
    Ok(SpectrumAnalysis {
        z_hit: z_hit::z_hit(spectrum, 0.01 * tested.scatter_percent),
        relaxation: relaxation::relaxation_times(spectrum, &tested),
        kramers_kronig: tested,
        circuits,
        best,
        issues,
    })
}

/// A circuit at its best in a spectrum.
pub(crate) struct Alone {
    /// Its parameters, Ohm and F.
    pub(crate) values: Vec<f64>,
    /// Root mean square of what it leaves, part of |Z|.
    pub(crate) residual_rms: f64,
}

/// The circuit of a lumped model in a spectrum; none where it cannot be fitted.
pub(crate) fn lumped_in_spectrum(circuit: &SpectrumCircuit, spectrum: &Spectrum) -> Option<Alone> {
    circuits::lowest(circuit, spectrum)
}

fn issues(tested: &KramersKronig, circuits: &[CircuitFit]) -> Vec<Issue> {
    let mut issues = Vec::new();
    if tested.verdict == Consistency::Violated {
        let (low, high) = tested.off_hz.unwrap_or((f64::NAN, f64::NAN));
        let message = format!(
            "the readings between {} and {} Hz are no impedance of anything linear and unchanging: they lie \
             {} % of |Z| off what the other frequencies allow (Kramers-Kronig)",
            significant(low, 4),
            significant(high, 4),
            fixed(tested.largest_mean_percent, 1)
        );
        let mend = "leave these frequencies out, measure with a smaller amplitude, or wait until the sample has come to rest";
        issues.push(Issue::warning("kramers-kronig", message).mend(mend));
    }
    if !circuits.iter().any(|fit| fit.describes) {
        let least = circuits
            .iter()
            .map(|fit| fit.residual_rms_percent)
            .fold(f64::INFINITY, f64::min);
        let message = format!(
            "no circuit of the list describes the spectrum: the best leaves {} % of |Z|, where the readings scatter by \
             {} %; intervals are those of the noise alone and too narrow",
            fixed(least, 2),
            fixed(tested.scatter_percent, 2)
        );
        issues.push(Issue::warning("no-circuit-describes", message));
    }
    issues
}
