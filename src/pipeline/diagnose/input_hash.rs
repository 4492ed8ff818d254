//! Hashes of everything that a diagnosis depends on.

use super::subject::Subject;
use crate::diagnose::{self, DiagnoseOptions};
use crate::model::effects;
use crate::pipeline::group_tags::take_tags;
use crate::store::FitTask;

/// Hash of the library of effects: ids, forms, parameters with units, equations, limits.
pub(in crate::pipeline) fn library_hash() -> String {
    let mut hasher = blake3::Hasher::new();
    let mut take = |text: &str| {
        hasher.update(&(text.len() as u64).to_le_bytes());
        hasher.update(text.as_bytes());
    };
    for effect in effects::ALL {
        let about = effect.about();
        [about.id, about.code, about.equation, about.vanishes]
            .into_iter()
            .for_each(&mut take);
        about.variants.iter().for_each(|variant| take(variant));
        for parameter in about.parameters {
            take(parameter.key);
            take(parameter.unit);
        }
    }
    hasher.finalize().to_hex().to_string()
}

/// Adds what a run of a group is known by: name, readings, drive, dimensions.
pub(in crate::pipeline) fn take_task(hasher: &mut blake3::Hasher, task: &FitTask) {
    let drive = format!("{:?}", task.drive);
    for text in [&task.path, &task.data_hash, &drive] {
        hasher.update(&(text.len() as u64).to_le_bytes());
        hasher.update(text.as_bytes());
    }
    hasher.update(&task.area_cm2.to_le_bytes());
    hasher.update(&task.length_cm.unwrap_or(f64::NAN).to_le_bytes());
    if let Some(along) = task.electrode_resistance_ohm_per_sq {
        hasher.update(&along.to_le_bytes());
    }
}

/// Hash of readings, drives, dimensions, names, tags that differ, base model, library, seed, draws, versions, and of whether a run is alone.
pub(super) fn input_hash(
    subject: &Subject,
    tasks: &[FitTask],
    options: &DiagnoseOptions,
    library: &str,
) -> String {
    let mut hasher = blake3::Hasher::new();
    for &member in &subject.members {
        take_task(&mut hasher, &tasks[member]);
    }
    for &member in &subject.right {
        hasher.update(b"right");
        take_task(&mut hasher, &tasks[member]);
    }
    take_tags(&mut hasher, &subject.tags);
    let apart = subject.set_apart.as_ref().map_or("", |issue| &issue.message);
    let model = options.model;
    hasher.update(
        format!(
            "{}/{}/{}/{}/{library}/{}/{}/{apart}",
            model.id,
            model.version,
            options.seed,
            options.draws,
            diagnose::VERSION,
            subject.of_several
        )
        .as_bytes(),
    );
    hasher.finalize().to_hex().to_string()
}
