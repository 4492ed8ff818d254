//! Electrolysis: a current above an onset voltage that stores no charge and does not bend the strip.

use super::{About, EffectParameter, Equation, Limits, Scale, Search};
use crate::extended::{Coefficients, Law, Now, RunContext, System};

/// See the module.
pub(super) struct FaradaicLeak;

static ABOUT: About = About {
    id: "faradaic-leak",
    code: "E8",
    summary: "electrolysis current above an onset voltage; does not bend the strip",
    equation: "i_F = i_0 (e^x - 1) where x > 0, else 0, along its tangent beyond e^16, x = (|w| - E_on)/s; soft: i_0 ln(1 + e^x); limited: i_0/(1 + e^-x), both less what they are at w = 0; w the voltage of the terminals or of branch 2's capacitor, in the last two forms of the terminals",
    variants: &["terminal", "capacitor", "soft", "limited"],
    parameters: &[
        EffectParameter {
            key: "leak_current_a_per_cm2",
            symbol: "i_0",
            unit: "A/cm2",
            meaning: "scale of the current",
        },
        EffectParameter {
            key: "onset_v",
            symbol: "E_on",
            unit: "V",
            meaning: "voltage above which it flows",
        },
        EffectParameter {
            key: "slope_v",
            symbol: "s",
            unit: "V",
            meaning: "voltage by which the current grows e-fold; width of the onset of the last two forms",
        },
    ],
    vanishes: "i_0 = 0",
    signature: "the end current grows faster than the voltage, and while the capacitor charges",
    twins: &[
        "coupling-saturation",
        "modulus-drift",
        "quadratic-coupling",
        "current-offset",
    ],
    separated_by: "four or more voltages around the onset, a discharge, or a repeat at low humidity",
    sources: "Tafel's law; a limiting current; water's window of 1.23 V; Sci. Rep. 2020 on leakage tails of supercapacitors",
};

/// From this exponent on the current grows along its tangent: e^16 is past any current that a source gives. A plateau would
/// leave onset and slope without a meaning there, and a search on it without a way back.
const STEEPEST: f64 = 16.0;
/// And from this one on no more: no search asks for so many slopes, and steps in time must stay finite.
const MOST: f64 = 40.0;
/// Exponents at the largest voltage that a search starts from: a milliampere over a nanoampere is e^14.
const STEEP: f64 = 12.0;

/// Current over its scale, so many slopes above the onset.
fn growth(above: f64) -> f64 {
    let steep = above.min(STEEPEST);
    steep.exp_m1() + (above.min(MOST) - steep) * steep.exp()
}

/// Current over its scale of the forms that do not begin at the onset, so many slopes above it.
fn gradual(variant: usize, above: f64) -> f64 {
    let above = above.min(MOST);
    match variant {
        2 => above.max(0.0) + (-above.abs()).exp().ln_1p(),
        _ => 1.0 / (1.0 + (-above).exp()),
    }
}

struct Leak {
    variant: usize,
    i0: f64,
    onset_v: f64,
    slope_v: f64,
}

impl Law for Leak {
    fn act(&self, now: &Now, _memory: f64, c: &mut Coefficients) {
        let w = if self.variant != 1 {
            now.terminal_v
        } else {
            now.capacitor_v
                .get(1)
                .or(now.capacitor_v.last())
                .copied()
                .unwrap_or(0.0)
        };
        let above = (w.abs() - self.onset_v) / self.slope_v;
        if self.variant > 1 {
            let at_rest = gradual(self.variant, -self.onset_v / self.slope_v);
            c.leak_a_per_cm2 += self.i0 * (gradual(self.variant, above) - at_rest).copysign(w);
        } else if above > 0.0 {
            c.leak_a_per_cm2 += (self.i0 * growth(above)).copysign(w) * self.i0.signum();
        }
    }
}

impl Equation for FaradaicLeak {
    const ABOUT: &'static About = &ABOUT;

    fn search(&self, variant: usize, scale: &Scale) -> Search {
        let volts = scale.voltage_v;
        if volts <= 0.0 {
            return Search::none();
        }
        let density = scale.current_a / scale.area_cm2;
        let (onsets, slopes): (&[f64], &[f64]) = match variant {
            0 | 1 => (&[0.25, 0.45, 0.6, 0.75, 0.88], &[0.1, 0.3]),
            _ => (&[0.4, 0.75], &[0.15]),
        };
        let onsets: Vec<f64> = onsets.iter().map(|part| part * volts).collect();
        let slopes = slopes.to_vec();
        let limits = vec![
            Limits::logarithmic(1e-8 * density, 100.0 * density),
            Limits::linear(0.05 * volts, volts),
            Limits::logarithmic(volts / 40.0, volts),
        ];
        let mut search = Search::over(0.0, limits, &[onsets, slopes]);
        search
            .probes
            .retain(|probe| (volts - probe[1]) / probe[2] < STEEP);
        for probe in &mut search.probes {
            let above = (volts - probe[1]) / probe[2];
            let most = if variant < 2 {
                growth(above)
            } else {
                gradual(variant, above)
            };
            probe[0] = 0.01 * density / most;
        }
        search
    }

    fn apply(&self, variant: usize, parameters: &[f64], _run: &RunContext, system: &mut System) {
        system.laws.push(Box::new(Leak {
            variant,
            i0: parameters[0],
            onset_v: parameters[1],
            slope_v: parameters[2],
        }));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gradual_onsets_are_known_at_and_far_above_their_onset() {
        use super::super::tests::respond;
        assert!((gradual(2, 0.0) - 2.0_f64.ln()).abs() < 1e-15 && (gradual(3, 0.0) - 0.5).abs() < 1e-15);
        let (i0, levels) = (1e-3, [(0.0, Some(-2.0))]);
        let more = |variant| {
            let with = respond(
                &[("faradaic-leak", variant, &[i0, 1.2, 0.02])],
                &levels,
                &[100.0],
                &[],
            );
            let with = with.current_a[0];
            with - respond(&[], &levels, &[100.0], &[]).current_a[0]
        };
        assert!((more(2) + 0.1 * i0 * 0.8 / 0.02).abs() < 1e-9);
        assert!((more(3) + 0.1 * i0).abs() < 1e-9);
    }

    #[test]
    fn beyond_what_a_source_gives_the_current_goes_on_along_its_tangent() {
        assert_eq!(growth(4.0), 4.0_f64.exp_m1());
        let slope = |above: f64| (growth(above + 1e-6) - growth(above - 1e-6)) / 2e-6;
        for above in [STEEPEST - 0.001, STEEPEST + 0.001, 39.0] {
            assert!((slope(above) / STEEPEST.exp() - 1.0).abs() < 2e-3, "{above}");
        }
        assert_eq!(growth(MOST), growth(400.0));
        assert!((growth(20.0) / (5.0 * STEEPEST.exp() - 1.0) - 1.0).abs() < 1e-12);
    }
}
