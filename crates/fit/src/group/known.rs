//! The fit of a run of which some parameters are known beforehand: both responses at once, weighted by their noise.
//!
//! What is exact is held. What has a standard error counts as a reading of the parameter with that error. What has limits is
//! searched within them. Whether the readings agree with what is known is asked of the same readings without it.

use ieap_domain::number::{measured, significant};
use ieap_domain::quantiles::NORMAL_95;
use ieap_domain::{Fit, Issue, Knowledge, KnownParameter};
use ieap_model::FitModel;
use ieap_numerics::chance::chi_square_chance;
use ieap_numerics::least_squares::Minimum;

use super::intervals::{JudgedGroup, judge};
use super::options::{GroupOptions, shareable};
use super::search::{deepest, search};
use super::{assemble, prepare};
use crate::error::FitError;
use crate::group::policy::CONTRADICTS_SIGMAS;
use crate::joint::feature::Feature;
use crate::joint::layout::Layout;
use crate::joint::minimum::excess;
use crate::joint::problem::{JointProblem, Slot};
use crate::joint::profile::{Interval, Solved};
use crate::joint::spring::Spring;
use crate::joint::start::{Start, problem};
use crate::options::FitInput;
use crate::policy::CONTRADICTED_BELOW;

/// What is known of a feature, in the feature's own number.
struct Taken<'k> {
    known: &'k KnownParameter,
    feature: Feature,
    /// Where it stands among the local parameters; none of what follows from several.
    place: Option<usize>,
    /// The same knowledge of the feature's number.
    knowledge: Knowledge,
}

/// Whether what is known can be taken into fits with the model.
///
/// # Errors
/// [`FitError::Known`] says what cannot and why.
pub fn can_be_known(known: &[KnownParameter], model: &'static FitModel) -> Result<(), FitError> {
    known
        .iter()
        .try_for_each(|known| Taken::of(known, model).map(|_| ()))
}

impl<'k> Taken<'k> {
    fn of(known: &'k KnownParameter, model: &'static FitModel) -> Result<Taken<'k>, FitError> {
        let refused = |reason: String| FitError::Known {
            found: known.to_string(),
            reason,
        };
        if shareable(model).is_empty() || !model.id.starts_with("lumped-") {
            return Err(refused(format!(
                "{} is no lumped model; fit with lumped-1 to lumped-4",
                model.id
            )));
        }
        let keys: Vec<&str> = model.parameters.iter().map(|parameter| parameter.key).collect();
        let feature = Feature::named(&known.parameter, model.branches).ok_or_else(|| {
            refused(format!(
                "{} has no such parameter; it has {}",
                model.id,
                keys.join(", ")
            ))
        })?;
        if !known.knowledge.can_be() {
            return Err(refused(
                "an error is positive, and limits are in rising order".to_owned(),
            ));
        }
        if feature != Feature::Coupling && known.knowledge.least() <= 0.0 {
            return Err(refused("it is positive".to_owned()));
        }
        let layout = Layout {
            branches: model.branches,
        };
        let place = feature.place(layout);
        let has_error = matches!(known.knowledge, Knowledge::About { .. });
        if place.is_none() && !has_error {
            return Err(refused(
                "it follows from several parameters; give it a standard error, as 120±6".to_owned(),
            ));
        }
        Ok(Taken {
            known,
            feature,
            place,
            knowledge: of_feature(feature, known.knowledge),
        })
    }

    /// Key of the parameter, however it was named.
    fn key(&self) -> &str {
        self.feature.key().unwrap_or(&self.known.parameter)
    }

    fn spring(&self) -> Option<Spring> {
        let Knowledge::About {
            value,
            standard_error,
        } = self.knowledge
        else {
            return None;
        };
        Some(Spring {
            run: 0,
            feature: self.feature,
            target: value,
            stiffness: standard_error.recip(),
        })
    }

    /// Where the search starts, and whether the parameter is searched.
    fn put(&self, start: &mut Start) {
        let Some(place) = self.place else { return };
        let (value, searched) = (&mut start.local[place], &mut start.searched[place]);
        match self.knowledge {
            Knowledge::Exact { value: exact } => (*value, *searched) = (exact, false),
            Knowledge::About { value: about, .. } if !*searched => (*value, *searched) = (about, true),
            Knowledge::About { .. } => {}
            Knowledge::Within { low, high } => (*value, *searched) = (value.clamp(low, high), true),
        }
    }

    fn limit(&self, problem: &mut JointProblem) {
        let (Knowledge::Within { low, high }, Some(place)) = (self.knowledge, self.place) else {
            return;
        };
        if let Slot::Searched(k) = problem.slots[0][place] {
            problem.bounds.low[k] = low / problem.units[place];
            problem.bounds.high[k] = high / problem.units[place];
        }
    }

    /// The interval within the limits: where the readings set no end, the limit is one.
    fn within(&self, interval: Interval) -> Interval {
        let Knowledge::Within { low, high } = self.knowledge else {
            return interval;
        };
        Interval {
            low: Some(interval.low.map_or(low, |end| end.max(low))),
            high: Some(interval.high.map_or(high, |end| end.min(high))),
            ..interval
        }
    }
}

/// Knowledge of a parameter as that of the feature's number: a logarithm, a conductance, or the parameter itself.
fn of_feature(feature: Feature, knowledge: Knowledge) -> Knowledge {
    let number = |value: f64| match feature {
        Feature::Steady => value.recip(),
        _ if feature.is_logarithm() => value.ln(),
        _ => value,
    };
    let slope = |value: f64| match feature {
        Feature::Steady => value.powi(-2),
        _ if feature.is_logarithm() => value.recip(),
        _ => 1.0,
    };
    match knowledge {
        Knowledge::Exact { value } => Knowledge::Exact { value: number(value) },
        Knowledge::About {
            value,
            standard_error,
        } => Knowledge::About {
            value: number(value),
            standard_error: slope(value) * standard_error,
        },
        Knowledge::Within { low, high } => {
            let ends = (number(low), number(high));
            Knowledge::Within {
                low: ends.0.min(ends.1),
                high: ends.0.max(ends.1),
            }
        }
    }
}

/// Fits a run whose edges are where its drive has them.
pub(crate) fn fit(
    input: &FitInput,
    model: &'static FitModel,
    known: &[KnownParameter],
) -> Result<Fit, FitError> {
    let taken: Vec<Taken> = known
        .iter()
        .map(|known| Taken::of(known, model))
        .collect::<Result<_, _>>()?;
    let options = GroupOptions::sharing_all(model);
    let (run, own) = prepare(0, input, &options).map_err(|error| match error {
        FitError::GroupRun { reason, .. } => FitError::Known {
            found: known
                .iter()
                .map(KnownParameter::to_string)
                .collect::<Vec<_>>()
                .join(", "),
            reason: format!("the run has no circuit to start from: {reason}"),
        },
        other => other,
    })?;
    let mut start = own.clone();
    taken.iter().for_each(|taken| taken.put(&mut start));
    let starts = [start];
    let (mut knowing, first) = problem(vec![run.clone()], &starts, &[]);
    taken.iter().for_each(|taken| taken.limit(&mut knowing));
    knowing.known = taken.iter().filter_map(Taken::spring).collect();
    let (bottom, evaluations) = deepest(&knowing, &starts, first);
    let mut judged = judge(&knowing, bottom, &options, evaluations);
    keep_within(&taken, &mut judged);

    let (free, free_bottom, more) = search(vec![run], &[own], &[]);
    judged.evaluations += more;
    let contradictions = contradictions(&taken, (&knowing, &judged.bottom), (&free, free_bottom));
    let group = assemble(&[*input], &options, &knowing, judged);
    let mut fit = group.runs.into_iter().next().ok_or(FitError::EmptyGroup)?;
    fit.method += ", with what is known of parameters";
    fit.issues.extend(taken.iter().map(said));
    fit.issues.extend(contradictions);
    Ok(fit)
}

fn keep_within(taken: &[Taken], judged: &mut JudgedGroup) {
    for (feature, interval, _) in judged.features.iter_mut().flatten() {
        let own = taken.iter().filter(|taken| taken.feature == *feature);
        *interval = own.fold(*interval, |interval, taken| taken.within(interval));
    }
}

fn said(taken: &Taken) -> Issue {
    let known = taken.known;
    let source = known
        .source
        .as_ref()
        .map_or(String::new(), |source| format!(" ({source})"));
    let exact = match known.knowledge {
        Knowledge::Exact { .. } => ", held exactly",
        _ => "",
    };
    Issue::note(
        "known-parameter",
        format!("taken as known: {}{exact}{source}", known.knowledge),
    )
    .at(taken.key())
}

/// Where the readings alone say something else than what is known.
fn contradictions(
    taken: &[Taken],
    (knowing, place): (&JointProblem, &Minimum),
    (free, bottom): (&JointProblem, Minimum),
) -> Vec<Issue> {
    let rise = knowing.square(&place.at) - free.square(&bottom.at);
    // What the circuit leaves beyond noise is not held against what is known.
    let p = chi_square_chance(rise.max(0.0) / excess(free, &bottom).powi(2), taken.len());
    if p >= CONTRADICTED_BELOW {
        return Vec::new();
    }
    let alone = Solved::new(free, bottom);
    let apart = taken.iter().filter_map(|taken| {
        let own = alone.linear(taken.feature, 0, NORMAL_95);
        let (gap, error) = match taken.knowledge {
            Knowledge::Exact { value } => (own.value - value, own.standard_error),
            Knowledge::About {
                value,
                standard_error,
            } => (own.value - value, own.standard_error.hypot(standard_error)),
            Knowledge::Within { low, high } => (own.value - own.value.clamp(low, high), own.standard_error),
        };
        (gap.abs() > CONTRADICTS_SIGMAS * error).then(|| contradicted(taken, &own, p))
    });
    let apart: Vec<Issue> = apart.collect();
    if !apart.is_empty() {
        return apart;
    }
    let message = format!(
        "what is known of the parameters and the readings contradict each other (p = {})",
        significant(p, 3)
    );
    vec![Issue::warning("known-contradicted", message).mend(MEND)]
}

const MEND: &str = "check where it comes from, or leave it out and let the readings tell";

fn contradicted(taken: &Taken, own: &Interval, p: f64) -> Issue {
    let feature = taken.feature;
    let value = feature.stated(own.value);
    let apart = |sign: f64| (feature.stated(own.value + sign * own.standard_error) - value).abs();
    let error = 0.5 * (apart(1.0) + apart(-1.0));
    let message = format!(
        "the readings alone say {}, where {} is taken as known: they contradict each other (p = {})",
        measured(value, error),
        taken.known.knowledge,
        significant(p, 2)
    );
    Issue::warning("known-contradicted", message)
        .at(taken.key())
        .mend(MEND)
}
