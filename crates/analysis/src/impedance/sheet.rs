//! The tables of impedance spectra.

use ieap_domain::tag::keys;
use ieap_domain::{
    CircuitFit, Consistency, Parameter, RelaxationPeak, RelaxationTimes, SpectrumAnalysis, SpectrumRun,
};
use ieap_show::quantities::{ENVIRONMENT, HUMIDITY, Quantity, SAMPLE};
use ieap_show::{Sheet, Source, Table, Value, rough};

use super::beside::{BesideRow, Comparison};
use ieap_domain::ParameterInfo;

/// Said where there is none.
pub const NO_SPECTRUM: &str = "No impedance spectrum is there: put files into impedance/ or beside the runs.";

const SPECTRUM: Quantity = Quantity::plain("spectrum", "Spectrum", "run of the spectrum");
const CIRCUIT: Quantity = Quantity::plain("circuit", "Circuit", "circuit, as its name or as a text");
const KRAMERS_KRONIG: Quantity = Quantity::plain(
    "kramers_kronig",
    "Kramers-Kronig",
    "whether it can be an impedance",
);
const DESCRIBES: Quantity = Quantity::plain(
    "describes",
    "Verdict",
    "whether the circuit describes the spectrum",
);
const RESIDUAL: Quantity = Quantity::new(
    "residual_percent",
    "Residual",
    "root mean square of what is left, of |Z|",
    "%",
);
const DELTA_BIC: Quantity = Quantity::plain(
    "bic_above_best",
    "ΔBIC",
    "Bayesian information criterion above that of the best circuit",
);
const NUMBER: Quantity = Quantity::plain("number", "Key", "key of the number, with its unit");
const SYMBOL: Quantity = Quantity::plain("symbol", "Number", "number, with its unit");
const VALUE: Quantity = Quantity::plain("value", "Value", "value");

/// Numbers of the circuits that every spectrum is fitted with.
const NUMBERS: [Quantity; 12] = [
    Quantity::new("r1_ohm", "R₁", "resistance of the first chain", "Ω"),
    Quantity::new("c1_f", "C₁", "capacitance of the first chain", "F").shown_in("mF", 1e3),
    Quantity::new("r2_ohm", "R₂", "resistance of the second chain", "Ω"),
    Quantity::new("c2_f", "C₂", "capacitance of the second chain", "F").shown_in("mF", 1e3),
    Quantity::new("rss_ohm", "Rₛₛ", "steady-state resistance", "Ω").shown_in("kΩ", 1e-3),
    Quantity::new("c_total_f", "C_total", "total capacitance", "F").shown_in("mF", 1e3),
    Quantity::new(
        "r_parallel_ohm",
        "R∥",
        "resistance of the chains in parallel",
        "Ω",
    ),
    Quantity::plain("cpe_exponent", "n", "exponent of the constant-phase element"),
    Quantity::new("cpe_s_sn", "Q", "size of the constant-phase element", "S sⁿ"),
    Quantity::new("rw_ohm", "R_W", "resistance of the finite Warburg element", "Ω"),
    Quantity::new("cw_f", "C_W", "capacitance of the finite Warburg element", "F").shown_in("mF", 1e3),
    Quantity::new("warburg_s_s05", "Y_W", "size of the Warburg element", "S s^½"),
];
/// Ends of keys with their units; `cpe1_s_sn` of a circuit as a text is `CPE1 (S sⁿ)`.
const UNITS: [(&str, &str); 7] = [
    ("_s_s05", "S s^½"),
    ("_s_sn", "S sⁿ"),
    ("_exponent", "n"),
    ("_ohm", "Ω"),
    ("_f", "F"),
    ("_h", "H"),
    ("_s", "s"),
];

/// A sweep that is analysed, with its name.
#[derive(Clone, Copy)]
pub struct Analysed<'a> {
    /// Its run.
    pub run: &'a SpectrumRun,
    /// Which sweep of it, from 0.
    pub sweep: usize,
    /// What is found.
    pub found: &'a SpectrumAnalysis,
}

/// Every sweep that is analysed.
pub fn analysed(spectra: &[SpectrumRun]) -> impl Iterator<Item = Analysed<'_>> {
    spectra.iter().flat_map(|run| {
        let sweeps = run.sweeps.iter().enumerate();
        sweeps.filter_map(move |(sweep, own)| {
            let found = own.analysis.as_ref().ok()?;
            Some(Analysed { run, sweep, found })
        })
    })
}

impl Analysed<'_> {
    fn name(&self) -> String {
        match self.sweep {
            0 => self.run.run.path.clone(),
            sweep => format!("{}, sweep {}", self.run.run.path, sweep + 1),
        }
    }

    fn verdict(&self, fit: &CircuitFit) -> &'static str {
        match (fit.circuit == self.found.best, fit.describes) {
            (true, true) => "describes it best",
            (true, false) => "best, and does not describe it",
            (false, true) => "describes it",
            (false, false) => "does not describe it",
        }
    }
}

/// A sheet whose rows say, first of all, of which spectrum they are.
fn of_spectra<'s, 'a: 's, R: 's>(
    name: &'static str,
    title: &'static str,
    stub: usize,
    of: impl Fn(&R) -> Analysed<'a> + Copy + 's,
) -> Sheet<'s, R> {
    Sheet::new(name, title, stub)
        .made_from(move |row| vec![Source::file(&of(row).run.run.path)])
        .column(SPECTRUM, move |row| of(row).name())
}

/// Sample and surroundings of a row's spectrum.
fn surrounded<'s, 'a: 's, R: 's>(
    sheet: Sheet<'s, R>,
    of: impl Fn(&R) -> Analysed<'a> + Copy + 's,
) -> Sheet<'s, R> {
    sheet
        .column(SAMPLE, move |row| {
            of(row).run.run.tag(keys::SAMPLE).map(Value::from)
        })
        .column(ENVIRONMENT, move |row| {
            of(row).run.run.tag(keys::ENVIRONMENT).map(Value::from)
        })
        .column(HUMIDITY, move |row| {
            of(row).run.run.tag_number(keys::RELATIVE_HUMIDITY_PERCENT)
        })
}

/// A circuit of a sweep.
pub type OfCircuit<'a> = (Analysed<'a>, &'a CircuitFit);

/// One row a sweep and circuit: table `impedance`.
pub fn impedance<'a>(spectra: &'a [SpectrumRun]) -> Table {
    let of = |row: &OfCircuit<'a>| row.0;
    let sheet = of_spectra("impedance", "Circuits fitted to the impedance spectra", 2, of)
        .remarks(
            "Values are those of the whole sample, with their standard error; intervals and bounds are by the profile of the sum of squares, every reading weighted by 1/|Z|.",
            NO_SPECTRUM,
        )
        .column(CIRCUIT, |(_, fit)| fit.circuit.clone());
    let rows = fits(spectra);
    surrounded(sheet, of)
        .column(KRAMERS_KRONIG, |(own, _)| {
            match own.found.kramers_kronig.verdict {
                Consistency::Consistent => "consistent",
                Consistency::Violated => "violated",
                Consistency::NotTested => "not tested",
            }
        })
        .column(DESCRIBES, |(own, fit)| own.verdict(fit))
        .column(RESIDUAL, |(_, fit)| rough(fit.residual_rms_percent))
        .column(DELTA_BIC, |(_, fit)| rough(fit.bic_above_best))
        .columns(&NUMBERS[..11], |(_, fit), of| {
            fit.parameter(of.key).map(Value::from)
        })
        .over(rows)
}

/// One row a sweep, circuit and number: table `circuits`.
pub fn circuits<'a>(fits: impl Iterator<Item = (Analysed<'a>, &'a CircuitFit)>) -> Table {
    type OfNumber<'a> = (Analysed<'a>, &'a CircuitFit, &'a Parameter);
    let of = |row: &OfNumber<'a>| row.0;
    let sheet = of_spectra("circuits", "Numbers of the circuits fitted to the impedance spectra", 3, of)
        .remarks(
            "Values are those of the whole sample. Circuits as texts are those of [impedance] circuits in campaign.toml.",
            NO_SPECTRUM,
        )
        .column(CIRCUIT, |(_, fit, _)| fit.circuit.clone())
        .column(NUMBER, |(.., own)| own.key.clone())
        .column(SYMBOL, |(.., own)| with_unit(&own.key))
        .column(VALUE, |(.., own)| Value::from(&own.estimate));
    surrounded(sheet, of)
        .column(DESCRIBES, |(own, fit, _)| own.verdict(fit))
        .column(RESIDUAL, |(_, fit, _)| rough(fit.residual_rms_percent))
        .column(DELTA_BIC, |(_, fit, _)| rough(fit.bic_above_best))
        .over(fits.flat_map(|(own, fit)| fit.parameters.iter().map(move |number| (own, fit, number))))
}

/// Every circuit of every sweep that is analysed.
pub fn fits(spectra: &[SpectrumRun]) -> impl Iterator<Item = OfCircuit<'_>> {
    analysed(spectra).flat_map(|own| own.found.circuits.iter().map(move |fit| (own, fit)))
}

/// One row a sweep and peak of its relaxation times: table `relaxation-times`.
pub fn relaxation_times<'a>(spectra: &'a [SpectrumRun]) -> Table {
    type OfPeak<'a> = (Analysed<'a>, &'a RelaxationTimes, usize, &'a RelaxationPeak);
    const PEAK: Quantity = Quantity::plain("peak", "Peak", "number of the peak, from the fastest");
    const TAU: Quantity = Quantity::new("tau_s", "τ", "time constant of the peak", "s");
    const RESISTANCE: Quantity = Quantity::new("peak_resistance_ohm", "R", "resistance of the peak", "Ω");
    const FROM: Quantity = Quantity::new("from_s", "from", "least value before the peak", "s");
    const TO: Quantity = Quantity::new("to_s", "to", "least value behind the peak", "s");
    const LAMBDA: Quantity = Quantity::plain("regularisation", "λ", "strength of the regularisation");
    let of = |row: &OfPeak<'a>| row.0;
    let sheet = of_spectra("relaxation-times", "Relaxation times of the impedance spectra", 2, of)
        .remarks(
            "The smoothest distribution (Tikhonov, of the second derivative) that leaves no more than the readings scatter; a peak has no interval, for its width is that of the regularisation.",
            "No impedance spectrum has a peak of relaxation times.",
        )
        .column(PEAK, |(_, _, at, _)| at + 1);
    let peaks = analysed(spectra).flat_map(|own| {
        let told = own.found.relaxation.iter();
        told.flat_map(move |told| {
            (told.peaks.iter().enumerate()).map(move |(at, peak)| (own, told, at, peak))
        })
    });
    surrounded(sheet, of)
        .column(TAU, |(.., peak)| rough(peak.tau_s))
        .column(RESISTANCE, |(.., peak)| rough(peak.resistance_ohm))
        .column(FROM, |(.., peak)| rough(peak.from_s))
        .column(TO, |(.., peak)| rough(peak.to_s))
        .column(LAMBDA, |(_, told, ..)| rough(told.regularisation))
        .column(RESIDUAL, |(_, told, ..)| rough(told.residual_rms_percent))
        .over(peaks)
}

/// The numbers of a spectrum beside those of steps.
pub fn beside(found: &Comparison) -> Table {
    const OF_SPECTRUM: Quantity = Quantity::plain("spectrum", "Spectrum", "from the spectrum");
    const OF_STEP: Quantity = Quantity::plain("step", "Lowest step", "from the steps at the lowest voltage");
    const AT_HIGHEST: Quantity = Quantity::plain(
        "step_at_highest",
        "Highest step",
        "from the steps at the highest voltage",
    );
    const RATIO: Quantity = Quantity::plain(
        "step_over_spectrum",
        "Step over spectrum",
        "ratio at the lowest voltage",
    );
    const AGREES: Quantity = Quantity::plain("agrees", "Verdict", "whether both can be the same");
    let sheet = Sheet::<&BesideRow>::new("beside-steps", "Numbers per unit area", 1)
        .column(SYMBOL, |row| {
            ParameterInfo::of(row.key).map(|info| format!("{} ({})", info.symbol, info.unit()))
        })
        .column(OF_SPECTRUM, |row| Value::from(&row.spectrum))
        .column(OF_STEP, |row| Value::from(&row.step));
    let sheet = match found.highest {
        Some(_) => sheet.column(AT_HIGHEST, |row| row.step_at_highest.as_ref().map(Value::from)),
        None => sheet,
    };
    sheet
        .column(RATIO, |row| Value::from(&row.ratio))
        .column(AGREES, |row| match row.agrees {
            Some(true) => "agree",
            Some(false) => "differ",
            None => "cannot be compared",
        })
        .over(&found.rows)
}

/// A number of a circuit with its unit: `R₁ (Ω)`.
fn with_unit(key: &str) -> String {
    let (name, unit) = UNITS
        .iter()
        .find_map(|(end, unit)| Some((key.strip_suffix(end)?, *unit)))
        .unwrap_or((key, ""));
    match NUMBERS.iter().find(|own| own.key == key) {
        Some(own) if own.unit.is_empty() => own.symbol.to_owned(),
        Some(own) => format!("{} ({unit})", own.symbol),
        None => format!("{} ({unit})", name.to_uppercase()),
    }
}
