//! Power of a study before it is measured: in how many campaigns of a design it would see a change (`ieap plan --study`).

use schemars::JsonSchema;
use serde::Serialize;

use crate::analysis::laws::doubt::{Doubts, Findings};
use crate::analysis::study::power::{
    ALIKE_PERCENT, Chance, Design, MOST_STRIPS, Planned, Question, Seen, chances,
};
use crate::analysis::study::{Evidence, symbol};
use crate::domain::number::{plain, significant};
use crate::domain::words::{counted, in_a_row};
use crate::pipeline::campaign::standing;
use crate::pipeline::findings::current::current_findings;
use crate::pipeline::{Context, Observer, PipelineError};

/// Simulated campaigns of each design where no number of them is asked for: what comes once in twenty is seen five times.
pub const DRAWS: usize = 100;
/// Numbers of strips that are tried where none are stated.
pub const STRIPS: [usize; 4] = [2, 3, 4, 6];

/// What is to be found out before a study is measured.
#[derive(Debug, Clone, PartialEq)]
pub struct StudyPlan {
    /// Numbers of strips.
    pub strips: Vec<usize>,
    /// Change that is to be seen, percent; none: the size from which on the study calls an effect one.
    pub change_percent: Option<f64>,
    /// Runs a strip and condition; none: as in the campaign.
    pub repeats: Option<usize>,
    /// Simulated campaigns of each design.
    pub draws: usize,
    /// Their seed.
    pub seed: u64,
}

/// What a study will see.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct StudyPlanDocument {
    /// Always `ieap/study-plan/1`.
    pub schema: &'static str,
    /// The answer in sentences.
    pub answer: Vec<String>,
    /// Change that is to be seen, percent.
    pub change_percent: f64,
    /// Voltages at which each strip is measured.
    pub voltages: usize,
    /// Runs a strip and condition.
    pub repeats: usize,
    /// Humidities of the law, percent.
    pub humidities_percent: Vec<f64>,
    /// Questions of the study that chances are judged together over.
    pub questions: usize,
    /// Simulated campaigns of each design.
    pub draws: usize,
    /// Their seed.
    pub seed: u64,
    /// What is taken to differ by chance.
    pub scatter: Vec<ScatterEntry>,
    /// What is seen.
    pub seen: Vec<SeenEntry>,
    /// What the answer rests on.
    pub remarks: Vec<String>,
}

/// What differs by chance: standard deviations, percent.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ScatterEntry {
    /// Stored key of the parameter; null: of any, where no runs tell.
    pub parameter: Option<&'static str>,
    /// Of strips.
    pub strips_percent: f64,
    /// Of a strip in one environment, or at one humidity.
    pub in_surroundings_percent: f64,
    /// From run to run.
    pub runs_percent: f64,
    /// Error of a fit.
    pub fits_percent: f64,
    /// Materials whose runs tell it; 0: it is assumed.
    pub materials: usize,
}

/// In how many campaigns of a design the change is seen.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct SeenEntry {
    /// `environment`, or `humidity-law`.
    pub question: &'static str,
    /// Stored key of the parameter; null: of any.
    pub parameter: Option<&'static str>,
    /// Strips of the material.
    pub strips: usize,
    /// Campaigns in which it is seen of the strips measured.
    pub of_strips: usize,
    /// Campaigns in which it is seen of the material; null of one strip.
    pub of_material: Option<usize>,
}

/// A parameter, or any, with what differs by chance.
type Of = (Option<&'static str>, Chance);

impl StudyPlan {
    /// Simulates campaigns of each design.
    ///
    /// # Errors
    /// The database cannot be read, or a number makes no sense.
    pub fn run(
        &self,
        context: &Context,
        observer: &dyn Observer,
    ) -> Result<StudyPlanDocument, PipelineError> {
        let rules = &context.campaign.study;
        let change_percent = (self.change_percent)
            .or(rules.alike_percent)
            .unwrap_or(ALIKE_PERCENT);
        self.check(change_percent)?;
        let runs = standing::runs(context)?.speaking;
        let found = current_findings(context)?;
        let findings = Findings {
            groups: &found.groups,
            runs: &found.runs,
        };
        let evidence = Evidence {
            runs: &runs,
            campaign: &context.campaign,
            doubts: &Doubts::new(findings, &runs),
            curves: &[],
        };
        let design = Design::of(&evidence);
        let repeats = self.repeats.unwrap_or(design.repeats);
        let told: Vec<Of> = (chances(&evidence).into_iter())
            .map(|(key, chance)| (Some(key), chance))
            .collect();
        let of = if told.is_empty() {
            vec![(None, Chance::assumed(rules.scatter_percent))]
        } else {
            told
        };
        let questions = [
            ("environment", Question::Environment),
            (
                "humidity-law",
                Question::Humidity(design.humidities_percent.clone()),
            ),
        ];
        let mut seen = Vec::new();
        observer.begin(
            "simulating studies",
            (questions.len() * of.len() * self.strips.len()) as u64,
        );
        for (name, question) in &questions {
            for (parameter, chance) in &of {
                for &strips in &self.strips {
                    let planned = Planned {
                        question: question.clone(),
                        strips,
                        voltages: design.voltages,
                        repeats,
                        change: (change_percent / 100.0).ln_1p(),
                        questions: design.questions,
                    };
                    let Seen {
                        of_strips,
                        of_material,
                    } = planned.seen(chance, (self.draws, self.seed));
                    seen.push(SeenEntry {
                        question: name,
                        parameter: *parameter,
                        strips,
                        of_strips,
                        of_material: (strips > 1).then_some(of_material),
                    });
                    observer.advance();
                }
            }
        }
        observer.end();
        Ok(StudyPlanDocument {
            schema: "ieap/study-plan/1",
            answer: answer(&seen, &design, change_percent, self.draws),
            remarks: remarks(&of, &design, repeats),
            change_percent,
            voltages: design.voltages,
            repeats,
            humidities_percent: design.humidities_percent,
            questions: design.questions,
            draws: self.draws,
            seed: self.seed,
            scatter: of.iter().map(scatter).collect(),
            seen,
        })
    }

    fn check(&self, change_percent: f64) -> Result<(), PipelineError> {
        let wrong = |what, found: String, needed| Err(PipelineError::bad_argument(what, found, needed));
        if !(change_percent.is_finite() && change_percent > 0.0) {
            return wrong("--change", change_percent.to_string(), "a percentage above 0");
        }
        if self.draws == 0 {
            return wrong("--draws", "0".to_owned(), "1 or more");
        }
        if self.repeats == Some(0) {
            return wrong("--repeats", "0".to_owned(), "1 or more");
        }
        match self.strips.iter().find(|own| !(1..=MOST_STRIPS).contains(*own)) {
            Some(strips) => wrong("--strips", strips.to_string(), "numbers from 1 to 12"),
            None => Ok(()),
        }
    }
}

/// Rows of one question and parameter as a sentence.
fn answer(seen: &[SeenEntry], design: &Design, change_percent: f64, draws: usize) -> Vec<String> {
    let is_same = |a: &SeenEntry, b: &SeenEntry| (a.question, a.parameter) == (b.question, b.parameter);
    let levels: Vec<String> = (design.humidities_percent.iter())
        .map(|own| significant(*own, 2))
        .collect();
    let said = |rows: &[SeenEntry]| {
        let of = rows[0].parameter.map_or("Any parameter", symbol);
        let change = plain(change_percent);
        let is_law = rows[0].question == "humidity-law";
        let (what, strips) = if is_law {
            (
                format!(
                    "{of}, changed by {change} % from {} to {} % RH",
                    levels[0],
                    levels[levels.len() - 1]
                ),
                "of the strips",
            )
        } else {
            (
                format!("{of}, changed by {change} % from one environment to another"),
                "of the strips as they were measured",
            )
        };
        let count = |(at, (strips, seen)): (usize, (usize, usize))| match at {
            0 => format!("with {} in {seen} of {draws} campaigns", counted(strips, "strip")),
            _ => format!("with {strips} in {seen}"),
        };
        let row =
            |of: Vec<(usize, usize)>| in_a_row(&of.into_iter().enumerate().map(count).collect::<Vec<_>>());
        let of_strips = row(rows.iter().map(|own| (own.strips, own.of_strips)).collect());
        let material: Vec<(usize, usize)> = (rows.iter())
            .filter_map(|own| Some((own.strips, own.of_material?)))
            .collect();
        let of_material = if material.is_empty() {
            "of one strip nothing is said of its material".to_owned()
        } else {
            format!("seen of the material {}", row(material))
        };
        format!("{what}: {of_material}; {strips} {of_strips}.")
    };
    seen.chunk_by(is_same).map(said).collect()
}

fn remarks(of: &[Of], design: &Design, repeats: usize) -> Vec<String> {
    let told = |(parameter, chance): &Of| {
        let percent = |size: f64| format!("{} %", significant(100.0 * size, 2));
        format!(
            "{}: strips differ by {}, a strip in one environment or at one humidity by {}, runs by {}, fits are known to {}",
            parameter.map_or("Any parameter", symbol),
            percent(chance.middle.strips),
            percent(chance.middle.in_surroundings),
            percent(chance.middle.runs),
            percent(chance.middle.fits)
        )
    };
    let scatter: Vec<String> = of.iter().map(told).collect();
    let origin = match of[0].1.told_by {
        0 => "Assumed, for no material has repeats on two strips in two environments",
        _ => {
            "By the runs of the campaign, whose scatters are drawn anew for every simulated one as they leave them open"
        }
    };
    let humidities = if design.humidities_are_measured {
        ""
    } else {
        " Humidities are assumed, for fewer than three were measured."
    };
    vec![
        format!("{origin}: {}.", scatter.join("; ")),
        format!(
            "Each strip is measured at {} with {} a condition; chances are judged together over {} questions, as in the study.{humidities} Strips are taken to follow one law.",
            counted(design.voltages, "voltage"),
            counted(repeats, "run"),
            design.questions
        ),
    ]
}

fn scatter((parameter, chance): &Of) -> ScatterEntry {
    ScatterEntry {
        parameter: *parameter,
        strips_percent: 100.0 * chance.middle.strips,
        in_surroundings_percent: 100.0 * chance.middle.in_surroundings,
        runs_percent: 100.0 * chance.middle.runs,
        fits_percent: 100.0 * chance.middle.fits,
        materials: chance.told_by,
    }
}
