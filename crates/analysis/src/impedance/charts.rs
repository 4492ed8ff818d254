//! Pictures of an impedance spectrum.

use std::collections::BTreeMap;

use ieap_domain::tag::keys;
use ieap_domain::{
    CircuitFit, KramersKronig, RelaxationTimes, Spectrum, SpectrumAnalysis, SpectrumRun, Sweep,
};
use ieap_show::{Chart, Form, Ink, Layer, Mark, Panel, Range};

/// Circuits that every spectrum is fitted with; others were asked for, and are drawn.
const BUILT_IN: [&str; 5] = [
    "lumped-1",
    "lumped-2",
    "constant-phase",
    "warburg-finite",
    "warburg-parallel",
];

/// Key of the total capacitance of a circuit.
const TOTAL: &str = "c_total_f";

/// Circuits that are drawn: that of the step's fit, the best one, and those that were asked for.
pub fn drawn(found: &SpectrumAnalysis) -> Vec<(&CircuitFit, Ink)> {
    let is_asked = |fit: &CircuitFit| !BUILT_IN.contains(&fit.circuit.as_str());
    let ink = |fit: &CircuitFit| match fit.circuit.as_str() {
        "lumped-2" => Some(Ink::SECOND),
        circuit if circuit == found.best => Some(Ink::FIRST),
        _ => is_asked(fit).then_some(Ink::THIRD),
    };
    found
        .circuits
        .iter()
        .filter_map(|fit| Some((fit, ink(fit)?)))
        .collect()
}

/// The pictures of a sweep: Nyquist and Bode plot.
pub fn of_spectrum(sweep: &Sweep, found: &SpectrumAnalysis) -> [Chart; 2] {
    let spectrum = &sweep.spectrum;
    let hz = &spectrum.frequency_hz;
    let layers = |x: &dyn Fn(&Spectrum) -> Vec<f64>, y: &dyn Fn(&Spectrum) -> Vec<f64>| -> Vec<Layer> {
        let of_fit = |(fit, ink): (&CircuitFit, Ink)| {
            let fitted = Spectrum {
                frequency_hz: hz.clone(),
                real_ohm: fit.real_ohm.clone(),
                imaginary_ohm: fit.imaginary_ohm.clone(),
            };
            Layer::over(fit.circuit.as_str(), Mark::Line, ink, &x(&fitted), &y(&fitted))
        };
        let readings = Layer::over(
            "Readings",
            Mark::Readings,
            Ink::Readings,
            &x(spectrum),
            &y(spectrum),
        );
        drawn(found).into_iter().map(of_fit).chain([readings]).collect()
    };
    let frequency = |own: &Spectrum| own.frequency_hz.clone();
    let against = |own: &Spectrum| own.imaginary_ohm.iter().map(|ohm| -ohm).collect();
    let nyquist = Panel {
        x: Range::linear("Z′", "Ω").with(0.0),
        y: Range::linear("−Z″", "Ω").with(0.0),
        layers: layers(&|own| own.real_ohm.clone(), &against),
    };
    let bode = |y: Range, of: &dyn Fn(&Spectrum) -> Vec<f64>| Panel {
        x: Range::log("Frequency", "Hz"),
        y,
        layers: layers(&frequency, of),
    };
    let phase = Range::linear("Phase (°)", "").with(-90.0).with(0.0);
    let panels = vec![
        bode(Range::log("|Z|", "Ω"), &Spectrum::magnitude_ohm),
        bode(phase, &phase_deg),
    ];
    [
        Chart::new("Nyquist plot", vec![nyquist]).formed(Form::EqualScales),
        Chart::new("Bode plot", panels),
    ]
}

fn phase_deg(spectrum: &Spectrum) -> Vec<f64> {
    let parts = spectrum.real_ohm.iter().zip(&spectrum.imaginary_ohm);
    parts
        .map(|(real, imaginary)| imaginary.atan2(*real).to_degrees())
        .collect()
}

/// Capacitance over the voltage at which spectra were taken, a series for each sample; none where no sample has two voltages.
///
/// The capacitance is that of the best of those circuits that have one.
pub fn over_voltage(spectra: &[SpectrumRun]) -> Option<Chart> {
    let point = |run: &SpectrumRun, found: &SpectrumAnalysis| {
        let volts = run.run.tag_number(keys::VOLTAGE_V)?;
        let known = |fit: &CircuitFit| {
            let own = fit.parameter(TOTAL)?;
            let ends = own.low_95.zip(own.high_95)?;
            Some((fit.bic_above_best, own.value?, ends))
        };
        let all = found.circuits.iter().filter_map(known);
        let (_, farad, ends) = all.min_by(|a, b| a.0.total_cmp(&b.0))?;
        Some(((volts, farad), ends, run.run.path.clone()))
    };
    let mut of_samples = BTreeMap::<&str, Vec<_>>::new();
    for run in spectra {
        let told = run
            .sweeps
            .iter()
            .filter_map(|sweep| point(run, sweep.analysis.as_ref().ok()?));
        if let Some(sample) = run.run.tag(keys::SAMPLE) {
            of_samples.entry(sample).or_default().extend(told);
        }
    }
    of_samples.retain(|_, told| told.windows(2).any(|pair| pair[0].0.0 != pair[1].0.0));
    let layers = of_samples.into_iter().enumerate().map(|(k, (sample, told))| {
        let points: Vec<(f64, f64)> = told.iter().map(|own| own.0).collect();
        Layer::new(sample, Mark::Marks, Ink::Series(k), points)
            .with_bars(told.iter().map(|own| own.1).collect())
            .of_runs(told.into_iter().map(|own| own.2).collect())
    });
    let panel = Panel {
        x: Range::linear("Voltage", "V"),
        y: Range::linear("C_total", "F").with(0.0),
        layers: layers.collect(),
    };
    let told = "Total capacitance of the best circuit that has one, with its 95\u{202f}% interval, over the voltage at which the spectrum was taken.";
    (!panel.layers.is_empty()).then(|| Chart::new("Capacitance over voltage", vec![panel]).told(told))
}

/// What the Kramers-Kronig test leaves.
pub fn of_test(sweep: &Sweep, test: &KramersKronig) -> Chart {
    let percent = |part: &[f64]| -> Vec<f64> { part.iter().map(|r| 100.0 * r).collect() };
    let layer = |name, ink, part: &[f64]| {
        Layer::over(
            name,
            Mark::DottedLine,
            ink,
            &sweep.spectrum.frequency_hz,
            &percent(part),
        )
    };
    let panel = Panel {
        x: Range::log("Frequency", "Hz"),
        y: Range::linear("Residual (%)", "").with(-1.0).with(1.0),
        layers: vec![
            Layer::guides(Mark::Level, [0.0]),
            layer("Z′", Ink::FIRST, &test.residual_real),
            layer("Z″", Ink::SECOND, &test.residual_imaginary),
        ],
    };
    Chart::new("Kramers-Kronig test", vec![panel])
        .told("What Voigt elements leave of the real and the imaginary part, percent of |Z|.")
}

/// The distribution of relaxation times, with its peaks and the limits of what the frequencies tell of.
pub fn of_relaxation(told: &RelaxationTimes) -> Chart {
    let away = |k: &usize, tau_s: f64| (told.tau_s[*k] / tau_s).ln().abs();
    let nearest = |tau_s: f64| {
        let at = (0..told.tau_s.len()).min_by(|a, b| away(a, tau_s).total_cmp(&away(b, tau_s)));
        at.map_or(0.0, |k| told.gamma_ohm[k])
    };
    let peaks = told.peaks.iter().map(|peak| (peak.tau_s, nearest(peak.tau_s)));
    let panel = Panel {
        x: Range::log("Time constant", "s"),
        y: Range::linear("γ", "Ω").with(0.0),
        layers: vec![
            Layer::guides(Mark::Upright, [told.told_s.0, told.told_s.1]),
            Layer::over(
                "γ(ln τ)",
                Mark::DottedLine,
                Ink::FIRST,
                &told.tau_s,
                &told.gamma_ohm,
            ),
            Layer::new("Peaks", Mark::Marks, Ink::SECOND, peaks),
        ],
    };
    Chart::new("Relaxation times", vec![panel]).told(
        "Resistance for a unit of the natural logarithm of the time constant; the frequencies tell of what lies between the dashed lines.",
    )
}
