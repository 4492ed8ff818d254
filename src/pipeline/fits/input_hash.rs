//! Hashes of what fits and diagnoses are made from: the library of effects, and a run as it is handed to them.

use crate::domain::{InputHash, KnownParameter};
use crate::fit::{FitOptions, MOVING_VERSION, NoiseBy, Steps, distributed};
use crate::model::effects;
use crate::store::FitTask;

/// Hash of the library of effects: ids, forms, parameters with units, equations, limits.
pub(crate) fn library_hash() -> String {
    let mut hash = InputHash::new();
    for effect in effects::ALL.iter() {
        let about = effect.about();
        for text in [about.id, about.code, about.equation, about.vanishes] {
            hash.text(text);
        }
        hash.count(about.variants.len());
        for variant in about.variants {
            hash.text(variant);
        }
        hash.count(about.parameters.len());
        for parameter in about.parameters {
            hash.text(parameter.key).text(parameter.unit);
        }
    }
    hash.finished()
}

/// Adds what a run of a group is known by: name, readings, drive, dimensions. Which of them a group takes is asked elsewhere,
/// and what is known of its sample's parameters.
pub(crate) fn take_task(hash: &mut InputHash, task: &FitTask) {
    let FitTask {
        run_id: _,
        path,
        revision: _,
        drive,
        area_cm2,
        length_cm,
        electrode_resistance_ohm_per_sq,
        electrode_resistance_error_ohm_per_sq,
        sample: _,
        instrument: _,
        started_at: _,
        data_hash,
        climate_hash: _,
        last_asked: _,
    } = task;
    hash.text(path)
        .text(data_hash)
        .drive(drive)
        .number(*area_cm2)
        .number_or_none(*length_cm)
        .number_or_none(*electrode_resistance_ohm_per_sq);
    // Where none is known the form is that of results before it could be.
    if let Some(error) = electrode_resistance_error_ohm_per_sq {
        hash.number(*error);
    }
}

/// Whether a run is weighed by kinds of noise, of which other runs of its instrument tell.
pub(crate) fn is_weighed_by_kinds(task: &FitTask, options: &FitOptions, known: &[KnownParameter]) -> bool {
    matches!(options.noise, NoiseBy::Kinds(_))
        && options.is_weighed_by_kinds()
        && known.is_empty()
        && !task.drive.moves()
}

/// Hash of everything that a fit depends on, where `others` tell of the noise of its instrument.
pub(crate) fn input_hash_beside<'a>(own: String, others: impl IntoIterator<Item = &'a str>) -> String {
    let mut others = others.into_iter().peekable();
    if others.peek().is_none() {
        return own;
    }
    let mut hash = InputHash::new();
    hash.text(&own);
    others.for_each(|other| {
        hash.text(other);
    });
    hash.finished()
}

/// Hash of everything that the fit of a run alone depends on.
pub(crate) fn input_hash(task: &FitTask, options: &FitOptions, known: &[KnownParameter]) -> String {
    // The name is in no fit; the sample chose what is known; how a fit was asked for last chose the options; instrument and start
    // choose which others tell of its noise.
    let FitTask {
        run_id: _,
        path: _,
        revision: _,
        drive,
        area_cm2,
        length_cm,
        electrode_resistance_ohm_per_sq: along,
        electrode_resistance_error_ohm_per_sq: along_error,
        sample: _,
        instrument: _,
        started_at: _,
        data_hash,
        climate_hash: _,
        last_asked: _,
    } = task;
    let mut hash = InputHash::new();
    hash.text(data_hash).drive(drive);
    hash.number(*area_cm2).number_or_none(*length_cm);
    if options.model.id == distributed::MODEL_ID || along.is_some() {
        hash.number_or_none(*along);
        // Where none is known the form is that of fits before it could be.
        if let Some(error) = along_error {
            hash.number(*error);
        }
    }
    let (model, method) = (options.model, options.method);
    hash.text(model.id)
        .whole(model.version.into())
        .text(method.id())
        .flag(options.steps == Steps::Simultaneous);
    if drive.moves() {
        hash.whole(MOVING_VERSION.into());
    }
    if method.is_random() {
        hash.whole(options.seed);
    }
    if is_weighed_by_kinds(task, options, known) {
        hash.text("kinds of noise");
    }
    // Where nothing is known the form is that of fits before it could be.
    for known in known {
        hash.text(&known.to_string());
    }
    hash.finished()
}
