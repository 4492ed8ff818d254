//! Which model describes which material in which environment: comparisons of single runs, summed up.

pub mod view;

use ieap_domain::number::{fixed, significant};
use ieap_domain::tag::keys;
use ieap_domain::words::counted;
use ieap_domain::{Campaign, ModelScore, Quantity, ResponseScore, RunComparison, RunRecord};

use crate::conditions::{Conditions, compared_material, conditions};

/// Models whose BIC differ by less are not told apart: the weight of one against the other is below e^5 = 150.
const TOLD_APART: f64 = 10.0;
/// Predictions that are worse by no more than this factor are as good.
const ALIKE: f64 = 1.1;
/// What is left counts as noise up to this multiple of it.
const TO_THE_NOISE: f64 = 1.2;

/// That stored comparisons are not shown, since what they were made from has changed; empty where there are none.
pub fn outdated(count: usize) -> String {
    match count {
        0 => String::new(),
        many => format!(
            "{}, not shown, made from what is no longer so: ieap compare makes them again.",
            counted(many, "comparison")
        ),
    }
}

/// The models on the runs of one material in one environment.
#[derive(Debug, Clone, PartialEq)]
pub struct ComparedCondition {
    /// Material.
    pub material: String,
    /// Environment, with its humidity where it was measured at several.
    pub surroundings: String,
    /// The comparisons, by place in the list that was given, the lowest voltage first.
    pub comparisons: Vec<usize>,
    /// The response that tells the models apart: the curvature where it was measured.
    pub deciding: Quantity,
    /// Every model, the best first; those that do not describe all runs stand last.
    pub models: Vec<ComparedModel>,
    /// The answer in words.
    pub sentence: String,
}

/// One model on these runs: medians over them.
#[derive(Debug, Clone, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct ComparedModel {
    /// Model id.
    pub model: String,
    /// Runs that it describes in all responses.
    pub runs: usize,
    /// Parameters that are searched.
    pub parameters: Option<f64>,
    /// What it leaves of the current, in units of the noise.
    pub leaves_current: Option<f64>,
    /// The same of the curvature.
    pub leaves_curvature: Option<f64>,
    /// What it leaves of later times of the deciding response, fitted to the earlier ones.
    pub later: Option<f64>,
    /// What it leaves of the deciding response with parameters of the nearest other voltages.
    pub other_voltages: Option<f64>,
    /// Sum of its BIC over the runs, less that of the best; null where it does not describe all runs.
    pub bic_beyond_best: Option<f64>,
    /// Time that its fits took together, s.
    pub seconds: f64,
}

/// Material, surroundings, and the comparisons there with the voltage of each.
type Gathered = (String, String, Vec<(f64, usize)>);

/// Sums up comparisons by material and surroundings, in the order of the campaign.
pub fn models_compared(
    comparisons: &[RunComparison],
    runs: &[RunRecord],
    campaign: &Campaign,
) -> Vec<ComparedCondition> {
    let table = conditions(runs, campaign);
    let mut found: Vec<Gathered> = Vec::new();
    for (place, one) in comparisons.iter().enumerate() {
        let Some(run) = runs.iter().position(|run| run.path == one.run) else {
            continue;
        };
        if one.curves.is_empty() {
            continue;
        }
        let (material, surroundings) = names(&table, run, &runs[run], campaign);
        let volts = runs[run]
            .drive
            .as_ref()
            .map_or(0.0, |drive| drive.nominal_step_v().abs());
        match found
            .iter_mut()
            .find(|own| (&own.0, &own.1) == (&material, &surroundings))
        {
            Some(own) => own.2.push((volts, place)),
            None => found.push((material, surroundings, vec![(volts, place)])),
        }
    }
    found
        .into_iter()
        .map(|(material, surroundings, mut places)| {
            places.sort_by(|a, b| a.0.total_cmp(&b.0));
            let places = places.into_iter().map(|(_, place)| place).collect();
            condition(comparisons, material, surroundings, places)
        })
        .collect()
}

/// Material and surroundings of a run in words.
fn names(table: &Conditions, index: usize, run: &RunRecord, campaign: &Campaign) -> (String, String) {
    let own = table
        .measured
        .iter()
        .find(|condition| condition.runs.contains(&index));
    if let Some(own) = own {
        let around = &table.surroundings[own.surroundings];
        let level = around.humidity.filter(|_| around.humidity_varies);
        let level = level.map_or_else(String::new, |level| {
            format!(
                " at {} to {} % RH",
                fixed(level.low_percent, 0),
                fixed(level.high_percent, 0)
            )
        });
        let surroundings = format!("{}{level}", around.environment);
        return (table.materials[own.material].clone(), surroundings);
    }
    (
        compared_material(run, campaign)
            .unwrap_or("no stated material")
            .to_owned(),
        run.tag(keys::ENVIRONMENT)
            .unwrap_or("no stated environment")
            .to_owned(),
    )
}

fn condition(
    comparisons: &[RunComparison],
    material: String,
    surroundings: String,
    places: Vec<usize>,
) -> ComparedCondition {
    let of_runs: Vec<&RunComparison> = places.iter().map(|&place| &comparisons[place]).collect();
    let deciding = if of_runs
        .iter()
        .any(|one| one.deciding() == Some(Quantity::Curvature))
    {
        Quantity::Curvature
    } else {
        Quantity::Current
    };
    let mut ids: Vec<&str> = Vec::new();
    for score in of_runs.iter().flat_map(|one| &one.models) {
        if !ids.contains(&score.model.as_str()) {
            ids.push(&score.model);
        }
    }
    // A model that has nothing to say of any of the runs is not asked.
    let is_asked = |id: &&str| {
        of_runs
            .iter()
            .any(|one| one.model(id).is_some_and(|score| !score.responses.is_empty()))
    };
    ids.retain(is_asked);
    let mut models: Vec<ComparedModel> = ids.iter().map(|id| summed(&of_runs, id, deciding)).collect();
    let best = models
        .iter()
        .filter_map(|model| model.bic_beyond_best)
        .fold(f64::INFINITY, f64::min);
    for model in &mut models {
        model.bic_beyond_best = model.bic_beyond_best.map(|bic| bic - best);
    }
    models.sort_by(|a, b| {
        let key = |model: &ComparedModel| model.bic_beyond_best.unwrap_or(f64::INFINITY);
        key(a).total_cmp(&key(b))
    });
    let sentence = sentence(&material, &surroundings, of_runs.len(), deciding, &models);
    ComparedCondition {
        material,
        surroundings,
        comparisons: places,
        deciding,
        models,
        sentence,
    }
}

fn summed(of_runs: &[&RunComparison], id: &str, deciding: Quantity) -> ComparedModel {
    let scores: Vec<&ModelScore> = of_runs.iter().filter_map(|one| one.model(id)).collect();
    let of = |quantity: Quantity, number: fn(&ResponseScore) -> Option<f64>| {
        let responses = scores.iter().filter_map(|score| score.response(quantity));
        median(responses.filter_map(number).collect())
    };
    let bics: Vec<f64> = scores.iter().filter_map(|score| score.bic).collect();
    ComparedModel {
        model: id.to_owned(),
        runs: bics.len(),
        parameters: median(
            scores
                .iter()
                .filter(|score| score.bic.is_some())
                .map(|score| score.parameters as f64)
                .collect(),
        ),
        leaves_current: of(Quantity::Current, |score| Some(score.leaves)),
        leaves_curvature: of(Quantity::Curvature, |score| Some(score.leaves)),
        later: of(deciding, |score| score.later),
        other_voltages: of(deciding, |score| score.other_voltages),
        bic_beyond_best: (bics.len() == of_runs.len()).then(|| bics.iter().sum()),
        seconds: scores.iter().map(|score| score.seconds).sum(),
    }
}

fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    let (count, middle) = (values.len(), values.len() / 2);
    match (count, count % 2) {
        (0, _) => None,
        (_, 1) => Some(values[middle]),
        _ => Some(0.5 * (values[middle - 1] + values[middle])),
    }
}

impl ComparedModel {
    /// What it leaves of the deciding response.
    pub fn leaves(&self, deciding: Quantity) -> Option<f64> {
        match deciding {
            Quantity::Curvature => self.leaves_curvature,
            _ => self.leaves_current,
        }
    }
}

/// The answer: which model is best, what it and the others leave, whether it is told apart, and who predicts best.
fn sentence(
    material: &str,
    surroundings: &str,
    runs: usize,
    deciding: Quantity,
    models: &[ComparedModel],
) -> String {
    let what = match deciding {
        Quantity::Curvature => "bending",
        _ => "current",
    };
    let head = format!("{material} in {surroundings} ({})", counted(runs, "run"));
    let ranked: Vec<&ComparedModel> = models
        .iter()
        .filter(|model| model.bic_beyond_best.is_some())
        .collect();
    let Some(best) = ranked.first() else {
        return format!("{head}: no model describes all that was measured.");
    };
    let leaves = |model: &ComparedModel| times(model.leaves(deciding));
    let others: Vec<String> = ranked[1..]
        .iter()
        .map(|other| format!("{} {}", other.model, leaves(other)))
        .collect();
    let mut words = format!(
        "{head}: {} leaves {} times the noise of the {what}",
        best.model,
        leaves(best)
    );
    if !others.is_empty() {
        words.push_str(&format!(", {}", others.join(", ")));
    }
    words.push('.');
    let beside = |model: &&&ComparedModel| model.bic_beyond_best.is_some_and(|bic| bic < TOLD_APART);
    let equals: Vec<&str> = ranked[1..]
        .iter()
        .filter(beside)
        .map(|model| &*model.model)
        .collect();
    match (ranked.len(), equals.as_slice()) {
        (1, _) => {}
        (_, []) => words.push_str(" It is the best by BIC."),
        (_, equals) => words.push_str(&format!(
            " BIC does not tell it apart from {}.",
            equals.join(", ")
        )),
    }
    if best.leaves(deciding).is_some_and(|left| left > TO_THE_NOISE) {
        words.push_str(" None describes it to the noise.");
    }
    words.push_str(&predicted("Later times", &ranked, |model| model.later));
    words.push_str(&predicted("Other voltages", &ranked, |model| {
        model.other_voltages
    }));
    words
}

fn predicted(
    what: &str,
    ranked: &[&ComparedModel],
    number: impl Fn(&ComparedModel) -> Option<f64>,
) -> String {
    let told = || {
        ranked
            .iter()
            .filter_map(|model| Some((number(model)?, &*model.model)))
    };
    let Some((least, _)) = told().min_by(|a, b| a.0.total_cmp(&b.0)) else {
        return String::new();
    };
    let alike: Vec<&str> = told()
        .filter(|(left, _)| *left <= ALIKE * least)
        .map(|(_, model)| model)
        .collect();
    format!(
        " {what} are predicted best by {}, to {} times the noise.",
        alike.join(", "),
        times(Some(least))
    )
}

/// A multiple of the noise with two digits that mean something.
fn times(number: Option<f64>) -> String {
    match number {
        None => "–".to_owned(),
        Some(number) if number < 9.95 => fixed(number, 1),
        Some(number) if number < 1e5 => fixed(number, 0),
        Some(number) => significant(number, 1),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ieap_domain::ComparedCurve;

    fn score(model: &str, bic: Option<f64>, leaves: f64, later: f64) -> ModelScore {
        let response = |quantity, leaves| ResponseScore {
            quantity,
            readings: 100,
            leaves,
            later: Some(later),
            other_voltages: None,
        };
        let mut responses = vec![response(Quantity::Current, 1.0)];
        responses.extend(bic.map(|_| response(Quantity::Curvature, leaves)));
        ModelScore {
            model: model.to_owned(),
            version: 1,
            parameters: 7,
            bic,
            responses,
            missing: None,
            seconds: 0.5,
        }
    }

    fn comparison(models: Vec<ModelScore>) -> RunComparison {
        let curve = |quantity| ComparedCurve {
            quantity,
            noise: 1.0,
            time_s: vec![],
            measured: vec![],
            fitted: vec![],
        };
        RunComparison {
            run: "a.csv".to_owned(),
            models,
            curves: vec![curve(Quantity::Current), curve(Quantity::Curvature)],
        }
    }

    fn of(all: &[RunComparison]) -> ComparedCondition {
        condition(all, "CNaf".into(), "air".into(), (0..all.len()).collect())
    }

    #[test]
    fn the_answer_names_the_best_and_what_all_leave() {
        let one = |shift: f64| {
            comparison(vec![
                score("lumped-2", Some(900.0 + shift), 3.1, 8.0),
                score("bao-two-way", Some(210.0 + shift), 1.3, 2.0),
                score("yagasaki-tamagawa", None, 0.0, 1.0),
            ])
        };
        let found = of(&[one(0.0), one(50.0)]);
        assert_eq!(found.models[0].model, "bao-two-way");
        assert_eq!(found.models[1].bic_beyond_best, Some(1380.0));
        assert_eq!((found.models[2].runs, found.models[2].bic_beyond_best), (0, None));
        assert_eq!(
            found.sentence,
            "CNaf in air (2 runs): bao-two-way leaves 1.3 times the noise of the bending, lumped-2 3.1. \
             It is the best by BIC. None describes it to the noise. \
             Later times are predicted best by bao-two-way, to 2.0 times the noise."
        );
    }

    #[test]
    fn models_that_differ_by_little_are_not_told_apart() {
        let found = of(&[comparison(vec![
            score("lumped-2", Some(100.0), 1.0, 1.0),
            score("bao-two-way", Some(104.0), 1.0, 1.1),
        ])]);
        assert!(
            found
                .sentence
                .contains("BIC does not tell it apart from bao-two-way."),
            "{}",
            found.sentence
        );
        assert!(!found.sentence.contains("None describes"));
    }

    #[test]
    fn a_median_is_the_middle() {
        assert_eq!(median(vec![]), None);
        assert_eq!(median(vec![3.0, 1.0, 2.0]), Some(2.0));
        assert_eq!(median(vec![4.0, 1.0]), Some(2.5));
        assert_eq!(
            (times(Some(1.26)), times(Some(123.4))),
            ("1.3".into(), "123".into())
        );
    }
}
