//! The finding about a group, put together.

mod effects;
mod forms;

use ieap_domain::{
    Account, DiagnosisNoise, EffectFinding, GroupDiagnosis, MisfitPercent, Parameter, ParameterScatter,
    ParameterShift, ResidualCurve, RunAlone, StrengthProfile, Verdict,
};

use crate::cause::evidence::{Varying, by_voltage};
use crate::cause::proof::by_size::between;
use crate::cause::proof::held_out::{HeldOut, Part};
use crate::fitting::fitted::Fitted;
use crate::fitting::profile::profiles;
use crate::levels::{RIGHT_FROM, VISIBLE_PERCENT, WRONG_BELOW};
use crate::misfit::misfit_size::misfit_percent;
use crate::misfit::null::Null;
use crate::misfit::residual_bins::ResidualBin;
use crate::misfit::signature::{Direction, Signature};
use crate::misfit::visible::visible_percent;
use crate::misfit::whereabouts::whereabouts;
use crate::missing::account::account;
use crate::missing::look::{Found, Lead};
use crate::missing::policy::INEXACT;
use crate::options::DiagnoseOptions;
use crate::outcome::alone::{alone, are_right};
use crate::outcome::gain::{gain, gain_of_runs};
use crate::outcome::next_run::next_run;
use crate::outcome::noise_words::{of_scatter, of_slow_noise};
use crate::outcome::policy::SPIKED_PART;
use crate::readings::drawn::{drawn, paired};
use crate::readings::group::{RunGroup, RunInput, channel_name};
use ieap_fit::left_out_in_words;
use ieap_model::effects::effect;
use ieap_numerics::random_effects::Spread;
use ieap_numerics::sums::{dot, mean};

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
    /// Right, undecided, or readings that allow no finding.
    pub(crate) fn without_cause(&self) -> GroupDiagnosis {
        let mut found = self.frame();
        let is_visible = is_visible(found.visible_percent);
        found.verdict = match () {
            () if self.is_spiked() => Verdict::DataProblem,
            () if self.p_misfit >= RIGHT_FROM && is_visible => Verdict::Right,
            () => Verdict::Undecided,
        };
        if found.verdict == Verdict::DataProblem {
            found.sentence = SPIKED_WORDS.into();
        }
        found
    }

    /// Right where a misfit of that size is smaller than what is tolerated; else wrong, and nothing told of it yet.
    pub(crate) fn of_size(&self, misfit_percent: MisfitPercent) -> GroupDiagnosis {
        let mut found = GroupDiagnosis {
            misfit_percent,
            ..self.without_cause()
        };
        if found.verdict != Verdict::DataProblem {
            found.verdict = if self.is_tolerated(found.misfit_percent) {
                Verdict::Right
            } else {
                Verdict::Unexplained
            };
        }
        found
    }

    /// With what was found of the misfit.
    pub(crate) fn with_law(&self, missing: Found<'g>) -> GroupDiagnosis {
        let mut found = self.frame();
        found.verdict = missing.verdict;
        found.account = Some(missing.account);
        let by_voltage = || missing.varying.as_ref()?.by_voltage(self.group, self.base);
        let mut held_out = None;
        if found.verdict == Verdict::Differs {
            held_out = by_voltage();
        } else if self.group.runs.len() > 1 && !explains_all(&missing) {
            found.alone = self.alone();
            if are_right(&found.alone) {
                held_out = by_voltage();
                if self.rather_differs(&missing, held_out.as_ref()) {
                    found.verdict = Verdict::Differs;
                }
            }
        }
        if found.verdict == Verdict::Differs
            && let Some(varying) = &missing.varying
        {
            self.add_differing(&mut found, varying, held_out);
        }
        found.posterior = missing.posterior;
        if found.verdict == Verdict::Law {
            found.missing = missing.laws;
        }
        let names = found.missing.iter().flat_map(|law| law.names.clone());
        found.set.extend(names);
        if let Some(lead) = missing
            .lead
            .as_ref()
            .filter(|_| found.verdict != Verdict::Differs)
        {
            self.add_lead(&mut found, lead);
        }
        let rivals = missing.rivals.iter();
        let rivals: Vec<(&str, &Fitted)> = rivals.map(|(name, fitted)| (name.as_str(), fitted)).collect();
        if matches!(found.verdict, Verdict::Law | Verdict::Unexplained) {
            found.next_run = next_run(self.group, &rivals);
        }
        if self.is_spiked() {
            found.verdict = Verdict::DataProblem;
            found.sentence = SPIKED_WORDS.into();
            found.set.clear();
            found.missing.clear();
        }
        found
    }

    /// Whether a misfit is smaller than what is tolerated.
    fn is_tolerated(&self, misfit: MisfitPercent) -> bool {
        let each = [misfit.current, misfit.curvature, misfit.charge];
        let largest = each.into_iter().flatten().fold(0.0, f64::max);
        largest < self.options.tolerance_percent
    }

    /// Every run by itself.
    fn alone(&self) -> Vec<RunAlone> {
        let given: Vec<RunInput> = self.group.runs.iter().map(|run| run.given).collect();
        alone(&given, self.options)
    }

    /// Whether it is said of runs that are each right by themselves that they differ: of these nothing is wrong but that one set
    /// of parameters is to describe them. A law that leaves more than chance is said instead where it explains as much as
    /// parameters of each run's own, but for what no law is exact to, and predicts runs left out that others lie on both sides of
    /// better than lines of the parameters over the voltage do.
    fn rather_differs(&self, missing: &Found<'g>, by_voltage: Option<&HeldOut>) -> bool {
        if missing.varying.is_none() {
            return false;
        }
        let Some(lead) = missing.lead.as_ref().filter(|_| !missing.laws.is_empty()) else {
            return true;
        };
        let account = &missing.account;
        if account.between_runs > INEXACT * account.beyond_noise() {
            return true;
        }
        let beside = by_voltage.and_then(|lines| {
            let both = HeldOut {
                before: lines.after.clone(),
                after: lead.held_out.after.clone(),
            };
            both.log_odds_between(&between(self.group, Some("voltage_v")))
        });
        beside.is_some_and(|law_over_lines| law_over_lines < 0.0)
    }

    /// What differs, and what it is worth as laws of the voltage.
    fn add_differing(&self, found: &mut GroupDiagnosis, varying: &Varying, held_out: Option<HeldOut>) {
        found.account = Some(account(self.group, self.base, None, Some(varying.own_square())));
        found.differs = varying.told(self.group, self.base);
        let differing = found.differs.iter();
        found.set = differing.map(|own| format!("varies:{}", own.key)).collect();
        let Some(held_out) = held_out else {
            return;
        };
        let squares = (self.base.square, varying.square());
        let of_voltage = between(self.group, Some("voltage_v"));
        let gain = gain_of_runs(self.group, squares, &held_out, &of_voltage);
        if !gain.proof.is_clear() {
            found.remarks.extend(by_voltage::next_in_words(self.group));
        }
        found.gain = Some(gain);
    }

    /// What the leading explanation is worth; and where it is told, what it is.
    fn add_lead(&self, found: &mut GroupDiagnosis, lead: &Lead<'g>) {
        let model = &lead.model;
        found.p_leftover = lead.p_leftover;
        found.gain = Some(gain(self.group, self.base, model, lead));
        found.residuals = paired(std::mem::take(&mut found.residuals), &self.drawn(model));
        let of = |parts: &[Part]| {
            parts
                .iter()
                .flat_map(|part| part.curves.clone())
                .collect::<Vec<_>>()
        };
        found.held_out_residuals = paired(of(&lead.held_out.before), &of(&lead.held_out.after));
        if found.verdict != Verdict::Law {
            return;
        }
        let forms = self.other_forms(model);
        let profiles = profiles(self.group, model);
        found.effects = self.findings(model, &found.set, &profiles, &forms);
        let is_strength = |profile: &StrengthProfile| {
            let about = effect(&profile.effect).map(|effect| effect.about());
            about.is_some_and(|about| about.parameters[0].key == profile.key)
        };
        found.profiles = profiles.into_iter().filter(is_strength).collect();
        found.remarks.extend(in_words(&found.effects, &forms));
        found.shifts = self.shifts(model);
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
        }
        GroupDiagnosis {
            p_misfit: Some(self.p_misfit),
            whereabouts: Some(whereabouts(self.group, self.null, self.bins, self.residuals)),
            noise,
            residuals: self.drawn(self.base),
            misfit_percent: misfit_percent(self.group, self.base),
            tolerance_percent: self.options.tolerance_percent,
            account: Some(if self.p_misfit < WRONG_BELOW {
                account(self.group, self.base, None, None)
            } else {
                // What chance leaves is noise.
                Account {
                    noise: 100.0,
                    ..Account::default()
                }
            }),
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
            Some(DiagnosisNoise {
                run: self.group.runs[block.run].given.name.to_owned(),
                channel: channel_name(block.channel).to_owned(),
                standard_deviation: mean(channel.standard_deviation()),
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

/// Whether the laws that are told leave no more than chance does.
fn explains_all(missing: &Found) -> bool {
    let left = missing.lead.as_ref().and_then(|lead| lead.p_leftover);
    left.is_some_and(|p| p >= RIGHT_FROM)
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
