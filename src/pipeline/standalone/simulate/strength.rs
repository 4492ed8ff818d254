//! Strengths given in standard deviations: how much of the effect is left after the base parameters are refitted.

use super::effect_spec::EffectSpec;
use super::run_spec::RunSpec;
use super::spec::Spec;
use super::table::{camera_times, current_times};
use super::wrong::Wrong;
use crate::diagnose::{DesignRun, KnownNoise, sigmas_after_refit};
use crate::domain::number::{fixed, significant};
use crate::model::extended::Responses;
use crate::truth::catalogue::KnownParameter;
use crate::truth::{HiddenEffect, simulate};

/// Steps of the search for a strength, and how near to what was asked for it must come.
const STEPS: usize = 24;
const NEAR: f64 = 0.02;

impl Spec {
    /// Puts numbers in the place of strengths that are given as `strength_sigma`.
    pub(super) fn resolve_strengths(&mut self) -> Result<(), Wrong> {
        for place in 0..self.effect.len() {
            let effect = &self.effect[place];
            if let Some(sigma) = effect.strength_sigma {
                let runs: Vec<usize> = (0..self.run.len())
                    .filter(|&run| effect.meets(&self.run[run]))
                    .collect();
                let found = self.strength(effect, sigma, &runs)?;
                self.effect[place].set_strength(found);
            }
        }
        for run in 0..self.run.len() {
            for place in 0..self.run[run].effect.len() {
                let effect = &self.run[run].effect[place];
                if let Some(sigma) = effect.strength_sigma {
                    let found = self.strength(effect, sigma, &[run])?;
                    self.run[run].effect[place].set_strength(found);
                }
            }
        }
        Ok(())
    }

    fn strength(&self, effect: &EffectSpec, sigma: f64, runs: &[usize]) -> Result<f64, Wrong> {
        let place = format!("effect {}: strength_sigma", effect.id);
        let Some(&KnownParameter { key, .. }) = effect.strength() else {
            return Err(Wrong::new(&place, effect.id.clone(), "an effect with a strength"));
        };
        let design = self.design(&place, runs)?;
        let size = |strength: f64| -> Result<f64, Wrong> {
            let mut hidden = effect.hidden();
            hidden.parameters.insert(key.to_owned(), strength);
            let responses = self.responses(&place, &hidden, runs, &design)?;
            let base = self.run[runs[0]].model();
            Ok(sigmas_after_refit(&base, &design, &responses, self.known_noise()))
        };
        let wanted = sigma.abs();
        let mut strength = effect.hidden().parameters.get(key).copied().unwrap_or(sigma);
        let mut reached = size(strength)?;
        for _ in 0..STEPS {
            if (reached / wanted - 1.0).abs() < NEAR {
                return Ok(strength);
            }
            let factor = if reached > 0.0 {
                (wanted / reached).clamp(0.1, 10.0)
            } else {
                10.0
            };
            let Ok(next) = size(strength * factor) else { break };
            strength *= factor;
            reached = next;
        }
        if (reached / wanted - 1.0).abs() < NEAR {
            return Ok(strength);
        }
        let found = format!(
            "{sigma}; at a strength of {} the effect leaves {} sigmas in these runs",
            significant(strength, 4),
            fixed(reached, 2)
        );
        Err(Wrong::new(
            &place,
            found,
            "a number of sigmas that the effect can reach in them",
        ))
    }

    /// The runs as a design; all with the parameters of the first.
    fn design(&self, place: &str, runs: &[usize]) -> Result<Vec<DesignRun>, Wrong> {
        let first = &self.run[runs[0]];
        let differs = |&&run: &&usize| self.run[run].parameters != first.parameters;
        if let Some(&other) = runs.iter().find(differs) {
            let found = format!(
                "{} and {} with different parameters",
                first.file.display(),
                self.run[other].file.display()
            );
            return Err(Wrong::new(
                place,
                found,
                "runs with the same parameters: name them with `runs`",
            ));
        }
        if self.noise.current_a <= 0.0 || self.noise.curvature_per_cm <= 0.0 {
            let needed =
                "noise.current_a and noise.curvature_per_cm above 0: they are what sigmas are counted in";
            return Err(Wrong::new(place, "no noise".into(), needed));
        }
        let run = |&run: &usize| DesignRun {
            drive: self.run[run].drive(),
            area_cm2: self.run[run].area_cm2,
            current_time_s: current_times(self),
            curvature_time_s: camera_times(self),
        };
        Ok(runs.iter().map(run).collect())
    }

    fn responses(
        &self,
        place: &str,
        hidden: &HiddenEffect,
        runs: &[usize],
        design: &[DesignRun],
    ) -> Result<Vec<Responses>, Wrong> {
        let of_run = |(&number, design): (&usize, &DesignRun)| {
            let run: &RunSpec = &self.run[number];
            let truth = run.truth(vec![hidden.clone()]);
            let (current_s, curvature_s) = (&design.current_time_s, &design.curvature_time_s);
            let found = simulate(&truth, &design.drive, current_s, curvature_s, number);
            let found = found.map_err(|error| Wrong::told(place, &error))?;
            Ok(Responses {
                current_a: found.current_a,
                curvature_per_cm: found.curvature_per_cm,
                ..Responses::default()
            })
        };
        runs.iter().zip(design).map(of_run).collect()
    }

    /// The even, correlated part of the noise.
    fn known_noise(&self) -> KnownNoise {
        KnownNoise {
            current_a: self.noise.current_a,
            curvature_per_cm: self.noise.curvature_per_cm,
            autocorrelation: self.noise.current().autocorrelation,
        }
    }
}

impl EffectSpec {
    fn set_strength(&mut self, strength: f64) {
        if let Some(parameter) = self.strength() {
            self.parameters.insert(parameter.key.to_owned(), strength);
            self.strength_sigma = None;
        }
    }
}
