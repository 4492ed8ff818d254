//! The finding about a group, put together.

mod causes;
mod effects;
mod forms;

use ieap_domain::{
    DiagnosisNoise, EffectFinding, GroupDiagnosis, MisfitPercent, Parameter, ParameterScatter,
    ParameterShift, ResidualCurve, RunAlone, StrengthProfile, Verdict,
};

use crate::cause::between::refused_in_words;
use crate::cause::decide::{Facts, decide, differ};
use crate::cause::evidence::{Asked, SURE, Standing, weigh};
use crate::cause::lead::{Lead, Settled};
use crate::cause::proof::held_out::Part;
use crate::cause::select::Selection;
use crate::cause::selection_input::SelectionInput;
use crate::fitting::fitted::Fitted;
use crate::fitting::profile::profiles;
use crate::levels::{RIGHT_FROM, VISIBLE_PERCENT, WRONG_BELOW};
use crate::misfit::misfit_size::misfit_percent;
use crate::misfit::null::Null;
use crate::misfit::residual_bins::ResidualBin;
use crate::misfit::signature::{Direction, Signature};
use crate::misfit::visible::visible_percent;
use crate::misfit::whereabouts::whereabouts;
use crate::options::DiagnoseOptions;
use crate::outcome::alone::{alone, are_described, doubts, in_words as alone_in_words};
use crate::outcome::gain::{gain, proof};
use crate::outcome::next_run::next_run;
use crate::outcome::noise_words::{of_scatter, of_slow_noise};
use crate::outcome::policy::{MOST_OF_MISFIT, SPIKED_PART};
use crate::readings::drawn::{drawn, paired};
use crate::readings::group::{RunGroup, RunInput, channel_name};
use crate::readings::tags::not_asked;
use ieap_fit::left_out_in_words;
use ieap_model::effects::effect;
use ieap_numerics::random_effects::Spread;
use ieap_numerics::sums::dot;

const SPIKED_WORDS: &str =
    "More than one reading in twenty stands far off its neighbours: the readings allow no finding.";

/// What is known before a cause is looked for.
pub(crate) struct FindingBuilder<'a, 'g> {
    pub(crate) name: &'a str,
    pub(crate) group: &'g RunGroup<'g>,
    pub(crate) base: &'a Fitted<'g>,
    pub(crate) null: &'a Null,
    pub(crate) directions: &'a [Direction],
    pub(crate) signatures: &'a [Signature],
    pub(crate) bins: &'a [ResidualBin],
    pub(crate) residuals: &'a [f64],
    pub(crate) p_misfit: f64,
    /// What each parameter scatters by; empty of fewer runs than tell it.
    pub(crate) scatter: &'a [Spread],
    pub(crate) options: &'a DiagnoseOptions,
}

/// A group without readings that could be diagnosed.
pub(crate) fn nothing(name: &str, runs: &[RunInput], options: &DiagnoseOptions) -> GroupDiagnosis {
    GroupDiagnosis::data_problem(
        name,
        runs.iter().map(|run| run.name.to_owned()).collect(),
        options.model.id,
        "No run of this group has enough readings of current or curvature after the step to be diagnosed."
            .into(),
    )
}

impl<'g> FindingBuilder<'_, 'g> {
    /// Consistent, undecided, or readings that allow no finding.
    pub(crate) fn without_cause(&self) -> GroupDiagnosis {
        let mut found = self.frame();
        let is_visible = is_visible(found.visible_percent);
        found.verdict = match () {
            () if self.is_spiked() => Verdict::DataProblem,
            () if self.p_misfit >= RIGHT_FROM && is_visible => Verdict::Consistent,
            () => Verdict::Undecided,
        };
        let places = self.by_forecast();
        found.confusable = self.confusable(places.iter().map(|(place, _)| *place));
        found.candidates = self.forecasts();
        if found.verdict == Verdict::DataProblem {
            found.sentence = SPIKED_WORDS.into();
        }
        found
    }

    /// With what the selection found.
    pub(crate) fn with_cause(
        &self,
        input: &SelectionInput<'_, 'g>,
        selection: &Selection<'g>,
    ) -> GroupDiagnosis {
        let mut found = self.frame();
        let weighed = weigh(&Asked {
            group: self.group,
            base: self.base,
            selection,
            model: self.options.model,
        });
        // Where parameters that differ carry weight, each run by itself must be described by its own.
        let first = weighed.posterior(Standing::ALL);
        let may_differ = differ(&first) > 1.0 - SURE;
        let mut runs_alone = may_differ.then(|| self.alone());
        let is_described = runs_alone.as_deref().is_some_and(are_described);
        let Settled { lead, posterior } = input.settled(&weighed, is_described);
        if differ(&posterior) > 1.0 - SURE
            && let Some(varying) = &weighed.varying
        {
            found.differs = varying.told(self.group, self.base);
        }
        let predicts = lead
            .as_ref()
            .is_some_and(|lead| lead.held_out.passed(self.gain_of(lead)));
        let ids = lead.as_ref().map_or_else(Vec::new, Lead::ids);
        let decision = decide(&Facts {
            posterior: &posterior,
            lead: &ids,
            is_adequate: lead.as_ref().is_some_and(Lead::is_adequate),
            explains_most: lead.as_ref().is_some_and(|lead| self.explains_most(lead)),
            predicts,
            is_clear: lead
                .as_ref()
                .is_some_and(|lead| proof(self.group, &lead.held_out).is_clear()),
        });
        found.posterior = posterior;
        found.verdict = decision.verdict;
        found.set = decision.set;
        found.node = decision.node;
        if self.is_spiked() {
            (found.verdict, found.node) = (Verdict::DataProblem, None);
            found.sentence = SPIKED_WORDS.into();
            found.set.clear();
        }
        found.remarks.extend(refused_in_words(&selection.dealt));
        found.candidates = self.candidates(selection, lead.as_ref(), found.verdict.extends_the_model());
        let candidates = selection.steps.first().map_or(&[][..], |step| &step.candidates);
        found.confusable = self.confusable(candidates.iter().map(|candidate| candidate.direction));
        if let Some(lead) = lead.as_ref().filter(|_| found.verdict != Verdict::Varies) {
            self.add_lead(&mut found, selection, lead);
        }
        if found.verdict == Verdict::Varies {
            found
                .remarks
                .extend(doubts(runs_alone.as_deref().unwrap_or_default()));
        }
        if found.verdict == Verdict::Unknown && self.group.runs.len() > 1 {
            let alone = runs_alone.get_or_insert_with(|| self.alone());
            found.remarks.extend(alone_in_words(alone));
        }
        if matches!(found.verdict, Verdict::Varies | Verdict::Unknown) {
            found.alone = runs_alone.unwrap_or_default();
        }
        found
    }

    /// Every run by itself.
    fn alone(&self) -> Vec<RunAlone> {
        let given: Vec<RunInput> = self.group.runs.iter().map(|run| run.given).collect();
        alone(&given, self.options)
    }

    /// Fall of the sum of squares by what leads.
    fn gain_of(&self, lead: &Lead) -> f64 {
        self.base.square - lead.model.square
    }

    /// Whether it takes more than half of what the base leaves beyond noise.
    fn explains_most(&self, lead: &Lead) -> bool {
        self.gain_of(lead) > MOST_OF_MISFIT * (self.base.square - self.group.rows() as f64)
    }

    /// What the leading explanation is worth; and where it is told, what it is.
    fn add_lead(&self, found: &mut GroupDiagnosis, selection: &Selection<'g>, lead: &Lead<'g>) {
        let model = &lead.model;
        found.p_leftover = Some(lead.p_leftover);
        found.gain = Some(gain(self.group, self.base, model, &lead.held_out));
        found.residuals = paired(std::mem::take(&mut found.residuals), &self.drawn(model));
        let of = |parts: &[Part]| {
            parts
                .iter()
                .flat_map(|part| part.curves.clone())
                .collect::<Vec<_>>()
        };
        found.held_out_residuals = paired(of(&lead.held_out.before), &of(&lead.held_out.after));
        if !found.verdict.extends_the_model() {
            return;
        }
        let forms = self.other_forms(model);
        let profiles = profiles(self.group, model);
        found.effects = self.findings(selection, model, &found.set, &profiles, &forms);
        let is_strength = |profile: &StrengthProfile| {
            let about = effect(&profile.effect).map(|effect| effect.about());
            about.is_some_and(|about| about.parameters[0].key == profile.key)
        };
        found.profiles = profiles.into_iter().filter(is_strength).collect();
        found.remarks.extend(in_words(&found.effects, &forms));
        found.shifts = self.shifts(model);
        found.next_run = self.next_run(selection, &found.set);
    }

    /// Everything that does not depend on a cause.
    fn frame(&self) -> GroupDiagnosis {
        let given: Vec<RunInput> = self.group.runs.iter().map(|run| run.given).collect();
        let mut remarks = Vec::new();
        for run in &self.group.runs {
            for (channel, left_out_s) in run.left_out_s.iter().enumerate() {
                if !left_out_s.is_empty() {
                    let words = left_out_in_words(channel_name(channel), left_out_s);
                    remarks.push(format!("{}: {words}", run.given.name));
                }
            }
        }
        remarks.extend(crate::readings::louder::remarks(self.group));
        let (scatter, scatter_is_noise) = (self.scatter(), self.group.scatter().is_some());
        remarks.extend(of_scatter(&scatter, scatter_is_noise));
        let noise = self.noise();
        let visible_percent = visible_percent(self.group, self.base, self.bins);
        remarks.extend(of_slow_noise(&noise, visible_percent));
        // Where the model is right its time constants do not depend on the record.
        if self.p_misfit < WRONG_BELOW {
            remarks.extend(crate::readings::record_length::remark(
                self.group,
                self.options.model,
            ));
            remarks.extend(not_asked(self.group));
        }
        GroupDiagnosis {
            p_misfit: Some(self.p_misfit),
            whereabouts: Some(whereabouts(self.group, self.null, self.bins, self.residuals)),
            gain_at_5_percent: Some(self.null.gain_at_5_percent()),
            noise,
            residuals: self.drawn(self.base),
            misfit_percent: misfit_percent(self.group, self.base),
            visible_percent,
            scatter,
            scatter_is_noise,
            remarks,
            ..nothing(self.name, &given, self.options)
        }
    }

    fn scatter(&self) -> Vec<ParameterScatter> {
        let of = |(k, spread): (usize, &Spread)| ParameterScatter {
            key: self.base.base_key(k),
            percent: 100.0 * spread.best,
            low_95_percent: 100.0 * spread.low,
            high_95_percent: 100.0 * spread.high,
        };
        self.scatter.iter().enumerate().map(of).collect()
    }

    fn noise(&self) -> Vec<DiagnosisNoise> {
        let of = |block: &crate::readings::group::Block| {
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
        let (mut left_out, mut readings) = (0, 0);
        for run in &self.group.runs {
            left_out += run.left_out();
            readings += run
                .channels
                .iter()
                .flatten()
                .map(|channel| channel.len())
                .sum::<usize>();
        }
        left_out as f64 > SPIKED_PART * readings.max(1) as f64
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

    fn next_run(&self, selection: &Selection<'g>, set: &[String]) -> Option<ieap_domain::NextRun> {
        let step = selection.steps.first()?;
        let fitted = step
            .candidates
            .iter()
            .filter(|candidate| set.iter().any(|id| id == candidate.effect));
        let members: Vec<(&'static str, &Fitted)> = fitted
            .filter_map(|candidate| Some((candidate.effect, candidate.fitted.as_ref()?)))
            .take(5)
            .collect();
        next_run(self.group, &members)
    }

    /// What a model leaves of every run; where runs scatter, with each run's own deviations, for these are noise.
    fn drawn(&self, model: &Fitted) -> Vec<ResidualCurve> {
        let found = model.problem.model(&model.at);
        let own = self.group.own_models(&found);
        let of_block = |block: &crate::readings::group::Block| {
            let run = &self.group.runs[block.run];
            let fitted = &run.fitted(&own[block.run], &run.context(block.run, None))[block.channel];
            drawn(self.group, block, fitted, &|_| true)
        };
        self.group.blocks.iter().filter_map(of_block).collect()
    }
}

/// Whether an error that matters would have been seen.
fn is_visible(visible: MisfitPercent) -> bool {
    let each = [visible.current, visible.curvature].into_iter().flatten();
    each.fold(0.0, f64::max) <= VISIBLE_PERCENT
}

/// What is said of forms of the first effect that explain the readings as well.
fn in_words(effects: &[EffectFinding], forms: &[(&'static str, Vec<Parameter>)]) -> Option<String> {
    let first = effects.first()?;
    let others: Vec<&str> = forms.iter().map(|(name, _)| *name).collect();
    (!others.is_empty()).then(|| {
        format!(
            "{}: as \"{}\" it explains the readings as well as \"{}\"; the interval of its strength holds them all",
            first.effect,
            others.join("\", \""),
            first.variant.as_deref().unwrap_or_default()
        )
    })
}
