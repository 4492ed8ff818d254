//! How far a strip has bent since it stood in its initial shape, in millimetres and per centimetre.

use ieap_domain::number::fixed;
use ieap_numerics::line::golden;
use serde::Deserialize;
use thiserror::Error;

use super::traced::Trace;

/// Length of a frame's strip may differ from the initial one by this share.
const SAME_LENGTH: f64 = 0.03;
/// Links with which a shape is compared with an arc.
const LINKS: usize = 200;

/// Which turn of the strip counts as positive curvature.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Positive {
    /// Walking from the clamp to the tip, a turn to the left as the picture shows it.
    #[default]
    CounterClockwise,
    /// A turn to the right.
    Clockwise,
}

impl Positive {
    /// Both.
    pub const ALL: [Positive; 2] = [Positive::CounterClockwise, Positive::Clockwise];

    /// As it is written in a sidecar.
    pub fn key(self) -> &'static str {
        match self {
            Positive::CounterClockwise => "counter-clockwise",
            Positive::Clockwise => "clockwise",
        }
    }

    fn sign(self) -> f64 {
        match self {
            Positive::CounterClockwise => 1.0,
            Positive::Clockwise => -1.0,
        }
    }
}

/// A value with its standard error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reading {
    /// The value.
    pub value: f64,
    /// Its standard error.
    pub standard_error: f64,
}

/// The initial shape, from which bending is counted: the mean of one or more frames.
#[derive(Debug, Clone, PartialEq)]
pub struct Initial {
    /// Pixels to a millimetre.
    pub px_per_mm: f64,
    /// Free length, mm.
    pub length_mm: f64,
    /// Arc lengths of the joints between equal vectors, mm from the clamp.
    pub joints_mm: Vec<f64>,
    length_px: f64,
    curvature_per_px: Vec<Reading>,
    mean_per_px: Reading,
    tip_px: (f64, f64),
    tip_error_px: f64,
    angle_rad: f64,
    positive: Positive,
}

/// The scale of a view.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Scale {
    /// Pixels to a millimetre.
    PixelsPerMm(f64),
    /// Free length of the strip, mm: the traced length is that.
    LengthMm(f64),
}

/// A frame's strip does not belong to the initial one.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[error(
    "the strip is {} pixels long here and {} in its initial shape: part of it is hidden, or it bends out of the plane",
    fixed(*.found_px, 0),
    fixed(*.needed_px, 0)
)]
pub struct OtherLength {
    /// Length here, pixels.
    pub found_px: f64,
    /// Length of the initial shape, pixels.
    pub needed_px: f64,
}

/// What a frame says of the bending.
#[derive(Debug, Clone, PartialEq)]
pub struct Bending {
    /// Curvature at each joint less the initial one, 1/cm.
    pub curvature_per_cm: Vec<Reading>,
    /// Mean curvature over the length less the initial one, 1/cm.
    pub mean_per_cm: Reading,
    /// How far the tip has moved across the direction in which the initial strip leaves the clamp, mm.
    pub tip_displacement_mm: Reading,
    /// Distance (root mean square) between the shape and the arc of a circle that fits it best, mm.
    pub arc_deviation_mm: f64,
    /// Length of strip over which the curvature is smoothed, mm.
    pub bandwidth_mm: f64,
}

impl Initial {
    /// The mean of traced frames, cut into `vectors` of equal length; none of no frame.
    pub fn of(traces: &[Trace], scale: Scale, vectors: usize, positive: Positive) -> Option<Initial> {
        let n = traces.len() as f64;
        let first = traces.first()?;
        let mean = |of: &dyn Fn(&Trace) -> f64| traces.iter().map(of).sum::<f64>() / n;
        let length_px = mean(&|trace| trace.length_px());
        let px_per_mm = match scale {
            Scale::PixelsPerMm(px_per_mm) => px_per_mm,
            Scale::LengthMm(length_mm) => length_px / length_mm,
        };
        let averaged = |of: &dyn Fn(&Trace) -> (f64, f64)| Reading {
            value: mean(&|trace| of(trace).0),
            standard_error: (traces.iter().map(|trace| of(trace).1.powi(2)).sum::<f64>()).sqrt() / n,
        };
        let joints_px: Vec<f64> = (1..vectors)
            .map(|k| length_px * k as f64 / vectors as f64)
            .collect();
        Some(Initial {
            px_per_mm,
            length_mm: length_px / px_per_mm,
            joints_mm: joints_px.iter().map(|s| s / px_per_mm).collect(),
            curvature_per_px: joints_px
                .iter()
                .map(|&s| averaged(&|trace| trace.curvature_per_px(s)))
                .collect(),
            mean_per_px: averaged(&|trace| trace.mean_curvature_per_px()),
            tip_px: (mean(&|trace| trace.tip_px().0), mean(&|trace| trace.tip_px().1)),
            tip_error_px: first.tip_across_error_px() / n.sqrt(),
            angle_rad: mean(&|trace| trace.clamp_angle_rad()),
            length_px,
            positive,
        })
    }

    /// The straight strip of a trace's length that leaves the clamp as the trace does: curvature and displacement are
    /// then those of the shape itself.
    pub fn straight(trace: &Trace, scale: Scale, vectors: usize, positive: Positive) -> Option<Initial> {
        let exact = Reading {
            value: 0.0,
            standard_error: 0.0,
        };
        let angle_rad = trace.clamp_angle_rad();
        let (root, length_px) = (trace.point_px(0.0), trace.length_px());
        let mut initial = Initial::of(std::slice::from_ref(trace), scale, vectors, positive)?;
        initial.curvature_per_px.fill(exact);
        initial.mean_per_px = exact;
        initial.tip_error_px = 0.0;
        initial.tip_px = (
            root.0 + length_px * angle_rad.cos(),
            root.1 - length_px * angle_rad.sin(),
        );
        Some(initial)
    }

    /// Bending of a frame against the initial shape.
    ///
    /// # Errors
    /// The strip is not as long as the initial one.
    pub fn bending(&self, trace: &Trace) -> Result<Bending, OtherLength> {
        let found_px = trace.length_px();
        if (found_px / self.length_px - 1.0).abs() > SAME_LENGTH {
            return Err(OtherLength {
                found_px,
                needed_px: self.length_px,
            });
        }
        let sign = self.positive.sign();
        let per_cm = 10.0 * self.px_per_mm;
        let less = |(value, error): (f64, f64), initial: &Reading| Reading {
            value: sign * (value - initial.value) * per_cm,
            standard_error: error.hypot(initial.standard_error) * per_cm,
        };
        let curvature_per_cm: Vec<Reading> = self
            .joints_mm
            .iter()
            .zip(&self.curvature_per_px)
            .map(|(s, initial)| less(trace.curvature_per_px(s * self.px_per_mm), initial))
            .collect();
        let tip = trace.tip_px();
        let (dx, dy) = (tip.0 - self.tip_px.0, self.tip_px.1 - tip.1);
        let across = -self.angle_rad.sin() * dx + self.angle_rad.cos() * dy;
        Ok(Bending {
            arc_deviation_mm: self.arc_deviation_mm(&curvature_per_cm),
            curvature_per_cm,
            mean_per_cm: less(trace.mean_curvature_per_px(), &self.mean_per_px),
            tip_displacement_mm: Reading {
                value: sign * across / self.px_per_mm,
                standard_error: trace.tip_across_error_px().hypot(self.tip_error_px) / self.px_per_mm,
            },
            bandwidth_mm: trace.bandwidth_px / self.px_per_mm,
        })
    }

    /// Distance of the shape that those curvatures give to the arc that lies nearest.
    fn arc_deviation_mm(&self, curvature_per_cm: &[Reading]) -> f64 {
        let values: Vec<f64> = curvature_per_cm
            .iter()
            .map(|reading| reading.value / 10.0)
            .collect();
        let step_mm = self.length_mm / LINKS as f64;
        let vectors = values.len() + 1;
        let at = |link: usize| {
            // Between joints straight, beyond the outermost as there.
            let place = (link as f64 + 0.5) * vectors as f64 / LINKS as f64 - 1.0;
            let left = place.floor().clamp(0.0, (values.len() - 1) as f64) as usize;
            let right = (left + 1).min(values.len() - 1);
            let share = (place - left as f64).clamp(0.0, 1.0);
            values[left] + share * (values[right] - values[left])
        };
        if values.is_empty() {
            return 0.0;
        }
        let shape = places(step_mm, at);
        let distance = |per_mm: f64| {
            let arc = places(step_mm, |_| per_mm);
            let square: f64 = shape
                .iter()
                .zip(&arc)
                .map(|(a, b)| (a.0 - b.0).powi(2) + (a.1 - b.1).powi(2))
                .sum();
            (square / LINKS as f64).sqrt()
        };
        // About the mean the distance has one bottom.
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let spread = values
            .iter()
            .map(|value| (value - mean).abs())
            .fold(1e-9, f64::max);
        distance(golden(distance, mean - spread, mean + spread))
    }
}

/// Ends of links of a chain that starts straight, mm.
fn places(step_mm: f64, curvature_per_mm: impl Fn(usize) -> f64) -> Vec<(f64, f64)> {
    let (mut angle, mut at) = (0.0f64, (0.0, 0.0));
    (0..LINKS)
        .map(|link| {
            let turn = curvature_per_mm(link) * step_mm;
            let middle = angle + 0.5 * turn;
            at = (at.0 + step_mm * middle.cos(), at.1 + step_mm * middle.sin());
            angle += turn;
            at
        })
        .collect()
}
