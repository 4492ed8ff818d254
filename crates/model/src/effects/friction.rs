//! Dead zone between force and motion: sticking, play, a support that is touched.

use ieap_numerics::sums::add;

use super::{About, EffectParameter, Equation, Limits, Scale, Search};
use crate::extended::{Observation, RunContext, System};

/// See the module.
pub(super) struct Friction;

static ABOUT: About = About {
    id: "friction",
    code: "M8",
    summary: "dead zone, stick",
    equation: "play: kappa follows kappa_q at a distance of at most w (play operator); spread: the mean of plays with w/4, 3w/4, 5w/4 and 7w/4",
    variants: &["play", "spread"],
    parameters: &[EffectParameter {
        key: "width_per_cm",
        symbol: "w",
        unit: "1/cm",
        meaning: "half width of the dead zone",
    }],
    vanishes: "w = 0",
    signature: "no motion at first and after every reversal",
    twins: &["camera-delay", "mechanical-lag", "threshold-relaxation"],
    separated_by: "small reversals, or a tap on the stand",
    sources: "play operator of Prandtl and Ishlinskii",
};

struct Play {
    width: f64,
    /// Where the curvature may turn at a corner, s.
    edges_s: Vec<f64>,
}

impl Play {
    /// The point at which the curvature turns smoothly around `t[1]`: time and value, by a parabola.
    fn turn(&self, t: [f64; 3], y: [f64; 3]) -> Option<(f64, f64)> {
        let (rise, fall) = (y[1] - y[0], y[2] - y[1]);
        if rise * fall >= 0.0 || self.edges_s.iter().any(|edge| (edge - t[1]).abs() < 1e-9) {
            return None;
        }
        let (before, after) = (rise / (t[1] - t[0]), fall / (t[2] - t[1]));
        let curve = (after - before) / (t[2] - t[0]);
        let slope = (before * (t[2] - t[1]) + after * (t[1] - t[0])) / (t[2] - t[0]);
        let away = -slope / (2.0 * curve);
        Some((t[1] + away, y[1] - slope * slope / (4.0 * curve)))
    }
}

impl Observation for Play {
    fn observe(&self, clock_s: &[f64], curvature_per_cm: &mut [f64]) {
        let own = curvature_per_cm.to_vec();
        let mut seen = 0.0_f64;
        let mut turned = None;
        for (k, kappa) in curvature_per_cm.iter_mut().enumerate() {
            // A search may try parameters at which the model has no number: it is passed on, for the search to turn back.
            let mut visit = |y: f64| {
                seen = if y.is_nan() {
                    f64::NAN
                } else {
                    seen.clamp(y - self.width, y + self.width)
                };
            };
            if let Some(y) = turned.take() {
                visit(y);
            }
            if k > 0 && k + 1 < own.len() {
                let turn = self.turn(
                    [clock_s[k - 1], clock_s[k], clock_s[k + 1]],
                    [own[k - 1], own[k], own[k + 1]],
                );
                match turn {
                    Some((t, y)) if t <= clock_s[k] => visit(y),
                    later => turned = later.map(|(_, y)| y),
                }
            }
            visit(own[k]);
            *kappa = seen;
        }
    }
}

/// Widths of the plays of a contact that gives way bit by bit, in terms of their mean.
const SPREAD: [f64; 4] = [0.25, 0.75, 1.25, 1.75];

/// The mean of several plays.
struct Plays(Vec<Play>);

impl Observation for Plays {
    fn observe(&self, clock_s: &[f64], curvature_per_cm: &mut [f64]) {
        if let [only] = self.0.as_slice() {
            return only.observe(clock_s, curvature_per_cm);
        }
        let own = curvature_per_cm.to_vec();
        curvature_per_cm.fill(0.0);
        for play in &self.0 {
            let mut seen = own.clone();
            play.observe(clock_s, &mut seen);
            let share = 1.0 / self.0.len() as f64;
            add(curvature_per_cm, share, &seen);
        }
    }
}

impl Equation for Friction {
    const ABOUT: &'static About = &ABOUT;

    fn search(&self, _variant: usize, scale: &Scale) -> Search {
        Search::over(
            0.01 * scale.curvature_per_cm,
            vec![Limits::linear(0.0, 0.3 * scale.curvature_per_cm)],
            &[],
        )
    }

    fn apply(&self, variant: usize, parameters: &[f64], run: &RunContext, system: &mut System) {
        let start_s = run.start_s();
        let widths: &[f64] = if variant == 0 { &[1.0] } else { &SPREAD };
        let segments = run.drive.segments.iter();
        let edges_s: Vec<f64> = segments.map(|segment| segment.start_s() - start_s).collect();
        let play = |part: &f64| Play {
            width: part * parameters[0].max(0.0),
            edges_s: edges_s.clone(),
        };
        system
            .observations
            .push(Box::new(Plays(widths.iter().map(play).collect())));
    }
}

#[cfg(test)]
mod tests {
    use super::{Observation, Play};

    #[test]
    fn nothing_moves_within_the_dead_zone() {
        let play = Play {
            width: 0.2,
            edges_s: vec![2.0],
        };
        let mut kappa = vec![0.0, 0.1, 1.0, 0.8, 0.5, 0.9, 1.2];
        play.observe(&[0.0, 1.0, 2.0, 3.0, 3.1, 3.2, 3.3], &mut kappa);
        let (turned, last) = (kappa[4], kappa[6]);
        assert_eq!(kappa[..4], [0.0, 0.0, 0.8, 0.8]);
        assert!((0.6..=0.7).contains(&turned), "{turned}");
        assert!((last - 1.0).abs() < 1e-12);
    }

    #[test]
    fn of_many_plays_the_narrow_ones_move_first() {
        let play = |part: &f64| Play {
            width: 0.4 * part,
            edges_s: vec![0.0],
        };
        let plays = super::Plays(super::SPREAD.iter().map(play).collect());
        let mut kappa = vec![0.0, 0.1, 0.4, 2.0];
        plays.observe(&[0.0, 1.0, 2.0, 3.0], &mut kappa);
        assert!((kappa[1] - 0.0).abs() < 1e-12 && (kappa[3] - 1.6).abs() < 1e-12);
        assert!((kappa[2] - (0.3 + 0.1) / 4.0).abs() < 1e-12, "{kappa:?}");
    }

    #[test]
    fn a_model_without_a_number_stays_without_one() {
        let play = Play {
            width: 0.2,
            edges_s: vec![0.0],
        };
        let mut kappa = vec![0.0, 1.0, f64::NAN, 1.0, 2.0];
        play.observe(&[0.0, 1.0, 2.0, 3.0, 4.0], &mut kappa);
        assert!(kappa[..2].iter().all(|k| k.is_finite()) && kappa[2..].iter().all(|k| k.is_nan()));
    }

    /// A parabola's top between two readings is met.
    #[test]
    fn a_smooth_top_is_found_between_readings() {
        let play = Play {
            width: 0.1,
            edges_s: vec![0.0],
        };
        let times: Vec<f64> = (0..8).map(|k| 0.4 * f64::from(k)).collect();
        let mut kappa: Vec<f64> = times.iter().map(|t| 1.0 - (t - 1.1) * (t - 1.1)).collect();
        play.observe(&times, &mut kappa);
        assert!((kappa[3] - 0.9).abs() < 1e-12, "{kappa:?}");
    }
}
