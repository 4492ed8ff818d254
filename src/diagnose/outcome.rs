//! The finding about a group, put together.

use crate::domain::{
    Candidate, Confusable, DiagnosisNoise, EffectFinding, GroupDiagnosis, ParameterShift, ResidualCurve,
    Verdict,
};
use crate::model::effects::effect;

use super::candidates::{AS_GOOD, INEXACT, Looked, PRICE};
use super::drawn::{drawn, paired};
use super::fitted::Fitted;
use super::gain::gain;
use super::group::Group;
use super::held_out::Part;
use super::next_run::next_run;
use super::null::{self, Null};
use super::problem::Problem;
use super::profile::profiles;
use super::select::{BEATEN, Selection};
use super::signature::{Direction, Signature};
use super::stretch::Stretch;
use super::words::{channel_name, whereabouts};
use super::{DiagnoseOptions, RunInput};
use crate::numerics::sums::dot;

/// The simulation is called wrong below this p, and right from the second on.
pub(super) const WRONG: f64 = 0.01;
const RIGHT: f64 = 0.05;
/// Where a misfit is left, a first cause that explains less than this part of everything names nothing.
const MOST_OF_IT: f64 = 0.8;
/// Spikes beyond this part of the readings make the readings themselves the problem.
const SPIKED: f64 = 0.05;
/// Candidates that are reported.
const REPORTED: usize = 20;
/// Candidates whose traces are compared with each other.
const COMPARED: usize = 10;
/// A strength that is known to this part of itself is one number: a law without free strength is held against it.
const SHARP: f64 = 0.1;

/// What is known before a cause is looked for.
pub(super) struct Shown<'a, 'g> {
    pub(super) name: &'a str,
    pub(super) group: &'g Group<'g>,
    pub(super) base: &'a Fitted<'g>,
    pub(super) null: &'a Null,
    pub(super) directions: &'a [Direction],
    pub(super) signatures: &'a [Signature],
    pub(super) stretches: &'a [Stretch],
    pub(super) residuals: &'a [f64],
    pub(super) p_misfit: f64,
    pub(super) options: &'a DiagnoseOptions,
}

/// A group without readings that could be diagnosed.
pub(super) fn nothing(name: &str, runs: &[RunInput], options: &DiagnoseOptions) -> GroupDiagnosis {
    GroupDiagnosis::data_problem(
        name,
        runs.iter().map(|run| run.name.to_owned()).collect(),
        options.model.id,
        "No run of this group has enough readings of current or curvature after the step to be diagnosed."
            .into(),
    )
}

impl<'g> Shown<'_, 'g> {
    /// Consistent, undecided, or readings that allow no finding.
    pub(super) fn without_cause(&self) -> GroupDiagnosis {
        let mut found = self.frame();
        found.verdict = if self.is_spiked() {
            Verdict::DataProblem
        } else if self.p_misfit >= RIGHT {
            Verdict::Consistent
        } else {
            Verdict::Undecided
        };
        let places = self.by_forecast();
        found.confusable = self.confusable(places.iter().map(|(place, _)| *place));
        found.candidates = self.forecasts();
        found.sentence = match found.verdict {
            Verdict::Consistent => format!(
                "The simulation is right to within the noise (p = {:.2}).",
                self.p_misfit
            ),
            Verdict::DataProblem => SPIKED_WORDS.into(),
            _ => format!(
                "The simulation may be wrong (p = {:.3}): too much for chance to be sure, too little to name a cause; {}.",
                self.p_misfit,
                found.whereabouts.as_ref().map_or("", |w| &w.text)
            ),
        };
        found
    }

    /// With what the selection found.
    pub(super) fn with_cause(&self, selection: &Selection<'g>) -> GroupDiagnosis {
        let mut found = self.frame();
        let model = &selection.model;
        let taken: Vec<&'static str> = model
            .problem
            .effects
            .iter()
            .map(|sought| sought.effect.about().id)
            .collect();
        let total = self.base.square - model.square;
        let passed = selection
            .held_out
            .as_ref()
            .is_some_and(|held_out| held_out.passed(total));
        let sets = self.sets(selection);
        found.candidates = self.candidates(selection, passed);
        let looked = selection.steps.first().map_or(&[][..], |step| &step.looked);
        found.confusable = self.confusable(looked.iter().map(|looked| looked.direction));
        found.p_leftover = (!taken.is_empty()).then_some(selection.p_leftover);
        let rest = (selection.leftover.together - self.expected_together())
            .max(selection.leftover.candidate)
            .max(0.0);
        let first = match &selection.proved {
            Some(_) => total,
            None => selection
                .steps
                .first()
                .and_then(|step| step.looked.first())
                .map_or(0.0, |looked| looked.gain),
        };
        let explained = first / (total + rest).max(1e-300);
        found.verdict = match () {
            () if self.is_spiked() => Verdict::DataProblem,
            () if taken.is_empty() || !passed || !self.determines(model) => Verdict::Unknown,
            () if selection.p_leftover < WRONG && explained < MOST_OF_IT => Verdict::Unknown,
            () if selection.p_leftover < WRONG => Verdict::Partial,
            () if sets.iter().all(|set| set.len() == 1) => Verdict::Named,
            () => Verdict::Set,
        };
        if found.verdict != Verdict::Unknown && found.verdict != Verdict::DataProblem {
            found.effects = self.findings(selection, &sets);
            let mut members: Vec<String> = Vec::new();
            for id in sets.iter().flatten() {
                if !members.iter().any(|other| other == id) {
                    members.push((*id).to_owned());
                }
            }
            found.set = members;
            found.shifts = self.shifts(model);
            found.profiles = profiles(self.group, model);
            found.next_run = self.next_run(selection, &sets);
        }
        found.gain = selection
            .held_out
            .as_ref()
            .map(|held_out| gain(self.group, self.base, model, held_out));
        if !taken.is_empty() {
            found.residuals = paired(std::mem::take(&mut found.residuals), &self.drawn(model));
        }
        if let Some(held_out) = &selection.held_out {
            let of = |parts: &[Part]| {
                parts
                    .iter()
                    .flat_map(|part| part.curves.clone())
                    .collect::<Vec<_>>()
            };
            found.held_out_residuals = paired(of(&held_out.before), &of(&held_out.after));
        }
        found.sentence = self.sentence(&found, &taken, passed);
        found
    }

    /// Whether the readings tell the strength of the effect from none. Of several effects none is there whose leaving
    /// out would not cost much more than chance: a strength that is drawn towards none only by the uncertain shape of
    /// another is no doubt of it.
    fn determines(&self, model: &Fitted) -> bool {
        let [sought] = model.problem.effects.as_slice() else {
            return true;
        };
        let parameters = model.effect_parameters(self.group);
        let strength = parameters[0].first().map(|parameter| &parameter.estimate);
        let interval = strength.and_then(|estimate| estimate.low_95.zip(estimate.high_95));
        // A logarithm never reaches none: there the gain alone decides.
        let limits = sought.limits[0];
        limits.held || limits.logarithmic || interval.is_some_and(|(low, high)| low * high > 0.0)
    }

    /// Everything that does not depend on a cause.
    fn frame(&self) -> GroupDiagnosis {
        let given: Vec<RunInput> = self.group.runs.iter().map(|run| run.given).collect();
        let mut remarks = Vec::new();
        for run in &self.group.runs {
            for (channel, &spikes) in run.spikes.iter().enumerate() {
                if spikes > 0 {
                    remarks.push(format!(
                        "{}: {spikes} single readings of the {} stand far off their neighbours and are left out",
                        run.given.name,
                        channel_name(channel)
                    ));
                }
            }
        }
        // Where the model is right its time constants do not depend on the record.
        if self.p_misfit < WRONG {
            remarks.extend(super::record_length::remark(self.group, self.options.model));
        }
        GroupDiagnosis {
            p_misfit: Some(self.p_misfit),
            whereabouts: Some(whereabouts(self.group, self.null, self.stretches, self.residuals)),
            gain_at_5_percent: Some(self.null.gain_at_5_percent()),
            noise: self.noise(),
            residuals: self.drawn(self.base),
            remarks,
            ..nothing(self.name, &given, self.options)
        }
    }

    fn noise(&self) -> Vec<DiagnosisNoise> {
        let of = |block: &super::group::Block| {
            let channel = self.group.channel(block)?;
            let character = channel.character();
            let rows = &self.residuals[block.first..block.end];
            let mean = channel.standard_deviation().iter().sum::<f64>() / channel.len() as f64;
            Some(DiagnosisNoise {
                run: self.group.runs[block.run].given.name.to_owned(),
                channel: channel_name(block.channel).to_owned(),
                standard_deviation: mean,
                autoregression: character.autoregression,
                correlation_time_s: character.correlation_time_s,
                proportional: character.proportional,
                readings: channel.len(),
                independent_readings: channel.len() as f64 / channel.readings_per_independent(),
                residual_rms_sigma: (dot(rows, rows) / rows.len() as f64).sqrt(),
            })
        };
        self.group.blocks.iter().filter_map(of).collect()
    }

    fn is_spiked(&self) -> bool {
        let (mut spikes, mut readings) = (0, 0);
        for run in &self.group.runs {
            spikes += run.spikes.iter().sum::<usize>();
            readings += run
                .channels
                .iter()
                .flatten()
                .map(|channel| channel.len())
                .sum::<usize>();
        }
        spikes as f64 > SPIKED * readings.max(1) as f64
    }

    fn expected_together(&self) -> f64 {
        self.null.independent_stretches() as f64
    }

    /// How alike the traces of the leading candidates are.
    fn confusable(&self, places: impl Iterator<Item = usize>) -> Confusable {
        let leading: Vec<&Direction> = places
            .take(COMPARED)
            .map(|place| &self.directions[place])
            .collect();
        let likeness = |a: &Direction, b: &Direction| dot(&a.unit, &b.unit).abs().min(1.0);
        Confusable {
            effects: leading
                .iter()
                .map(|direction| self.signatures[direction.signature].effect.about().id.to_owned())
                .collect(),
            likeness: leading
                .iter()
                .map(|a| leading.iter().map(|b| likeness(a, b)).collect())
                .collect(),
        }
    }

    /// The best direction of every effect with its forecast, the best first.
    fn by_forecast(&self) -> Vec<(usize, f64)> {
        let mut best: Vec<(usize, f64)> = Vec::new();
        for (place, direction) in self.directions.iter().enumerate() {
            let id = self.signatures[direction.signature].effect.about().id;
            let forecast = null::gain(direction, self.residuals);
            let same = |(other, _): &&mut (usize, f64)| {
                self.signatures[self.directions[*other].signature]
                    .effect
                    .about()
                    .id
                    == id
            };
            match best.iter_mut().find(same) {
                Some(known) if known.1 < forecast => *known = (place, forecast),
                Some(_) => {}
                None => best.push((place, forecast)),
            }
        }
        best.sort_by(|a, b| b.1.total_cmp(&a.1));
        best
    }

    /// Candidates by forecast alone.
    fn forecasts(&self) -> Vec<Candidate> {
        let best = self.by_forecast();
        let first = best.first().map(|(place, _)| *place);
        best.iter()
            .take(REPORTED)
            .map(|&(place, forecast)| self.candidate(place, first, forecast))
            .collect()
    }

    fn candidate(&self, place: usize, best: Option<usize>, forecast_gain: f64) -> Candidate {
        let direction = &self.directions[place];
        let signature = &self.signatures[direction.signature];
        let about = signature.effect.about();
        // Seen in 80 % of groups: 0.84 standard deviations beyond what chance passes in 5 %.
        let seen = self.null.gain_at_5_percent().sqrt() + 0.84;
        let likeness = best.map_or(0.0, |best| {
            dot(&direction.unit, &self.directions[best].unit).abs()
        });
        Candidate {
            effect: about.id.to_owned(),
            variant: about.variants.get(signature.variant).map(|v| (*v).to_owned()),
            forecast_gain,
            fitted_gain: None,
            extra_parameters: signature.sought().free(),
            held_out_gain: None,
            left_after_refit: direction.left,
            detectable_strength: detectable(signature, seen / direction.norm),
            likeness,
            accepted: false,
        }
    }

    fn candidates(&self, selection: &Selection, passed: bool) -> Vec<Candidate> {
        let Some(step) = selection.steps.first() else {
            return self.forecasts();
        };
        let first = step.looked.first().map(|looked| looked.direction);
        let taken: Vec<&str> = selection
            .model
            .problem
            .effects
            .iter()
            .map(|sought| sought.effect.about().id)
            .collect();
        let held_out: Option<f64> = selection.held_out.as_ref().map(|h| h.falls().iter().sum());
        let of = |looked: &Looked| {
            let accepted = passed && taken.contains(&looked.effect);
            Candidate {
                fitted_gain: looked.fitted.as_ref().map(|_| looked.gain),
                held_out_gain: held_out.filter(|_| taken == [looked.effect]),
                accepted,
                ..self.candidate(looked.direction, first, looked.forecast)
            }
        };
        step.looked.iter().take(REPORTED).map(of).collect()
    }

    /// For every effect of the model the ids that could stand in its place, itself first.
    fn sets(&self, selection: &Selection<'g>) -> Vec<Vec<&'static str>> {
        if let Some(proved) = &selection.proved {
            return vec![proved.clone()];
        }
        let effects = &selection.model.problem.effects;
        if let ([_], Some(step)) = (effects.as_slice(), selection.steps.first())
            && step
                .looked
                .first()
                .is_some_and(|best| effects[0].effect.about().id == best.effect)
        {
            return vec![self.sharpened(step, &selection.model)];
        }
        (0..effects.len())
            .map(|place| self.stand_ins(selection, place))
            .collect()
    }

    /// The rivals of a single cause; one that has no free strength wins where the fitted strength of its twin is
    /// sharp, for it could have been anything.
    fn sharpened(&self, step: &super::select::Step, model: &Fitted) -> Vec<&'static str> {
        let rivals = step.rivals.clone();
        let is_free = |id: &str| {
            step.looked
                .iter()
                .any(|looked| looked.effect == id && looked.extra > 0)
        };
        let free: Vec<&&str> = rivals.iter().filter(|id| is_free(id)).collect();
        let fixed: Vec<&&str> = rivals.iter().filter(|id| !is_free(id)).collect();
        let sharp = || {
            let twin = step
                .looked
                .iter()
                .find(|looked| rivals.contains(&looked.effect) && is_free(looked.effect));
            let fitted = twin.and_then(|twin| twin.fitted.as_ref()).unwrap_or(model);
            let parameters = fitted.effect_parameters(self.group);
            let strength = parameters.first().and_then(|p| p.first()).map(|p| &p.estimate);
            strength.is_some_and(|s| match (s.value, s.standard_error) {
                (Some(value), Some(sd)) => sd < SHARP * value.abs(),
                _ => false,
            })
        };
        if let ([fixed], false) = (fixed.as_slice(), free.is_empty())
            && sharp()
        {
            return vec![**fixed];
        }
        rivals
    }

    /// Effects that fit as well in the place of one of several.
    fn stand_ins(&self, selection: &Selection<'g>, place: usize) -> Vec<&'static str> {
        let model = &selection.model;
        let own = model.problem.effects[place].effect.about().id;
        let step = selection
            .steps
            .iter()
            .find_map(|step| step.looked.first().filter(|best| best.effect == own));
        let own_gain = step.map_or(0.0, |best| best.gain);
        let mut set = vec![own];
        let taken: Vec<&str> = model
            .problem
            .effects
            .iter()
            .map(|s| s.effect.about().id)
            .collect();
        let known = selection.steps.iter().flat_map(|step| step.looked.iter().take(8));
        for looked in known {
            let Some(fitted) = looked.fitted.as_ref().filter(|_| !taken.contains(&looked.effect)) else {
                continue;
            };
            if set.contains(&looked.effect) {
                continue;
            }
            let Some(other) = fitted.problem.effects.last() else {
                continue;
            };
            let mut effects = model.problem.effects.clone();
            let mut values = model.effect_values();
            let extra = other.free() as f64 - effects[place].free() as f64;
            effects[place] = other.clone();
            values[place] = fitted.effect_values().pop().unwrap_or_default();
            let problem = Problem::new(self.group, &model.base(), effects);
            let start = problem.coordinates(&model.base(), &values);
            let Some(found) = Fitted::search(problem, &[start], &[]).map(Fitted::settled) else {
                continue;
            };
            let margin = AS_GOOD + INEXACT * own_gain;
            if found.square + PRICE * extra < model.square + margin {
                set.push(looked.effect);
            }
        }
        set
    }

    fn findings(&self, selection: &Selection, sets: &[Vec<&'static str>]) -> Vec<EffectFinding> {
        let model = &selection.model;
        let parameters = model.effect_parameters(self.group);
        let each = model.problem.effects.iter().zip(parameters).zip(sets);
        each.map(|((sought, parameters), set)| {
            let about = sought.effect.about();
            let step = selection.steps.iter().find(|step| {
                let is_first = |looked: &Looked| looked.effect == about.id || selection.proved.is_some();
                step.taken && step.looked.first().is_some_and(is_first)
            });
            EffectFinding {
                effect: about.id.to_owned(),
                variant: about.variants.get(sought.variant).map(|v| (*v).to_owned()),
                parameters,
                p: step.map_or(1.0, |step| step.p),
                q: None,
                twins: set
                    .iter()
                    .filter(|id| **id != about.id)
                    .map(|id| (*id).to_owned())
                    .collect(),
            }
        })
        .collect()
    }

    fn shifts(&self, model: &Fitted) -> Vec<ParameterShift> {
        let after = model.base_parameters();
        let of = |(key, before, _): (String, f64, f64)| {
            let (_, after, standard_error) = after.iter().find(|(other, _, _)| *other == key)?;
            Some(ParameterShift {
                key,
                before,
                after: *after,
                standard_error: *standard_error,
            })
        };
        self.base.base_parameters().into_iter().filter_map(of).collect()
    }

    fn next_run(
        &self,
        selection: &Selection<'g>,
        sets: &[Vec<&'static str>],
    ) -> Option<crate::domain::NextRun> {
        let set = sets.iter().find(|set| set.len() > 1)?;
        let step = selection.steps.first()?;
        let fitted = step.looked.iter().filter(|looked| set.contains(&looked.effect));
        let members: Vec<(&'static str, &Fitted)> = fitted
            .filter_map(|looked| Some((looked.effect, looked.fitted.as_ref()?)))
            .take(5)
            .collect();
        next_run(self.group, &members)
    }

    fn drawn(&self, model: &Fitted) -> Vec<ResidualCurve> {
        let found = model.problem.model(&model.at);
        let of_block = |block: &super::group::Block| {
            let run = &self.group.runs[block.run];
            let context = run.context(block.run, None);
            let responses = found.responses(&context, run.times(0), run.times(1));
            let fitted = [&responses.current_a, &responses.curvature_per_cm][block.channel];
            drawn(self.group, block, fitted, &|_| true)
        };
        self.group.blocks.iter().filter_map(of_block).collect()
    }

    fn sentence(&self, found: &GroupDiagnosis, taken: &[&str], passed: bool) -> String {
        let place = found.whereabouts.as_ref().map_or("", |w| &w.text);
        let summary = |id: &str| {
            effect(id).map_or_else(|| id.to_owned(), |e| format!("{} ({})", id, e.about().summary))
        };
        let proof = found.gain.as_ref().map_or_else(String::new, |gain| {
            format!(
                " On held-out readings the extended model lowers the sum of squares by {:.0} +- {:.0}.",
                gain.deviance, gain.standard_error
            )
        });
        match found.verdict {
            Verdict::Named => {
                let names: Vec<String> = taken.iter().map(|id| summary(id)).collect();
                format!("The simulation misses {}: {place}.{proof}", names.join(" and "))
            }
            Verdict::Set => format!(
                "The simulation is wrong ({place}); {} explain it equally well.{proof}",
                found.set.join(", ")
            ),
            Verdict::Partial => format!(
                "The simulation is wrong ({place}); {} explains most of it, and a misfit is left.{proof}",
                taken.join(" with ")
            ),
            Verdict::DataProblem => SPIKED_WORDS.into(),
            _ if !taken.is_empty() && is_beaten(found) => format!(
                "The simulation is wrong ({place}), and no known cause is proved: {} fits, but a smooth answer to the voltage without a name predicts held-out readings better.",
                taken.join(" with ")
            ),
            _ if !taken.is_empty() && !passed => format!(
                "The simulation is wrong ({place}), and no known cause is proved: {} fits, but does not predict held-out readings.",
                taken.join(" with ")
            ),
            _ => format!(
                "The simulation is wrong ({place}), and no known cause explains it. It leaves {:.1} times the noise.",
                (self.base.square / self.group.rows().max(1) as f64).sqrt()
            ),
        }
    }
}

/// Whether what has no name predicts held-out readings better.
fn is_beaten(found: &GroupDiagnosis) -> bool {
    found
        .gain
        .as_ref()
        .is_some_and(|gain| gain.nameless_deviance > gain.deviance + BEATEN)
}

const SPIKED_WORDS: &str =
    "More than one reading in twenty stands far off its neighbours: the readings allow no finding.";

/// Strength of that many times what the signature was taken at.
fn detectable(signature: &Signature, times: f64) -> f64 {
    if signature.absent == 0.0 {
        times * signature.part * signature.probe[0]
    } else {
        signature.probe[0]
    }
}
