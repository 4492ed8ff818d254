//! A current that falls as a power of time, of any exponent.

use super::acting::instant;
use super::{About, EffectParameter, Equation, Limits, Scale, Search};
use crate::extended::{BranchLaw, RunContext, System};

/// See the module.
pub(super) struct ConstantPhase;

static ABOUT: About = About {
    id: "constant-phase",
    code: "E19",
    summary: "a current ~ t^-n of any exponent, beside the branches",
    equation: "i = k SUM dv_j ((t - t_j + t_0)/1 s)^-n over the edges t_j before, whose charge bends, or (stiff) does not; lost: i = k v ((t_e + t_0)/1 s)^-n, t_e since the last edge; t_0 = 0.05 s, or a ten-thousandth of a run shorter than 500 s",
    variants: &["bending", "stiff", "lost"],
    parameters: &[
        EffectParameter {
            key: "current_at_1_s_a_per_v_cm2",
            symbol: "k",
            unit: "A/(V cm2)",
            meaning: "current per voltage one second after an edge",
        },
        EffectParameter {
            key: "exponent",
            symbol: "n",
            unit: "",
            meaning: "power of time by which it falls; an impedance of constant phase -(1 - n) 90 degrees",
        },
    ],
    vanishes: "k = 0",
    signature: "a straight line in the logarithms of current and time, over decades",
    twins: &["warburg", "diffusion-limited-leak", "slow-branch", "dispersion"],
    separated_by: "readings over three decades of time and a discharge: what is stored comes back, what is lost does not; or an impedance",
    sources: "constant-phase element (Cole and Cole 1941); absorption currents of Curie and von Schweidler",
};

/// Nothing answers sooner, s, or in terms of the run: the current stays finite at the edge.
const SOONEST_S: f64 = 0.05;
const SOONEST_OF_RUN: f64 = 1e-4;
/// Branches of the spectrum are so far apart in the logarithm of their rates: 1e-3 of the current.
const APART: f64 = 1.1;
/// Rates slower than this part of one over the run are one branch; none faster than so many times one over the soonest.
const SLOWEST: f64 = 0.05;
const FASTEST: f64 = 12.0;

/// Exponents that are sought: nearer to 0 the current is a leak's, nearer to 1 its charge has no end.
const EXPONENTS: (f64, f64) = (0.02, 0.98);

/// The gamma function of a positive number, by Stirling's series farther up.
fn gamma(n: f64) -> f64 {
    let z = n + 8.0;
    let series = 1.0 / (12.0 * z) - 1.0 / (360.0 * z.powi(3)) + 1.0 / (1260.0 * z.powi(5));
    let far = (2.0 * std::f64::consts::PI / z).sqrt() * (z * (z.ln() - 1.0) + series).exp();
    far / (0..8).map(|k| n + f64::from(k)).product::<f64>()
}

/// Rates, 1/s, and conductances of branches whose currents add up to ((t + soonest)/1 s)^-n until the end of a run:
/// t^-n is the integral of s^(n - 1) e^(-s t) ds over the gamma function of n.
fn spectrum(exponent: f64, soonest_s: f64, run_s: f64) -> Vec<(f64, f64)> {
    let whole = gamma(exponent);
    let cut = SLOWEST / run_s;
    // All that is slower: its conductance, and its mean rate.
    let rest = cut.powf(exponent) / (exponent * whole);
    let mut out = vec![(cut * exponent / (exponent + 1.0), rest)];
    let mut rate = cut * (APART / 2.0).exp();
    while rate * soonest_s < FASTEST {
        out.push((
            rate,
            APART * rate.powf(exponent) * (-rate * soonest_s).exp() / whole,
        ));
        rate *= APART.exp();
    }
    out
}

impl Equation for ConstantPhase {
    const ABOUT: &'static About = &ABOUT;

    fn search(&self, variant: usize, scale: &Scale) -> Search {
        if scale.voltage_v == 0.0 || variant == 1 && scale.curvature_per_cm == 0.0 {
            return Search::none();
        }
        let most = scale.current_a / (scale.area_cm2 * scale.voltage_v);
        let limits = vec![
            Limits::linear(0.0, most),
            Limits::linear(EXPONENTS.0, EXPONENTS.1),
        ];
        Search::over(0.003 * most, limits, &[vec![0.25, 0.7]])
    }

    fn apply(&self, variant: usize, parameters: &[f64], run: &RunContext, system: &mut System) {
        let [k, exponent] = [parameters[0], parameters[1].clamp(EXPONENTS.0, EXPONENTS.1)];
        let run_s = (run.duration_s - run.start_s()).max(f64::MIN_POSITIVE);
        let soonest_s = SOONEST_S.min(SOONEST_OF_RUN * run_s);
        if variant == 2 {
            system.laws.push(instant(move |now, c| {
                c.leak_s_per_cm2 += k * (now.since_edge_s.max(0.0) + soonest_s).powf(-exponent);
            }));
        } else if k > 0.0 {
            let spectrum = spectrum(exponent, soonest_s, run_s).into_iter();
            system
                .branches
                .extend(spectrum.map(|(rate_per_s, conductance)| BranchLaw {
                    bends: if variant == 0 { 1.0 } else { 0.0 },
                    ..BranchLaw::added(k * conductance / rate_per_s, rate_per_s.recip())
                }));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::respond;

    #[test]
    fn gamma_is_known_at_a_half() {
        assert!((super::gamma(0.5) - std::f64::consts::PI.sqrt()).abs() < 1e-8);
        assert!((super::gamma(1.0) - 1.0).abs() < 1e-8);
    }

    #[test]
    fn current_falls_as_the_power_of_time_and_comes_back_unless_it_is_lost() {
        let (k, edge_s) = (2e-3, 150.0);
        let times = [0.2, 2.0, 20.0, 149.0, 151.0, 170.0, 290.0];
        let levels = [(0.0, Some(2.0)), (edge_s, Some(0.0))];
        let own = respond(&[], &levels, &times, &times);
        for n in [0.15, 0.5, 0.85] {
            let power = |t: f64| (t + 0.03).powf(-n);
            for variant in 0..3 {
                let found = respond(&[("constant-phase", variant, &[k, n])], &levels, &times, &times);
                for (place, &t) in times.iter().enumerate() {
                    let charging = if t < edge_s { power(t) } else { 0.0 };
                    let expected = match variant {
                        2 => charging,
                        _ if t < edge_s => charging,
                        _ => power(t) - power(t - edge_s),
                    };
                    let more = (found.current_a[place] - own.current_a[place]) / (0.1 * 2.0 * k);
                    assert!(
                        (more - expected).abs() < 3e-3 * power(t).max(expected.abs()),
                        "{variant} {n} {t}: {more} {expected}"
                    );
                }
                let pairs = found.curvature_per_cm.iter().zip(&own.curvature_per_cm);
                let most = pairs.fold(0.0_f64, |most, (with, own)| most.max((with - own).abs()));
                assert_eq!(most > 1e-5, variant == 0, "{variant} {n}: {most}");
            }
        }
    }
}
