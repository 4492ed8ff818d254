//! What every model gives without noise, each by the functions that its fits go through.

use std::collections::BTreeMap;

use super::simulate::{Curvature, CurvesAsked};
use crate::domain::{Drive, Issue, Level, Quantity};
use crate::fit::distributed;
use crate::model::bending::{ChargeCourse, Reported, Stated, curvature_per_cm};
use crate::model::coupling::CurvaturePerLineCharge;
use crate::model::distributed::{DistributedModel, DrivenStrip};
use crate::model::{BendingLaw, FitModel, fit_model, fit_models, rival_law};
use crate::pipeline::standalone::simulate::{RunSpec, checked_run, exact_responses};

/// Keys of a break of the electrodes, which a fit of the distributed model may have beside those of the registry.
const BREAK: [&str; 2] = ["contact-break.place_mm", "contact-break.resistance_factor"];

/// Responses without noise.
pub(super) struct Exact {
    /// Current, A.
    pub current_a: Vec<f64>,
    /// Curvatures; none where none is asked for.
    pub curvatures: Vec<Curvature>,
}

/// The responses of the model that is asked for; `run` has the strip and the drive.
///
/// # Errors
/// A parameter, the drive or an effect is none of the model, or the equations have no solution.
pub(super) fn exact(asked: &CurvesAsked, run: RunSpec) -> Result<Exact, Issue> {
    let Some(model) = fit_model(&asked.model) else {
        let known: Vec<&str> = fit_models().iter().map(|model| model.id).collect();
        let issue = Issue::error("not-known", format!("found {:?}", asked.model)).at("model");
        return Err(issue.mend(format!("give one of {}", known.join(", "))));
    };
    let is_along = model.id == distributed::MODEL_ID;
    let law = rival_law(model.id);
    if (is_along || law.is_some()) && !asked.effects.is_empty() {
        let message = format!("effects act on lumped models, and the model is {}", model.id);
        let issue = Issue::error("bad-effect", message).at("effects");
        return Err(issue.mend("leave the effects out, or simulate a lumped model"));
    }
    match law {
        _ if is_along => along(asked, model, run),
        Some(law) => of_rival(asked, model, law, run),
        None => lumped(asked, &run),
    }
}

fn lumped(asked: &CurvesAsked, run: &RunSpec) -> Result<Exact, Issue> {
    checked_run(run, &asked.noise, &asked.effects)?;
    let exact = exact_responses(run, &asked.effects, (&asked.time_s, &asked.time_s), 0)
        .map_err(|error| Issue::error("not-solved", error.to_string()).at("effects"))?;
    Ok(Exact {
        current_a: exact.current_a,
        curvatures: vec![Curvature::whole(exact.curvature_per_cm)],
    })
}

/// The circuit, and the rival's law of what its charge bends.
fn of_rival(
    asked: &CurvesAsked,
    model: &FitModel,
    law: &dyn BendingLaw,
    mut run: RunSpec,
) -> Result<Exact, Issue> {
    let given = Given::of(asked, model, &[])?;
    let natural = law.couplings() + law.shapes().len();
    let reported = &law.reported()[..natural];
    let values: Vec<f64> = reported
        .iter()
        .map(|own| given.of_law(own))
        .collect::<Result<_, _>>()?;
    run.parameters
        .retain(|key, _| reported.iter().all(|own| own.key != key));
    checked_run(&run, &asked.noise, &[])?;
    let drive = run.drive();
    if let Some(why) = law.refuses(&drive) {
        let issue = Issue::error("bad-drive", format!("{} does not describe it: {why}", model.id));
        return Err(issue
            .at("drive")
            .mend("give a drive of one step, or another model"));
    }
    let circuit = run.model();
    let charge = ChargeCourse::new(&circuit, &drive, run.area_cm2, &asked.time_s);
    let natural = law.natural(&values);
    let (couplings, shapes) = natural.split_at(law.couplings());
    Ok(Exact {
        current_a: circuit.current_a(&drive, run.area_cm2, &asked.time_s),
        curvatures: vec![Curvature::whole(curvature_per_cm(
            law, &charge, couplings, shapes,
        ))],
    })
}

/// The strip whose electrodes resist along it, with the curvature at the places that are asked for.
fn along(asked: &CurvesAsked, model: &FitModel, mut run: RunSpec) -> Result<Exact, Issue> {
    let given = Given::of(asked, model, &BREAK)?;
    run.parameters.clear();
    checked_run(&run, &asked.noise, &[])?;
    let drive = run.drive();
    check_held(&drive)?;
    let Some(length_cm) = run.length_cm else {
        let issue = Issue::error(
            "no-length",
            "the distributed model needs the free length of the strip",
        );
        return Err(issue.at("length_mm").mend("state length_mm"));
    };
    let places_cm: Vec<f64> = asked.places_mm.iter().map(|place| place / 10.0).collect();
    if let Some(outside) = (places_cm.iter()).find(|s| !(**s >= 0.0 && **s <= length_cm * (1.0 + 1e-9))) {
        let issue = Issue::error("bad-value", format!("found {} mm", outside * 10.0)).at("places_mm");
        return Err(issue.mend(format!("give places from 0 to {} mm", length_cm * 10.0)));
    }
    let strip = given.strip(length_cm, run.area_cm2 / length_cm)?;
    let bent = if places_cm.is_empty() {
        Vec::new()
    } else {
        strip.respond(Quantity::Curvature, &drive, &places_cm, &asked.time_s)
    };
    let rows = bent.chunks_exact(asked.time_s.len());
    let curvature = |(place_mm, row): (&f64, &[f64])| Curvature {
        place_mm: Some(*place_mm),
        per_cm: row.to_vec(),
    };
    Ok(Exact {
        current_a: strip.respond(Quantity::Current, &drive, &[0.0], &asked.time_s),
        curvatures: asked.places_mm.iter().zip(rows).map(curvature).collect(),
    })
}

fn check_held(drive: &Drive) -> Result<(), Issue> {
    let open = drive.segments.iter().find(|own| own.level == Level::OpenCircuit);
    let Some(open) = open else { return Ok(()) };
    let found = format!(
        "an open circuit from {} s on, which the distributed model does not describe",
        open.start_s()
    );
    let issue = Issue::error("bad-drive", found).at("drive");
    Err(issue.mend("hold a voltage in its place, or simulate a lumped model"))
}

/// Parameters that were given, of those that a model has.
struct Given<'a> {
    values: &'a BTreeMap<String, f64>,
    model: &'a FitModel,
}

impl Given<'_> {
    /// The parameters, all of them the model's own or `more`.
    fn of<'a>(asked: &'a CurvesAsked, model: &'a FitModel, more: &[&str]) -> Result<Given<'a>, Issue> {
        let own = model
            .parameters
            .iter()
            .filter(|own| !own.derived)
            .map(|own| own.key);
        let known: Vec<&str> = own.chain(more.iter().copied()).collect();
        match (asked.parameters.keys()).find(|key| !known.contains(&key.as_str())) {
            None => Ok(Given {
                values: &asked.parameters,
                model,
            }),
            Some(key) => {
                let issue = Issue::error("bad-value", format!("found {key}")).at("parameters");
                Err(issue.mend(format!("give one of {}", known.join(", "))))
            }
        }
    }

    /// A parameter that cannot be left out.
    fn needed(&self, key: &str) -> Result<f64, Issue> {
        self.values.get(key).copied().ok_or_else(|| {
            let message = format!("there is no {key}, which {} needs", self.model.id);
            Issue::error("bad-value", message)
                .at("parameters")
                .mend(format!("give {key}"))
        })
    }

    /// A parameter of a law of bending.
    fn of_law(&self, own: &Reported) -> Result<f64, Issue> {
        let value = self.needed(own.key)?;
        match own.stated {
            Stated::Time => checked(own.key, value, value > 0.0, "a number above 0"),
            Stated::FromZero => checked(own.key, value, value >= 0.0, "a number of 0 or more"),
            Stated::Coupling | Stated::Signed => checked(own.key, value, true, "a number"),
        }
    }

    fn above_zero(&self, key: &str) -> Result<f64, Issue> {
        let value = self.needed(key)?;
        checked(key, value, value > 0.0, "a number above 0")
    }

    /// A parameter that is 0 where it is left out.
    fn or_zero(&self, key: &str, may_be_negative: bool) -> Result<f64, Issue> {
        let value = self.values.get(key).copied().unwrap_or(0.0);
        let needed = "a number of 0 or more, or none";
        checked(key, value, may_be_negative || value >= 0.0, needed)
    }

    /// The strip of that length and width.
    fn strip(&self, length_cm: f64, width_cm: f64) -> Result<DrivenStrip, Issue> {
        let steady = if self.values.contains_key("rss_ohm_cm2") {
            self.above_zero("rss_ohm_cm2")?
        } else {
            f64::INFINITY
        };
        let model = DistributedModel {
            electrode_resistance_ohm_per_cm: self.or_zero("re_ohm_per_sq", false)? / width_cm,
            branch_resistance_ohm_cm: self.above_zero("rc_ohm_cm2")? / width_cm,
            capacitance_f_per_cm: self.above_zero("c_f_per_cm2")? * width_cm,
            steady_state_resistance_ohm_cm: steady / width_cm,
            length_cm,
            coupling: CurvaturePerLineCharge(1.0),
            relaxation_rate_per_s: self.or_zero("lambda_per_s", false)?,
        };
        let [place, factor] = BREAK;
        let contact_break = if BREAK.iter().any(|key| self.values.contains_key(*key)) {
            Some((self.above_zero(place)? / 10.0, self.above_zero(factor)?))
        } else {
            None
        };
        Ok(DrivenStrip::new(
            &model,
            self.or_zero("mu_per_c", true)?,
            contact_break,
        ))
    }
}

fn checked(key: &str, value: f64, is_possible: bool, needed: &str) -> Result<f64, Issue> {
    if is_possible && value.is_finite() {
        Ok(value)
    } else {
        let issue = Issue::error("bad-value", format!("found {value}")).at(key);
        Err(issue.mend(format!("give {needed}")))
    }
}
