//! How runs are fitted, and who said so: the caller, campaign.toml, or an earlier call that asked for it by hand.

use schemars::JsonSchema;
use serde::Serialize;

use crate::domain::words::counted;
use crate::domain::{AskedFit, Campaign, KnownParameter, key_named};
use crate::fit::{FitError, FitOptions, NoiseBy, Steps, can_be_known};
use crate::model::{FitModel, ModelChoice, fit_models};

/// How runs are fitted.
#[derive(Debug, Clone, Default)]
pub struct FitChoice {
    /// Model to fit with; none takes the campaign's.
    pub model: Option<String>,
    /// Id of the method that searches minima; none takes the campaign's.
    pub method: Option<String>,
    /// Whether current and curvature are fitted together instead of one after the other; false takes the campaign's.
    pub simultaneous: bool,
    /// Seed of a random method; none takes the default.
    pub seed: Option<u64>,
    /// What is known of parameters; nothing takes what the campaign states.
    pub known: Vec<KnownParameter>,
}

impl FitChoice {
    /// As options of a fit with the base model; what is left open is the campaign's.
    pub(crate) fn options(&self, campaign: &Campaign) -> Result<FitOptions<'static>, FitError> {
        Ok(choose(&self.asked(), campaign, &AskedFit::default())?.options)
    }

    /// What is asked for.
    pub(crate) fn asked(&self) -> AskedFit {
        AskedFit {
            model: self.model.clone(),
            method: self.method.clone(),
            simultaneous: self.simultaneous.then_some(true),
            seed: self.seed,
            known: self.known.clone(),
        }
    }
}

/// Who chose how a run is fitted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum ChosenBy {
    /// The caller.
    Asked,
    /// An earlier caller, and nothing that was said since stands against it.
    Kept,
    /// campaign.toml.
    Campaign,
    /// Nobody.
    Default,
}

/// How one run is fitted.
#[derive(Debug, Clone)]
pub(crate) struct Chosen {
    /// The base of `model`, method and steps.
    pub(crate) options: FitOptions<'static>,
    pub(crate) model: ModelChoice,
    /// What was asked for by hand, to be stored with the fit.
    pub(crate) asked: AskedFit,
    /// What of the choice was said at all.
    pub(crate) said: AskedFit,
    pub(crate) by: ChosenBy,
}

/// How a run is fitted: as `asked`; else as campaign.toml states; and what that leaves open as it was `last_asked`.
pub(crate) fn choose(
    asked: &AskedFit,
    campaign: &Campaign,
    last_asked: &AskedFit,
) -> Result<Chosen, FitError> {
    let stated = &campaign.fit;
    let adds = |last: &AskedFit| {
        last.model.is_some() && stated.model.is_none()
            || last.method.is_some() && stated.method.is_none()
            || last.simultaneous.is_some() && stated.simultaneous.is_none()
            || !last.known.is_empty() && stated.known.is_empty()
    };
    let (said, held, by) = if !asked.is_open() {
        (asked.or(stated), asked.clone(), ChosenBy::Asked)
    } else if adds(last_asked) {
        let said = stated.or(last_asked);
        let seed = asked.seed.or(said.seed);
        (AskedFit { seed, ..said }, last_asked.clone(), ChosenBy::Kept)
    } else if stated.is_open() {
        (asked.clone(), AskedFit::default(), ChosenBy::Default)
    } else {
        (asked.or(stated), AskedFit::default(), ChosenBy::Campaign)
    };
    let model = ModelChoice::parse(said.model.as_deref().unwrap_or(&campaign.model))?;
    Ok(Chosen {
        options: options_of(&said, &model)?,
        model,
        asked: held,
        said,
        by,
    })
}

/// What was said, as options of a fit with the base of `model`.
pub(crate) fn options_of(said: &AskedFit, model: &ModelChoice) -> Result<FitOptions<'static>, FitError> {
    let mut options = FitOptions::for_model(model.base.id)?;
    if let Some(method) = &said.method {
        options = options.with_method(method)?;
    }
    if takes_known(model.base) && !model.is_extended() {
        can_be_known(&said.known, model.base)?;
    } else if let Some(unknown) = said.known.iter().find(|known| !is_parameter(&known.parameter)) {
        return Err(FitError::Known {
            found: unknown.to_string(),
            reason: "no model has such a parameter; `ieap list models` lists them".to_owned(),
        });
    }
    if said.simultaneous == Some(true) {
        options.steps = Steps::Simultaneous;
    }
    options.describes_noise = true;
    options.noise = NoiseBy::Kinds(None);
    options.seed = said.seed.unwrap_or(options.seed);
    Ok(options)
}

/// Whether a model has a parameter of that name.
fn is_parameter(name: &str) -> bool {
    let keys = |model: &FitModel| key_named(name, model.parameters.iter().map(|own| own.key)).is_some();
    fit_models().iter().any(keys)
}

/// Whether what is known of parameters is taken into fits with the model.
pub(crate) fn takes_known(model: &FitModel) -> bool {
    model.id.starts_with("lumped-")
}

/// A choice with the number of runs that it holds for.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct HeldChoice {
    /// What of it was said.
    pub said: AskedFit,
    /// By whom.
    pub by: ChosenBy,
    /// Runs.
    pub runs: usize,
    /// Whether campaign.toml states something else, which holds again from the next `run` on.
    pub against_campaign: bool,
}

/// The choices that hold and that somebody made, each with its runs; what only repeats the defaults is left out.
pub(crate) fn held<'a>(chosen: impl Iterator<Item = &'a Chosen>, campaign: &Campaign) -> Vec<HeldChoice> {
    let defaults = FitOptions::default();
    let mut held: Vec<HeldChoice> = Vec::new();
    for one in chosen.filter(|one| one.by != ChosenBy::Default) {
        let differs = one.options.method.id() != defaults.method.id()
            || one.options.steps != defaults.steps
            || !one.said.known.is_empty();
        if one.by == ChosenBy::Campaign && !differs {
            // The model stands with every fit.
            continue;
        }
        match held
            .iter_mut()
            .find(|own| own.said == one.said && own.by == one.by)
        {
            Some(own) => own.runs += 1,
            None => held.push(HeldChoice {
                said: one.said.clone(),
                by: one.by,
                runs: 1,
                against_campaign: campaign.fit.or(&one.said) != one.said.or(&campaign.fit),
            }),
        }
    }
    held
}

impl HeldChoice {
    /// In words: what holds for which runs, where it comes from, and how it is changed.
    pub fn words(&self) -> String {
        let runs = counted(self.runs, "run");
        let said = &self.said;
        let lasting = "`[fit]` (and `model`) in campaign.toml sets it for all runs, those to come as well";
        match self.by {
            ChosenBy::Asked if self.against_campaign => format!(
                "{runs}: {said}, as asked; campaign.toml states another choice, which holds again at the next `ieap run`"
            ),
            ChosenBy::Asked => {
                format!(
                    "{runs}: {said}, as asked; later calls of `ieap run` keep it for these runs; {lasting}"
                )
            }
            ChosenBy::Kept => format!(
                "{runs}: {said}, kept as it was asked for by hand where campaign.toml states nothing; `ieap run --only fit` with other options changes it; {lasting}"
            ),
            ChosenBy::Campaign | ChosenBy::Default => format!("{runs}: {said}, as campaign.toml states"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::domain::testing::campaign;

    fn asked(method: Option<&str>, simultaneous: Option<bool>) -> AskedFit {
        AskedFit {
            method: method.map(str::to_owned),
            simultaneous,
            ..AskedFit::default()
        }
    }

    #[test]
    fn the_caller_goes_before_campaign_toml_and_that_before_an_earlier_caller() {
        let (open, de) = (AskedFit::default(), asked(Some("differential-evolution"), None));
        let mut campaign = campaign();
        let found = |now: &AskedFit, campaign: &Campaign, last: &AskedFit| {
            let chosen = choose(now, campaign, last).unwrap();
            (
                chosen.options.method.id(),
                chosen.options.steps,
                chosen.by,
                chosen.asked,
            )
        };
        let plain = ("variable-projection", Steps::TwoStep);
        assert_eq!(
            found(&open, &campaign, &open),
            (plain.0, plain.1, ChosenBy::Default, open.clone())
        );
        let kept = found(&open, &campaign, &de);
        assert_eq!(
            kept,
            (de.method.as_deref().unwrap(), plain.1, ChosenBy::Kept, de.clone())
        );
        let anew = found(&asked(None, Some(true)), &campaign, &de);
        assert_eq!(
            (anew.0, anew.1, anew.2),
            (plain.0, Steps::Simultaneous, ChosenBy::Asked)
        );
        campaign.fit.method = Some("variable-projection".to_owned());
        let stated = found(&open, &campaign, &de);
        assert_eq!((stated.0, stated.2), (plain.0, ChosenBy::Campaign));
        assert_eq!(
            stated.3, open,
            "what campaign.toml overrules is not kept for later"
        );
    }
}
