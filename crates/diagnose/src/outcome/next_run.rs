//! The run that would tell the members of a set apart.

use ieap_domain::number::fixed;
use ieap_domain::number::seconds::seconds;
use ieap_domain::{Drive, NextRun};
use ieap_model::extended::ExtendedModel;
use ieap_numerics::least_squares::Local;
use ieap_numerics::sums::{dot, mean};
use ieap_numerics::symmetric::Symmetric;

use crate::cause::policy::AS_GOOD;
use crate::fitting::fitted::Fitted;
use crate::outcome::policy::READINGS_OF_NEXT_RUN;
use crate::readings::group::RunGroup;

/// The best of the known drives for telling `members` (fitted models with their names) apart.
pub(crate) fn next_run(group: &RunGroup, members: &[(&str, &Fitted)]) -> Option<NextRun> {
    if members.len() < 2 {
        return None;
    }
    let strongest = group
        .runs
        .iter()
        .max_by(|a, b| volts(a.drive()).total_cmp(&volts(b.drive())))?;
    let step_v = strongest.drive().nominal_step_v();
    let longest_s = strongest.duration_s;
    let proposals = proposals(step_v, longest_s);
    let judged = proposals.into_iter().map(|(words, drive, duration_s)| {
        let (size, splits) = after(group, members, &drive, duration_s);
        (size, words, splits)
    });
    let (expected_set_size, drive, splits) = judged.min_by(|a, b| a.0.total_cmp(&b.0))?;
    (!splits.is_empty()).then_some(NextRun {
        drive,
        splits,
        expected_set_size,
    })
}

fn volts(drive: &Drive) -> f64 {
    drive.nominal_step_v().abs()
}

/// Drives that are known to separate causes, for a sample that was stepped to `v` V for `t` s: in words, as a drive, and
/// how long it takes, s.
pub fn proposals(v: f64, t: f64) -> Vec<(String, Drive, f64)> {
    let of = |levels: &[(f64, Option<f64>)]| Drive::of_levels(0.0, levels.iter().copied());
    let t_s = seconds(t);
    let on_s = (t / 30.0).max(1.0);
    let pulses: Vec<(f64, Option<f64>)> = (0..30)
        .map(|k| (f64::from(k) * on_s, Some(if k % 2 == 0 { v } else { 0.0 })))
        .collect();
    vec![
        (
            format!("{} V for {t_s} s, then 0 V for {t_s} s", fixed(v, 2)),
            of(&[(0.0, Some(v)), (t, Some(0.0))]),
            2.0 * t,
        ),
        (
            format!("{} V for {t_s} s (half the voltage)", fixed(v / 2.0, 2)),
            of(&[(0.0, Some(v / 2.0))]),
            t,
        ),
        (
            format!("{} V for {t_s} s (reversed)", fixed(-v, 2)),
            of(&[(0.0, Some(-v))]),
            t,
        ),
        (
            format!(
                "{} V and 0 V in turn, {} s each, 15 times",
                fixed(v, 2),
                seconds(on_s)
            ),
            of(&pulses),
            30.0 * on_s,
        ),
        (
            format!("{} V for {t_s} s, then open circuit for {t_s} s", fixed(v, 2)),
            of(&[(0.0, Some(v)), (t, None)]),
            2.0 * t,
        ),
        (
            format!(
                "{} V for {t_s} s, then {} V for {t_s} s",
                fixed(v, 2),
                fixed(-v, 2)
            ),
            of(&[(0.0, Some(v)), (t, Some(-v))]),
            2.0 * t,
        ),
        (
            format!("{} V for {} s (longer)", fixed(v, 2), seconds(5.0 * t)),
            of(&[(0.0, Some(v))]),
            5.0 * t,
        ),
    ]
}

/// Mean size of the set after that run, and the members that it would split off from the first.
fn after(
    group: &RunGroup,
    members: &[(&str, &Fitted)],
    drive: &Drive,
    duration_s: f64,
) -> (f64, Vec<String>) {
    let mut alike = vec![vec![true; members.len()]; members.len()];
    for (a, (_, truth)) in members.iter().enumerate() {
        for (b, (_, rival)) in members.iter().enumerate() {
            if a != b {
                alike[a][b] = distance(group, truth, rival, drive, duration_s) < AS_GOOD;
            }
        }
    }
    let sizes: Vec<f64> = alike
        .iter()
        .map(|row| row.iter().filter(|x| **x).count() as f64)
        .collect();
    let splits = members
        .iter()
        .zip(&alike)
        .filter(|(_, row)| row.iter().any(|x| !*x))
        .map(|((id, _), _)| (*id).to_owned());
    (mean(&sizes), splits.collect())
}

/// Sum of squares by which `rival`, refitted to old and new readings, would miss what `truth` gives on the new run.
fn distance(group: &RunGroup, truth: &Fitted, rival: &Fitted, drive: &Drive, duration_s: f64) -> f64 {
    let times: Vec<f64> = (1..=READINGS_OF_NEXT_RUN)
        .map(|k| duration_s * k as f64 / READINGS_OF_NEXT_RUN as f64)
        .collect();
    let run = &group.runs[0];
    let mut context = run.context(0, None);
    context.drive = drive;
    context.duration_s = duration_s;
    let sizes: [f64; 2] = std::array::from_fn(|k| {
        let of_run = |run: &crate::readings::group::GroupRun| {
            let channel = run.channels[k].as_ref()?;
            Some(mean(channel.standard_deviation()) * channel.readings_per_independent().sqrt())
        };
        group
            .runs
            .iter()
            .filter_map(of_run)
            .next()
            .unwrap_or(f64::INFINITY)
    });
    let weighted = |model: &ExtendedModel| -> Vec<f64> {
        let found = model.responses(&context, &times, &times);
        let current = found.current_a.iter().map(|v| v / sizes[0]);
        current
            .chain(found.curvature_per_cm.iter().map(|v| v / sizes[1]))
            .collect()
    };
    let here = weighted(&rival.problem.model(&rival.at));
    let there = weighted(&truth.problem.model(&truth.at));
    let miss: Vec<f64> = there.iter().zip(&here).map(|(a, b)| a - b).collect();
    let (slope, _) = rival.tangent();
    let columns: Vec<Vec<f64>> = (0..rival.at.len())
        .map(|k| {
            let mut at = rival.at.clone();
            at[k] += 1e-4;
            let moved = weighted(&rival.problem.model(&at));
            moved.iter().zip(&here).map(|(m, h)| (m - h) / 1e-4).collect()
        })
        .collect();
    let told = Local::of(&miss, &columns);
    let both = |a, b| slope.normal.get(a, b) + told.normal.get(a, b);
    let step = Symmetric::from_fn(columns.len(), both).solve(&told.descent, 1e-12);
    let left = told.square - dot(&told.descent, &step);
    if left.is_finite() { left } else { f64::INFINITY }
}
