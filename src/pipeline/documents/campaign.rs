//! What holds across runs, as the document of `ieap diagnose --json` states it.

use schemars::JsonSchema;
use serde::Serialize;

use crate::analysis::false_discovery::CLAIMED_BELOW;
use crate::analysis::laws::covariate::Covariate;
use crate::analysis::laws::design::Level;
use crate::analysis::laws::doubt::{Doubted, Treatment};
use crate::analysis::laws::fitted::{Fitted, Interval};
use crate::analysis::laws::offset::LengthDoubt;
use crate::analysis::laws::rivals::RuledOut;
use crate::analysis::laws::selection::Selection;
use crate::analysis::laws::{CampaignLaws, Dependence, words};
use crate::domain::Estimate;

/// An effect that only a comparison of runs shows: one that may be claimed.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct CampaignEntry {
    /// Id of the effect.
    pub effect: &'static str,
    /// Material; none for what is said of all.
    pub material: Option<String>,
    /// Sample; none for what is said of a material.
    pub sample: Option<String>,
    /// Stored key of the parameter, or `runs` of what is said of runs as such.
    pub parameter: String,
    /// What it follows.
    pub covariate: &'static str,
    /// By which law.
    pub law: &'static str,
    /// The law's coefficient.
    pub coefficient: Estimate,
    /// Unit of the coefficient in words.
    pub coefficient_unit: &'static str,
    /// Threshold, knee or time constant, in the covariate's unit.
    pub bend_at: Option<Interval>,
    /// Ratio of the parameter between the ends.
    pub ratio: Option<RatioEntry>,
    /// Probability of such a tie by chance.
    pub p: f64,
    /// The same over all questions of its family.
    pub q: f64,
    /// What p rests on.
    pub basis: &'static str,
    /// Covariates that changed with it.
    pub confounded_with: Vec<&'static str>,
    /// Covariates that changed with it and that the readings rule out.
    pub told_apart: Option<ToldApartEntry>,
    /// Ids of the effects that it may be instead.
    pub confounded_effects: Vec<&'static str>,
    /// Covariates that were allowed for.
    pub adjusted_for: Vec<&'static str>,
    /// Number of runs.
    pub runs: usize,
    /// Number of samples.
    pub samples: usize,
    /// Fitted runs left out, for they give a bound or nothing.
    pub left_out: usize,
    /// Whether runs within samples, or samples, were compared.
    pub compared: &'static str,
    /// Laws that were compared, the chosen one first.
    pub laws: Vec<LawEntry>,
    /// The finding in words.
    pub sentence: String,
}

/// By how much the readings tell covariates apart that the design ties.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ToldApartEntry {
    /// Part of the variation that the covariate leaves alone.
    pub left: f64,
    /// Those that are ruled out, the nearest rival first.
    pub ruled_out: Vec<RuledOutEntry>,
}

/// A covariate that the readings rule out.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct RuledOutEntry {
    /// The covariate.
    pub covariate: &'static str,
    /// Part of the variation that it leaves alone.
    pub left: f64,
    /// Twice the logarithm of the odds against it.
    pub evidence: f64,
}

/// Ratio of a parameter between two ends.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct RatioEntry {
    /// One end, in the covariate's unit, or a name.
    pub from: serde_json::Value,
    /// The other.
    pub to: serde_json::Value,
    /// Ratio with its interval.
    #[serde(flatten)]
    pub ratio: Interval,
}

/// A law that was compared.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct LawEntry {
    /// The law.
    pub law: &'static str,
    /// Bayesian information criterion less that without a law.
    pub bic: f64,
    /// Root mean square deviation of left-out samples over that without a law.
    pub left_out: Option<f64>,
}

/// One question, whatever the answer.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct CampaignTest {
    /// Id of the effect.
    pub effect: &'static str,
    /// Material.
    pub material: Option<String>,
    /// Stored key of the parameter.
    pub parameter: String,
    /// What it may follow.
    pub covariate: &'static str,
    /// Covariates that changed with it.
    pub confounded_with: Vec<&'static str>,
    /// Probability of such a tie by chance.
    pub p: f64,
    /// The same over all questions of its family.
    pub q: f64,
    /// What can be said.
    pub sentence: String,
}

/// What a design ties together.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ConfoundedEntry {
    /// Material.
    pub material: String,
    /// Covariates.
    pub covariates: Vec<&'static str>,
    /// Within samples or between them.
    pub compared: &'static str,
    /// In words.
    pub sentence: String,
}

/// Fits of a group whose misfit is claimed.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct DoubtedEntry {
    /// Name of the group.
    pub group: String,
    /// `widened` or `left-out`.
    pub treatment: &'static str,
    /// Runs that this is about.
    pub runs: Vec<String>,
    /// Ids of the causes that its finding names.
    pub causes: Vec<String>,
    /// In words.
    pub sentence: String,
}

/// Groups whose fits are in doubt.
pub fn doubted(laws: &CampaignLaws) -> Vec<DoubtedEntry> {
    let entry = |one: &Doubted| DoubtedEntry {
        group: one.group.clone(),
        treatment: match one.treatment {
            Treatment::Widened => "widened",
            Treatment::LeftOut => "left-out",
        },
        runs: one.runs.clone(),
        causes: one.causes.clone(),
        sentence: words::doubted(one),
    };
    laws.doubted.iter().map(entry).collect()
}

/// Entries of what may be claimed.
pub fn entries(laws: &CampaignLaws) -> Vec<CampaignEntry> {
    let mut entries: Vec<CampaignEntry> = laws.claimed().map(dependence).collect();
    let lengths = laws
        .lengths
        .iter()
        .filter(|found| found.q <= CLAIMED_BELOW && found.explains_all);
    entries.extend(lengths.map(length));
    let selections = laws.selections.iter().filter(|found| found.q <= CLAIMED_BELOW);
    entries.extend(selections.map(selection));
    entries
}

/// Every question.
pub fn tests(laws: &CampaignLaws) -> Vec<CampaignTest> {
    let of_laws = laws.dependences.iter().map(|found| CampaignTest {
        effect: effect(found.covariate),
        material: Some(found.material.clone()),
        parameter: found.parameter.clone(),
        covariate: found.covariate.key(),
        confounded_with: keys(&found.confounded_with),
        p: found.p,
        q: found.q,
        sentence: words::sentence(found),
    });
    let of_lengths = laws.lengths.iter().map(|found| CampaignTest {
        effect: "geometry-error",
        material: Some(found.material.clone()),
        parameter: "length_mm".to_owned(),
        covariate: Covariate::Sample.key(),
        confounded_with: Vec::new(),
        p: found.p,
        q: found.q,
        sentence: if found.q <= CLAIMED_BELOW && found.explains_all {
            words::length(found)
        } else {
            format!("The parameters of sample {} show no wrong length.", found.sample)
        },
    });
    let of_failures = laws.selections.iter().map(|found| CampaignTest {
        effect: "selection",
        material: None,
        parameter: "runs".to_owned(),
        covariate: found.covariate,
        confounded_with: Vec::new(),
        p: found.p,
        q: found.q,
        sentence: if found.q <= CLAIMED_BELOW {
            words::selection(found)
        } else {
            "That runs failed otherwise than at random is not shown.".to_owned()
        },
    });
    of_laws.chain(of_lengths).chain(of_failures).collect()
}

/// What the design ties together.
pub fn confounded(laws: &CampaignLaws) -> Vec<ConfoundedEntry> {
    let entry = |set: &crate::analysis::laws::find::TiedSet| ConfoundedEntry {
        material: set.material.clone(),
        covariates: keys(&set.covariates),
        compared: compared(set.level),
        sentence: words::in_runs_of(&[&set.material], &words::tied(set, laws)),
    };
    laws.tied.iter().map(entry).collect()
}

fn dependence(found: &Dependence) -> CampaignEntry {
    let law = found.laws.first();
    let change = found.change();
    let stated = found.stated();
    let ratio = change
        .filter(|_| stated.is_some() && found.covariate != Covariate::Sample)
        .map(|change| RatioEntry {
            from: end(found, |span| span.low, |jump| &jump.from),
            to: end(found, |span| span.high, |jump| &jump.to),
            ratio: if found.is_log {
                change.map(f64::exp)
            } else {
                change
            },
        });
    let effects: Vec<&'static str> = found
        .confounded_with
        .iter()
        .filter_map(|covariate| covariate.effect())
        .filter(|other| *other != effect(found.covariate))
        .collect();
    let mut confounded_effects = effects;
    confounded_effects.dedup();
    CampaignEntry {
        effect: effect(found.covariate),
        material: Some(found.material.clone()),
        sample: None,
        parameter: found.parameter.clone(),
        covariate: found.covariate.key(),
        law: stated.map_or("unknown", |(law, _)| law.key()),
        coefficient: stated.map_or_else(
            || Estimate::not_determined("it changes by no law that is known here"),
            |(_, coefficient)| coefficient.estimate(),
        ),
        coefficient_unit: stated.map_or("", |(law, _)| law.coefficient_unit()),
        bend_at: law.filter(|_| stated.is_some()).and_then(|law| law.bend_at),
        ratio,
        p: found.p,
        q: found.q,
        basis: found.basis.key(),
        confounded_with: keys(&found.confounded_with),
        told_apart: told_apart(found),
        confounded_effects,
        adjusted_for: keys(&found.adjusted_for),
        runs: found.runs,
        samples: found.samples.len(),
        left_out: found.left_out,
        compared: compared(found.level),
        laws: found.laws.iter().map(|law| law_entry(found, law)).collect(),
        sentence: words::sentence(found),
    }
}

fn told_apart(found: &Dependence) -> Option<ToldApartEntry> {
    let told = &found.told_apart;
    let entry = |rival: &RuledOut| RuledOutEntry {
        covariate: rival.covariate.key(),
        left: rival.left,
        evidence: rival.evidence,
    };
    (!told.ruled_out.is_empty()).then(|| ToldApartEntry {
        left: told.left,
        ruled_out: told.ruled_out.iter().map(entry).collect(),
    })
}

fn end(
    found: &Dependence,
    number: fn(crate::analysis::laws::shape::Span) -> f64,
    name: fn(&crate::analysis::laws::jump::Jump) -> &String,
) -> serde_json::Value {
    match (&found.jump, found.span) {
        (Some(jump), _) => name(jump).clone().into(),
        (None, Some(span)) => number(span).into(),
        (None, None) => serde_json::Value::Null,
    }
}

fn law_entry(found: &Dependence, law: &Fitted) -> LawEntry {
    LawEntry {
        law: law.law.key(),
        bic: law.bic - found.bic_of_none,
        left_out: law.left_out_rms.map(|rms| rms / found.rms_of_none),
    }
}

fn length(found: &LengthDoubt) -> CampaignEntry {
    CampaignEntry {
        effect: "geometry-error",
        sample: Some(found.sample.clone()),
        parameter: "length_mm".to_owned(),
        covariate: Covariate::Sample.key(),
        law: "factor",
        coefficient: found.factor.estimate(),
        coefficient_unit: "true over stated length",
        p: found.p,
        q: found.q,
        basis: "normal-errors",
        samples: found.samples,
        compared: compared(Level::Between),
        sentence: words::length(found),
        ..blank(Some(found.material.clone()))
    }
}

fn selection(found: &Selection) -> CampaignEntry {
    let coefficient = match found.shift {
        Some(shift) => Estimate {
            value: Some(shift),
            ..Estimate::not_determined("a difference of means")
        },
        None => Estimate::not_determined("names have no size"),
    };
    CampaignEntry {
        effect: "selection",
        parameter: "runs".to_owned(),
        covariate: found.covariate,
        law: "uneven",
        coefficient,
        coefficient_unit: "mean of failed runs less that of usable ones",
        p: found.p,
        q: found.q,
        basis: "permutation",
        runs: found.attempts,
        left_out: found.failed,
        sentence: words::selection(found),
        ..blank(None)
    }
}

fn blank(material: Option<String>) -> CampaignEntry {
    CampaignEntry {
        effect: "",
        material,
        sample: None,
        parameter: String::new(),
        covariate: "",
        law: "",
        coefficient: Estimate::not_determined(""),
        coefficient_unit: "",
        bend_at: None,
        ratio: None,
        p: 1.0,
        q: 1.0,
        basis: "",
        confounded_with: Vec::new(),
        told_apart: None,
        confounded_effects: Vec::new(),
        adjusted_for: Vec::new(),
        runs: 0,
        samples: 0,
        left_out: 0,
        compared: compared(Level::Within),
        laws: Vec::new(),
        sentence: String::new(),
    }
}

fn effect(covariate: Covariate) -> &'static str {
    covariate.effect().unwrap_or("")
}

fn keys(covariates: &[Covariate]) -> Vec<&'static str> {
    covariates.iter().map(|covariate| covariate.key()).collect()
}

fn compared(level: Level) -> &'static str {
    match level {
        Level::Within => "runs",
        Level::Between => "samples",
    }
}
